#!/usr/bin/env python3
"""check_schemas.py IDENTIFY SIMULATE MODELS: the JSON of each command of both programs against the schema that
`identify schema` prints.

The check is stricter than the schema: a key that the schema does not name is a failure, so that what is added to a
result is added to its schema too. The record of each result is compared with what hashlib says of the files.
"""
import copy
import hashlib
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

import jsonschema

IDENTIFY, SIMULATE, MODELS = sys.argv[1:4]
MODEL = f"{MODELS}/smallsat_wems.toml"
ELEMENT = """[body]
mass = 1.0
inertia = [1.0, 1.0, 1.0]
[[connection]]
name = "1"
position = [0.0, 0.0, 0.0]
[connection.x]
stiffness = 1e4
[connection.y]
stiffness = 1e4
[connection.z]
stiffness = 4e4
damping = 10.0
"""
failures = []


def check(condition, text):
    if not condition:
        failures.append(text)


def call(*arguments, status=0):
    done = subprocess.run(arguments, capture_output=True, text=True, check=False)
    check(done.returncode == status, f"{' '.join(map(str, arguments))}: status {done.returncode}, {done.stderr}")
    return done


def close(schema):
    """The schema that takes no key that it does not name."""
    if isinstance(schema, dict):
        for part in schema.values():
            close(part)
        if schema.get("type") == "object" and "properties" in schema:
            schema.setdefault("additionalProperties", False)
    elif isinstance(schema, list):
        for part in schema:
            close(part)
    return schema


def validate(command, result):
    schema = json.loads(call(IDENTIFY, "schema", command).stdout)
    jsonschema.Draft202012Validator.check_schema(schema)
    strict = close(copy.deepcopy(schema))
    for error in jsonschema.Draft202012Validator(strict).iter_errors(result):
        failures.append(f"{command}: {'/'.join(map(str, error.absolute_path))}: {error.message[:300]}")
    # The schema is no empty promise: it refuses the result without its first key and with a wrong version.
    plain = jsonschema.Draft202012Validator(schema)
    check(not plain.is_valid({key: value for key, value in result.items() if key != schema["required"][0]}),
          f"{command}: the schema does not ask for {schema['required'][0]}")
    check(not plain.is_valid({**result, "version": 1}), f"{command}: the schema takes version 1")


def run(command, *arguments, status=0):
    return check_result(command, "identify", [IDENTIFY, command, *arguments], status)


def run_simulate(command, *arguments):
    return check_result(command, "simulate", [SIMULATE, *arguments], 0)


def check_result(command, program, words, status):
    output = pathlib.Path(f"{command}.json")
    output.unlink(missing_ok=True)
    call(*words, "-q", "--json", output, status=status)
    if not output.exists():
        sys.exit("\n".join(failures))
    result = json.loads(output.read_text(encoding="utf-8"))
    validate(command, result)
    check(result["command"] == command, f"{command}: says that it is {result['command']}")
    check(result["program"].startswith(f"wems {program} "), f"{command}: program {result['program']}")
    check(len(result["inputs"]) > 0, f"{command}: no inputs")
    for entry in result["inputs"]:
        digest = hashlib.sha256(pathlib.Path(entry["file"]).read_bytes()).hexdigest()
        check(entry["sha256"] == digest, f"{command}: {entry['file']}: checksum {entry['sha256']}, is {digest}")
    return result


def rename(source, target):
    """The same recording with a laboratory's names, and their map."""
    lines = pathlib.Path(source).read_text(encoding="utf-8").splitlines()
    header = next(i for i, line in enumerate(lines) if not line.startswith("#"))
    own, entries = [], []
    for number, column in enumerate(lines[header].split(",")):
        name, unit = column.split(" [")
        own.append(f"Ch {number} [{unit}")
        entries.append(f'"Ch {number}" = "{name}"')
    lines[header] = ",".join(own)
    pathlib.Path(target).write_text("\n".join(lines) + "\n", encoding="utf-8")
    pathlib.Path("map.toml").write_text("[columns]\n" + "\n".join(entries) + "\n", encoding="utf-8")


def keep_columns(source, target, names):
    """The recording with the columns alone whose names begin so."""
    rows = [line.split(",") for line in pathlib.Path(source).read_text(encoding="utf-8").splitlines()
            if not line.startswith("#")]
    kept = [i for i, name in enumerate(rows[0]) if name.startswith(tuple(names))]
    text = "\n".join(",".join(row[i] for i in kept) for row in rows)
    pathlib.Path(target).write_text(text + "\n", encoding="utf-8")


def write_element(target):
    """One element on a test machine: a spring with a dashpot, 2 Hz, 1 mm."""
    lines = ["time [s],relative.1.z [m],force.1.z [N]"]
    for k in range(2000):
        t, w = 1e-3 * k, 2 * math.pi * 2
        q, v = 1e-3 * math.sin(w * t), 1e-3 * w * math.cos(w * t)
        lines.append(f"{t:.4f},{q:.9e},{5e4 * q + 40 * v:.9e}")
    pathlib.Path(target).write_text("\n".join(lines) + "\n", encoding="utf-8")


def main():
    believed = pathlib.Path(MODEL).read_text(encoding="utf-8").replace("stiffness = 1.0e5", "stiffness = 1.2e5")
    pathlib.Path("believed.toml").write_text(believed, encoding="utf-8")
    pathlib.Path("smallsat_bracket.csv").write_bytes(pathlib.Path(f"{MODELS}/smallsat_bracket.csv").read_bytes())
    noise = ["--noise", "displacement=1e-6,acceleration=0.01,load=0.1"]
    for name, axis in (("run.csv", "z=40"), ("other.csv", "x=30,z=30")):
        call(SIMULATE, MODEL, "--sweep", "8:40", "--rate", "60", "--force", axis, *noise, "-q", "-o", name)
    rename("run.csv", "laboratory.csv")

    simulated = run_simulate("simulate", MODEL, "--sweep", "8:40", "--rate", "120", "--force", "z=400", "-o", "hard.csv")
    check(any(stop["contacts"] for stop in simulated["stops"]), "a hard run touches no stop")
    check(simulated["options"]["force"] == [0, 0, 400], "options of simulate")
    check([entry["role"] for entry in simulated["inputs"]] == ["model", "bracket modes"], "inputs of simulate")
    replayed = run_simulate("simulate", MODEL, "--from-csv", "run.csv")
    check("recording" in [entry["role"] for entry in replayed["inputs"]], "no recording among the inputs of a replay")
    pathlib.Path("test.csv").write_text("frequency [Hz],density [g^2/Hz]\n5,0.001\n60,0.001\n", encoding="utf-8")
    run_simulate("modes", MODEL, "--modes", "--psd", "test.csv", "--base-acceleration", "z")
    run_simulate("modes", MODEL, "--frf", "5:50", "--force", "z=1")
    curve = run_simulate("response", MODEL, "--response", "25:40", "--force", "z=150", "--harmonics", "5")
    check(curve["levels"][0]["points"], "no point of a response curve")
    run("inspect", "run.csv", "--model", MODEL)
    run("rigidity", "run.csv", "--model", MODEL)
    run("spectra", "run.csv", "--model", MODEL)
    run("compare", "run.csv", "run.csv", "--model", MODEL)
    run("convert", "run.csv", "converted.csv")
    keep_columns("run.csv", "mobile.csv", ["time", "mobile", "load"])
    keep_columns("run.csv", "fixed.csv", ["time", "fixed", "load.fz"])
    run("merge", "mobile.csv", "fixed.csv", "-o", "merged.csv", "--common", "load.fz")
    run("set", MODEL, "1.z.stiffness*=1.1", "-o", "changed.toml")
    write_element("element.csv")
    pathlib.Path("element.toml").write_text(ELEMENT, encoding="utf-8")
    run("surface", "element.csv")
    run("equations", "run.csv", "--model", "believed.toml", "-o", "run.equations")
    run("join", "run.equations", "--model", "believed.toml")
    run("fit", "element.csv", "--model", "element.toml")
    run("plan", "run.csv", "--model", "believed.toml", "--proposals", "1", "--sweep", "8:40", "--rate", "60")
    run("fit", "run.csv", "--model", "believed.toml", "--timing")
    diagnosis = run("diagnose", "run.csv", "--model", "believed.toml", "--validate", "other.csv")
    used = {entry["of"]: entry for entry in diagnosis["tolerances"] if not entry["item"]}
    check(used["stiffness"]["value"] == 0.10 and used["stiffness"]["source"] == "default", "tolerances of a diagnosis")

    # The user's own names beside ours.
    inspected = run("inspect", "laboratory.csv", "--columns", "map.toml", "--model", MODEL)
    check(inspected["columns"]["load.fz"].startswith("Ch "), "no column of load.fz")
    for channel in inspected["recordings"][0]["channels"]:
        check(channel.get("column") == inspected["columns"][channel["name"]], f"column of {channel['name']}")

    # The exit status follows the verdict where that is asked for.
    verdict = diagnosis["verdict"]
    fitted = json.loads(pathlib.Path("fit.json").read_text(encoding="utf-8"))["verdict"]
    others = [name for name in ("identified", "doubtful", "unexplained") if name != fitted]
    run("fit", "run.csv", "--model", "believed.toml", "--fail-on", fitted, status=1)
    run("fit", "run.csv", "--model", "believed.toml", "--fail-on", ",".join(others))
    check(verdict in ("explained", "nothing_missing", "unexplained"), verdict)
    refused = call(IDENTIFY, "fit", "run.csv", "--model", MODEL, "--fail-on", "bad", status=2)
    check("identified" in refused.stderr, "--fail-on does not list what it accepts")
    refused = call(IDENTIFY, "schema", "nothing", status=2)
    check("diagnose" in refused.stderr, "schema does not list the commands")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    main()
for line in failures:
    print(line)
sys.exit(1 if failures else 0)
