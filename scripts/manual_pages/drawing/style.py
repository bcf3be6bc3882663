"""How all figures look, and how they are written: the same bytes from the same data."""
import re

import matplotlib

matplotlib.use("svg")
from matplotlib import pyplot  # noqa: E402

INK, GREY, PALE = "#1f2933", "#8896a5", "#e6ebf0"
BLUE, ORANGE, GREEN, RED = "#2166ac", "#d9730d", "#2f8f4e", "#b2182b"

matplotlib.rcParams.update({
    "svg.hashsalt": "wems", "svg.fonttype": "path", "font.size": 9, "font.family": "DejaVu Sans",
    "axes.edgecolor": GREY, "axes.labelcolor": INK, "text.color": INK, "xtick.color": INK, "ytick.color": INK,
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.color": PALE, "axes.axisbelow": True,
    "axes.titlesize": 10, "axes.titleweight": "bold", "legend.frameon": False, "path.simplify_threshold": 0.3,
    "lines.linewidth": 1.4})


def write(figure, folder, name):
    file = folder / f"{name}.svg"
    figure.savefig(file, metadata={"Date": None, "Creator": None}, facecolor="white")
    pyplot.close(figure)
    # Hundredths of a point are enough, and half as long.
    text = re.sub(r' d="[^"]*"', lambda path: re.sub(r"(\.\d\d)\d+", r"\1", path.group()), file.read_text(encoding="utf-8"))
    file.write_text(text, encoding="utf-8")


def bare(axes):
    """Axes for a drawing: no frame, no ticks, the same scale both ways."""
    axes.set_aspect("equal")
    axes.axis("off")


def arrow(axes, start, end, color=INK, width=1.2):
    axes.annotate("", xy=end, xytext=start, arrowprops={"arrowstyle": "-|>", "color": color, "lw": width,
                                                       "shrinkA": 0, "shrinkB": 0})
