#!/usr/bin/env python3
"""Runs every `sh` block of a Markdown file and compares what it prints with the `text` block below it.

    run_commands.py FILE.md --work FOLDER --source SOURCE --build BUILD --programs NAME=PATH …

A line of a `text` block must occur in the output: its words one after the other in one line, but for punctuation at their
ends, numbers to 2 %. Lines follow
each other in the output; `…` allows any number of lines between, which without it are not allowed but for blank ones and
rules. Blocks run in FOLDER, in order, each with `set -e`.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

TOLERANCE = 0.02
NUMBER = re.compile(r"[-+]?\d+(\.\d+)?([eE][-+]?\d+)?$")


def read_blocks(markdown):
    """(line number, commands, expected output or None) of each `sh` block."""
    blocks, lines, i = [], markdown.split("\n"), 0
    while i < len(lines):
        if lines[i] in ("```sh", "```text"):
            end = lines.index("```", i + 1)
            body = lines[i + 1:end]
            if lines[i] == "```sh":
                blocks.append((i + 1, "\n".join(body), None))
            else:
                line, commands, shown = blocks.pop()
                if shown is not None:
                    raise SystemExit(f"line {i + 1}: output without a command")
                blocks.append((line, commands, body))
            i = end
        i += 1
    return blocks


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


def prepare(work, source, programs):
    shutil.rmtree(work, ignore_errors=True)
    (work / "bin").mkdir(parents=True)
    for name, path in (program.split("=") for program in programs):
        (work / "bin" / name).symlink_to(path)
    for folder in ("models", "tests"):
        (work / folder).symlink_to(source / folder)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("markdown", type=Path)
    for option in ("work", "source", "build"):
        parser.add_argument("--" + option, required=True, type=Path)
    parser.add_argument("--programs", nargs="+", required=True)
    arguments = parser.parse_args()
    prepare(arguments.work, arguments.source, arguments.programs)
    environment = {**os.environ, "PATH": f"{arguments.work}/bin:{os.environ['PATH']}", "BUILD": str(arguments.build)}
    blocks = read_blocks(arguments.markdown.read_text(encoding="utf-8"))
    if not blocks:
        raise SystemExit(f"{arguments.markdown}: no command")
    failures = 0
    for line, commands, expected in blocks:
        where = f"{arguments.markdown.name}:{line}"
        done = subprocess.run(["bash", "-e"], input=commands, cwd=arguments.work, env=environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
        missing = find_missing(expected, done.stdout) if expected else None
        if done.returncode != 0 or missing is not None:
            failures += 1
            print(f"{where}: exit status {done.returncode}, not found: {missing}\n{commands}\n{done.stdout}{done.stderr}")
            if done.returncode != 0:
                break
        else:
            print(f"{where}: as shown")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
