"""Called by scripts/peers: sets the forward model beside Simbody, SciPy and MuJoCo on the same equations and prints the tables.

Every contestant runs with all its settings in each round, right after the forward model with all of its own, so that the
ratio of their times is of runs taken in turn; of the rounds the median is given. CPU time of one core throughout, from the
model in memory to the displacements at all samples.
"""
import argparse
import importlib.metadata
import json
import random
import statistics
import sys
import time
from pathlib import Path

import numpy as np
from peer_programs import mujoco_peer, scipy_peer
from peer_programs.contestants import BARE, FORWARD, PEERS, Case
from peer_programs.cpp_peer import Programs
from peer_programs.equal_error import measure, time_at
from peer_programs.problem import Mount, Problem, Sweep

PROGRAM = "build/release/tests/peers/peer_run"
WORK = Path("build/peers")
SWEEP = {"sweep": [20, 50], "octaves_per_minute": 30, "duration": 2.5, "sample_rate": 1000}
DIRECTION = [0.6, 0.4, 1.0]
GROUPS = {"no stop reached": [8], "stops reached": [30]}  # m/s^2 along z
TARGETS = {"no stop reached": [1e-4, 1e-6], "stops reached": [1e-2, 2e-3]}


def write_model():
    """The shipped device without its bracket: the base is the fixed part."""
    text = Path("models/shipped/smallsat_wems.toml").read_text()
    WORK.mkdir(parents=True, exist_ok=True)
    model = WORK / "mount.toml"
    model.write_text(text[:text.index("[bracket]")])
    return str(model)


def make_case(model, level):
    acceleration = [level * part for part in DIRECTION]
    sweep = Sweep(SWEEP["sweep"][0], SWEEP["octaves_per_minute"], acceleration)
    problem = Problem(Mount(model), sweep, SWEEP["duration"], SWEEP["sample_rate"])
    case = Case(f"{level} m/s^2", problem, Programs(PROGRAM, model, {**SWEEP, "base_acceleration": acceleration}))
    case.reference, case.contacts = scipy_peer.reference(problem, 1e-12)
    return case


def print_agreement(case):
    """That all solve the same equations: how far a fine run of each program is from the reference. With stops only of those whose
    fine runs are affordable."""
    largest = np.abs(case.reference).max()
    print(f"{case.name}: largest displacement {1e3 * largest:.3f} mm, {case.contacts} closings and openings of stops; "
          "largest difference from the reference [m]:")
    finest = {"forward model, 1/64 ms": lambda: case.programs.forward(64), "Simbody, accuracy 1e-10": lambda: case.programs.simbody(1e-10, 1e-3)}
    if case.contacts == 0:
        finest["SciPy LSODA, rtol 1e-10"] = lambda: scipy_peer.simulate(case.problem, "LSODA", 1e-10)
        finest["MuJoCo RK4, forces in Python, 1/8 ms"] = lambda: mujoco_peer.forces_in_python(case.problem, 8)
        finest["MuJoCo RK4, own elements, 1/8 ms"] = lambda: mujoco_peer.own_elements_exact_base(case.problem, 8)
    for name, run in finest.items():
        print(f"  {name:44} {np.abs(run()[0] - case.reference).max():.1e}", flush=True)


def run_round(groups, results, draw):
    """Adds to results[group][contestant] a pair: rows of the forward model just before, own rows."""
    for group, cases in groups.items():
        for peer in draw.sample(PEERS, len(PEERS)):
            results[group][peer.name].append((measure(FORWARD, cases), measure(peer, cases)))


def print_settings(name, rounds, duration):
    """Every setting of one contestant: medians of the rounds."""
    for same in zip(*rounds):
        spent = statistics.median(row.time for row in same)
        first = same[0]
        print(f"  {name:42} {', '.join(map(str, first.setting)):18} {duration / spent:8.1f} x real time, "
              f"{first.evaluations / duration:9.0f} evaluations/s, error {first.metres:.1e} m, {first.error:.1e}")


def summarise(results, group, targets, duration):
    """At each target: the forward model's times real time, and for each contestant how many times longer it takes."""
    table = {}
    for name, rounds in results[group].items():
        cells = []
        for target in targets:
            ratios = [own / forward for forward, own in ((time_at(f, target), time_at(p, target)) for f, p in rounds) if own]
            cells.append([statistics.median(ratios), min(ratios), max(ratios)] if ratios else None)
        table[name] = cells
    forward = [statistics.median(duration / time_at(f, target) for rounds in results[group].values() for f, _ in rounds)
               for target in targets]
    return {"targets": targets, "forward_times_real_time": forward, "longer": table}


def print_summary(group, summary):
    print(f"\n{group}: computing time at equal error, over that of the forward model (median, range of the rounds)")
    print(f"  {'error, of the largest displacement':42}" + "".join(f"{target:>28.0e}" for target in summary["targets"]))
    print(f"  {'forward model, times real time':42}" + "".join(f"{factor:28.0f}" for factor in summary["forward_times_real_time"]))
    for name, cells in summary["longer"].items():
        words = ["not reached" if cell is None else f"{cell[0]:.3g} ({cell[1]:.3g} - {cell[2]:.3g})" for cell in cells]
        print(f"  {name:42}" + "".join(f"{word:>28}" for word in words))


def print_shares(case, rounds):
    """What of the time is Python and what the engine."""
    steps = 1
    peer = {contestant.name: contestant for contestant in PEERS}

    def cost(contestant, setting):
        runs = [contestant.run(case, *setting) for _ in range(rounds)]
        return statistics.median(spent / evaluations * 1e6 for _, evaluations, spent in runs)

    forward = cost(FORWARD, (steps,))
    bare = cost(BARE, ("rk4", steps))
    own = cost(peer["MuJoCo RK4, own elements"], ("rk4", steps))
    python = cost(peer["MuJoCo RK4, forces in Python"], (steps,))
    scipy = cost(peer["SciPy DOP853"], ("DOP853", 1e-6))
    rates = timed_rates(case.problem)
    print(f"\nMicroseconds for an evaluation of the equations, everything included: forward model {forward:.2f}; MuJoCo without any "
          f"force {bare:.2f}, own elements {own:.2f}, forces in Python {python:.1f} (without the engine {python - bare:.1f}); "
          f"SciPy DOP853 {scipy:.1f}, of which the right-hand side in NumPy {rates:.1f}")


def timed_rates(problem, calls=5000):
    y = problem.initial()
    y[:3], y[10:] = 1e-3, 0.1
    start = time.process_time()
    for _ in range(calls):
        problem.rates(0.1, y)
    return (time.process_time() - start) / calls * 1e6


def write_json(file, versions, results):
    """All rows of the rounds so far: of each a pair, the forward model's and the contestant's own."""
    rows = {group: {name: [[[vars(row) for row in part] for part in pair] for pair in rounds] for name, rounds in of.items()}
            for group, of in results.items()}
    Path(file).write_text(json.dumps({"versions": versions, "rounds": rows}, indent=1))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seed", type=int, default=random.randrange(1, 10**6), help="of the order of the contestants")
    parser.add_argument("--json", help="all rows of all rounds, written after each")
    options = parser.parse_args()
    versions = ", ".join(f"{name} {importlib.metadata.version(name)}" for name in ("scipy", "mujoco", "numpy"))
    print(f"{versions}; seed {options.seed}, {options.rounds} rounds", flush=True)
    model = write_model()
    groups = {group: [make_case(model, level) for level in levels] for group, levels in GROUPS.items()}
    for cases in groups.values():
        for case in cases:
            print_agreement(case)
    results = {group: {peer.name: [] for peer in PEERS} for group in groups}
    draw = random.Random(options.seed)
    for number in range(options.rounds):
        run_round(groups, results, draw)
        print(f"round {number + 1} of {options.rounds} done", file=sys.stderr, flush=True)
        if options.json:
            write_json(options.json, versions, results)
    summaries = {}
    for group, cases in groups.items():
        duration = SWEEP["duration"] * len(cases)
        print(f"\n{group}: every setting")
        print_settings(FORWARD.name, [forward for rounds in results[group].values() for forward, _ in rounds], duration)
        for name, rounds in results[group].items():
            print_settings(name, [own for _, own in rounds], duration)
        summaries[group] = summarise(results, group, TARGETS[group], duration)
    for group, summary in summaries.items():
        print_summary(group, summary)
    print_shares(groups["no stop reached"][0], max(3, options.rounds))


if __name__ == "__main__":
    main()
