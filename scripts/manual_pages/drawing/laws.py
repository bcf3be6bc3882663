"""Each law's curve, from the program: a block of 100 t stands still on an element whose other end is shaken along z.

The force of the element is the block's mass times its acceleration, the displacement that of the block less that of the
table, as `simulate` records both."""
import csv
import math

from matplotlib import pyplot

from style import BLUE, GREEN, GREY, INK, ORANGE, write

MASS = 1e5  # kg: at 1 Hz and above the block hardly moves
CYCLES, RISING, SAMPLES = 6, 2, 400  # periods, of which the amplitude rises; samples in each
LINEAR = "stiffness = 1.0e5"
STOPS = 'stops = [ {{ side = "+", clearance = 1.0e-3, stiffness = 4.0e5{0} }}, {{ side = "-", clearance = 1.0e-3, stiffness = 4.0e5{0} }} ]'
PANELS = [  # title, law, what is drawn: (frequency in Hz, amplitude in mm)
    ("stiffness, stops", [LINEAR, STOPS.format("")], [(10, 2)]),
    ("offset 0.4 mm", [LINEAR, STOPS.format(""), "offset = 4.0e-4"], [(10, 2)]),
    ("cubic 3e10 N/m³", [LINEAR, "cubic = 3.0e10"], [(10, 2)]),
    ("drift 0.3 1/s", [LINEAR, "drift = 0.3"], [(4, 2)]),
    ("damping 1.5 kN s/m", [LINEAR, "damping = 1500.0"], [(2, 2), (10, 2)]),
    ("loss factor 0.2", [LINEAR, "loss_factor = 0.2"], [(5, 2), (40, 2)]),
    ("relaxation, ratio 0.6, 10 ms", [LINEAR, "relaxation = { stiffness_ratio = 0.6, time_constant = 0.01 }"],
     [(2, 2), (16, 2), (100, 2)]),
    ("friction 60 N, tanh", [LINEAR, "friction = { force = 60.0, transition_velocity = 5.0e-3 }"], [(1, 2), (10, 2)]),
    ("friction 60 N, presliding", [LINEAR, "friction = { force = 60.0, presliding_stiffness = 2.0e5 }"], [(2, 2), (2, 0.5)]),
    ("hysteresis, β = 0.5", ["stiffness = 2.0e4",
                             "hysteresis = { force = 100.0, yield_displacement = 5.0e-4, exponent = 1.0, shape = 0.5 }"],
     [(2, 2), (2, 0.7)]),
    ("hysteresis, β = 1, n = 4", ["stiffness = 2.0e4",
                                  "hysteresis = { force = 100.0, yield_displacement = 5.0e-4, exponent = 4.0, shape = 1.0 }"],
     [(2, 2), (2, 0.7)]),
    ("stop's dissipation 4 s/m", [LINEAR, STOPS.format(", dissipation = 4.0")], [(10, 2)]),
]


def write_drive(file, frequency, amplitude):
    """The table's acceleration for amplitude · r(t) · sin(ωt), where r rises by 10 s³ − 15 s⁴ + 6 s⁵: it starts at rest."""
    omega = 2 * math.pi * frequency
    rows = ["time [s],base.ax [m/s^2],base.ay [m/s^2],base.az [m/s^2]"]
    for k in range(CYCLES * SAMPLES + 1):
        time = k / (SAMPLES * frequency)
        s, ds = min(1.0, time * frequency / RISING), frequency / RISING
        r, dr, ddr = s**3 * (10 - 15 * s + 6 * s * s), 30 * (s - s * s) ** 2 * ds, 60 * (s - 3 * s * s + 2 * s**3) * ds * ds
        sine, cosine = math.sin(omega * time), math.cos(omega * time)
        a = amplitude * (ddr * sine + 2 * dr * omega * cosine - r * omega * omega * sine)
        rows.append(f"{time!r},0,0,{a!r}")
    file.write_text("\n".join(rows) + "\n", encoding="utf-8")


def simulate(work, name, law, frequency, amplitude):
    """Displacement (mm) and force (N) at each sample."""
    model = "\n".join([f'name = "{name}"', "[body]", f"mass = {MASS}", "inertia = [1.0e3, 1.0e3, 1.0e3]", 'motion = ["z"]',
                       "[[connection]]", 'name = "e"', "position = [0.0, 0.0, 0.0]", "[connection.z]", *law])
    (work.folder / f"{name}.toml").write_text(model + "\n", encoding="utf-8")
    write_drive(work.folder / f"{name}_drive.csv", frequency, 1e-3 * amplitude)
    work.run("simulate", f"{name}.toml", "--from-csv", f"{name}_drive.csv", "-o", f"{name}.csv")
    with open(work.folder / f"{name}.csv", encoding="utf-8", newline="") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return [(1e3 * (float(row["mobile.e.z [m]"]) - float(row["fixed.e.z [m]"])), -MASS * float(row["mobile.e.az [m/s^2]"]))
                for row in rows]


def draw(_source, work, folder):
    figure, grid = pyplot.subplots(3, 4, figsize=(8.2, 6.2), sharex=True)
    colours = (BLUE, ORANGE, GREEN)
    for k, (axes, (title, law, runs)) in enumerate(zip(grid.flat, PANELS)):
        for (frequency, amplitude), colour in zip(runs, colours):
            samples = simulate(work, f"law{k}_{frequency}_{amplitude}".replace(".", "p"), law, frequency, amplitude)
            drawn = samples if "drift" in title else samples[-SAMPLES - 1:]
            axes.plot([q for q, _ in drawn[::4]], [f for _, f in drawn[::4]], color=colour, lw=1.1,
                      label=f"{frequency} Hz" if len({f for f, _ in runs}) > 1 else None)
        axes.set_title(title, fontsize=8, fontweight="normal", color=INK)
        axes.axhline(0, color=GREY, lw=0.6)
        axes.axvline(0, color=GREY, lw=0.6)
        axes.tick_params(labelsize=7)
        if len({f for f, _ in runs}) > 1:
            axes.legend(fontsize=6.5, loc="upper left", handlelength=1.0, borderaxespad=0.1)
    figure.supxlabel("relative displacement q, mm", fontsize=9)
    figure.supylabel("force f on the fixed part, N", fontsize=9)
    figure.subplots_adjust(0.085, 0.08, 0.99, 0.96, wspace=0.38, hspace=0.26)
    write(figure, folder, "laws")
