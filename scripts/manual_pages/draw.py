#!/usr/bin/env python3
"""Draws the figures of the manual into the folder `figures` beside this file.

    draw.py --work FOLDER --programs simulate=PATH identify=PATH [NAME …]

Models and curves come from the shipped files and from runs of the programs, which FOLDER keeps. Without NAME all of
all are drawn.
"""
import argparse
import importlib
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
sys.path.insert(0, str(HERE / "drawing"))
FIGURES = ("device", "loop", "laws", "decision", "result")


class Work:
    """Runs the programs in a folder of their own."""

    def __init__(self, folder, programs):
        self.folder = folder.resolve()
        self.folder.mkdir(parents=True, exist_ok=True)
        self.programs = {name: str(Path(path).resolve()) for name, path in programs.items()}

    def run(self, program, *arguments, accepted=(0,)):
        done = subprocess.run([self.programs[program], *map(str, arguments), "--quiet"], cwd=self.folder, text=True,
                              capture_output=True, check=False)
        if done.returncode not in accepted:
            raise SystemExit(f"{program} {' '.join(map(str, arguments))}: {done.stderr}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--programs", nargs=2, required=True)
    parser.add_argument("names", nargs="*", metavar="NAME", help="one of " + ", ".join(FIGURES))
    arguments = parser.parse_args()
    work = Work(arguments.work, dict(program.split("=", 1) for program in arguments.programs))
    folder = HERE / "figures"
    folder.mkdir(exist_ok=True)
    for name in arguments.names or FIGURES:
        print(name, flush=True)
        importlib.import_module(name).draw(SOURCE, work, folder)


if __name__ == "__main__":
    main()
