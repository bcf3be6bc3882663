#!/usr/bin/env python3
"""Checks the blocks of Markdown files: runs every `sh` block and compares what it prints with the `text` block below it.

    run_commands.py [FILE.md …] [--but FILE.md …] --work FOLDER --source SOURCE --build BUILD --programs NAME=PATH …
                    [--before SCRIPT] [--instead OLD=NEW …]

Without FILE all Markdown files of SOURCE are taken, but those named after --but. A line of a `text` block must occur in the
output: its words one after the other in one line, but for punctuation at their ends, numbers to 2 %. Lines follow each
other in the output; `…` allows any number of lines between, which without it are not allowed but for blank ones and rules.
Blocks run in FOLDER, in order, each with `set -e`; before them SCRIPT, which makes the files that they read. A comment
above a block may say `<!-- not run: why -->` or `<!-- needs VARIABLE -->`.

Other blocks: every option of a `usage` block is in the command's help; a `toml` block is TOML; each line of a `cpp` or
`cmake` block stands in tests/consumer; Python and Octave read a `python` or `matlab` block. Any other language is refused.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

from markdown import list_documents, read_blocks

TOLERANCE = 0.02
NUMBER = re.compile(r"[-+]?\d+(\.\d+)?([eE][-+]?\d+)?$")


def same_word(expected, word):
    expected, word = expected.rstrip(",;:"), word.rstrip(",;:")
    if NUMBER.match(expected) and NUMBER.match(word):
        return abs(float(expected) - float(word)) <= TOLERANCE * abs(float(expected))
    return expected == word


def fits(expected, line):
    """True if the words of `expected` occur in `line` one after the other."""
    wanted, words = expected.split(), line.split()
    return any(len(words) - start >= len(wanted) and all(map(same_word, wanted, words[start:]))
               for start in range(len(words) - len(wanted) + 1))


def find_missing(expected, output):
    """The first expected line that does not occur where it should; None if all do."""
    lines = [line for line in output.split("\n") if line.strip() and not set(line) <= set("- ")]
    at, anywhere = 0, True
    for wanted in expected:
        if wanted == "…":
            anywhere = True
            continue
        found = next((i for i in range(at, len(lines) if anywhere else min(at + 1, len(lines))) if fits(wanted, lines[i])), None)
        if found is None:
            return wanted
        at, anywhere = found + 1, False
    return None


class Runner:
    def __init__(self, arguments):
        self.work, self.source = arguments.work, arguments.source
        self.instead = [pair.split("=", 1) for pair in arguments.instead]
        shutil.rmtree(self.work, ignore_errors=True)
        (self.work / "bin").mkdir(parents=True)
        for name, path in (program.split("=") for program in arguments.programs):
            (self.work / "bin" / name).symlink_to(path)
        for folder in ("models", "scripts", "tests"):
            (self.work / folder).symlink_to(self.source / folder)
        self.environment = {**os.environ, "PATH": f"{self.work}/bin:{os.environ['PATH']}", "BUILD": str(arguments.build)}

    def run(self, commands):
        """(exit status, standard output, both)"""
        for old, new in self.instead:
            commands = commands.replace(old, new)
        done = subprocess.run(["bash", "-e"], input=commands, cwd=self.work, env=self.environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
        return done.returncode, done.stdout, done.stdout + done.stderr

    def check(self, block):
        """What happened, and whether it was right."""
        body = "\n".join(block.body)
        if block.remark.startswith("not run: "):
            return block.remark, True
        needed = block.remark.removeprefix("needs ") if block.remark.startswith("needs ") else None
        if needed and not os.environ.get(needed):
            return f"skipped: {needed} is not set", True
        if block.language == "sh":
            status, output, everything = self.run(body)
            missing = find_missing(block.output, output) if block.output else None
            if status == 0 and missing is None:
                return "as shown" if block.output else "runs", True
            return f"exit status {status}, not found: {missing}\n{body}\n{everything}", False
        if block.language == "usage":
            command = " ".join(word for word in body.split() if re.match(r"[a-z-]+$", word) and not word.startswith("-"))
            helped = self.run(f"{command} --help")[1]
            unknown = [option for option in re.findall(r"--[a-z-]+", body) if option not in helped]
            return (f"`{command} --help` does not know {unknown}", False) if unknown else ("as helped", True)
        if block.language == "toml":
            try:
                tomllib.loads(body)
            except tomllib.TOMLDecodeError as error:
                return f"is no TOML: {error}", False
            return "TOML", True
        if block.language in ("cpp", "cmake"):
            consumer = "".join(path.read_text() for path in sorted((self.source / "tests/consumer").iterdir()))
            squeezed = "".join(consumer.split())
            strange = [line for line in block.body if "".join(line.split("  #")[0].split()) not in squeezed]
            return (f"not in tests/consumer: {strange}", False) if strange else ("as in tests/consumer", True)
        if block.language == "matlab":
            octave = shutil.which("octave-cli")
            if octave is None:
                return "no Octave to read it", True
            done = subprocess.run([octave, "--no-init-file", "--quiet", "--eval", f"if false\n{body}\nend"],
                                  capture_output=True, text=True, check=False)
            return ("read by Octave", True) if done.returncode == 0 else (f"is not read by Octave: {done.stderr}", False)
        if block.language == "python":
            try:
                compile(body, "block", "exec")
            except SyntaxError as error:
                return f"is no Python: {error}", False
            return "Python", True
        return f"a block of language '{block.language}' is not checked: sh, text, usage, toml, python, matlab, cpp, cmake are", False


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("markdown", nargs="*", type=Path)
    parser.add_argument("--but", nargs="*", default=[], type=Path)
    for option in ("work", "source", "build"):
        parser.add_argument("--" + option, required=True, type=Path)
    parser.add_argument("--programs", nargs="+", required=True)
    parser.add_argument("--before", type=Path)
    parser.add_argument("--instead", nargs="*", default=[], help="OLD=NEW: what is run where a document shows OLD")
    arguments = parser.parse_args()
    runner = Runner(arguments)
    if arguments.before:
        status, _, everything = runner.run(arguments.before.read_text(encoding="utf-8"))
        if status != 0:
            raise SystemExit(f"{arguments.before}: exit status {status}\n{everything}")
    failures = 0
    for file in arguments.markdown or list_documents(arguments.source):
        if file in arguments.but:
            continue
        for block in read_blocks(file.read_text(encoding="utf-8")):
            said, right = runner.check(block)
            failures += not right
            print(f"{file.relative_to(arguments.source)}:{block.line}: {said}", flush=True)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
