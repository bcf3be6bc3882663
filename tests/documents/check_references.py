#!/usr/bin/env python3
"""Links and paths of all Markdown files of the source tree lead somewhere, no sentence is too long to read, and the cases
that tests/README.md names are there.

    check_references.py SOURCE

Links count from the file's folder, paths in code style from the top (a header or source from its folder too).
A sentence has at most 45 words; rows of tables do not count.
"""
import re
import sys
from pathlib import Path

from markdown import list_documents, read_links, read_paths, read_sentences

MOST_WORDS = 45
FOLDERS = ("models", "plugin", "identify", "tests", "scripts")


def find_missing_cases(source):
    """Beginnings of names in tests/README.md that no case of any test program has."""
    cases = [name for file in (source / "tests").rglob("test_*.cpp")
             for name in re.findall(r'TEST_CASE\("([^"]+)"', file.read_text(encoding="utf-8"))]
    named = re.findall(r'"([^"]+)"', (source / "tests/README.md").read_text(encoding="utf-8"))
    return [f"tests/README.md: case {name}" for name in named if not any(case.startswith(name) for case in cases)]


def main():
    source = Path(sys.argv[1]).resolve()
    broken = find_missing_cases(source)
    for file in list_documents(source):
        text = file.read_text(encoding="utf-8")
        broken += [f"{file}: link to {link}" for link in read_links(text) if not (file.parent / link).exists()]
        broken += [f"{file}: path {path}" for path in read_paths(text, FOLDERS)
                   if not any((base / (path + suffix)).exists() for base in (source, file.parent)
                              for suffix in ("", ".hpp", ".cpp"))]
        for sentence in read_sentences(text):
            words = sum(bool(re.search(r"\w", word)) for word in sentence.split())
            if words > MOST_WORDS:
                broken.append(f"{file}: {words} words: {sentence.strip()}")
    print("\n".join(broken) or "all lead somewhere, no sentence above 45 words")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
