"""Draws hidden effects, has them diagnosed, and says how often the diagnosis was right. Called by scripts/hidden_effects.

A case is one of a campaign (scripts/campaign), with a command that draws it and one that has it diagnosed: both are this file
again, called with --step."""
import argparse
import json
import os
import random
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, f"{HERE}/campaign_files"]
from definition import Campaign, CampaignError  # noqa: E402
from hidden_scores import judge, summarise  # noqa: E402
from launch import run_campaign  # noqa: E402

PROGRAMS = os.path.abspath(os.environ.get("WEMS_PROGRAMS", f"{HERE}/../build/release"))
SET_UPS = {"bracket": 0.52, "base": 0.38, "axis": 0.1}  # shares


def run(command, seconds=None):
    """Output and CPU seconds. Throws CalledProcessError with what was said on standard error.
    With a limit of wall-clock seconds also one of memory, 8 GB: a program that has lost its way must not take the machine along."""
    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30))

    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        process = subprocess.Popen(command, stdout=out, stderr=err, preexec_fn=limit if seconds else None)
        stopwatch = threading.Timer(seconds or 0, process.kill)
        if seconds:
            stopwatch.start()
        _, status, usage = os.wait4(process.pid, 0)
        stopwatch.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        if process.returncode != 0:
            raise subprocess.CalledProcessError(process.returncode, command, out.read(), err.read())
        return out.read(), usage.ru_utime + usage.ru_stime


def simulate(folder, truth, programs):
    """The truth once more by Simbody, driven by the load that the generator wrote, in place of its recordings."""
    noise = truth["noise"]
    channels = [c for c in ("displacement", "acceleration") if noise[c] > 0]
    for number, name in enumerate(("run1", "run2", "validate")):
        file = f"{folder}/seen/{name}.csv"
        run([f"{programs}/plugin/simulate", f"{folder}/truth.toml", "--from-csv", file, "--channels", ",".join(channels), "-q",
             "--seed", str(1 + number), "-o", f"{folder}/simbody.csv",
             "--noise", ",".join(f"{c}={noise[c]:.4g}" for c in channels)])
        os.replace(f"{folder}/simbody.csv", file)


def draw(seed, index, options):
    """Draws a case into its folder, unless it is there."""
    folder = f"{options.folder}/{index:04d}"
    if os.path.exists(f"{folder}/truth.json"):
        return
    choice = random.Random(f"{seed} {index}")
    level = choice.choice(options.level)
    set_up = choice.choices(options.set_up, [SET_UPS[s] for s in options.set_up])[0]
    partial = folder + ".part"
    shutil.rmtree(partial, ignore_errors=True)
    try:
        _, cpu = run([f"{options.programs}/tests/hidden/hidden_case", str(seed), str(index), partial, "--level", str(level),
                      "--kind", options.kind or "any", "--set-up", set_up, "--sensors", options.sensors,
                      "--excitation", options.excitation, "--time-scale", options.time_scale,
                      "--tolerance", "no" if options.without_tolerance else "yes"])
        with open(f"{partial}/truth.json") as file:
            truth = json.load(file)
        simbody = not options.forward and truth["set_up"] == "bracket" and level == 0 and truth["class"] != "outside"
        if simbody:
            simulate(partial, truth, options.programs)
        truth["truth_by"] = "Simbody" if simbody else "the generator"
        truth["cpu_to_draw"] = cpu
        with open(f"{partial}/truth.json", "w") as file:
            json.dump(truth, file, indent=1)
        os.replace(partial, folder)
    except subprocess.CalledProcessError as error:
        raise SystemExit(f"{index:4d} not drawn: {error.stderr.strip()[-300:]}") from error


def diagnose(index, options):
    """The answer for a case, as an entry."""
    case, out = f"{options.folder}/{index:04d}", f"{options.output}/{index:04d}"
    entry = {"index": index}
    shutil.rmtree(out, ignore_errors=True)
    try:
        with open(f"{case}/truth.json") as file:
            entry["truth"] = json.load(file)
        os.makedirs(out, exist_ok=True)
        model = f"{case}/seen/believed.toml"
        if options.without_tolerance:
            model = strip(case, out)
        started = time.time()
        text, entry["cpu"] = run([options.identify, "diagnose", f"{case}/seen/run1.csv", f"{case}/seen/run2.csv", "--model", model,
                                  "--validate", f"{case}/seen/validate.csv", "--json", f"{out}/result.json",
                                  "-o", f"{out}/extended.toml"], options.longest)
        entry["wall"] = time.time() - started
        with open(f"{out}/result.txt", "w") as file:
            file.write(text)
        with open(f"{out}/result.json") as file:
            entry["result"] = json.load(file)
    except subprocess.CalledProcessError as error:
        killed = error.returncode == -signal.SIGKILL
        entry["failed"] = f"no answer in {options.longest:g} s" if killed else error.stderr.strip()[-300:] or f"exit status {error.returncode}"
    except (OSError, ValueError) as error:
        entry["failed"] = str(error)
    return entry


def strip(case, out):
    """The believed model without its table of tolerances."""
    with open(f"{case}/seen/believed.toml") as file:
        text = file.read().split("\n[tolerance]")[0]
    with open(f"{out}/believed.toml", "w") as file:
        file.write(text + "\n")
    if os.path.exists(f"{case}/seen/bracket.csv"):
        shutil.copy(f"{case}/seen/bracket.csv", f"{out}/bracket.csv")
    return f"{out}/believed.toml"


def describe(entry):
    truth = entry["truth"]
    hidden = " + ".join(f"{c['cause']} {' '.join(c['where'])}" for c in truth["causes"])
    hidden = hidden or truth.get("outside", {}).get("kind", "none")
    what = f"{entry['index']:4d} level {truth['level']}, {truth['set_up']}, {truth['recorded']}, {hidden}: "
    if "failed" in entry:
        return f"{what}FAILED: {entry['failed']}"
    named = " + ".join(f"{c['cause']} {' '.join(c['where'])} ({c['probability']:.2f})" for c in entry["named"]) or "-"
    return f"{what}{'ok' if entry['good'] else 'NO'}: {named}, {entry['verdict']}, {entry['cpu']:.1f} s"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--seed", type=int, default=None, help="printed; the same seed draws the same cases")
    parser.add_argument("--index", type=int, nargs="*", help="these cases of the seed alone")
    parser.add_argument("--first", type=int, default=0, help="index of the first case")
    parser.add_argument("--kind", default="", help="single, two, none, outside, or a cause")
    parser.add_argument("--level", type=int, nargs="+", choices=[0, 1, 2], default=[0, 1, 2, 2],
                        help="small errors everywhere; one of these is drawn for each case")
    parser.add_argument("--set-up", nargs="+", choices=list(SET_UPS), default=list(SET_UPS))
    parser.add_argument("--sensors", choices=["any", "accelerations", "displacements", "both"], default="any")
    parser.add_argument("--excitation", choices=["any", "logarithmic", "linear", "random"], default="any")
    parser.add_argument("--time-scale", default="any", help="a factor, 1 for the device as drawn; any: 0.05 to 20")
    parser.add_argument("--without-tolerance", action="store_true", help="the believed model does not state its tolerances")
    parser.add_argument("--forward", action="store_true", help="truth by the generator's own integrator, also at level 0 on a bracket")
    parser.add_argument("--only-draw", type=int, metavar="N", help="draw N cases into the folder and stop")
    parser.add_argument("--again", metavar="FOLDER", help="diagnose the cases of a folder, drawing none")
    parser.add_argument("--identify", default=f"{PROGRAMS}/identify/cli/identify", help="the program that is asked")
    parser.add_argument("--longest", type=float, default=600, help="seconds that a diagnosis may take by the clock")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", action="store_true", help="keep the cases")
    parser.add_argument("--folder", default="", help="where the cases are written")
    parser.add_argument("--output", default="", help="where answers and cases.jsonl are written; default: answers beside the cases")
    parser.add_argument("--resume", action="store_true", help="go on with a campaign that was ended; needs its --folder and --seed")
    parser.add_argument("--slurm", action="store_true", help="on Slurm, --jobs at a time; the folder must be one that all nodes see")
    parser.add_argument("--sbatch", default="", help="further options of sbatch")
    parser.add_argument("--step", nargs=2, metavar=("STEP", "INDEX"), help=argparse.SUPPRESS)
    parser.add_argument("--settings", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.step:
        return take_step(options.step[0], int(options.step[1]), options.settings)
    if options.resume and not options.again and (not options.folder or options.seed is None):
        parser.error("--resume needs --folder and --seed")
    options.identify = os.path.abspath(options.identify)
    options.remove = not (options.keep or options.folder or options.again or options.only_draw is not None)
    options.folder = os.path.abspath(options.again or options.folder or tempfile.mkdtemp(prefix="hidden_effects_"))
    os.makedirs(options.folder, exist_ok=True)
    options.programs = PROGRAMS  # the steps run elsewhere
    options.output = os.path.abspath(options.output or options.folder + "_answers")
    options.seed = options.seed if options.seed is not None else random.SystemRandom().randrange(10**6)
    try:
        return run_cases(list_indices(options), options)
    except CampaignError as error:
        print(f"hidden_effects: {error}", file=sys.stderr)
        return 2


def list_indices(options):
    if options.again:
        indices = sorted(int(name) for name in os.listdir(options.folder) if name.isdigit())
        return [i for i in indices if i in options.index] if options.index else indices
    print(f"seed {options.seed}, cases in {options.folder}", flush=True)
    count = options.only_draw if options.only_draw is not None else options.cases
    return options.index or list(range(options.first, options.first + count))


def take_step(step, index, settings):
    """One command of a case, as the campaign calls it: `draw`, or `diagnose`, which leaves its entry beside the answer."""
    with open(settings, encoding="utf-8") as file:
        options = argparse.Namespace(**json.load(file))
    if step == "draw":
        draw(options.seed, index, options)
        return 0
    entry = diagnose(index, options)
    with open(f"{options.output}/{index:04d}/entry.part", "w", encoding="utf-8") as file:
        json.dump(entry, file)
    os.replace(f"{options.output}/{index:04d}/entry.part", f"{options.output}/{index:04d}/entry.json")
    if options.remove:
        shutil.rmtree(f"{options.folder}/{index:04d}", ignore_errors=True)
    return 0


def make_campaign(indices, options):
    """Its folder holds the settings that the steps read."""
    where = f"{options.output}/campaign"
    if not options.resume:
        shutil.rmtree(where, ignore_errors=True)
        if options.only_draw is None:
            for index in indices:  # answers of another time
                shutil.rmtree(f"{options.output}/{index:04d}", ignore_errors=True)
    os.makedirs(where, exist_ok=True)
    settings = f"{where}/settings.json"
    with open(settings, "w", encoding="utf-8") as file:
        json.dump(vars(options), file)
    call = f"{shlex.quote(sys.executable)} {shlex.quote(HERE)}/hidden_effects.py --settings {shlex.quote(settings)} --step"
    steps = [] if options.again else ["draw"]
    steps += [] if options.only_draw is not None else ["diagnose"]
    return Campaign({"name": "hidden effects", "batch": 1, "variable": [{"name": "number", "grid": indices}],
                     "command": [{"run": f"{call} {step} {{number}}"} for step in steps]}, where, "hidden_effects")


def run_cases(indices, options):
    if not indices:
        raise CampaignError(f"{options.folder}: no case (accepted: a folder with cases)")
    campaign = make_campaign(indices, options)
    where = f"{options.output}/campaign"
    placed = argparse.Namespace(folder=where, cores=options.jobs, slurm=options.slurm, jobs=options.jobs, sbatch=options.sbatch,
                                profile="", threads=1, minutes=240, memory=8000, programs="", quiet=True)
    entries, statuses = [], []
    workflow = threading.Thread(target=lambda: statuses.append(run_campaign(campaign, placed)), daemon=True)
    workflow.start()
    if options.only_draw is not None:
        workflow.join()
        return statuses[0] if statuses else 2
    with open(f"{options.output}/cases.jsonl", "w") as lines:
        for index in indices:
            entry = wait_for(f"{options.output}/{index:04d}/entry.json", workflow)
            if entry is None or "truth" not in entry:
                continue
            judge(entry)
            print(describe(entry), flush=True)
            lines.write(json.dumps(entry) + "\n")
            lines.flush()
            entries.append(entry)
    workflow.join()
    text = summarise(entries)
    with open(f"{options.output}/summary.txt", "w") as file:
        file.write(text + "\n")
    print("\n" + text)
    return 0


def wait_for(path, workflow):
    """An entry as soon as it is there; None if the workflow ends without it."""
    while workflow.is_alive() and not os.path.exists(path):
        time.sleep(0.2)
    if not os.path.exists(path):
        return None
    with open(path, encoding="utf-8") as file:
        return json.load(file)


if __name__ == "__main__":
    sys.exit(main())
