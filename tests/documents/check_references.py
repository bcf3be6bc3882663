#!/usr/bin/env python3
"""Links and paths of all Markdown files of the source tree lead somewhere.

    check_references.py SOURCE

Links count from the file's folder, paths in code style from the top (a header or source from its folder too).
"""
import sys
from pathlib import Path

from markdown import list_documents, read_links, read_paths

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
    print("\n".join(broken) or "all lead somewhere")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
