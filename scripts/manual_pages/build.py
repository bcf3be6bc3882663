#!/usr/bin/env python3
"""Builds the manual: the Markdown files of the source tree, the pages of this folder, and the commands' own help.

    build.py --source SOURCE --output FOLDER --programs simulate=PATH identify=PATH

FOLDER/source holds what Sphinx reads, FOLDER/html the pages. Any warning, link that leads nowhere or picture that is
missing fails. Exit status 77: there is no Sphinx, MyST or theme (Debian: python3-sphinx, python3-myst-parser, furo).
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import check_pages
import commands

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "tests/documents"))
from markdown import list_documents, read_links  # noqa: E402


def find_missing_tools():
    missing = []
    for module in ("sphinx", "myst_parser", "furo"):
        if subprocess.run([sys.executable, "-c", f"import {module}"], capture_output=True, check=False).returncode:
            missing.append(module)
    return missing


def stage(source, target):
    """All documents at the place that they have in the tree, and the files that they link."""
    shutil.rmtree(target, ignore_errors=True)
    for document in list_documents(source):
        copied = target / document.relative_to(source)
        copied.parent.mkdir(parents=True, exist_ok=True)
        text = document.read_text(encoding="utf-8")
        for link in read_links(text):
            linked = (document.parent / link).resolve()
            if linked.is_file() and linked.suffix != ".md":
                place = target / linked.relative_to(source)
                place.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(linked, place)
        copied.write_text(unlink_folders(text, document.parent), encoding="utf-8")


def unlink_folders(text, folder):
    """A page cannot show a folder: the link's text stays."""
    return re.sub(r"\[([^\]]*)\]\(([^)\s]+)\)",
                  lambda link: link.group(1) if (folder / link.group(2)).is_dir() else link.group(0), text)


def read_version(source):
    return re.search(r"project\(wems VERSION ([0-9.]+)", (source / "CMakeLists.txt").read_text(encoding="utf-8")).group(1)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--source", type=Path, required=True)
    parser.add_argument("--output", type=Path, required=True)
    parser.add_argument("--programs", nargs=2, required=True, help="NAME=PATH")
    arguments = parser.parse_args()
    missing = find_missing_tools()
    if missing:
        print(f"skipped: no {', '.join(missing)} (Debian: python3-sphinx, python3-myst-parser, furo)")
        return 77
    source = arguments.source.resolve()
    staged, pages = arguments.output / "source", arguments.output / "html"
    stage(source, staged)
    programs = dict(program.split("=", 1) for program in arguments.programs)
    (staged / "scripts/manual_pages/commands.md").write_text(commands.describe(programs), encoding="utf-8")
    shutil.rmtree(pages, ignore_errors=True)
    environment = {**os.environ, "WEMS_VERSION": read_version(source), "PYTHONDONTWRITEBYTECODE": "1"}
    status = subprocess.run([sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-n", "-c", str(HERE), "-d",
                             str(arguments.output / "doctrees"), str(staged), str(pages)], env=environment, check=False).returncode
    if status:
        return status
    shutil.copy(pages / "README.html", pages / "index.html")
    faults = check_pages.find_faults(pages)
    print("\n".join(faults) or f"{len(list(pages.rglob('*.html')))} pages, all links and pictures are there")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
