"""clang-tidy on the sources of a build tree whose path matches a pattern; what passed is remembered and not read again.

  scripts/tidy.py BUILD_FOLDER PATTERN [CLANG_TIDY_OPTION ...]

A source is known to pass if its preprocessed text, comments included, is one that passed under the same configuration,
options and version. The memory lies beside the compiler's cache: ${XDG_CACHE_HOME:-~/.cache}/wems-tidy.
"""
import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

CLANG_TIDY = "clang-tidy-14"


def preprocess(entry):
    """The source as clang-tidy reads it, without the names of the files that it comes from."""
    command = shlex.split(entry["command"])
    output = command.index("-o")
    del command[output:output + 2]
    if "-include-pch" in command:  # holds no text: the header that it was made of is included, too
        at = command.index("-include-pch")
        del command[at - 1:at + 3]
    command.remove("-c")
    # -C keeps comments, since they can silence a finding; -P leaves out line markers, which hold paths.
    return subprocess.run([*command, "-E", "-C", "-P", "-Wno-everything"], cwd=entry["directory"], check=True,
                          stdout=subprocess.PIPE).stdout


def check(entry, folder, options, memory, same):
    """What clang-tidy finds in a source; empty if nothing."""
    key = hashlib.sha256(same + preprocess(entry)).hexdigest()
    stamp = os.path.join(memory, key)
    if os.path.exists(stamp):
        os.utime(stamp)
        return ""
    run = subprocess.run([CLANG_TIDY, "-quiet", "-p", folder, *options, entry["file"]], stdout=subprocess.PIPE,
                         stderr=subprocess.PIPE, text=True)
    if run.returncode == 0:
        open(stamp, "w").close()
        return ""
    return run.stdout + run.stderr


def main():
    folder, pattern, *options = sys.argv[1:]
    memory = os.path.join(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "wems-tidy")
    os.makedirs(memory, exist_ok=True)
    with open(f"{folder}/compile_commands.json") as file:
        entries = [entry for entry in json.load(file) if re.search(pattern, entry["file"])]
    if not entries:
        sys.exit(f"{folder}/compile_commands.json: no source matches {pattern}")
    version = subprocess.run([CLANG_TIDY, "--version"], check=True, stdout=subprocess.PIPE).stdout
    with open(".clang-tidy", "rb") as file:
        same = version + file.read() + " ".join(options).encode()
    failed = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for found in pool.map(lambda entry: check(entry, folder, options, memory, same), entries):
            if found:
                failed += 1
                print(found, flush=True)
    print(f"{len(entries) - failed} of {len(entries)} without findings")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
