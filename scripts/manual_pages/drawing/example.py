"""The worked example: a device on which everything is a bit off and one elastomer hardens, three runs of it, the model
that was believed, and the diagnosis. Made once for all figures that show it."""
import csv
import json
import random
import re
import shutil

HARDENING = "3.0e10"  # N/m³, at 3.z: hidden
# Half of a tolerance each, as a share of the number (stated below).
SCATTER = {"stiffness": 0.04, "damping": 0.12, "mass": 0.002, "clearance": 0.02, "stop": 0.06}
TOLERANCES = """
[tolerance]
stiffness = 0.08
damping = 0.25
mass = 0.005
clearance = 0.04
stop_stiffness = 0.12
sensor_gain = 2.0e-3                      # calibrated before the test
sensor_rotation = 2.0e-3
sensor_position = 2.0e-4
"""
RUNS = {"run1": "z=200", "run2": "x=80,y=60", "run3": "x=50,z=150"}  # the third one judges
SWEEP = (5.0, 50.0, 30.0)  # Hz, Hz, octaves per minute


def draw_true_model(text, generator):
    """The shipped model with every number off by chance, and the hardening."""
    def off(value, kind):
        return f"{float(value) * (1 + SCATTER[kind] * max(-1.8, min(1.8, generator.gauss(0, 1)))):.6g}"

    section, connection, lines = "", "", []
    for line in text.split("\n"):
        if match := re.match(r"\[+(.*?)\]+$", line):
            section = match.group(1)
        if match := re.match(r'name = "(\d)"', line):
            connection = match.group(1)
        line = re.sub(r"^(stiffness|damping|mass) = ([\d.e+]+)", lambda m: f"{m[1]} = {off(m[2], m[1])}", line)
        line = re.sub(r"clearance = ([\d.e-]+), stiffness = ([\d.e+]+)",
                      lambda m: f"clearance = {off(m[1], 'clearance')}, stiffness = {off(m[2], 'stop')}", line)
        line = line.replace("[0.0, 0.0, 0.1415]", "[0.0004, -0.0006, 0.1411]")
        lines.append(line)
        if (section, connection) == ("connection.z", "3") and line.startswith("stiffness"):
            lines.append(f"cubic = {HARDENING}")
    return "\n".join(lines)


def read_rows(file, *names):
    with open(file, encoding="utf-8", newline="") as stream:
        rows = csv.DictReader(line for line in stream if not line.startswith("#"))
        columns = {name.split(" ")[0]: name for name in rows.fieldnames}
        return [[float(row[columns[name]]) for name in names] for row in rows]


def make(source, work):
    """The diagnosis as data; files stay in the folder of `work`."""
    result = work.folder / "diagnosis.json"
    if result.exists():
        return json.loads(result.read_text(encoding="utf-8"))
    shipped = source / "models/shipped"
    shutil.copy(shipped / "smallsat_bracket.csv", work.folder)
    text = (shipped / "smallsat_wems.toml").read_text(encoding="utf-8")
    (work.folder / "true.toml").write_text(draw_true_model(text, random.Random(7)), encoding="utf-8")
    (work.folder / "believed.toml").write_text(text + TOLERANCES, encoding="utf-8")
    for seed, (run, force) in enumerate(RUNS.items(), 1):
        work.run("simulate", "true.toml", "--sweep", f"{SWEEP[0]:g}:{SWEEP[1]:g}", "--rate", SWEEP[2], "--force", force, "--channels",
                 "displacement", "--noise", "displacement=2e-6,load=0.2", "--seed", seed, "-o", f"{run}.csv")
    work.run("identify", "diagnose", "run1.csv", "run2.csv", "--model", "believed.toml", "--validate", "run3.csv", "-o",
             "extended.toml", "--json", result.name, "--report", "diagnosis.html")
    for model in ("believed", "extended"):
        work.run("simulate", f"{model}.toml", "--from-csv", "run3.csv", "-o", f"run3_{model}.csv")
    return json.loads(result.read_text(encoding="utf-8"))
