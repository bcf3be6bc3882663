"""What it is about, for the front page: the device, and a run that nothing was fitted to before and after the diagnosis."""
import tomllib

from matplotlib import pyplot

import device
import example
from style import BLUE, ORANGE, PALE, write

WINDOW = 0.1  # s, of which the largest motion is drawn


def calc_envelopes(folder):
    """Swept frequency in Hz, and in mm the largest motion at 3.z and the largest difference of each model from it, in each
    window."""
    start, end, rate = example.SWEEP
    names = ("run3", "run3_believed", "run3_extended")
    runs = [[(t, 1e3 * (m - f)) for t, m, f in example.read_rows(folder / f"{name}.csv", "time", "mobile.3.z", "fixed.3.z")]
            for name in names]
    rows = {}
    for (t, measured), (_, before), (_, after) in zip(*runs):
        row = rows.setdefault(int(t / WINDOW), [0.0, 0.0, 0.0])
        row[:] = map(max, row, (abs(measured), abs(before - measured), abs(after - measured)))
    table = [(start * 2 ** (rate / 60 * WINDOW * (k + 0.5)), *row) for k, row in rows.items()]
    return list(zip(*(row for row in table if row[0] < end)))


def draw(source, work, folder):
    diagnosis = example.make(source, work)
    with open(source / "models/shipped/smallsat_wems.toml", "rb") as file:
        model = tomllib.load(file)
    figure = pyplot.figure(figsize=(8.2, 3.2))
    sketch = figure.add_axes((0.0, 0.0, 0.42, 0.93))
    device.draw_side(sketch, model)
    sketch.set_title("", loc="left")
    axes = figure.add_axes((0.50, 0.15, 0.49, 0.74))
    errors = {name: 100 * diagnosis[f"error_{name}"]["validation"] for name in ("before", "after")}
    frequency, measured, before, after = calc_envelopes(work.folder)
    axes.fill_between(frequency, 1e-4, measured, color=PALE, lw=0, label="measured motion")
    axes.plot(frequency, before, color=ORANGE, label=f"error of the model before: {errors['before']:.1f} %")
    axes.plot(frequency, after, color=BLUE, label=f"error of the model after: {errors['after']:.1f} %")
    axes.set_yscale("log")
    axes.set_ylim(1e-3, 3)
    axes.set_xscale("log")
    axes.set_xticks([5, 10, 20, 30, 40, 50], ["5", "10", "20", "30", "40", "50"])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("swept frequency, Hz")
    axes.set_ylabel("largest in 0.1 s at 3.z, mm")
    axes.legend(fontsize=8, loc="upper left")
    axes.set_title("a run that nothing was fitted to", loc="left")
    write(figure, folder, "result")
