"""Pictures and rows that rest on time histories: the beam, rigidity, jumps."""
import json

import recordings
import work
from work import DEVICE, WORK, by_paper, csv, identify

BEAM_CUBIC = 8e9  # N/m^3, default of simulate_beam


def beam(page, svg):
    page.heading("The beam of section 3.1 (figure 2)")
    result = by_paper("beam-tip", WORK / "beam.csv")
    rows = []
    for kind in ("complete", "truncated"):
        p = {q["name"]: q["value"] for q in result[kind]["parameters"]}
        rows.append([f"{kind} equation of the tip", f"{p['cubic']:.4g}", f"{100 * (p['cubic'] / BEAM_CUBIC - 1):+.3g} %",
                     f"{100 * result[kind]['residual']['fraction']:.2g} %"])
        q, f = result[kind]["spring"]["displacement"], result[kind]["spring"]["force"]
        grid = [min(q) + k * (max(q) - min(q)) / 100 for k in range(101)]
        linear = p["stiffness"] if kind == "truncated" else 0.0  # the complete equation's force is the spring alone
        series = [("nonparametric", [1e3 * v for v in q], f, "points"), ("fitted", [1e3 * v for v in grid], [linear * v + p["cubic"] * v ** 3 for v in grid])]
        if kind == "complete":
            series.append(("exact", [1e3 * v for v in grid], [BEAM_CUBIC * v ** 3 for v in grid]))
        page.picture(f"figure_02_{kind}", svg.plot(f"Tip spring, {kind} equation", "tip deflection [mm]", "force [N]", series))
    page.table(["", "cubic stiffness, N/m³", "error", "unexplained"], rows)
    page.text("Main beam of Kerschen, Lenaerts and Golinval (2003): 0.7 m × 14 mm × 14 mm, steel (205 GPa, 7800 kg/m³), ten elements, clamped. Cubic spring 8e9 N/m³ at the tip, damping proportional "
              "to stiffness (6e-5 s), sweep 10 to 60 Hz of 10 N at node 3. Truth: 8e9. The complete equation takes mass and stiffness rows from the model and both deflections and rotations of the last "
              "two nodes from the recording. The truncated one has the tip's deflection alone, with its own linear stiffness and damping free: it shows a hardening spring, and its numbers mean nothing.")


PAPER_LIMITS = {"length 1-2": ("0.03", "0.2"), "length 3-4": ("1", "0.4"), "perpendicularity": ("1e-6", "1.5e-7"),
                "midpoint x": ("1.5e-5", "1e-4"), "midpoint y": ("1e-4", "3e-5"), "midpoint z": ("0.02", "5e-6")}


def rigidity(page, svg):
    page.heading("Rigidity: figures 4 and 5")

    def check(file):
        return identify("rigidity", WORK / f"{file}.csv", "--model", DEVICE)

    results = {name: check(name) for name in ("axial_300", "axial_300_flexible", "lateral_300", "lateral_300_flexible", "lateral_100_flexible")}

    def largest(name, which):
        c = next(c for c in results[name]["checks"] if c["name"] == which)
        return f"{c['max_percent']:.2g}" + (f" at {c['at_frequency']:.1f} Hz" if c["max_percent"] > 1e-7 else "")

    page.table(["check, largest error in %", "paper, z 300 N (scale of figure 4)", "ours, z 300 N, rigid", "ours, z 300 N, flexible", "paper, x 300 N (scale of figure 5)",
                "ours, x 300 N, rigid", "ours, x 300 N, flexible", "ours, x 100 N (no stop), flexible"],
               [[name, PAPER_LIMITS[name][0], largest("axial_300", name), largest("axial_300_flexible", name), PAPER_LIMITS[name][1], largest("lateral_300", name),
                 largest("lateral_300_flexible", name), largest("lateral_100_flexible", name)] for name in PAPER_LIMITS])
    for run, figure in (("axial_300", "4"), ("lateral_300", "5")):
        for name in PAPER_LIMITS:
            c = next(c for c in results[run + "_flexible"]["checks"] if c["name"] == name)
            key = name.replace(" ", "_").replace("-", "_")
            page.picture(f"figure_0{figure}_{key}", svg.plot(f"Figure {figure}: {name}, flexible", "swept frequency [Hz]", "error [%]",
                                                            [(run.replace("_", " ") + " N", c["history"]["frequency"], c["history"]["percent"])], symmetric=True))
    ends = recordings.read_columns(csv("axial_300"), ["mobile.3.z", "mobile.4.z"])
    rotation = max(abs(a - b) / 0.2 for a, b in zip(ends["mobile.3.z"], ends["mobile.4.z"]))
    page.text("The rigid simulation leaves the digits of the file. The flexible cross: the static response of a bending mode at 3109 Hz to the forces at its ends is added to the recording. The mode "
              "is that of table 2, arms 1, 2 up and 3, 4 down; its modal mass of 0.2 kg for unit deflection of the ends is an assumption. It shows in `midpoint z`, where the stop 4-z is hit, with "
              "the size of the paper's sixth check (0.02 %). "
              "The paper's length errors, up to 1 %, are far above what bending can do to a length (second order); small-rotation finite "
              f"elements leave the squared rotation, {100 * rotation ** 2:.2g} % in our run: our inference is that the paper's come from there.")
    gain = check("axial_300_gain")
    page.text("A marker with a wrong gain (mobile.4.z times 1.03, in the run with 1 µm and 0.01 m/s² noise): " + "; ".join(
        f"`identify rigidity` names {s['channel']}, {s['fault']} {s.get('gain', 0):.4f}, which explains {100 * s['explained']:.1f} % of the breach" for s in gain["suspects"]) + ".")


def envelope(run, connection="4", start=5.0, rate=4.0):
    """Largest |relative z displacement| in bands of 0.1 Hz, mm; keys in Hz."""
    time, q = recordings.relative(csv(run), connection, "z")
    bands = {}
    for f, v in zip(recordings.swept_frequency(time, start, rate), q):
        key = round(f, 1)
        bands[key] = max(bands.get(key, 0.0), abs(1e3 * v))
    return bands


def nonlinear(page, r, svg):
    page.heading("Axial, nonlinear: figures 10, 11, 12")
    time, q = recordings.relative(csv("axial_300"), 4, "z")
    page.picture("figure_10_history", svg.plot("Figure 10: 4-z, 300 N", "swept frequency [Hz]", "relative displacement [mm]", [
        ("4-z", recordings.swept_frequency(time, 5, 4), [1e3 * v for v in q])]))
    low, up, down = envelope("axial_200"), envelope("axial_300"), envelope("axial_300_down", start=50.0, rate=-4.0)
    band = [f for f in sorted(up) if 26 <= f <= 40 and f in down and f in low]
    page.picture("figure_10_envelopes", svg.plot("Envelopes of 4-z up and down", "swept frequency [Hz]", "displacement / force [mm/N]", [
        ("300 N up", band, [up[f] / 300 for f in band]), ("300 N down", band, [down[f] / 300 for f in band]), ("200 N up (linear)", band, [low[f] / 200 for f in band])]))
    jump = max(band[5:-5], key=lambda f: up[band[band.index(f) - 3]] - up[band[band.index(f) + 3]])
    rise = max(band[5:-5], key=lambda f: down[band[band.index(f) - 3]] - down[band[band.index(f) + 3]])
    stable = [f for f in band if up[f] > 1.2 * down[f]]
    page.text(f"Upwards the stop holds the motion up to a jump at {jump:.1f} Hz; downwards the motion rises at {rise:.1f} Hz. "
              + (f"Between {stable[0]:.1f} and {stable[-1]:.1f} Hz the upward sweep is more than 1.2 times the downward one: the bistable range." if stable else "No bistable range was found."))
    for run, name, ends in (("axial_300", "figure_11", "4"), ("axial_500", "figure_12", "34")):
        s = r.single(run, "--hold-elastomers", model=r.linear)
        for i in ends:
            q, f = s.curve(f"{i}.z.stiffness")
            grid = [min(q) + k * (max(q) - min(q)) / 200 for k in range(201)]
            law = {"stiffness": s.terms[f"{i}.z.stiffness"]["value"], "stops": [
                {"side": side, "clearance": 1.57e-3, "stiffness": s.terms[f"{i}.z.stops.stiffness"]["value"]} for side in "+-"]}
            exact = {"stiffness": 1e5, "stops": [{"side": side, "clearance": 1.57e-3, "stiffness": 13.2e5} for side in "+-"]}
            page.picture(f"{name}_{i}z", svg.plot(f"Figure {name[-2:]}: {i}-z, {run[-3:]} N", "relative displacement [mm]", "restoring force [N]", [
                ("nonparametric", q, f, "points"), ("fitted", grid, [recordings.law_force(law, 1e-3 * v) for v in grid]),
                ("exact", grid, [recordings.law_force(exact, 1e-3 * v) for v in grid])]))


def save_results(results):
    (work.OUT / "fits.json").write_text(json.dumps(results, indent=1))
