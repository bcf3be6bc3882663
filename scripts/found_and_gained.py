#!/usr/bin/env python3
"""Helps scripts/demo: a model that has the centre of gravity in the wrong place, and what finding that gains.

  found_and_gained.py believe TRUE.toml BELIEVED.toml
  found_and_gained.py table TRUE.toml BELIEVED.toml DIAGNOSIS.json BEFORE.json AFTER.json
"""
import json
import re
import shutil
import sys
import tomllib
from pathlib import Path


def believe(true_file, believed_file):
    """Writes the model with the centre of gravity at the centre of the connections."""
    source, target = Path(true_file), Path(believed_file)
    text, count = re.subn(r"(?m)^center_of_gravity\s*=\s*\[[^\]]*\]", "center_of_gravity = [0.0, 0.0, 0.0]", source.read_text())
    if count != 1:
        sys.exit(f"{true_file}: [body] has no center_of_gravity to change")
    target.write_text(text)
    modes = tomllib.loads(text).get("bracket", {}).get("modes")
    if modes and source.parent != target.parent:
        shutil.copy(source.parent / modes, target.parent / modes)


def table(true_file, believed_file, diagnosis_file, before_file, after_file):
    def read(file):
        return json.loads(Path(file).read_text())

    def center(file):
        return tomllib.loads(Path(file).read_text())["body"]["center_of_gravity"]

    diagnosis, before, after = read(diagnosis_file), read(before_file), read(after_file)
    causes = ", ".join(f"{c['cause']} at {' '.join(c['where'])} ({c['probability']:.3f})" for c in diagnosis["causes"])
    print(f"Verdict of the diagnosis: {diagnosis['verdict']}; causes (probability): {causes or 'none'}")
    row = "{:28s} {:>12s} {:>12s} {:>12s} {:>26s}".format
    print(row("centre of gravity, mm", "true", "believed", "found", "95 % interval"))
    found = {p["name"]: p for c in diagnosis["causes"] if c["cause"] == "cog_offset" for p in c["parameters"]}
    for k, axis in enumerate("xyz"):
        cells = ["-", "-"]
        if axis in found:
            interval = " … ".join(f"{1e3 * bound:.3f}" for bound in found[axis]["interval95"])
            cells = [f"{1e3 * found[axis]['value']:.3f}", interval]
        print(row(axis, f"{1e3 * center(true_file)[k]:.1f}", f"{1e3 * center(believed_file)[k]:.1f}", *cells))
    print(row("error of the simulation", "", "before", "after", "noise alone"))
    floor = diagnosis["unexplained"]["noise_floor"]
    print(row("  of a run not fitted to", "", f"{100 * before['error']:.2f} %", f"{100 * after['error']:.2f} %", f"{100 * floor:.2f} %"))


if __name__ == "__main__":
    {"believe": believe, "table": table}[sys.argv[1]](*sys.argv[2:])
