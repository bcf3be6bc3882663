"""The shipped device: axes, connections, stops and numbers, all read from its model."""
import tomllib

from matplotlib import patches, pyplot

from style import BLUE, GREEN, GREY, INK, ORANGE, PALE, RED, arrow, bare, write

MM = 1e3
PLOT = 9  # mm, half the edge of an elastomer as drawn


def spring(axes, start, end, color, width=3.0, turns=4):
    """A zigzag between two points that lie on a line along an axis."""
    (x0, y0), (x1, y1) = start, end
    count = 2 * turns + 2
    xs, ys = [], []
    for k in range(count + 1):
        side = 0 if k in (0, count) else (width if k % 2 else -width)
        xs.append(x0 + (x1 - x0) * k / count + (side if x0 == x1 else 0))
        ys.append(y0 + (y1 - y0) * k / count + (side if y0 == y1 else 0))
    axes.plot(xs, ys, color=color, lw=1.3)


def draw_top(axes, model):
    bare(axes)
    axes.set_title("From above: connections and lateral stops", loc="left")
    for connection in model["connection"]:
        x, y, _ = (MM * value for value in connection["position"])
        axes.plot([0, x], [0, y], color=GREY, lw=7, solid_capstyle="butt", zorder=1)
    axes.add_patch(patches.Circle((0, 0), 45, facecolor=PALE, edgecolor=GREY, zorder=2))
    axes.text(0, -27, "mobile part", ha="center", va="center")
    for connection in model["connection"]:
        x, y, _ = (MM * value for value in connection["position"])
        axes.add_patch(patches.Rectangle((x - PLOT, y - PLOT), 2 * PLOT, 2 * PLOT, facecolor=BLUE, edgecolor="none",
                                         alpha=0.85, zorder=3))
        axes.text(x, y, connection["name"], color="white", ha="center", va="center", fontweight="bold", zorder=4)
        for axis, (ex, ey) in {"x": (1, 0), "y": (0, 1)}.items():
            for stop in connection[axis].get("stops", []):
                sign = 1 if stop["side"] == "+" else -1
                at = (x + sign * ex * (PLOT + 8), y + sign * ey * (PLOT + 8))
                axes.plot([at[0] - 12 * ey, at[0] + 12 * ey], [at[1] - 12 * ex, at[1] + 12 * ex], color=RED, lw=3)
                axes.text(at[0] + (26 if ey else 0), at[1] + (19 if ex else 0),
                          f"{connection['name']}.{axis}.{stop['side'].replace('-', '−')}", color=RED,
                          ha="center", va="center", fontsize=8)
    arrow(axes, (0, 0), (38, 0))
    arrow(axes, (0, 0), (0, 38))
    axes.text(34, -10, "x")
    axes.text(-8, 33, "y")
    axes.set_xlim(-142, 142)
    axes.set_ylim(-142, 142)


def draw_side(axes, model):
    bare(axes)
    axes.set_title("From the side: axial elastomers and stops", loc="left")
    height = MM * model["body"]["center_of_gravity"][2]
    left, right = (MM * model["connection"][i]["position"][0] for i in (0, 1))
    axes.add_patch(patches.Rectangle((left - 38, -62), right - left + 76, 12, facecolor=PALE, edgecolor=GREY, hatch="//"))
    axes.text(10, -69, "fixed part: flexible bracket (frame F)", ha="center", va="top")
    axes.add_patch(patches.Rectangle((left - 12, -4), right - left + 24, 8, facecolor=GREY, edgecolor="none"))
    axes.add_patch(patches.FancyBboxPatch((-44, 10), 88, height + 22, boxstyle="round,pad=0,rounding_size=9",
                                          facecolor=PALE, edgecolor=GREY))
    axes.plot(0, height, marker="o", ms=7, mfc="white", mec=GREEN, mew=2)
    axes.text(47, height, f"centre of gravity\nat z = {height:.1f} mm", va="center", color=GREEN, fontsize=8)
    axes.text(0, height - 36, f"mobile part\n(frame M)\n{model['body']['mass']:g} kg", ha="center", va="center", fontsize=8)
    for connection, x in ((model["connection"][0], left), (model["connection"][1], right)):
        spring(axes, (x, -50), (x, -4), BLUE)
        axes.text(x, 18, connection["name"], color=BLUE, ha="center", fontweight="bold")
        outward = -1 if x < 0 else 1
        for stop in connection["z"]["stops"]:
            sign = 1 if stop["side"] == "+" else -1
            at = (x + outward * 24, sign * 15)
            axes.plot([at[0] - 9, at[0] + 9], [at[1], at[1]], color=RED, lw=3)
            axes.text(at[0], at[1] + sign * 9, f"{connection['name']}.z.{stop['side'].replace('-', '−')}", color=RED,
                      ha="center", va="center", fontsize=8)
        axes.plot([x, x + outward * 24], [0, 0], color=GREY, lw=4, solid_capstyle="butt")
        axes.plot([x + outward * 30, x + outward * 38, x + outward * 38, x + outward * 30], [-15, -15, 15, 15],
                  color=RED, lw=0.8)
    arrow(axes, (0, 0), (34, 0))
    arrow(axes, (0, 0), (0, 34))
    axes.text(33, -14, "x")
    axes.text(-10, 29, "z")
    arrow(axes, (left - 20, -100), (left - 20, -64), ORANGE, 2)
    axes.text(left - 12, -97, "load or base motion", color=ORANGE, va="center")
    axes.set_xlim(-155, 155)
    axes.set_ylim(-112, 190)


def tabulate(model):
    """Rows of numbers: axial, and lateral towards a stop."""
    axial, lateral = model["connection"][0]["z"], model["connection"][0]["x"]
    free = model["connection"][0]["y"]

    def row(name, law):
        stops = law.get("stops", [])
        return [name, f"{law['stiffness'] / 1e3:g} N/mm", f"{law['damping']:g} N s/m",
                f"{MM * stops[0]['clearance']:.3g} mm" if stops else "none",
                f"{stops[0]['stiffness'] / 1e3:g} N/mm" if stops else ""]

    return [row("axial (z)", axial), row("lateral, towards the stop", lateral), row("lateral, across", free)]


def draw(source, _, folder):
    with open(source / "models/shipped/smallsat_wems.toml", "rb") as file:
        model = tomllib.load(file)
    figure = pyplot.figure(figsize=(8.2, 5.0))
    top = figure.add_axes((0.0, 0.24, 0.46, 0.71))
    side = figure.add_axes((0.47, 0.24, 0.53, 0.71))
    draw_top(top, model)
    draw_side(side, model)
    numbers = figure.add_axes((0.03, 0.0, 0.94, 0.22))
    numbers.axis("off")
    table = numbers.table(cellText=tabulate(model), loc="center", cellLoc="left", edges="horizontal",
                          colLabels=["connection axis", "elastomer", "damping", "clearance", "stop stiffness"],
                          colWidths=[0.30, 0.17, 0.17, 0.17, 0.19])
    table.auto_set_font_size(False)
    table.set_fontsize(9)
    table.scale(1, 1.25)
    for cell in table.get_celld().values():
        cell.set_edgecolor(PALE)
        cell.get_text().set_color(INK)
    write(figure, folder, "device")
