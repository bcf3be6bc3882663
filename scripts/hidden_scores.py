"""Judges the answers to hidden effects and counts them: what scripts/hidden_effects prints."""
import math
from collections import Counter, defaultdict

# Documented ties: causes that these pairs of names cannot be told apart by, whatever the noise.
TIES = [{"clearance", "preload"}, {"load", "sensor_gain"}, {"sensor_delay", "viscous_damping"}]
NAMED = 0.5  # probability from which a cause counts as named
BINS = [(0.5, 0.7), (0.7, 0.9), (0.9, 0.97), (0.97, 1.01)]
NORMAL95 = 1.96


def axis_of(place):
    return ".".join(place.split(".")[:2])


def same_place(true, named):
    """True if a place is named, or the connection's axis that it belongs to."""
    return any(axis_of(a) == axis_of(b) for a in true for b in named)


def matches(true, named):
    """`right`, `tie` (documented) or None: does an entry of the result name a true cause?"""
    if not same_place(true["where"], named["where"]):
        # A side's delay and damping, the load's gain and a side's gain have no place in common.
        distant = {true["cause"], named["cause"]}
        return "tie" if distant in TIES and distant != {"clearance", "preload"} else None
    if named["cause"] == true["cause"]:
        return "right"
    return "tie" if {true["cause"], named["cause"]} in TIES else None


def how_named(true, named):
    """As matches; `rival` where the true cause stands among the rivals, which is not counted as right."""
    found = matches(true, named)
    if found:
        return found
    rivals = [dict(r, where=r.get("where", named["where"])) for r in named.get("rivals", [])]
    return "rival" if any(matches(true, r) == "right" for r in rivals) else None


def true_values(truth):
    """True value by the names that results use."""
    values = dict(truth["parameters"])
    for name in list(values):
        if name.startswith("body."):
            values[name.removeprefix("body.")] = values[name]
            values[name.rsplit(".", 1)[1]] = values[name]
    for cause in truth["causes"]:
        values.update(cause["parameters"])
    return values


def along_one_axis(cause):
    """A cause without the name of its connection: in a rig that moves along one axis all connections move alike, so that no
    recording tells which of them has it."""
    where = [place.split(".", 1)[1] if place[0].isdigit() else place for place in cause["where"]]
    return dict(cause, where=where, rivals=[along_one_axis(r) for r in cause.get("rivals", [])])


def judge(entry):
    """Adds what a case's answer is worth."""
    if "failed" in entry:
        return
    truth, result = entry["truth"], entry["result"]
    causes = truth["causes"]
    if truth["set_up"].startswith("axis"):
        causes = [along_one_axis(c) for c in causes]
        result = dict(result, causes=[along_one_axis(c) for c in result["causes"]])
    named = [c for c in result["causes"] if c["probability"] >= NAMED]
    entry["named"] = [{"cause": c["cause"], "where": c["where"], "probability": c["probability"]} for c in named]
    entry["verdict"] = result["verdict"]
    marks = [{"probability": c["probability"], "how": next(filter(None, (how_named(t, c) for t in causes)), None)}
             for c in result["causes"]]
    entry["marks"] = marks
    right = [m for m in marks if m["how"] in ("right", "tie")]
    entry["first"] = marks[0]["how"] if marks and marks[0]["probability"] >= NAMED else None
    entry["all"] = bool(causes) and all(any(matches(t, c) for c in named) for t in causes)
    entry["false"] = sum(m["probability"] >= NAMED and m not in right for m in marks)
    kind = truth["class"]
    if kind == "none":
        entry["good"] = result["verdict"] == "nothing_missing" and not named
    elif kind == "outside":
        entry["good"] = result["verdict"] == "unexplained" and not named
        places = [w for w in result["unexplained"]["where"] if "." in w]
        entry["place"] = bool(places) and places[0].startswith(truth["outside"]["where"])
    else:
        entry["good"] = entry["first"] in ("right", "tie") if kind == "single" else entry["all"]
    after = result["error_after"].get("validation")
    least = truth["error_of_true_model"]["validation"]
    entry["over_true"] = after / least if after is not None and least else math.inf
    judge_numbers(entry, named)


def judge_numbers(entry, named):
    """Parameters of named causes against their intervals; adjustments against what was believed."""
    truth, values = entry["truth"], true_values(entry["truth"])
    entry["parameters"], entry["adjusted"] = [], []
    for cause in named:
        if not any(matches(t, cause) == "right" for t in truth["causes"]):
            continue
        own = next(t for t in truth["causes"] if matches(t, cause) == "right")["parameters"]
        for p in cause["parameters"]:
            if p["name"] in own:
                entry["parameters"].append({"cause": cause["cause"], "name": p["name"], "true": own[p["name"]],
                                            "found": p["value"], "interval": p.get("interval95")})
    for a in entry["result"].get("adjustments", []):
        true = values.get(a["name"])
        if true is None or a.get("believed") is None or a.get("value") is None:
            continue
        interval = a.get("interval95")
        entry["adjusted"].append({"name": a["name"], "nearer": abs(a["value"] - true) < abs(a["believed"] - true),
                                  "held": None if not interval or None in interval else interval[0] <= true <= interval[1]})


def relative_error(parameter, entry):
    true, found = parameter["true"], parameter["found"]
    if true is None or found is None:
        return 0.0 if true is None and found is None else math.inf
    if parameter["cause"] in ("sensor_misalignment", "cog_offset", "gyroscopic"):
        # Vectors: relative to the largest component.
        own = [abs(p["true"]) for p in entry["parameters"] if p["cause"] == parameter["cause"] and p["true"] is not None]
        return abs(found - true) / max(own)
    return abs(found - true) / abs(true) if true else math.inf


def percent(count, total):
    return f"{count}/{total}" + (f" ({100 * count / total:.0f} %)" if total else "")


def quantile(values, share):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


def binomial_band(share, count):
    """Wilson's 95 % interval of a share."""
    if count == 0:
        return 0.0, 1.0
    z2 = NORMAL95**2
    centre = (share + z2 / (2 * count)) / (1 + z2 / count)
    half = NORMAL95 / (1 + z2 / count) * math.sqrt(share * (1 - share) / count + z2 / (4 * count**2))
    return centre - half, centre + half


def count_classes(entries, lines, title):
    """One block: what was asked for in each class, of these cases."""
    groups = defaultdict(list)
    for e in entries:
        groups[e["truth"]["class"]].append(e)
    parts = []
    for kind, text in (("single", "first and placed"), ("two", "both"), ("none", "nothing_missing"), ("outside", "unexplained")):
        own = groups[kind]
        if not own:
            continue
        parts.append(f"{kind}: {text} {percent(sum(e.get('good', False) for e in own), len(own))}")
    done = [e for e in entries if "result" in e]
    parts.append(f"false causes in {percent(sum(e['false'] > 0 for e in done), len(done))}")
    over = [e["over_true"] for e in done]
    if over:
        parts.append(f"error after / true model's: median {quantile(over, 0.5):.2f}, 95 % {quantile(over, 0.95):.2f}")
    if len(done) < len(entries):
        parts.append(f"failed {len(entries) - len(done)}")
    lines.append(f"{title:28s} " + "; ".join(parts))


def describe_reliability(done, lines):
    marks = [m for e in done for m in e["marks"]]
    lines.append("Reliability of named causes: probability, count, mean, share right, 95 % band of that share")
    for lower, upper in BINS:
        own = [m for m in marks if lower <= m["probability"] < upper]
        if not own:
            lines.append(f"  {lower:.2f} to {min(upper, 1):.2f}     0")
            continue
        mean = sum(m["probability"] for m in own) / len(own)
        share = sum(m["how"] in ("right", "tie") for m in own) / len(own)
        low, high = binomial_band(share, len(own))
        lines.append(f"  {lower:.2f} to {min(upper, 1):.2f}  {len(own):4d}  {mean:.3f}  {share:.3f}  {low:.2f} to {high:.2f}")
    if marks:
        brier = sum((m["probability"] - (m["how"] in ("right", "tie")))**2 for m in marks) / len(marks)
        lines.append(f"  Brier score of all {len(marks)} causes in the results: {brier:.3f}")


def describe_parameters(done, lines):
    errors, intervals, inside = defaultdict(list), Counter(), Counter()
    for e in done:
        for p in e["parameters"]:
            errors[p["cause"]].append(relative_error(p, e))
            if p["interval"] and p["true"] is not None and None not in p["interval"]:
                intervals[p["cause"]] += 1
                inside[p["cause"]] += p["interval"][0] <= p["true"] <= p["interval"][1]
    every = [x for own in errors.values() for x in own]
    if every:
        lines.append(f"Parameters of true causes: {len(every)}, median error {100 * quantile(every, 0.5):.2f} %, within 5 %: "
                     f"{percent(sum(x <= 0.05 for x in every), len(every))}; intervals hold the truth: "
                     f"{percent(sum(inside.values()), sum(intervals.values()))}")
    for cause in sorted(errors):
        own = errors[cause]
        lines.append(f"  {cause:22s} {len(own):4d}, median {100 * quantile(own, 0.5):6.2f} %, largest {100 * max(own):8.1f} %, "
                     f"held {percent(inside[cause], intervals[cause])}")
    adjusted = [a for e in done for a in e["adjusted"]]
    held = [a["held"] for a in adjusted if a["held"] is not None]
    lines.append(f"Adjustments nearer to the truth than believed: {percent(sum(a['nearer'] for a in adjusted), len(adjusted))}; "
                 f"intervals hold the truth: {percent(sum(held), len(held))}")


def describe_confusion(entries, lines):
    lines.append("What was hidden → what was answered")
    rows = defaultdict(Counter)
    for e in entries:
        truth = e["truth"]
        hidden = " + ".join(sorted(c["cause"] for c in truth["causes"])) or truth["class"]
        if truth["class"] == "outside":
            hidden = "outside: " + truth["outside"]["kind"]
        if truth["class"] == "two":
            hidden = "two"
        if "failed" in e:
            rows[hidden]["failed"] += 1
            continue
        answer = " + ".join(sorted({c["cause"] for c in e["named"]})) or "-"
        if e["good"] and truth["class"] != "none":
            answer = "good" + (" and more" if e["false"] else "")
        elif e["first"] == "rival":
            answer += " (true cause its rival)"
        rows[hidden][f"{answer}, {e['verdict']}"] += 1
    for hidden in sorted(rows):
        lines.append(f"  {hidden:32s} " + "; ".join(f"{n} {a}" for a, n in rows[hidden].most_common()))


def summarise(entries):
    lines = []
    done = [e for e in entries if "result" in e]
    describe_confusion(entries, lines)
    lines.append("")
    count_classes(entries, lines, "all")
    for key, what in (("level", "level"), ("set_up", ""), ("recorded", "")):
        for value in sorted({e["truth"][key] for e in entries}, key=str):
            count_classes([e for e in entries if e["truth"][key] == value], lines, f"{what} {value}".strip())
    for name in ("log", "linear", "random"):
        own = [e for e in entries if e["truth"]["runs"][0]["excitation"].startswith(name)]
        if own:
            count_classes(own, lines, "excitation " + name)
    for lower, upper in ((0, 0.3), (0.3, 3), (3, 100)):
        own = [e for e in entries if lower <= e["truth"]["time_scale"] < upper]
        if own:
            count_classes(own, lines, f"time scale {lower} to {upper}")
    outside = [e for e in done if e["truth"]["class"] == "outside"]
    lines.append(f"outside: right place named as unexplained: {percent(sum(e['place'] for e in outside), len(outside))}")
    verdicts = Counter(e["verdict"] for e in done if e["truth"]["class"] in ("single", "two"))
    lines.append("verdicts where a cause was hidden: " + ", ".join(f"{v} {n}" for v, n in verdicts.most_common()))
    lines.append("")
    describe_reliability(done, lines)
    lines.append("")
    describe_parameters(done, lines)
    cpu = [e["cpu"] for e in done]
    if cpu:
        lines.append(f"CPU time of a diagnosis: median {quantile(cpu, 0.5):.1f} s, longest {max(cpu):.1f} s")
    lines.append("not good: " + " ".join(str(e["index"]) for e in done if not e["good"]))
    for e in entries:
        if "failed" in e:
            lines.append(f"failed: {e['index']} ({e['truth']['set_up']}): {e['failed']}")
    return "\n".join(lines)
