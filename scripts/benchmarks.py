"""Runs identify on public measurements of real elements and prints a table: what, ours, known or published, verdict."""
import argparse
import concurrent.futures
import json
import pathlib
import re
import subprocess
import sys
import tempfile

SHIPPED = pathlib.Path(__file__).resolve().parent.parent / "models" / "shipped"
SINE = re.compile(r"(?P<hertz>[\d.p]+)Hz_?(?P<pounds>\d+)lbtension(?:(?P<inches>[\d.p]+)amplitude)?\.(?:json|csv)$")
DROP = re.compile(r"(?:(?P<stiffness>\d+)npmm|(?P<threshold>\d+)nthreshold)_(?P<speed>\d)mps(?:_0?(?P<damping>25|5)damping)?_trial\d\.csv$")


def identify(program, *arguments):
    """The JSON result of a command, or the line in which it refused."""
    run = subprocess.run([program, *map(str, arguments), "--json", "-"], capture_output=True, text=True, check=False)
    if run.returncode != 0:
        return {"refused": run.stderr.strip().splitlines()[-1] if run.stderr.strip() else f"status {run.returncode}"}
    return json.loads(run.stdout)


def columns_of(file):
    return SHIPPED / ("friction_damper_json_columns.toml" if file.suffix == ".json" else "friction_damper_columns.toml")


def left_of(law):
    return law.get("root_relative_squared_error")


class Row:
    def __init__(self, data, what, ours, known, verdict):
        self.cells = [data, what, ours, known, verdict]


def judge_sine(program, file):
    """A sine test of the friction damper: friction and, where the band is tight, a gap at the reversals."""
    result = identify(program, "surface", file, "--columns", columns_of(file))
    name = "/".join(file.parts[-3:])
    if "refused" in result:
        return name, False, False, Row(name, "kind", result["refused"], "friction with gap", "refused")
    kind, law = result["kind"], result["law_with_memory"]
    friction = "friction" in kind
    gap = "gap" in kind or "gap" in law["law"]
    left = left_of(law)
    return name, friction, gap, Row(name, "kind, error", f"{kind}, {left:.3f}", "friction with gap", result["verdict"])


def judge_histories(program, fitted, judged):
    """The law of one irregular history, judged on another."""
    result = identify(program, "fit", fitted, "--columns", columns_of(fitted), "--model", SHIPPED / "friction_damper.toml",
                      "--law", "found", "--validate", judged)
    name = f"{fitted.parts[-3]}: {fitted.stem} on {judged.stem}"
    if "refused" in result:
        return Row(name, "error", result["refused"], "0.45", "refused")
    error = result["validation"][0]["error"]
    return Row(name, "error fitted, judged", f"{result['residual']['fraction']:.3f}, {error:.3f}",
               "0.45; LuGre of a sine 0.44 to 0.80", "holds" if error <= 0.45 else "short")


def judge_drop(program, file):
    """A drop of the CyberDiver in the 69 ms after it enters the water: the programmed stiffness by its coil's force, with the
    interval that gains of 1 % allow. A law with a threshold has it up to that force."""
    found = DROP.search(file.name)
    known, begin = float(found["stiffness"] or 15) * 1e3, 0.1 * float(found["speed"]) + 0.001
    result = identify(program, "surface", file, "--columns", SHIPPED / "cyberdiver_columns.toml", "--from", f"{begin:g}", "--to",
                      f"{begin + 0.069:g}")
    if "refused" in result:
        return Row(file.name, "stiffness", result["refused"], f"{known:.0f} N/m", "refused")
    stiffness = [p for p in result["parameters"] if ".stiffness" in p["name"]]
    if not stiffness:
        return Row(file.name, "kind", result["kind"], f"{known:.0f} N/m", "short")
    best = max(stiffness, key=lambda p: p["value"])
    low, high = best["interval95_with_gains"]
    off = best["value"] / known - 1
    return Row(file.name, "stiffness", f"{result['kind']}: {best['value']:.0f} N/m ({100 * off:+.2f} %), {low:.0f} to {high:.0f}",
               f"{known:.0f} N/m", "holds" if low <= known <= high else "short")


def cut_silverbox(file, first, count, name):
    """Samples of the Silverbox as a recording of a rig with one axis: volts of the input as N, of the output as m."""
    rate = 1e7 / 2**14  # Hz
    lines = file.read_text().splitlines()[1 + first:1 + first + count]
    with open(name, "w", encoding="utf-8") as part:
        part.write("time [s],load.fz [N],mobile.1.z [m]\n")
        for k, line in enumerate(lines):
            force, displacement = line.split(",")[:2]
            part.write(f"{k / rate:.9f},{force},{displacement}\n")
    return name


def judge_silverbox(program, file):
    """Fitted to five multisines, judged by the arrow that grows beyond them: RMS of its free run."""
    arrow_samples, multisine_samples = 40650, 43460
    with tempfile.TemporaryDirectory() as folder:
        arrow = cut_silverbox(file, 0, arrow_samples, f"{folder}/arrow.csv")
        multisine = cut_silverbox(file, arrow_samples, multisine_samples, f"{folder}/multisine.csv")
        result = identify(program, "fit", multisine, "--model", SHIPPED / "silverbox.toml", "--free", "body.mass", "--free",
                          "1.z.cubic", "--validate", arrow)
        with open(arrow, encoding="utf-8") as part:
            squares = [float(line.split(",")[2]) ** 2 for line in list(part)[1:]]
    if "refused" in result:
        return [Row(file.name, "arrow", result["refused"], "0.5 mV", "refused")]
    millivolts = 1e3 * result["validation"][0]["error"] * (sum(squares) / len(squares)) ** 0.5
    rows = [Row(file.name, "arrow, free run", f"{millivolts:.3f} mV RMS, fitted: {100 * result['residual']['fraction']:.2f} %",
                "0.5 mV asked; linear 14.4, black boxes from 0.26", "holds" if millivolts <= 0.5 else "short")]
    rows += [Row(file.name, parameter["name"], f"{parameter['value']:.5g} {parameter['unit']}, "
                 f"{parameter['interval95'][0]:.5g} to {parameter['interval95'][1]:.5g}", "not published as such", result["verdict"])
             for parameter in result["parameters"]]
    return rows


def find(folder):
    files = [f for f in sorted(folder.rglob("*")) if f.is_file()]
    sines = [f for f in files if SINE.search(f.name)]
    histories = [f for f in files if "earthquake" in str(f.parent).lower() and f.suffix in (".json", ".csv")]
    drops = [f for f in files if DROP.search(f.name)]
    silverbox = [f for f in files if f.name == "SNLS80mV.csv"]
    return sines, histories, drops, silverbox


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--identify", default="identify", help="the program")
    parser.add_argument("--json", type=pathlib.Path, help="write the table as data")
    parser.add_argument("--jobs", type=int, default=2, help="programs at a time")
    arguments = parser.parse_args()
    if not arguments.folder.is_dir():
        sys.exit(f"scripts/benchmarks: {arguments.folder}: no folder")
    sines, histories, drops, silverbox = find(arguments.folder)
    if not sines and not histories and not drops and not silverbox:
        sys.exit(f"scripts/benchmarks: {arguments.folder}: none of the known data sets (identify/component/README.md, "
                 "identify/VALIDATION.md)")
    pairs = [(a, b) for a in histories for b in histories if a != b and a.parent == b.parent]
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        judged = list(pool.map(lambda f: judge_sine(arguments.identify, f), sines))
        rows = [row for *_, row in judged]
        rows += pool.map(lambda pair: judge_histories(arguments.identify, *pair), pairs)
        rows += pool.map(lambda f: judge_drop(arguments.identify, f), drops)
        for found in pool.map(lambda f: judge_silverbox(arguments.identify, f), silverbox):
            rows += found
    tight = [(friction, gap) for name, friction, gap, _ in judged if not SINE.search(name)["pounds"] == "0"]
    header = ["data", "what", "ours", "known or published", "verdict"]
    table = [header] + [row.cells for row in rows]
    widths = [max(len(line[k]) for line in table) for k in range(len(header))]
    for line in table:
        print("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip())
    if tight:
        both = sum(friction and gap for friction, gap in tight)
        print(f"sine tests with band tension: friction and gap named in {both} of {len(tight)}, "
              f"friction in {sum(friction for friction, _ in tight)}")
    if pairs:
        print(f"histories: {sum(row.cells[4] == 'holds' for row in rows if 'judged' in row.cells[1])} of {len(pairs)} pairs "
              "judged within 0.45")
    for kind in ("npmm", "nthreshold"):
        verdicts = [row.cells[4] for row in rows if kind in row.cells[0] and DROP.search(row.cells[0])]
        if verdicts:
            print(f"drops with a {'stiffness' if kind == 'npmm' else 'force threshold'}: the interval holds the programmed stiffness in "
                  f"{verdicts.count('holds')} of {len(verdicts)}")
    if arguments.json:
        arguments.json.write_text(json.dumps([dict(zip(header, row.cells)) for row in rows], indent=1) + "\n")


if __name__ == "__main__":
    main()
