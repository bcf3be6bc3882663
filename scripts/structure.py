#!/usr/bin/env python3
"""The structure of the sources in figures, one column for each revision: structure.py [--imports] [REVISION …]

Files, lines, median sizes, headers under 35 lines and casts, of models, plugin, identify and tests.
--imports also lists which folder includes headers of which others, in the last revision. Without a revision: HEAD.
"""
import argparse
import re
import statistics
import subprocess
from collections import Counter, defaultdict

CAST = re.compile(r"static_cast<")
SMALL = 35


def git(*arguments):
    return subprocess.run(["git", *arguments], capture_output=True, check=True).stdout


def read_sources(revision):
    """{path: text} of the C++ sources of a revision."""
    names = git("ls-tree", "-r", "--name-only", revision, "models", "plugin", "identify", "tests").decode().split("\n")
    names = [name for name in names if name.endswith((".hpp", ".cpp"))]
    request = "".join(f"{revision}:{name}\n" for name in names).encode()
    blobs = subprocess.run(["git", "cat-file", "--batch"], input=request, capture_output=True, check=True).stdout
    sources, at = {}, 0
    for name in names:
        end = blobs.index(b"\n", at)
        size = int(blobs[at:end].split()[2])
        sources[name] = blobs[end + 1:end + 1 + size].decode()
        at = end + size + 2
    return sources


def measure(sources):
    lines = {name: text.count("\n") for name, text in sources.items()}
    own = {name: count for name, count in lines.items() if not name.startswith("tests/")}
    headers = [count for name, count in own.items() if name.endswith(".hpp")]
    bodies = [count for name, count in own.items() if name.endswith(".cpp")]
    tests = [count for name, count in lines.items() if re.search(r"^tests/.*/test_[^/]*\.cpp$", name)]
    casts = sum(len(CAST.findall(sources[name])) for name in own)
    return {"source files (headers and sources, without tests)": len(own), "headers": len(headers),
            f"headers under {SMALL} lines": sum(count < SMALL for count in headers), "lines": sum(own.values()),
            "median lines of a header": statistics.median(headers), "median lines of a source": statistics.median(bodies),
            "median lines of a test": statistics.median(tests), "longest file": max(own.values()),
            "files above 400 lines": sum(count > 400 for count in own.values()), "files of tests": len(lines) - len(own),
            "lines of tests": sum(lines.values()) - sum(own.values()),
            "casts in 1000 lines": round(1000 * casts / sum(own.values()), 1)}


def list_imports(sources):
    """{folder: how many of its files include which other folders}"""
    imports = defaultdict(Counter)
    for name, text in sources.items():
        folder = name.rsplit("/", 1)[0]
        if folder.startswith("tests"):
            continue
        others = {other.rsplit("/", 1)[0] for other in re.findall(r'#include "((?:models|plugin|identify)/[^"]+)"', text)}
        imports[folder].update(others - {folder})
    return imports


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("revisions", nargs="*", default=["HEAD"])
    parser.add_argument("--imports", action="store_true")
    options = parser.parse_args()
    columns = [measure(read_sources(revision)) for revision in options.revisions]
    print("| what | " + " | ".join(options.revisions) + " |\n| --- |" + " --- |" * len(columns))
    for what in columns[0]:
        print(f"| {what} | " + " | ".join(f"{column[what]:g}" for column in columns) + " |")
    if options.imports:
        print("\n| folder | includes, files |\n| --- | --- |")
        for folder, others in sorted(list_imports(read_sources(options.revisions[-1])).items()):
            print(f"| {folder} | " + ", ".join(f"{other} {count}" for other, count in sorted(others.items())) + " |")


if __name__ == "__main__":
    main()
