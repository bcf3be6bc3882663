"""One row of scripts/work_precision: cost of a run, and its largest differences from the run at accuracy 1e-10."""
import csv
import json
import sys

folder, accuracy = sys.argv[1:]


def rows(name):
    with open(f"{folder}/{name}.csv") as file:
        yield from csv.reader(line for line in file if not line.startswith("#"))


run, reference = rows(accuracy), rows("1e-10")
header = next(run)
assert header == next(reference)
displacement = [i for i, name in enumerate(header) if name.endswith("[m]")]
acceleration = [i for i, name in enumerate(header) if name.endswith("[m/s^2]")]
worst = [0.0, 0.0]
for row, exact in zip(run, reference):
    for kind, columns in enumerate((displacement, acceleration)):
        worst[kind] = max(worst[kind], max(abs(float(row[i]) - float(exact[i])) for i in columns))
with open(f"{folder}/{accuracy}.json") as file:
    cost = json.load(file)["cost"]
print(f"accuracy {accuracy}: {cost['wall_time']:.2f} s wall, {cost['steps']} steps, {cost['realizations']} realizations, "
      f"worst error {worst[0]:.2g} m, {worst[1]:.2g} m/s^2")
