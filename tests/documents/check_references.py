#!/usr/bin/env python3
"""Links and paths of all Markdown files of the source tree lead somewhere, and no sentence is too long to read.

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


def main():
    source = Path(sys.argv[1]).resolve()
    broken = []
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
