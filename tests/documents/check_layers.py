#!/usr/bin/env python3
"""No source includes a header that its folder must not know of.

    check_layers.py SOURCE

Libraries: models/common < models/recording < models < the other folders of models; models < identify, plugin; identify
never includes plugin. Folders of identify: each includes those only that stand above it in identify/CMakeLists.txt.
"""
import re
import sys
from pathlib import Path

INCLUDE = re.compile(r'^#include "((?:models|identify|plugin|tests)/[^"]+)"', re.MULTILINE)


def list_layers(source):
    """Folders, the lowest first; those of one rank are independent of the caller's point of view."""
    folders = re.findall(r"^\s*add_subdirectory\((\w+)\)", (source / "identify/CMakeLists.txt").read_text(encoding="utf-8"), re.MULTILINE)
    return [["models/common"], ["models/recording"], ["models"],
            [f"models/{name}" for name in ("beam", "command_line", "periodic", "report", "result")],
            *([f"identify/{folder}"] for folder in folders if folder != "python"), ["plugin"], ["identify/python"], ["plugin/python"]]


def main():
    source = Path(sys.argv[1]).resolve()
    ranks = {folder: rank for rank, folders in enumerate(list_layers(source)) for folder in folders}
    broken = []
    for file in sorted(path for top in ("models", "identify", "plugin") for path in (source / top).rglob("*.[ch]pp")):
        name = file.relative_to(source)
        own = str(name.parent)
        if own not in ranks:
            broken.append(f"{name}: its folder has no place among the layers")
            continue
        for header in INCLUDE.findall(file.read_text(encoding="utf-8")):
            other = str(Path(header).parent)
            allowed = other == own or ranks.get(other, len(ranks)) < ranks[own]
            if own.startswith("plugin") and other.startswith("identify"):
                allowed = own == "plugin/python"
            if not allowed:
                broken.append(f"{name}: includes {header}, of a folder that is not below its own")
    print("\n".join(broken) or f"{len(ranks)} folders, each includes only those below it")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
