"""Called by scripts/peers --response: periodic responses with stops by `simulate --response` and by a harmonic balance in NumPy and
SciPy, on the same equations: processor time at equal error of the frequencies where a slow sweep jumps.

The reference is the peer with 60 harmonics and steps a quarter as long. Each round runs both with all numbers of harmonics, in turn; of the
rounds the median is given. The time of `simulate` has the multipliers of every point and the search for detached curves in it,
the peer's has not.
"""
import argparse
import json
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from peer_programs.harmonic_balance_peer import HarmonicBalance, Spring

WORK = Path("build/peers")
BAND = (8, 60)  # Hz
LEVEL = 6  # m/s^2 of the base along z
HARMONICS = (3, 5, 9, 15, 25)
TARGETS = (0.05, 0.005)  # Hz
STOP = {"clearance": 1e-3, "stiffness": 2e5}
FIRST = {"stiffness": 1.5e4, "damping": 10.0, "x": 0.1, "stops": "+-"}
SECOND = {"stiffness": 2.5e4, "damping": 15.0, "x": -0.1, "stops": "+"}
ALONE = {"stiffness": 2e4, "damping": 10.0, "x": 0.0, "stops": "+-"}
PROBLEMS = {"one coordinate": (["z"], [ALONE]), "two coordinates": (["z", "ry"], [FIRST, SECOND])}
MASS, INERTIA = 2.0, 8e-3


def write_model(name, motions, springs):
    text = f'name = "{name}"\n[body]\nmass = {MASS}\ninertia = [{INERTIA}, {INERTIA}, {INERTIA}]\nmotion = {json.dumps(motions)}\n'
    for i, spring in enumerate(springs):
        stops = ", ".join(f'{{ side = "{side}", clearance = {STOP["clearance"]}, stiffness = {STOP["stiffness"]} }}' for side in spring["stops"])
        text += (f'\n[[connection]]\nname = "{i + 1}"\nposition = [{spring["x"]}, 0.0, 0.0]\n[connection.z]\n'
                 f'stiffness = {spring["stiffness"]}\ndamping = {spring["damping"]}\nstops = [ {stops} ]\n')
    WORK.mkdir(parents=True, exist_ok=True)
    file = WORK / (name.replace(" ", "_") + ".toml")
    file.write_text(text)
    return file


def make_peer(motions, springs, harmonics):
    """A turn about y lowers what lies along x."""
    axes = {"z": lambda s: 1.0, "ry": lambda s: -s["x"]}
    mass = np.diag([MASS if motion == "z" else INERTIA for motion in motions])
    base = [LEVEL if motion == "z" else 0.0 for motion in motions]
    sides = {"+": 1, "-": -1}
    return HarmonicBalance(mass, [Spring([axes[m](s) for m in motions], s["stiffness"], s["damping"],
                                         [(sides[side], STOP["clearance"], STOP["stiffness"]) for side in s["stops"]]) for s in springs],
                           base, harmonics)


def run_peer(motions, springs, harmonics, longest=0.1):
    """A curve that it loses has no folds."""
    start = time.process_time()
    try:
        _, folds = make_peer(motions, springs, harmonics).follow(*BAND, 1e-3, longest)
    except (RuntimeError, ValueError) as error:
        print(f"NumPy and SciPy, {harmonics} harmonics: {error}")
        folds = []
    return time.process_time() - start, folds


def run_simulate(program, model, harmonics):
    answer = subprocess.run([program, model, "--response", f"{BAND[0]}:{BAND[1]}", "--base-acceleration", f"z={LEVEL}", "--harmonics",
                             str(harmonics), "--json", "-", "--quiet"], check=True, capture_output=True, text=True)
    level = json.loads(answer.stdout)["levels"][0]
    return level["seconds"], [fold["frequency"] for fold in level["folds"]]


def error_of(folds, reference):
    """Of the two jumps, up and down: the lowest and the highest fold. Infinite where a curve has none."""
    return max(abs(min(folds) - min(reference)), abs(max(folds) - max(reference))) if folds else np.inf


def time_at(target, results):
    """Of the fewest harmonics from which on all errors are below the target."""
    good = [i for i in range(len(results)) if all(error <= target for _, error in results[i:])]
    return results[good[0]][0] if good else np.nan


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    for name, (motions, springs) in PROBLEMS.items():
        model = write_model(name, motions, springs)
        reference = run_peer(motions, springs, 60, 0.025)[1]
        print(f"{name}: a slow sweep jumps at {min(reference):.4f} and {max(reference):.4f} Hz")
        times = {"ours": {h: [] for h in HARMONICS}, "peer": {h: [] for h in HARMONICS}}
        errors = {"ours": {}, "peer": {}}
        for _ in range(options.rounds):
            for h in HARMONICS:
                for who, (seconds, folds) in (("ours", run_simulate(options.program, model, h)), ("peer", run_peer(motions, springs, h))):
                    times[who][h].append(seconds)
                    errors[who][h] = error_of(folds, reference)
        print("harmonics   simulate: time [s], error [Hz]   NumPy and SciPy: time [s], error [Hz]")
        for h in HARMONICS:
            print(f"{h:9d}" + "".join(f"   {statistics.median(times[who][h]):8.4f}  {errors[who][h]:8.2g}" for who in ("ours", "peer")))
        for target in TARGETS:
            ours, peer = (time_at(target, [(statistics.median(times[who][h]), errors[who][h]) for h in HARMONICS]) for who in ("ours", "peer"))
            print(f"folds within {target} Hz: simulate {ours:.3g} s, NumPy and SciPy {peer:.3g} s, ratio {peer / ours:.3g}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
