"""Odd recordings and odd models through every command.

A command must answer or refuse: exit status 0, 1 or 2; with 2 one line on standard error, no file left and no text of an
exception; no signal; within S seconds of processor time on each of two threads, 60 unless said otherwise.

    run_odd_inputs.py IDENTIFY SIMULATE MODELS [--seed N] [--recordings N] [--models N] [--minutes M] [--longest S] [--keep FOLDER] [--skip COMMAND …] [--only COMMAND …]

prints its seed, one line for each failure and the figures, after M minutes those of what was done; exit status 1 if there is a failure.
"""
import argparse
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from good_inputs import write_good_inputs
from odd_models import draw_model
from odd_recordings import draw_recording

EXCEPTION = re.compile(r"std::|terminate|what\(\)|[Aa]ssert|internal error|basic_string|vector::|bad_alloc|SimTK|Eigen|"
                       r"H5|nlohmann|CLI::|json\.exception|filesystem error|stack smashing|core dumped")


def run(arguments, folder, longest):
    """Exit status, standard error, seconds of processor time; status None where the limit is exceeded."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (2 * longest, 2 * longest + 5))  # two threads; SIGXCPU first
    try:
        done = subprocess.run(arguments, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, timeout=60 * longest, preexec_fn=limit)  # waits for nothing, on a loaded machine
        status, errors = done.returncode, done.stderr.decode("utf-8", "replace")
    except subprocess.TimeoutExpired:
        status, errors = None, ""
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return status, errors, seconds


def recording_commands(identify, simulate):
    """Of an odd recording odd.csv; good.csv, model.toml are good. Outputs begin with `out`."""
    all_outputs = ["--json", "out.json", "--report", "out.html"]
    on_model = ["--model", "model.toml"]
    return {
        "inspect": [identify, "inspect", "odd.csv", *all_outputs],
        "inspect --model": [identify, "inspect", "odd.csv", *on_model, *all_outputs],
        "rigidity": [identify, "rigidity", "odd.csv", *on_model, *all_outputs],
        "fit": [identify, "fit", "odd.csv", *on_model, "-o", "out.toml", *all_outputs],
        "fit two": [identify, "fit", "good.csv", "odd.csv", *on_model, "-o", "out.toml", *all_outputs],
        "surface": [identify, "surface", "odd.csv", *all_outputs],
        "compare": [identify, "compare", "odd.csv", "good.csv", *on_model, *all_outputs],
        "convert": [identify, "convert", "odd.csv", "out.trc", *all_outputs],
        "merge": [identify, "merge", "good.csv", "odd.csv", "-o", "out.csv", "--common", "load.fz", *all_outputs],
        "replay": [simulate, "model.toml", "--from-csv", "odd.csv", "-q", "-o", "out.csv", *all_outputs],
        "plan": [identify, "plan", "odd.csv", *on_model, "--rate", "240", "-o", "out.toml", *all_outputs],
        "diagnose": [identify, "diagnose", "odd.csv", *on_model, "-o", "out.toml", *all_outputs],
    }


def model_commands(identify, simulate):
    """Of an odd model odd.toml."""
    all_outputs = ["--json", "out.json", "--report", "out.html"]
    on_model = ["--model", "odd.toml"]
    return {
        "sweep": [simulate, "odd.toml", "--sweep", "5:50", "--rate", "240", "--force", "z=200", "-q", "-o", "out.csv",
                  *all_outputs],
        "random": [simulate, "odd.toml", "--random", "5:100:0.5", "--base-acceleration", "z=5", "-q", "-o", "out.csv",
                   *all_outputs],
        "inspect --model": [identify, "inspect", "good.csv", *on_model, *all_outputs],
        "rigidity": [identify, "rigidity", "good.csv", *on_model, *all_outputs],
        "fit": [identify, "fit", "good.csv", *on_model, "-o", "out.toml", *all_outputs],
        "compare": [identify, "compare", "good.csv", "good2.csv", *on_model, *all_outputs],
        "convert": [identify, "convert", "good.csv", "out.trc", *on_model, *all_outputs],
        "diagnose": [identify, "diagnose", "good.csv", *on_model, "-o", "out.toml", *all_outputs],
    }


def findings(status, errors, seconds, left, longest):
    """What is wrong with an outcome, in words."""
    if status is None or status == -24:
        yield f"more than {longest} s"
        return
    if status < 0:
        yield f"signal {-status}: {errors.strip()[-200:]}"
        return
    if status not in (0, 1, 2):
        yield f"exit status {status}"
    if seconds > 2 * longest:
        yield f"{seconds:.0f} s of processor time"
    if EXCEPTION.search(errors):
        yield "text of an exception: " + errors.strip()[:200]
    if status == 2 and errors.count("\n") != 1:
        yield f"{errors.count(chr(10))} lines on standard error: " + errors.strip()[:300]
    if status == 2 and left:
        yield "left behind: " + " ".join(left)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("identify"), parser.add_argument("simulate"), parser.add_argument("models")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--recordings", type=int, default=200)
    parser.add_argument("--models", dest="model_count", type=int, default=200)
    parser.add_argument("--minutes", type=float, default=1e9)
    parser.add_argument("--longest", type=int, default=60, help="seconds of processor time")
    parser.add_argument("--keep", help="folder for inputs that failed")
    parser.add_argument("--skip", nargs="*", default=[])
    parser.add_argument("--only", nargs="*", default=[])
    arguments = parser.parse_args()
    print("seed", arguments.seed)
    runs = refused = failures = 0
    done = {"recording": 0, "model": 0}
    slowest = (0.0, "")
    end = time.monotonic() + 60 * arguments.minutes
    with tempfile.TemporaryDirectory(prefix="wems-odd-") as name:
        folder = Path(name)
        write_good_inputs(folder, arguments.simulate, arguments.models)
        good = (folder / "good.csv").read_text()
        model, modes = (folder / "model.toml").read_text(), (folder / "smallsat_bracket.csv").read_text()
        cases = [("recording", i) for i in range(arguments.recordings)] + [("model", i) for i in range(arguments.model_count)]
        for kind, i in cases:
            if time.monotonic() > end:
                break
            done[kind] += 1
            drawn = random.Random(f"{arguments.seed} {kind} {i}")
            if kind == "recording":
                content, what = draw_recording(good, drawn)
                odd = {"odd.csv": content}
                commands = recording_commands(arguments.identify, arguments.simulate)
            else:
                content, odd_modes, what = draw_model(model, modes, drawn)
                content = content.replace(b"smallsat_bracket.csv", b"odd_bracket.csv")
                odd = {"odd.toml": content, "odd_bracket.csv": odd_modes}
                commands = model_commands(arguments.identify, arguments.simulate)
            for file, data in odd.items():
                (folder / file).write_bytes(data)
            before = set(os.listdir(folder))
            for command, words in commands.items():
                if command in arguments.skip or arguments.only and command not in arguments.only:
                    continue
                status, errors, seconds = run(words, folder, arguments.longest)
                left = sorted(set(os.listdir(folder)) - before)
                runs += 1
                refused += status == 2
                slowest = max(slowest, (seconds, f"{kind} {i} {what}: {command}"))
                wrong = list(findings(status, errors, seconds, left, arguments.longest))
                for text in wrong:
                    failures += 1
                    print(f"{kind} {i} {what}: {command}: {text}", flush=True)
                if wrong and arguments.keep:
                    for file in odd:
                        os.makedirs(arguments.keep, exist_ok=True)
                        shutil.copy(folder / file, Path(arguments.keep) / f"{kind}{i}_{file}")
                for file in left:
                    (folder / file).unlink()
            for file in odd:
                (folder / file).unlink()
    print(f"{done['recording']} recordings, {done['model']} models, {runs} runs: {refused} refused, {failures} failures; "
          f"slowest {slowest[0]:.1f} s of processor time ({slowest[1]})")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
