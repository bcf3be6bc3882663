"""The loop: simulate, identify, explain, and back."""
from matplotlib import patches, pyplot

from style import BLUE, GREEN, GREY, INK, ORANGE, arrow, bare, write

BOXES = {  # name: (x, y, colour, title, lines)
    "model": (0, 0, GREY, "model (TOML)", "masses, laws, stops,\nbracket, tolerances"),
    "simulate": (40, 14, BLUE, "simulate", "Simbody: sweeps, random,\nshock; modes, responses"),
    "test": (40, -14, ORANGE, "test rig", "accelerometers, markers,\nload cells"),
    "recording": (80, 0, GREY, "recordings", "CSV, MATLAB, UFF,\nOpenSim, LabVIEW"),
    "identify": (120, 14, BLUE, "inspect · fit · spectra", "quality, stiffness, clearance,\ndamping with intervals"),
    "explain": (120, -14, GREEN, "diagnose", "causes, adjustments,\nremainder, prediction band"),
}
WIDTH, HEIGHT = 33, 19


def draw(_source, _run, folder):
    figure, axes = pyplot.subplots(figsize=(8.2, 3.25))
    figure.subplots_adjust(0.01, 0.01, 0.99, 0.99)
    bare(axes)
    for x, y, color, title, lines in BOXES.values():
        axes.add_patch(patches.FancyBboxPatch((x - WIDTH / 2, y - HEIGHT / 2), WIDTH, HEIGHT, facecolor="white",
                                              boxstyle="round,pad=0,rounding_size=2", edgecolor=color, lw=1.8))
        axes.text(x, y + 5.2, title, ha="center", va="center", fontweight="bold", color=color if color != GREY else INK)
        axes.text(x, y - 3.2, lines, ha="center", va="center", fontsize=7.6)
    half_width, half_height = WIDTH / 2, HEIGHT / 2
    arrow(axes, (half_width, 3), (40 - half_width, 11))
    arrow(axes, (40 + half_width, 11), (80 - half_width, 3))
    arrow(axes, (40 + half_width, -11), (80 - half_width, -3))
    arrow(axes, (80 + half_width, 3), (120 - half_width, 11))
    arrow(axes, (80 + half_width, -3), (120 - half_width, -11))
    bottom = -14 - half_height
    axes.plot([120, 120, 0], [bottom, bottom - 7, bottom - 7], color=GREEN, lw=1.6)
    arrow(axes, (0, bottom - 7), (0, -half_height), GREEN, 1.6)
    axes.text(60, bottom - 9, "the extended model: simulate it, compare it, run the next test", ha="center", va="top", color=GREEN)
    axes.set_xlim(-18, 138)
    axes.set_ylim(-36, 25)
    write(figure, folder, "loop")
