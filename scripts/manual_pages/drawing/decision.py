"""How a diagnosis decides: the evidence of the candidates, the errors before, adjusted and after, and the law found."""
import tomllib

from matplotlib import pyplot

import example
from style import BLUE, GREEN, GREY, INK, ORANGE, PALE, write

SHOWN = 6


def name_candidate(candidate):
    places = candidate["where"]
    return f"{candidate['cause'].replace('_', ' ')}, {places[0] if len(places) == 1 else f'{len(places)} places by one factor'}"


def draw_evidence(axes, decision):
    best = sorted(decision["candidates"], key=lambda c: c["log_odds"], reverse=True)[:SHOWN]
    odds = [c["log_odds"] for c in best]
    axes.barh(range(len(best)), odds, color=[BLUE] + [GREY] * (len(best) - 1), height=0.62)
    for k, (candidate, value) in enumerate(zip(best, odds)):
        axes.text(0.02 * max(odds), k - 0.44, name_candidate(candidate), va="bottom", fontsize=7.2)
        axes.text(value + 0.02 * max(odds), k, f"{value:.0f}", va="center", fontsize=8)
    axes.set_ylim(len(best) - 0.5, -0.75)
    axes.set_xlim(0, 1.16 * max(odds))
    axes.set_yticks([])
    axes.set_xlabel("gain in log evidence")
    axes.set_title("1  candidates", loc="left")


def draw_errors(axes, diagnosis):
    bars = [("before", diagnosis["error_before"], GREY), ("adjusted", diagnosis["error_adjusted"], ORANGE),
            ("with the\ncause", diagnosis["error_after"], BLUE)]
    percents = [100 * error["validation"] for _, error, _ in bars]
    axes.bar(range(3), percents, color=[colour for _, _, colour in bars], width=0.62)
    for k, value in enumerate(percents):
        axes.text(k, value + 0.3, f"{value:.1f} %", ha="center", fontsize=8)
    band, noise = (100 * value for value in (diagnosis["prediction"]["band"], diagnosis["unexplained"]["noise_floor"]))
    axes.axhspan(0, min(band, 1.18 * max(percents)), color=PALE, zorder=0)
    axes.axhline(noise, color=GREEN, lw=1.2, ls="--")
    axes.text(2.42, noise + 0.10 * max(percents), f"noise alone {noise:.1f} %", color=GREEN, ha="right", fontsize=7.2)
    axes.text(2.42, 1.10 * max(percents), f"95 % band: {band:.1f} %", color=INK, ha="right", fontsize=7.2)
    axes.set_xticks(range(3), [name for name, _, _ in bars])
    axes.tick_params(axis="x", length=0)
    axes.grid(False, axis="x")
    axes.set_ylim(0, 1.18 * max(percents))
    axes.set_ylabel("error of a run not fitted to, %")
    axes.set_title("2  prediction", loc="left")


def draw_law(axes, work, diagnosis):
    laws = {}
    for name in ("believed", "true", "extended"):
        with open(work.folder / f"{name}.toml", "rb") as file:
            laws[name] = next(c for c in tomllib.load(file)["connection"] if c["name"] == "3")["z"]
    parameter = diagnosis["causes"][0]["parameters"][0]
    q = [0.05 * k for k in range(-28, 29)]  # mm, within the clearance
    styles = {"believed": (GREY, "-"), "true": (GREEN, "-"), "extended": (BLUE, "--")}
    for name, law in laws.items():
        force = [law["stiffness"] * 1e-3 * x + law.get("cubic", 0.0) * (1e-3 * x) ** 3 for x in q]
        axes.plot(q, force, color=styles[name][0], ls=styles[name][1], label="found" if name == "extended" else name)
    axes.set_xlabel("q at 3.z, mm")
    axes.set_ylabel("elastic force, N")
    axes.legend(fontsize=7.5, loc="upper left", handlelength=1.6)
    lower, upper = parameter["interval95"]
    axes.text(0.98, 0.04, f"cubic, GN/m³\ntrue {float(example.HARDENING) / 1e9:.1f}\nfound {parameter['value'] / 1e9:.2f}\n"
              f"95 % {lower / 1e9:.2f} … {upper / 1e9:.2f}", transform=axes.transAxes, ha="right", va="bottom", fontsize=7.2)
    axes.set_title("3  what was found", loc="left")


def draw(source, work, folder):
    diagnosis = example.make(source, work)
    figure, axes = pyplot.subplots(1, 3, figsize=(8.2, 3.3), width_ratios=(1.15, 1, 1))
    first = next(decision for decision in diagnosis["decisions"] if decision.get("candidates"))
    draw_evidence(axes[0], first)
    draw_errors(axes[1], diagnosis)
    draw_law(axes[2], work, diagnosis)
    figure.subplots_adjust(0.02, 0.15, 0.99, 0.91, wspace=0.32)
    write(figure, folder, "decision")
