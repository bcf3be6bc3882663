#!/usr/bin/env python3
"""Helps scripts/demo: draws a wrong model to start from, and sets identified values beside the true ones.

  true_and_identified.py believe TRUE.toml BELIEVED.toml SEED
  true_and_identified.py table TRUE.toml BELIEVED.toml FIT.json
"""
import json
import random
import re
import shutil
import sys
import tomllib
from pathlib import Path


def believe(true_file, believed_file, seed):
    """Writes the model with each stiffness, damping and clearance changed by up to 25 %."""
    source = Path(true_file)
    draw = random.Random(int(seed))

    def change(match):
        return f"{match[1]}{float(match[2]) * draw.uniform(0.75, 1.25):.6g}"

    text = re.sub(r"((?:^|[{,\s])(?:stiffness|damping|clearance)\s*=\s*)([-+0-9.eE]+)", change, source.read_text())
    Path(believed_file).write_text(text)
    modes = tomllib.loads(text).get("bracket", {}).get("modes")
    if modes:
        shutil.copy(source.parent / modes, Path(believed_file).parent / modes)


def parameters(file):
    """Values of a model by the names that the results use."""
    values = {}
    for connection in tomllib.loads(Path(file).read_text())["connection"]:
        for axis in "xyz":
            law = connection.get(axis, {})
            for key in ("stiffness", "damping"):
                values[f"{connection['name']}.{axis}.{key}"] = law.get(key, 0.0)
            for stop in law.get("stops", []):
                for key in ("clearance", "stiffness"):
                    values[f"{connection['name']}.{axis}.{stop['side']}.{key}"] = stop[key]
    return values


def combination(expression, values):
    """Value of a text such as `1.x.stiffness + 2 3.y.stiffness - 4.y.stiffness`."""
    total, factor = 0.0, 1.0
    for word in expression.split():
        if word in "+-":
            factor = -1.0 if word == "-" else 1.0
            continue
        if word.startswith("-"):
            factor, word = -1.0, word[1:]
        if word in values:
            total += factor * values[word]
        else:
            factor *= float(word)
    return total


def table(true_file, believed_file, fit_file):
    true, believed = parameters(true_file), parameters(believed_file)
    fit = json.loads(Path(fit_file).read_text())
    rows = [("parameter", "true", "started from", "identified", "error %", "95 % interval", "holds the truth")]
    held = []
    for p in fit["parameters"]:
        name = p["name"]
        if name not in true:
            continue
        rows.append(row(name, true[name], believed[name], p, held))
    for group in fit["not_identifiable"]:
        expression = group.get("known_combination")
        if expression and group.get("interval95"):
            rows.append(row(expression, combination(expression, true), combination(expression, believed), group, held))
    widths = [max(len(r[i]) for r in rows) for i in range(len(rows[0]))]
    for number, r in enumerate(rows):
        print("  ".join(c.ljust(w) if i == 0 else c.rjust(w) for i, (c, w) in enumerate(zip(r, widths))))
        if number == 0:
            print("  ".join("-" * w for w in widths))
    alone = list(dict.fromkeys(n for g in fit["not_identifiable"] for n in g["names"]))
    if alone:
        print("\nNot identifiable one by one from these runs: " + ", ".join(alone))
    print(f"\n{sum(held)} of {len(held)} intervals hold the truth.")


def row(name, true, believed, result, held):
    value, interval = result["value"], result["interval95"]
    held.append(interval[0] <= true <= interval[1])
    error = "-" if abs(true) < 1e-9 else f"{100 * (value / true - 1):+.3f}"
    return (name, f"{true:.6g}", f"{believed:.6g}", f"{value:.6g}", error, f"{interval[0]:.6g} … {interval[1]:.6g}", "yes" if held[-1] else "no")


if __name__ == "__main__":
    {"believe": believe, "table": table}[sys.argv[1]](*sys.argv[2:])
