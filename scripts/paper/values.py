"""Identified values beside the truth."""
import true_and_identified

UNIT = 1e5  # N/m, the axial elastomer stiffness that the paper's values are relative to


def relative_error(value, truth):
    return abs(value / truth - 1)


def stiffness(value, truth):
    """`12.93 (2.08 %)` as the paper writes it."""
    error = 100 * relative_error(value, truth)
    return f"{value / UNIT:.{2 if abs(value) > 2e5 or error > 1 else 3}f} ({error:.{2 if error >= 0.1 else 3}f} %)"


class SingleAxis:
    """Result of `paper_methods single-axis`."""

    def __init__(self, result, truth_file):
        self.result = result
        self.truth = true_and_identified.parameters(truth_file)
        self.terms = {t["name"]: t for t in result["terms"]}

    def true(self, name):
        return self.truth[name.replace(".stops.", ".+.")]

    def cell(self, *names):
        return "; ".join(stiffness(self.terms[n]["value"], self.true(n)) if n in self.terms else "–" for n in names)

    def worst(self, *names):
        return max(relative_error(self.terms[n]["value"], self.true(n)) for n in names)

    def curve(self, name):
        c = next(c for c in self.result["nonparametric"] if c["term"] == name)
        return [1e3 * q for q in c["displacement"]], c["force"]

    def singular_values(self):
        return ", ".join(f"{v:.3g}" for v in self.result["singular_values_percent"]) + f"; {self.result['rank']} kept"

    def confidence(self, name, kind="confidence_factor"):
        return self.terms[name][kind]


class Fit:
    """Result of `identify fit`."""

    def __init__(self, result, truth_file):
        self.truth = true_and_identified.parameters(truth_file)
        self.known = {p["name"]: p for p in result["parameters"] if p["name"] in self.truth}
        self.combined = {g["known_combination"]: g for g in result["not_identifiable"] if g.get("known_combination")}
        self.residual = result["residual"]["fraction"]
        self.notes = result["notes"]

    def cell(self, *names):
        """Values of parameters; of both stops of an axis (`4.z.stops.stiffness`) the worse one."""
        cells = []
        for name in names:
            sides = [n for n in (name.replace("stops", "+"), name.replace("stops", "-")) if n in self.known]
            if not sides:
                cells.append("not known")
                continue
            worst = max(sides, key=lambda n: relative_error(self.known[n]["value"], self.truth[n]))
            cells.append(stiffness(self.known[worst]["value"], self.truth[worst]))
        return "; ".join(cells)

    def combination_error(self, expression):
        group = self.combined[expression]
        names = group["names"]
        return (group["value"] - true_and_identified.combination(expression, self.truth)) / max(abs(self.truth[n]) for n in names)

    def errors(self, select=lambda name: True):
        """|error| of every known value and combination whose names are all selected, relative to the values."""
        errors = [relative_error(p["value"], self.truth[n]) for n, p in self.known.items() if select(n) and self.truth[n]]
        return errors + [abs(self.combination_error(e)) for e, g in self.combined.items() if all(select(n) for n in g["names"])]

    def worst(self, select=lambda name: True):
        errors = self.errors(select)
        return f"{100 * max(errors):.3g} %" if errors else "–"

    def intervals(self):
        """How many intervals hold the truth, of how many."""
        held = [p["interval95"][0] <= self.truth[n] <= p["interval95"][1] for n, p in self.known.items()]
        for expression, group in self.combined.items():
            truth = true_and_identified.combination(expression, self.truth)
            held.append(group["interval95"][0] <= truth <= group["interval95"][1])
        return f"{sum(held)} of {len(held)}"


def is_elastomer(name):
    return name.endswith("stiffness") and name.count(".") == 2


def is_stop(name):
    return name.endswith("stiffness") and name.count(".") == 3


def is_clearance(name):
    return name.endswith("clearance")


def is_damping(name):
    return name.endswith("damping")
