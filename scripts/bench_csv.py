#!/usr/bin/env python3
"""Compares reading a recording with pandas and NumPy, on the same files, on one core.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install pandas numpy pyarrow
    /tmp/venv/bin/python scripts/bench_csv.py build/bench/tests/bench/bench_csv

Every round times each reader once, one after the other; the table gives the medians over the rounds, in CPU time, so
that other work on the machine counts little. Files lie in the page cache.
"""
import argparse
import json
import os
import statistics
import subprocess
import tempfile
import time

import numpy as np
import pandas as pd


def write_file(path, columns, channels, rows):
    """Numbers of about eight characters; `channels` columns beside time have a channel's name."""
    random = np.random.default_rng(1)
    step = columns // channels
    names = ["time [s]"] + [("mobile." if j % step == 0 else "other.") + f"{j}.x [mm]" for j in range(1, columns)]
    values = random.normal(0, 0.5, (rows, columns))
    with open(path, "w") as file:
        file.write(",".join(names) + "\n")
        for i in range(rows):
            file.write(f"{i * 0.0005:.6f}," + ",".join(f"{v:.5f}" for v in values[i, 1:]) + "\n")
    return [i for i, name in enumerate(names) if not name.startswith("other.")]


def time_cpu(function):
    start = time.process_time()
    function()
    return time.process_time() - start


def time_ours(program, path):
    out = subprocess.run([program, "--benchmark_filter=benchReadGiven", "--benchmark_format=json"],
                         env={**os.environ, "WEMS_BENCH_CSV": path}, capture_output=True, check=True, text=True).stdout
    return json.loads(out)["benchmarks"][0]["cpu_time"] / 1e3


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the benchmark bench_csv, built in Release")
    parser.add_argument("--rounds", type=int, default=7)
    options = parser.parse_args()
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    with tempfile.TemporaryDirectory() as folder:
        for title, columns, channels, rows in (("28 columns, all", 28, 28, 100000), ("50 columns, all", 50, 50, 60000),
                                               ("1000 columns, 6 and time", 1000, 6, 3000)):
            path = os.path.join(folder, f"{columns}.csv")
            wanted = write_file(path, columns, channels, rows)
            readers = {
                "readRecording": lambda: time_ours(options.program, path),
                "pandas, C engine": lambda: time_cpu(lambda: pd.read_csv(path, usecols=wanted)),
                "numpy.loadtxt": lambda: time_cpu(
                    lambda: np.loadtxt(path, delimiter=",", skiprows=1, usecols=wanted)),
            }
            try:
                import pyarrow  # noqa: F401
                names = [pd.read_csv(path, nrows=0).columns[i] for i in wanted]
                readers["pandas, pyarrow engine"] = lambda: time_cpu(
                    lambda: pd.read_csv(path, usecols=names, engine="pyarrow"))
            except ImportError:
                print("pyarrow is not installed; left out")
            times = {name: [] for name in readers}
            for _ in range(options.rounds):
                for name, reader in readers.items():
                    times[name].append(reader())
            size = os.path.getsize(path) / 1e6
            print(f"\n{title}: {size:.1f} MB, medians of {options.rounds} rounds")
            ours = statistics.median(times["readRecording"])
            for name, seconds in times.items():
                median = statistics.median(seconds)
                print(f"  {name:24s} {1e3 * median:9.1f} ms {size / median:8.0f} MB/s {median / ours:7.1f} x ours")


if __name__ == "__main__":
    main()
