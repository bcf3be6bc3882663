"""Commands killed at random moments.

Each kill draws a command, whether its outputs exist already, a signal (KILL, TERM, INT, HUP) and a moment between start and end.
Afterwards each output is absent or as it was before, or complete to the byte; then the command runs again to its end,
after which nothing may lie in the folder that was not there or is not an output.

    kill_commands.py IDENTIFY SIMULATE MODELS [--kills N] [--seed N] [--skip COMMAND ...]

prints its seed, how long each command takes, one line for each failure and the figures; exit status 1 if there is a failure.
"""
import argparse
import collections
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from good_inputs import write_good_inputs

OLD = b"what stood here before\n"
SIGNALS = (signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP)


def commands(identify, simulate):
    """Each with its outputs, which begin with `out`."""
    every = ["--json", "out.json", "--report", "out.html"]
    on_model = ["--model", "model.toml"]
    return {
        "sweep": [simulate, "model.toml", "--sweep", "5:50", "--rate", "120", "--force", "z=200", "-q", "-o", "out.csv", *every],
        "random": [simulate, "model.toml", "--random", "5:100:0.5", "--base-acceleration", "z=5", "--seed", "3", "-q",
                   "-o", "out.csv", *every],
        "replay": [simulate, "model.toml", "--from-csv", "good.csv", "-q", "-o", "out.csv", *every],
        "modes": [simulate, "model.toml", "--modes", "-q", *every],
        "inspect": [identify, "inspect", "good.csv", *on_model, *every],
        "rigidity": [identify, "rigidity", "good.csv", *on_model, *every],
        "fit": [identify, "fit", "good.csv", "good2.csv", *on_model, "-o", "out.toml", *every],
        "surface": [identify, "surface", "element.csv", "--mass", "1", *every],
        "compare": [identify, "compare", "good.csv", "good2.csv", *on_model, *every],
        "spectra": [identify, "spectra", "good.csv", *on_model, *every],
        "convert": [identify, "convert", "good.csv", "out.trc", *on_model, *every],
        "merge": [identify, "merge", "good.csv", "part.csv", "-o", "out.csv", "--common", "load.fz", *every],
        "plan": [identify, "plan", "good.csv", *on_model, "--rate", "240", "-o", "out.toml", *every],
        "diagnose": [identify, "diagnose", "good.csv", "good2.csv", *on_model, "-o", "out.toml", *every],
    }


def outputs_of(words):
    return [word for word in words if word.startswith("out.")]


def write_inputs(folder, arguments):
    """Good inputs, a part of a recording, a test of one element."""
    write_good_inputs(folder, arguments.simulate, arguments.models)
    write_part(folder)
    write_element_test(folder)


def write_part(folder):
    """part.csv: time and load.fz of good.csv."""
    lines = (folder / "good.csv").read_text().splitlines()
    head = next(i for i, line in enumerate(lines) if line.startswith("time"))
    names = lines[head].split(",")
    kept = [0] + [i for i, name in enumerate(names) if name.startswith("load.fz")]
    (folder / "part.csv").write_text("".join(",".join(line.split(",")[i] for i in kept) + "\n" for line in lines[head:]))


def write_element_test(folder):
    """element.csv: a cubic spring under a slow, irregular motion."""
    drawn = random.Random(1)
    rows = []
    for k in range(2000):
        at = k * 1e-3
        x = 1e-3 * (drawn.random() * 0.01 + (k % 400 - 200) / 200 * (1 if k // 400 % 2 else -1))
        rows.append(f"{at:.4f},{x:.9g},{1e4 * x + 1e9 * x ** 3:.9g}\n")
    (folder / "element.csv").write_text("time [s],mobile.1.z [m],force.1.z [N]\n" + "".join(rows))


def run(words, folder, stop_after=None, with_signal=None):
    """Exit status and seconds."""
    start = time.monotonic()
    process = subprocess.Popen(words, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE)
    try:
        errors = process.communicate(timeout=stop_after)[1]
    except subprocess.TimeoutExpired:
        process.send_signal(with_signal)
        errors = process.communicate()[1]
    return process.returncode, time.monotonic() - start, errors.decode("utf-8", "replace").strip()


def contents(folder, names):
    return {name: (folder / name).read_bytes() for name in names if (folder / name).exists()}


def without_time(data):
    """A file without how long the run took."""
    return re.sub(rb'"wall_time": [0-9.e+-]+|[0-9.e+-]+ s wall', b"", data)


def remove(folder, names):
    for name in names:
        (folder / name).unlink(missing_ok=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("identify"), parser.add_argument("simulate"), parser.add_argument("models")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--skip", nargs="*", default=[])
    arguments = parser.parse_args()
    print("seed", arguments.seed)
    drawn = random.Random(arguments.seed)
    failures = 0
    states = collections.Counter()
    with tempfile.TemporaryDirectory(prefix="wems-kill-") as name:
        folder = Path(name)
        write_inputs(folder, arguments)
        inputs = set(os.listdir(folder))
        known = {}
        for command, words in commands(arguments.identify, arguments.simulate).items():
            if command in arguments.skip:
                continue
            status, seconds, errors = run(words, folder)
            complete = {output: without_time(data) for output, data in contents(folder, outputs_of(words)).items()}
            if status not in (0, 1) or set(complete) != set(outputs_of(words)):
                sys.exit(f"{command} ends with status {status}: {errors}")
            remove(folder, complete)
            known[command] = (words, seconds, complete)
            print(f"{command} {seconds:.2f} s", flush=True)
        for k in range(arguments.kills):
            command = drawn.choice(list(known))
            words, seconds, complete = known[command]
            existed, with_signal, moment = drawn.random() < 0.5, drawn.choice(SIGNALS), drawn.random()
            if existed:
                for output in complete:
                    (folder / output).write_bytes(OLD)
            status, _, _ = run(words, folder, moment * seconds, with_signal)
            found = contents(folder, complete)
            new = [output for output in complete if output in found and without_time(found[output]) == complete[output]]
            wrong = [output for output in complete if output not in new and found.get(output) != (OLD if existed else None)]
            states["ended before" if status in (0, 1) else "all new" if len(new) == len(complete) else "some new" if new else "none new"] += 1
            states["left for the next run"] += len(set(os.listdir(folder)) - inputs - set(complete))
            run(words, folder)
            again = {output: without_time(data) for output, data in contents(folder, complete).items()}
            left = sorted(set(os.listdir(folder)) - inputs - set(complete))
            for problem in ([f"half-written: {wrong}"] if wrong else []) + ([f"left: {left}"] if left else []) + (
                    ["the next run gives something else"] if again != complete else []):
                failures += 1
                print(f"{k} {command} {with_signal.name} after {moment * seconds:.3f} s: {problem}", flush=True)
            remove(folder, list(complete) + left)
    print(f"{arguments.kills} kills of {len(known)} commands: {failures} failures; " +
          ", ".join(f"{text} {count}" for text, count in sorted(states.items())))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
