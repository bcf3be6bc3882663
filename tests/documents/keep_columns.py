#!/usr/bin/env python3
"""Keeps the time and some channels of recordings in CSV, as a test with fewer sensors would have them.

    keep_columns.py FILE.csv … --prefix PREFIX … --quantity NAME … [--scale CHANNEL=FACTOR] [--output FILE]

A column stays if its name begins with a PREFIX and ends with a NAME. Files are rewritten in place, or one of them goes to
--output.
"""
import argparse
import csv


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("files", nargs="+")
    parser.add_argument("--prefix", nargs="+", required=True)
    parser.add_argument("--quantity", nargs="+", required=True)
    parser.add_argument("--scale", default="=1")
    parser.add_argument("--output")
    arguments = parser.parse_args()
    scaled, factor = arguments.scale.split("=")
    for file in arguments.files:
        with open(file, encoding="utf-8", newline="") as stream:
            rows = list(csv.reader(line for line in stream if not line.startswith("#")))
        names = [column.split(" ")[0] for column in rows[0]]
        kept = [i for i, name in enumerate(names)
                if name == "time" or (name.startswith(tuple(arguments.prefix)) and name.split(".")[-1] in arguments.quantity)]
        if scaled in names:
            at = names.index(scaled)
            for row in rows[1:]:
                row[at] = repr(float(row[at]) * float(factor))
        with open(arguments.output or file, "w", encoding="utf-8", newline="") as stream:
            csv.writer(stream, lineterminator="\n").writerows([row[i] for i in kept] for row in rows)


if __name__ == "__main__":
    main()
