"""Draws hidden effects, has them diagnosed, and says how often the diagnosis was right. Called by scripts/hidden_effects."""
import argparse
import json
import math
import os
import random
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter, defaultdict
from concurrent.futures import ThreadPoolExecutor

PROGRAMS = os.environ.get("WEMS_PROGRAMS", "build/release")
# Ties in principle, whatever the noise.
TIES = [{"clearance", "preload"}, {"load", "sensor_gain"}, {"sensor_delay", "viscous_damping"}]


def run(command, **options):
    return subprocess.run(command, check=True, capture_output=True, text=True, **options)


def simulate(folder):
    """The truth once more by Simbody, in place of the recordings that the generator wrote."""
    truth = json.load(open(f"{folder}/truth.json"))
    noise = truth["noise"]
    channels = [c for c in ("displacement", "acceleration") if noise[c] > 0]
    if noise["gain_scatter"] > 0:
        # Each channel's own calibration: further entries of the truth's sensors.
        draw = random.Random(folder)
        header = open(f"{folder}/run1.csv").readline()
        while header.startswith("#"):
            header = header.split("\n")[0]
        with open(f"{folder}/truth.toml", "a") as model:
            for column in header.strip().split(",")[1:]:
                name = column.split()[0]
                if name.startswith(("mobile.", "fixed.")):
                    model.write(f'\n[[sensor]]\nchannel = "{name}"\ngain = {1 + draw.gauss(0, noise["gain_scatter"]):.6f}\n')
    for number, (name, plan) in enumerate(zip(("run1", "run2", "validate"), json.load(open(f"{folder}/plan.json")))):
        force = ",".join(f"{axis}={value:.6g}" for axis, value in zip("xyz", plan["force"]))
        run([f"{PROGRAMS}/plugin/simulate", f"{folder}/truth.toml", "--sweep", "5:50" if plan["upward"] else "50:5",
             "--rate", str(plan["octaves_per_minute"]), "--sample-rate", str(plan["sample_rate"]), "--force", force,
             "--channels", ",".join(channels), "-q", "--seed", str(1 + number), "-o", f"{folder}/{name}.csv",
             "--noise", ",".join(f"{c}={noise[c]:.4g}" for c in channels)])


def diagnose(seed, index, options):
    folder = f"{options.folder}/{index}"
    command = [f"{PROGRAMS}/tests/hidden/hidden_case", str(seed), str(index), folder, options.kind or "any", options.sensors]
    entry = {"index": index}
    try:
        run(command)
        truth = json.load(open(f"{folder}/truth.json"))
        entry["truth"] = truth
        if truth["class"] != "outside" and not options.forward:
            simulate(folder)
        # The diagnosis sees a folder without the truth.
        seen = f"{folder}/seen"
        os.makedirs(seen, exist_ok=True)
        for name in ("base.toml", "bracket.csv", "run1.csv", "run2.csv", "validate.csv"):
            shutil.move(f"{folder}/{name}", f"{seen}/{name}")
        started, used = time.time(), resource.getrusage(resource.RUSAGE_CHILDREN)
        text = run([f"{PROGRAMS}/identify/cli/identify", "diagnose", f"{seen}/run1.csv", f"{seen}/run2.csv", "--model",
                    f"{seen}/base.toml", "--validate", f"{seen}/validate.csv", "--json", f"{folder}/result.json", "-o",
                    f"{folder}/extended.toml"]).stdout
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        entry["wall"] = time.time() - started
        entry["cpu"] = after.ru_utime + after.ru_stime - used.ru_utime - used.ru_stime
        with open(f"{folder}/result.txt", "w") as out:
            out.write(text)
        entry["result"] = json.load(open(f"{folder}/result.json"))
    except subprocess.CalledProcessError as error:
        entry["failed"] = error.stderr.strip()[-300:]
    if not options.keep:
        for name in ("run1.csv", "run2.csv", "validate.csv"):
            for place in (f"{folder}/{name}", f"{folder}/seen/{name}"):
                if os.path.exists(place):
                    os.remove(place)
    return entry


def tied(true, named):
    return true == named or any({true, named} <= tie for tie in TIES)


def same_place(true, named):
    """True if a place is named, or the connection's axis that it belongs to."""
    def axis(place):
        return ".".join(place.split(".")[:2])
    return any(axis(a) == axis(b) for a in true for b in named)


def find(true, result):
    """The entry that names a true cause: (entry, how), how being `right`, `tie` or None."""
    for cause in result["causes"]:
        if cause["probability"] < 0.5:
            continue
        if cause["cause"] == true["cause"] and same_place(true["where"], cause["where"]):
            return cause, "right"
    for cause in result["causes"]:
        if cause["probability"] < 0.5:
            continue
        for rival in cause["rivals"]:
            if rival["cause"] == true["cause"] and same_place(true["where"], rival["where"]):
                return rival, "tie"
    return None, None


def judge(entry):
    """Adds `good` and details to a case."""
    truth, result = entry["truth"], entry["result"]
    kind = truth["class"]
    named = sorted(c["cause"] for c in result["causes"] if c["probability"] >= 0.5)
    entry["named"] = named
    entry["verdict"] = result["verdict"]
    entry["parameters"] = []
    if kind == "none":
        entry["good"] = result["verdict"] == "nothing_missing" and not named
        return
    if kind == "outside":
        where = truth["outside"]["where"]
        places = [w for w in result["unexplained"]["where"] if "." in w]
        entry["place"] = bool(places) and places[0] == where
        # What the verdict's own limits (1.5 noise floors and 3 %) do not see in the validation run cannot be asked for.
        before = result["error_before"]["validation"]
        entry["small"] = before < max(1.5 * result["unexplained"]["noise_floor"], 0.03)
        entry["good"] = (result["verdict"] == "unexplained" or entry["small"]) and not named
        return
    found = []
    for true in truth["causes"]:
        cause, how = find(true, result)
        found.append(how)
        for name, value in (true["parameters"].items() if cause else ()):
            for parameter in cause["parameters"]:
                if parameter["name"] != name:
                    continue
                entry["parameters"].append({"cause": true["cause"], "name": name, "true": value, "found": parameter["value"],
                                            "interval": parameter.get("interval95")})
    entry["found"] = found
    entry["good"] = all(found)
    entry["extra"] = len(named) > len(truth["causes"])
    floor, after = result["unexplained"]["noise_floor"], result["error_after"]["validation"]
    entry["over_floor"] = after / floor if after and floor else math.inf


def relative_error(parameter, entry):
    true, found = parameter["true"], parameter["found"]
    if true is None or found is None:
        return 0.0 if true is None and found is None else math.inf
    if parameter["cause"] in ("sensor_misalignment", "cog_offset", "gyroscopic"):
        # Vectors: relative to the largest component.
        own = [abs(p["true"]) for p in entry["parameters"] if p["cause"] == parameter["cause"] and p["true"] is not None]
        return abs(found - true) / max(own)
    return abs(found - true) / abs(true) if true else math.inf


def percent(count, total):
    return f"{count}/{total}" + (f" ({100 * count / total:.1f} %)" if total else "")


def summarise(entries):
    lines = []
    done = [e for e in entries if "result" in e]
    failed = [e for e in entries if "failed" in e]
    groups = defaultdict(list)
    for e in done:
        groups[e["truth"]["class"]].append(e)
    lines.append("Confusion: what was hidden → what was named")
    rows = defaultdict(Counter)
    for e in done:
        truth = " + ".join(sorted(c["cause"] for c in e["truth"]["causes"])) or e["truth"]["class"]
        if e["truth"]["class"] == "outside":
            truth = "outside: " + e["truth"]["outside"]["kind"]
        if e["truth"]["class"] == "two":
            truth = "two"
        answer = " + ".join(e["named"]) or e["verdict"]
        if e["truth"]["class"] in ("single", "two"):
            answer = ("right" if all(f == "right" for f in e["found"]) else "tie" if e["good"] else
                      f"{sum(map(bool, e['found']))} of 2" if e["truth"]["class"] == "two" else answer)
            answer += " and more" if e["good"] and e["extra"] else ""
            answer += " (unexplained)" if e["verdict"] == "unexplained" else ""
        elif e["truth"]["class"] == "outside" and e["good"]:
            answer = ("below the limits of the verdict" if e["small"] else
                      "unexplained, right place" if e["place"] else "unexplained, another place")
        rows[truth][answer] += 1
    for truth in sorted(rows):
        lines.append(f"  {truth:32s} " + ", ".join(f"{n} {a}" for a, n in rows[truth].most_common()))
    lines.append("")
    for kind, what in (("single", "right cause or its tie"), ("two", "both causes"), ("none", "nothing_missing"),
                       ("outside", "unexplained, nothing named")):
        own = groups[kind]
        lines.append(f"{kind:8s} {what}: {percent(sum(e['good'] for e in own), len(own))}")
    own = [e for e in groups["outside"] if not e["small"]]
    lines.append(f"outside  right place, of the {len(own)} above the verdict's limits: "
                 f"{percent(sum(e['place'] and e['good'] for e in own), len(own))}")
    both = groups["single"] + groups["two"]
    lines.append(f"single, two: causes named beyond the true ones: {percent(sum(e['extra'] for e in both), len(both))}")
    good = [e for e in both if e["good"]]
    lines.append(f"validation error after within 1.5 noise floors: "
                 f"{percent(sum(e['over_floor'] <= 1.5 for e in good), len(good))} of those named")
    errors, inside, intervals = [], 0, 0
    by_cause = defaultdict(list)
    for e in good:
        for p in e["parameters"]:
            error = relative_error(p, e)
            errors.append(error)
            by_cause[p["cause"]].append(error)
            if p["interval"] and p["true"] is not None and None not in p["interval"]:
                intervals += 1
                inside += p["interval"][0] <= p["true"] <= p["interval"][1]
    errors.sort()
    if errors:
        lines.append(f"parameters: median error {100 * errors[len(errors) // 2]:.2f} %, within 5 %: "
                     f"{percent(sum(x <= 0.05 for x in errors), len(errors))}; intervals hold the truth: {percent(inside, intervals)}")
        for cause in sorted(by_cause):
            own = sorted(by_cause[cause])
            lines.append(f"  {cause:22s} {len(own):4d} parameters, median {100 * own[len(own) // 2]:6.2f} %, largest {100 * own[-1]:8.1f} %")
    wall = sorted(e["wall"] for e in done)
    if wall:
        lines.append(f"time of a diagnosis: median {wall[len(wall) // 2]:.1f} s, longest {wall[-1]:.1f} s")
    bad = [e["index"] for e in done if not e["good"]]
    lines.append("not good: " + " ".join(map(str, bad)))
    for e in failed:
        lines.append(f"failed: {e['index']}: {e['failed']}")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--seed", type=int, default=None, help="printed; the same seed draws the same cases")
    parser.add_argument("--index", type=int, nargs="*", help="these cases of the seed alone")
    parser.add_argument("--first", type=int, default=0, help="index of the first case")
    parser.add_argument("--kind", default="", help="single, two, none, outside, or a cause")
    parser.add_argument("--sensors", choices=["any", "accelerations"], default="any", help="accelerations: nothing else recorded")
    parser.add_argument("--forward", action="store_true", help="truth by the generator's own integrator, not by Simbody")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", action="store_true", help="keep the recordings")
    parser.add_argument("--folder", default="", help="where the cases are written")
    parser.add_argument("--json", default="", help="all cases with truth and result")
    options = parser.parse_args()
    seed = options.seed if options.seed is not None else random.SystemRandom().randrange(10**6)
    options.folder = options.folder or tempfile.mkdtemp(prefix="hidden_effects_")
    print(f"seed {seed}, cases in {options.folder}", flush=True)
    indices = options.index or list(range(options.first, options.first + options.cases))
    entries = []
    with ThreadPoolExecutor(options.jobs) as pool:
        for entry in pool.map(lambda i: diagnose(seed, i, options), indices):
            if "result" in entry:
                judge(entry)
                truth = " + ".join(c["cause"] for c in entry["truth"]["causes"]) or entry["truth"].get("outside", {}).get("kind", "none")
                print(f"{entry['index']:4d} {'ok ' if entry['good'] else 'NO '} {truth}: {' + '.join(entry['named']) or '-'}, "
                      f"{entry['verdict']} {' '.join(entry['result']['unexplained']['where'])}, {entry['wall']:.1f} s", flush=True)
            else:
                print(f"{entry['index']:4d} failed: {entry['failed']}", flush=True)
            entries.append(entry)
            if options.json:
                with open(options.json + ".part", "w") as out:
                    json.dump({"seed": seed, "cases": entries}, out, indent=1)
                os.replace(options.json + ".part", options.json)
    print("\n" + summarise(entries))
    if not options.keep and not options.json:
        shutil.rmtree(options.folder, ignore_errors=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
