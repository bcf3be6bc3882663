"""Hidden effects drawn by scripts/hidden_effects.py, called from a folder that is not the project's, with programs named relative
to it: each case has its recordings, its model and its truth. test_hidden_draws.py SOURCE BUILD [--seed N]"""
import argparse
import importlib.util
import json
import os
import random
import subprocess
import sys
import tempfile


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("source")
    parser.add_argument("build")
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**6))
    options = parser.parse_args()
    program = f"{options.build}/tests/hidden/hidden_case"
    missing = [] if importlib.util.find_spec("snakemake") else ["Snakemake (Debian: snakemake)"]
    missing += [] if os.path.exists(program) else [program]
    if missing:
        print(f"skipped: no {', no '.join(missing)}")
        return 4
    print(f"seed {options.seed}")
    with tempfile.TemporaryDirectory() as folder:
        drawn = subprocess.run([sys.executable, f"{options.source}/scripts/hidden_effects.py", "--only-draw", "2", "--level", "0",
                                "--seed", str(options.seed), "--folder", "cases"], cwd=folder, capture_output=True, text=True,
                               env={**os.environ, "WEMS_PROGRAMS": os.path.relpath(options.build, folder)})
        if drawn.returncode != 0:
            print(drawn.stdout + drawn.stderr)
            return 1
        for case in ("0000", "0001"):
            with open(f"{folder}/cases/{case}/truth.json", encoding="utf-8") as file:
                truth = json.load(file)
            lacking = [name for name in ("run1.csv", "run2.csv", "validate.csv", "believed.toml")
                       if not os.path.exists(f"{folder}/cases/{case}/seen/{name}")]
            if lacking or truth["seed"] != options.seed or truth["level"] != 0:
                print(f"case {case}: lacks {', '.join(lacking) or 'nothing'}; seed {truth['seed']}, level {truth['level']}")
                return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
