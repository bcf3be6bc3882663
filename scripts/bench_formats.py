#!/usr/bin/env python3
"""Reading speed of every format; the MATLAB files are written by scipy and hdf5storage.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install numpy scipy h5py hdf5storage
    /tmp/venv/bin/python scripts/bench_formats.py build/bench/tests/bench/bench_formats
"""
import os
import subprocess
import sys
import tempfile

import hdf5storage
import numpy as np
import scipy.io

random = np.random.default_rng(1)
rows = 100000
run = {"time": np.arange(rows) / 2000}
for connection in "123":
    for axis in "xyz":
        run[f"mobile_{connection}_{axis}"] = 1e-3 * random.normal(size=rows)
with tempfile.TemporaryDirectory() as folder:
    mat5, mat73 = os.path.join(folder, "5.mat"), os.path.join(folder, "73.mat")
    scipy.io.savemat(mat5, run, do_compression=False)
    hdf5storage.savemat(mat73, run, format="7.3", store_python_metadata=False)
    subprocess.run([sys.argv[1], "--benchmark_min_time=0.5"], check=True,
                   env={**os.environ, "WEMS_BENCH_MAT5": mat5, "WEMS_BENCH_MAT73": mat73})
