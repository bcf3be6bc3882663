"""Makes report.html of the rows of all batches: report.py FOLDER. A page of its own, no network."""
import html
import json
import os
import sys
from collections import defaultdict

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from collect import FIRST, list_columns, make_column, read_rows  # noqa: E402

STYLE = """body{font:15px/1.45 system-ui,sans-serif;margin:2em auto;max-width:70em;padding:0 1em;color:#222;background:#fff}
table{border-collapse:collapse;margin:.6em 0}td,th{padding:.2em .8em;text-align:right;border-bottom:1px solid #ccc}
td:first-child,th:first-child{text-align:left}svg{vertical-align:middle}rect{fill:#3b76af}
@media(prefers-color-scheme:dark){body{color:#ddd;background:#181818}td,th{border-color:#444}rect{fill:#7db1e0}}"""
MOST = 30  # rows of the tables of failures and of dependences


def draw_histogram(values, bins=30, width=150, height=28):
    counts, _ = np.histogram(values, bins=bins)
    top = max(1, counts.max())
    step = width / bins
    bars = "".join(f'<rect x="{step * k:.1f}" y="{height * (1 - c / top):.1f}" width="{step - 0.5:.1f}" height="{height * c / top:.1f}"/>'
                   for k, c in enumerate(counts) if c)
    return f'<svg width="{width}" height="{height}" role="img" aria-label="histogram">{bars}</svg>'


def format_table(header, rows):
    def line(cells, tag):
        return "<tr>" + "".join(f"<{tag}>{cell}</{tag}>" for cell in cells) + "</tr>"
    return "<table>" + line(header, "th") + "".join(line(row, "td") for row in rows) + "</table>"


def rank(values):
    """Ranks, equal values sharing their mean rank."""
    order = np.argsort(values, kind="stable")
    ranks = np.empty(len(values))
    ranks[order] = np.arange(len(values), dtype=float)
    _, inverse, counts = np.unique(values, return_inverse=True, return_counts=True)
    return (np.bincount(inverse, ranks) / counts)[inverse]


def find_dependences(numbers, drawn):
    """(size, drawn quantity, result, Spearman's correlation), the largest first; those that chance gives one in a thousand
    columns are left out."""
    found = []
    for a in drawn:
        for b in numbers:
            both = np.isfinite(numbers[a]) & np.isfinite(numbers[b])
            count = int(both.sum())
            if b in drawn or count < 10 or np.ptp(numbers[a][both]) == 0 or np.ptp(numbers[b][both]) == 0:
                continue
            r = float(np.corrcoef(rank(numbers[a][both]), rank(numbers[b][both]))[0, 1])
            if abs(r) > 3.29 / np.sqrt(count - 1):  # of a normal distribution: 0.1 %
                found.append((abs(r), a, b, r))
    return sorted(found, key=lambda entry: (-entry[0], entry[1], entry[2]))


def describe_failures(rows):
    groups = defaultdict(list)
    for row in rows:
        if row["status"] != "done":
            groups[row["command"].split(" ")[0], row["failed_command"], row["exit_status"], row["last_line"]].append(row["case"])
    lines = [[f"{html.escape(str(key[0]))} ({'set' if key[1] == 0 else f'command {key[1]}'})", html.escape(key[2]), len(cases),
              html.escape(key[3]), ", ".join(map(str, cases[:10])) + (" …" if len(cases) > 10 else "")]
             for key, cases in sorted(groups.items(), key=lambda item: -len(item[1]))]
    return lines[:MOST]


def make_page(rows, name, drawn):
    done = [row for row in rows if row["status"] == "done"]
    numbers = {c: make_column(done, c) for c in list_columns(done) if c not in FIRST}
    numbers = {c: v for c, v in numbers.items() if v.dtype.kind == "f"}
    parts = [f"<h1>{html.escape(name)}</h1><p>{len(rows)} cases, {len(rows) - len(done)} failed.</p>"]
    if len(done) < len(rows):
        parts += ["<h2>Failures</h2>", format_table(["command", "exit status", "cases", "last line", "which"], describe_failures(rows))]
    statistics = []
    for column, values in numbers.items():
        finite = values[np.isfinite(values)]
        if len(finite) == 0:
            continue
        figures = [finite.mean(), finite.std(ddof=1) if len(finite) > 1 else 0.0, finite.min(), *np.quantile(finite, [0.05, 0.5, 0.95]),
                   finite.max()]
        statistics.append([html.escape(column), len(finite), *(f"{v:.5g}" for v in figures), draw_histogram(finite)])
    parts += ["<h2>Numbers</h2>", format_table(["column", "cases", "mean", "standard deviation", "least", "5 %", "median", "95 %",
                                                "largest", "histogram"], statistics)]
    dependences = find_dependences(numbers, [c for c in numbers if c in drawn])
    if dependences:
        parts += ["<h2>What follows what</h2><p>Rank correlation of drawn quantities and results, beyond what chance gives once in a "
                  "thousand.</p>",
                  format_table(["drawn", "result", "correlation"],
                               [[html.escape(a), html.escape(b), f"{r:+.3f}"] for _, a, b, r in dependences[:MOST]])]
    return f'<!doctype html><meta charset="utf-8"><title>{html.escape(name)}</title><style>{STYLE}</style>' + "\n".join(parts) + "\n"


def main():
    folder = sys.argv[1]
    with open(f"{folder}/campaign.json", encoding="utf-8") as file:
        stored = json.load(file)
    rows = read_rows(folder)
    results = [r["column"] for r in stored["text"].get("result", [])]
    columns = set(list_columns(rows)) - set(FIRST)
    drawn = {c for c in columns if not any(c == r or c.startswith(r + ".") for r in results)}
    page = make_page(rows, stored["text"].get("name", "campaign"), drawn)
    with open(f"{folder}/report.html.part", "w", encoding="utf-8") as file:
        file.write(page)
    os.replace(f"{folder}/report.html.part", f"{folder}/report.html")


if __name__ == "__main__":
    main()
