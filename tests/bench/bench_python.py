#!/usr/bin/env python3
"""What the Python module adds to `fit`: bench_python.py RECORDING MODEL [TIMES], with the module on PYTHONPATH.

A command works on a thread of its own. The processor time of the calling thread is therefore all that the module does:
arguments, waiting, progress, the objects of the result. It is put beside the processor time of the whole call, so that
other programs on the machine do not matter. Waiting costs twenty looks a second, by the clock.
"""
import statistics
import sys
import time

import wems


def main():
    recording, model = wems.Recording(sys.argv[1]), wems.Model(sys.argv[2])
    begin = time.process_time()
    wems.Recording.from_arrays(recording.time, {name: recording[name] for name in recording.names})
    print(f"{len(recording)} samples, {len(recording.names)} channels; from_arrays {1e3 * (time.process_time() - begin):.1f} ms")
    shares = []
    for _ in range(int(sys.argv[3]) if len(sys.argv) > 3 else 15):
        own, whole = time.thread_time(), time.process_time()
        result = wems.fit(recording, model)
        own, whole = time.thread_time() - own, time.process_time() - whole
        begin = time.thread_time()
        result.to_dict()
        shares.append(100 * own / whole)
        print(f"fit {whole:.3f} s, of that the module {1e3 * own:.2f} ms, {shares[-1]:.3f} %; "
              f"to_dict {1e3 * (time.thread_time() - begin):.2f} ms", flush=True)
    print(f"the module's share: median {statistics.median(shares):.3f} %, largest {max(shares):.3f} %")


if __name__ == "__main__":
    main()
