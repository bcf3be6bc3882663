"""A campaign that is killed at random moments and begun again: the same table to the byte, no case that was done run twice, and
what fails named. test_kills.py SOURCE BUILD [--kills N] [--seed N]"""
import argparse
import glob
import importlib.util
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

CAMPAIGN = """
seed = 3
cases = 8
batch = 4
models = ["{source}/models/shipped/smallsat_wems.toml"]
[[parameter]]
name = "1.z.stiffness"
grid = [0.9, 1.1, -1.0]
relative = true
[[command]]
run = "simulate {{model}} --half-sine 0.01:0.04 --force z=300 -o run.csv --json run.json -q"
[[command]]
run = "sh -c 'sleep 0.1; echo {{index}} >> $CASES_RUN'"
[[result]]
column = "stroke"
file = "run.json"
key = "relative_displacements[name=1.z].largest"
"""


def list_done(folder):
    done = {int(os.path.splitext(os.path.basename(p))[0]) for p in glob.glob(f"{folder}/begun/*/*.json")}
    for path in glob.glob(f"{folder}/batches/*.jsonl"):
        with open(path, encoding="utf-8") as file:
            done |= {json.loads(line)["case"] for line in file}
    return done


def read_log(path):
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8") as file:
        return [int(line) for line in file]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("source")
    parser.add_argument("build")
    parser.add_argument("--kills", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    missing = [m for m in ("snakemake", "h5py") if importlib.util.find_spec(m) is None]
    if missing:
        print(f"skipped: this Python has no {' and no '.join(missing)} (Debian: snakemake, python3-h5py)")
        return 4
    choice = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as folder:
        def command(name, cores):
            with open(f"{folder}/{name}.toml", "w", encoding="utf-8") as file:
                file.write(CAMPAIGN.format(source=os.path.abspath(options.source)))
            os.environ["CASES_RUN"] = f"{folder}/log_{name}"
            return [sys.executable, f"{options.source}/scripts/campaign", f"{folder}/{name}.toml", "--folder", f"{folder}/{name}",
                    "--cores", str(cores), "--programs", options.build]

        undisturbed = subprocess.run(command("a", 2), capture_output=True, text=True, check=False)
        said = undisturbed.stdout + undisturbed.stderr
        assert undisturbed.returncode == 1, said  # every third case fails: a negative stiffness
        assert said.count("failed: identify set") == 8 and "16 cases done, 8 failed" in said, said
        assert "case 2 failed" in said and "stiffness" in said, said
        assert sorted(read_log(f"{folder}/log_a")) == [i for i in range(24) if i % 3 < 2]

        repeated = set()
        for _ in range(options.kills):
            more = len(list_done(f"{folder}/b")) + choice.randint(2, 6)
            process = subprocess.Popen(command("b", 2), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
            while process.poll() is None and len(list_done(f"{folder}/b")) < more:
                time.sleep(0.02)
            time.sleep(choice.uniform(0, 0.2))
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            done, before = list_done(f"{folder}/b"), len(read_log(f"{folder}/log_b"))
            print(f"killed with {len(done)} of 24 cases done")
            repeated |= {(before, case) for case in done}
        again = subprocess.run(command("b", 1), capture_output=True, text=True, check=False)
        assert again.returncode == 1, again.stdout + again.stderr
        log = read_log(f"{folder}/log_b")
        twice = [case for before, case in repeated if case in log[before:]]
        assert not twice, f"done and run again: {twice}"
        for name in ("table.h5", "report.html"):
            with open(f"{folder}/a/{name}", "rb") as a, open(f"{folder}/b/{name}", "rb") as b:
                one, other = a.read(), b.read()
            assert one == other, f"{name} differs"
        print("the same table and report to the byte")
    return 0


if __name__ == "__main__":
    sys.exit(main())
