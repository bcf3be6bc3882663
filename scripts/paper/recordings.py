"""Columns of recordings, and recordings made from others: what a flexible cross or a wrong sensor would have left."""
import math
import tomllib


def lines(path):
    with open(path) as file:
        for line in file:
            if not line.startswith("#"):
                yield line.rstrip("\n")


def read_columns(path, names):
    """{name: values} for names without their unit."""
    rows = lines(path)
    header = [h.split(" [")[0] for h in next(rows).split(",")]
    index = [header.index(n) for n in names]
    columns = [[] for _ in names]
    for row in rows:
        fields = row.split(",")
        for column, i in zip(columns, index):
            column.append(float(fields[i]))
    return dict(zip(names, columns))


def relative(path, connection, axis):
    c = read_columns(path, ["time", f"mobile.{connection}.{axis}", f"fixed.{connection}.{axis}"])
    return c["time"], [m - f for m, f in zip(c[f"mobile.{connection}.{axis}"], c[f"fixed.{connection}.{axis}"])]


def swept_frequency(time, start, rate):
    """Of a sweep that starts at `start` Hz; rate in octaves per minute, negative downwards."""
    return [start * 2 ** (rate / 60 * t) for t in time]


def rms_levels(path):
    """RMS of the relative displacements (m) and of the mobile accelerations (m/s^2), over the channels that move most."""
    names = [f"{p}.{c}.{a}" for p in ("mobile", "fixed") for c in "1234" for a in "xyz"]
    names += [f"mobile.{c}.a{a}" for c in "1234" for a in "xyz"]
    columns = read_columns(path, names)

    def rms(values):
        return math.sqrt(sum(v * v for v in values) / len(values))

    q = [rms([m - f for m, f in zip(columns[f"mobile.{c}.{a}"], columns[f"fixed.{c}.{a}"])]) for c in "1234" for a in "xyz"]
    a = [rms(columns[f"mobile.{c}.a{x}"]) for c in "1234" for x in "xyz"]
    return max(q), max(a)


def law_force(law, q):
    force = law.get("stiffness", 0.0) * q
    for stop in law.get("stops", []):
        if stop["side"] == "+" and q > stop["clearance"]:
            force += stop["stiffness"] * (q - stop["clearance"])
        if stop["side"] == "-" and q < -stop["clearance"]:
            force += stop["stiffness"] * (q + stop["clearance"])
    return force


# Free-free bending of the cross: arms 1 and 2 up, 3 and 4 down, the wheel at rest. Of the paper only the frequency is known;
# the modal mass, for unit deflection of the ends, is an assumption: 50 g that move with each end.
BENDING = {"frequency": 3109.0, "modal_mass": 0.2, "shape": {"1": 1.0, "2": 1.0, "3": -1.0, "4": -1.0}}


def add_flexibility(source, model_file, target):
    """Displacements of a recording with the static response of the bending mode to the axial forces at the ends."""
    with open(model_file, "rb") as file:
        model = tomllib.load(file)
    laws = {c["name"]: c["z"] for c in model["connection"]}
    stiffness = BENDING["modal_mass"] * (2 * math.pi * BENDING["frequency"]) ** 2
    rows = lines(source)
    header = next(rows).split(",")
    names = [h.split(" [")[0] for h in header]
    kept = [i for i, n in enumerate(names) if n == "time" or n.split(".")[-1] in ("x", "y", "z") or n.startswith("load")]
    mobile = {c: names.index(f"mobile.{c}.z") for c in laws}
    fixed = {c: names.index(f"fixed.{c}.z") for c in laws}
    with open(target, "w") as out:
        out.write(",".join(header[i] for i in kept) + "\n")
        for row in rows:
            fields = row.split(",")
            modal = 0.0
            for c, shape in BENDING["shape"].items():
                modal -= shape * law_force(laws[c], float(fields[mobile[c]]) - float(fields[fixed[c]]))
            modal /= stiffness
            for c, shape in BENDING["shape"].items():
                fields[mobile[c]] = f"{float(fields[mobile[c]]) + shape * modal:.12g}"
            out.write(",".join(fields[i] for i in kept) + "\n")


def change_gain(source, channel, gain, target):
    """The recording with one channel multiplied."""
    rows = lines(source)
    header = next(rows)
    index = [h.split(" [")[0] for h in header.split(",")].index(channel)
    with open(target, "w") as out:
        out.write(header + "\n")
        for row in rows:
            fields = row.split(",")
            fields[index] = f"{gain * float(fields[index]):.12g}"
            out.write(",".join(fields) + "\n")
