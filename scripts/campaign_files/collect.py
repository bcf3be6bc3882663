"""Makes table.h5 of the rows of all batches: collect.py FOLDER.

/table holds a dataset for each column, each as long as there are cases, /columns their order; texts are UTF-8 of fixed length. No time and no place is in the file: the same rows give the same bytes.
"""
import json
import os
import sys

import h5py
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

FIRST = ["case", "draw", "model", "each", "excitation", "status", "failed_command", "command", "exit_status", "last_line"]


def read_rows(folder):
    """The rows of a campaign, by case."""
    rows = []
    for name in sorted(os.listdir(f"{folder}/batches")):
        if name.endswith(".jsonl"):
            with open(f"{folder}/batches/{name}", encoding="utf-8") as file:
                rows += [json.loads(line) for line in file]
    return sorted(rows, key=lambda row: row["case"])


def list_columns(rows):
    """Those that say which case it is and how it ended, then all others by name."""
    names = {name for row in rows for name in row}
    return [name for name in FIRST if name in names] + sorted(names - set(FIRST))


def make_column(rows, name):
    values = [row.get(name) for row in rows]
    if name in ("case", "draw"):
        return np.array(values, dtype="<i8")
    if any(isinstance(value, str) for value in values):
        texts = ["" if value is None else str(value) for value in values]
        longest = max(1, max(len(text.encode()) for text in texts))
        return np.array([text.encode() for text in texts], dtype=h5py.string_dtype("utf-8", longest))
    return np.array([np.nan if value is None else float(value) for value in values], dtype="<f8")


def write_table(rows, path, campaign_text):
    partial = path + ".part"
    # Groups of the oldest format, which alone have no time of their own.
    with h5py.File(partial, "w", libver="earliest") as file:
        group = file.create_group("table")
        columns = [name.replace("/", "_") for name in list_columns(rows)]
        file["campaign"] = np.bytes_(campaign_text.encode())
        file["columns"] = np.array([name.encode() for name in columns])
        for name in list_columns(rows):
            group.create_dataset(name.replace("/", "_"), data=make_column(rows, name), track_times=False)
    os.replace(partial, path)


def main():
    folder = sys.argv[1]
    with open(f"{folder}/campaign.json", encoding="utf-8") as file:
        stored = json.load(file)
    write_table(read_rows(folder), f"{folder}/table.h5", json.dumps(stored["text"], sort_keys=True))


if __name__ == "__main__":
    main()
