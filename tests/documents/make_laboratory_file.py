#!/usr/bin/env python3
"""A recording as a data acquisition writes it: free text, semicolons, decimal commas, ms, mm and kN, names of its own.

    make_laboratory_file.py RECORDING.csv LABORATORY.csv
"""
import csv
import sys

PARTS = {"mobile": "Support", "fixed": "Bracket"}


def rename(column):
    """(name and unit, factor from SI) of a column that the laboratory has, None of one that it has not."""
    if column == "time [s]":
        return "Time [ms]", 1e3
    if column == "load.fz [N]":
        return "Shaker [kN]", 1e-3
    name = column.split(" ")[0].split(".")
    if len(name) == 3 and name[0] in PARTS and name[2] in "xyz":
        return f"{PARTS[name[0]]} {name[1]} {name[2].upper()} [mm]", 1e3
    return None


def main():
    source, target = sys.argv[1:]
    with open(source, newline="") as file:
        rows = csv.reader(line for line in file if not line.startswith("#"))
        kept = [(i, *renamed) for i, renamed in enumerate(map(rename, next(rows))) if renamed]
        with open(target, "w", encoding="utf-8", newline="") as laboratory:
            laboratory.write("Rig 3, shaker test\r\nOperator: NN\r\n\r\n")
            laboratory.write(";".join(name for _, name, _ in kept) + "\r\n")
            for row in rows:
                values = (f"{float(row[i]) * factor:.9g}".replace(".", ",") for i, _, factor in kept)
                laboratory.write(";".join(values) + "\r\n")


if __name__ == "__main__":
    main()
