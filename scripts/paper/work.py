"""Everything that is simulated and identified for the reproduction: what to run, and running it on all cores."""
import concurrent.futures
import json
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import recordings

ROOT = Path(__file__).resolve().parent.parent.parent
BUILD = ROOT / "build/release"
SIMULATE, IDENTIFY, BEAM = BUILD / "plugin/simulate", BUILD / "identify/cli/identify", BUILD / "models/beam/simulate_beam"
PAPER_METHODS = BUILD / "identify/paper/paper_methods"
DEVICE = ROOT / "models/shipped/smallsat_wems.toml"
OUT = ROOT / "build/paper"
WORK = OUT / "work"
SEED = 7

sys.path.insert(0, str(ROOT / "scripts"))
import true_and_identified  # noqa: E402

# name: (model, sweep, force, octaves per minute, sample rate in Hz)
RUNS = {
    "axial_200": ("device", "5:50", "z=200", 4, 1000),
    "axial_300": ("device", "5:50", "z=300", 4, 1000),
    "axial_400": ("device", "5:50", "z=400", 4, 1000),
    "axial_500": ("device", "5:50", "z=500", 4, 1000),
    "axial_300_down": ("device", "50:5", "z=300", 4, 1000),
    "lateral_100": ("device", "5:50", "x=100", 4, 1000),
    "lateral_300": ("device", "5:50", "x=300", 4, 1000),
    "oblique_200": ("device", "5:50", "x=141.4214,y=141.4214", 4, 1000),
    "soft_200": ("soft", "5:50", "z=200", 4, 1000),
    "low_cog_200": ("low_cog", "5:50", "x=141.4214,y=141.4214", 4, 1000),
}
TABLES = ("axial_200", "axial_300", "axial_400", "axial_500", "oblique_200")
# Integrating accelerations twice needs a sampling that resolves the contacts: 4 kHz, with a fast sweep to keep files small.
RUNS.update({f"{run}_fast": (*RUNS[run][:3], 16, 4000) for run in TABLES})
RUNS["asymmetric_500_fast"] = ("asymmetric", "5:50", "z=500", 16, 4000)
LEVELS = {"noise": "1 µm, 0.01 m/s²", "1_percent": "1 %", "5_percent": "5 %"}
# (noise, channels) of the fits of the full method
FITS = [("", "all"), ("noise", "all"), ("noise", "displacements"), ("1_percent", "displacements"), ("5_percent", "displacements")]


def model(name):
    return DEVICE if name == "device" else WORK / f"{name}.toml"


def csv(run, noise=""):
    return WORK / f"{run}{'_' + noise if noise else ''}.csv"


def call(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    if done.returncode == 2 or done.returncode < 0:
        raise SystemExit(f"{' '.join(str(w) for w in words)}\nfailed: {done.stderr.strip()}")
    return done.stdout


def identify(*words):
    """JSON result of a command of identify."""
    return json.loads(call(IDENTIFY, *words, "--json", "-"))


def by_paper(*words):
    """JSON result of one of the paper's methods."""
    return json.loads(call(PAPER_METHODS, *words, "--json", "-"))


def make_models():
    text = DEVICE.read_text()
    third = text.index('name = "3"')
    axial = text.index("stiffness = 1.0e5", third)
    (WORK / "soft.toml").write_text(text[:axial] + text[axial:].replace("1.0e5", "0.8e5", 1))
    (WORK / "low_cog.toml").write_text(re.sub(r"center_of_gravity = \[[^\]]*\]", "center_of_gravity = [0.0, 0.0, 0.034]", text))
    (WORK / "asymmetric.toml").write_text(text.replace('"+", clearance = 1.57e-3', '"+", clearance = 1.6e-3')
                                          .replace('"-", clearance = 1.57e-3', '"-", clearance = 2.0e-3'))
    shutil.copy(DEVICE.parent / "smallsat_bracket.csv", WORK)
    true_and_identified.believe(DEVICE, WORK / "believed.toml", SEED)


def simulate(run, noise=""):
    device, sweep, force, rate, sample_rate = RUNS[run]
    words = [SIMULATE, model(device), "--sweep", sweep, "--rate", rate, "--force", force, "--sample-rate", sample_rate, "-q",
             "-o", csv(run, noise)]
    if noise:
        q, a = (1e-6, 0.01)
        if noise != "noise":
            share = int(noise[0]) / 100
            q, a = (share * level for level in recordings.rms_levels(csv(run)))
        words += ["--noise", f"displacement={q:.3g},acceleration={a:.3g}", "--seed", SEED]
    call(*words)


def step(text, jobs):
    """Runs the jobs on all cores; on a terminal, the time left on one line that is overwritten."""
    started = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for count, done in enumerate(concurrent.futures.as_completed([pool.submit(*job) for job in jobs]), 1):
            done.result()
            if sys.stderr.isatty():
                left = (time.monotonic() - started) * (len(jobs) - count) / count
                sys.stderr.write(f"\r\033[K{text}: {count} of {len(jobs)}, about {left:.0f} s left" if count < len(jobs) else "\r\033[K")
                sys.stderr.flush()
    print(f"{text:40s} {len(jobs):3d} jobs {time.monotonic() - started:6.0f} s", flush=True)


def fit(results, run, noise, use):
    name = f"{run}.{noise}.{use}"
    results[name] = identify("fit", csv(run, noise), "--model", WORK / "believed.toml", "--use", use)


def run_all():
    """Simulates and identifies everything; returns the results of the full method by `run.noise.channels`."""
    shutil.rmtree(OUT, ignore_errors=True)
    WORK.mkdir(parents=True)
    make_models()
    step("simulate", [(simulate, run) for run in RUNS] + [(call, BEAM, "-o", WORK / "beam.csv")])
    step("simulate with sensor noise", [(simulate, run + kind, noise) for run in TABLES for kind in ("", "_fast") for noise in LEVELS]
         + [(simulate, "asymmetric_500_fast", "noise"), (simulate, "soft_200", "noise")])
    flexible = [(recordings.add_flexibility, csv(r), DEVICE, WORK / f"{r}_flexible.csv") for r in ("axial_300", "lateral_300", "lateral_100")]
    step("recordings of a flexible cross, a wrong gain",
         flexible + [(recordings.change_gain, csv("axial_300", "noise"), "mobile.4.z", 1.03, WORK / "axial_300_gain.csv")])
    results = {}
    step("identify, full method", [(fit, results, run, noise, use) for run in TABLES for noise, use in FITS]
         + [(fit, results, "soft_200", "noise", "all")])
    step("identify, accelerations alone", [(fit, results, f"{run}_fast", noise, "accelerations") for run in TABLES for noise in LEVELS]
         + [(fit, results, "asymmetric_500_fast", noise, "accelerations") for noise in ("", "noise")])
    return results
