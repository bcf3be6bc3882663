#!/usr/bin/env python3
"""Reading speed of every format, MB of file a second of CPU time, medians of runs in turn with those of SciPy and pyuff.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install numpy scipy h5py hdf5storage pyuff
    /tmp/venv/bin/python scripts/bench_formats.py build/bench/tests/bench/bench_formats
"""
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

import hdf5storage
import numpy as np
import pyuff
import scipy.io

ROUNDS = 7
random = np.random.default_rng(1)
rows = 100000
run = {"time": np.arange(rows) / 2000}
for connection in "123":
    for axis in "xyz":
        run[f"mobile_{connection}_{axis}"] = 1e-3 * random.normal(size=rows)


def write_uff(path, binary):
    for k, (name, values) in enumerate(list(run.items())[1:]):
        dataset = pyuff.prepare_58(func_type=1, rsp_node=1 + k // 3, rsp_dir=1 + k % 3, ref_node=0, ref_dir=0, data=values, x=run["time"],
                                   id1=name, rsp_ent_name="NONE", ref_ent_name="NONE", ord_data_type=4, num_pts=rows, abscissa_spacing=1,
                                   abscissa_min=0.0, abscissa_inc=1 / 2000, abscissa_spec_data_type=17, ordinate_spec_data_type=8,
                                   orddenom_spec_data_type=0)
        dataset["binary"] = 1 if binary else 0
        pyuff.UFF(path)._write_set(dataset, "add")


def megabytes_a_second(path, read):
    start = time.process_time()
    read(path)
    return os.path.getsize(path) / 2**20 / (time.process_time() - start)


with tempfile.TemporaryDirectory() as folder:
    files = {name: os.path.join(folder, name) for name in ("5.mat", "7.mat", "73.mat", "ascii.uff", "binary.uff")}
    scipy.io.savemat(files["5.mat"], run, do_compression=False)
    scipy.io.savemat(files["7.mat"], run, do_compression=True)
    hdf5storage.savemat(files["73.mat"], run, format="7.3", store_python_metadata=False)
    write_uff(files["ascii.uff"], False)
    write_uff(files["binary.uff"], True)
    others = {"scipy 5.mat": (files["5.mat"], scipy.io.loadmat), "scipy 7.mat": (files["7.mat"], scipy.io.loadmat),
              "pyuff ascii": (files["ascii.uff"], lambda path: pyuff.UFF(path).read_sets()),
              "pyuff binary": (files["binary.uff"], lambda path: pyuff.UFF(path).read_sets())}
    speeds = {}
    environment = {**os.environ, "WEMS_BENCH_MAT5": files["5.mat"], "WEMS_BENCH_MAT7": files["7.mat"], "WEMS_BENCH_MAT73": files["73.mat"]}
    for _ in range(ROUNDS):
        text = subprocess.run([sys.argv[1], "--benchmark_min_time=0.1", "--benchmark_format=json"], check=True, env=environment,
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout
        for entry in json.loads(text)["benchmarks"]:
            speeds.setdefault(entry["name"], []).append(entry.get("bytes_per_second", float("nan")) / 2**20)
        for name, (path, read) in others.items():
            speeds.setdefault(name, []).append(megabytes_a_second(path, read))
for name, values in speeds.items():
    print(f"{name:40s} {statistics.median(values):8.1f} MiB/s ({min(values):.1f} to {max(values):.1f})")
