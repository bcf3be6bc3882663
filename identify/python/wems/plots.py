"""The main figure of each result."""
import numpy


def _axes(ax):
    if ax is not None:
        return ax
    import matplotlib.pyplot

    return matplotlib.pyplot.figure(figsize=(8, 4.5), layout="constrained").add_subplot()


def plot_recording(recording, names, ax):
    ax = _axes(ax)
    if not names:
        names = [name for name in recording.names if name.startswith("mobile.") and name.endswith(".z")]
    for name in names or recording.names:
        ax.plot(recording.time, recording[name], label=f"{name} [{recording.unit(name)}]", linewidth=0.8)
    ax.set(xlabel="time [s]", title=recording.file)
    ax.legend(fontsize="small")
    return ax


def _fit(result, ax):
    known = [p for p in result["parameters"] if p["value"] and None not in p["interval95"]]
    value = numpy.array([p["value"] for p in known])
    low, high = numpy.array([p["interval95"] for p in known]).reshape(-1, 2).T
    scale = numpy.array([p.get("model_value") or p["value"] for p in known])
    ends = numpy.abs(numpy.vstack([(value - low) / scale, (high - value) / scale]))
    ax.errorbar(value / scale, range(len(known)), xerr=ends, fmt="o", markersize=3, capsize=2)
    ax.set_yticks(range(len(known)), [p["name"] for p in known], fontsize="x-small")
    ax.axvline(1, color="grey", linewidth=0.8)
    ax.set(xlabel="identified / model, 95 % interval", title=f"fit: {result.verdict}")


def _diagnose(result, ax):
    stages = ["error_before", "error_adjusted", "error_after"]
    for offset, group in ((-0.2, "identification"), (0.2, "validation")):
        errors = [100 * (result[stage][group] if result[stage][group] is not None else numpy.nan) for stage in stages]
        ax.bar(numpy.arange(len(stages)) + offset, errors, width=0.4, label=group)
    floor = result["unexplained"]["noise_floor"]
    if floor is not None:
        ax.axhline(100 * floor, color="grey", linestyle="--", label="noise alone")
    ax.set_xticks(range(len(stages)), ["before", "adjusted", "after"])
    causes = ", ".join(cause["cause"] for cause in result["causes"]) or "no cause"
    ax.set(ylabel="error of the free simulation [%]", yscale="log", title=f"{result.verdict}: {causes}")
    ax.legend()


def _rigidity(result, ax):
    for check in result["checks"]:
        ax.plot(check["history"]["time"], check["history"]["percent"], label=check["name"], linewidth=0.8)
    ax.set(xlabel="time [s]", ylabel="error [%]", title="rigidity")
    ax.legend(fontsize="x-small", ncols=2)


def _spectra(result, ax):
    for run in result["runs"]:
        transfers = run["transmissibility"] or run["transfer"]
        driven = [transfer for transfer in transfers if transfer["input"] == run["reference"]]
        for transfer in driven or transfers:
            real, imaginary = (numpy.array(transfer["h1"][part], dtype=float) for part in ("real", "imaginary"))
            ax.plot(run["frequency"], numpy.hypot(real, imaginary), linewidth=0.8,
                    label=f"{transfer['output']}/{transfer['input']}")
        if run["reference"]:
            ax.set_xlim(run["band"])
    ax.set(xlabel="frequency [Hz]", ylabel="amplitude", yscale="log", title="frequency response")
    ax.legend(fontsize="x-small", ncols=2)


def _compare(result, ax):
    for channel in result["channels"]:
        centre = [numpy.sqrt(band["from"] * band["to"]) for band in channel["bands"]]
        error = [numpy.nan if band["error"] is None else 100 * band["error"] for band in channel["bands"]]
        ax.plot(centre, error, ".-", label=channel["name"], linewidth=0.8)
    ax.set(xlabel="swept frequency [Hz]", ylabel="error [%]", title=f"error {100 * (result['error'] or 0):.3g} %")
    ax.legend(fontsize="x-small", ncols=2)


def _inspect(result, ax):
    channels = [channel for one in result["recordings"] for channel in one["channels"]]
    decibel = [numpy.nan if c["signal_to_noise_db"] is None else c["signal_to_noise_db"] for c in channels]
    ax.bar(range(len(channels)), decibel)
    ax.set_xticks(range(len(channels)), [c["name"] for c in channels], rotation=90, fontsize="x-small")
    ax.set(ylabel="signal to noise [dB]", title=", ".join(one["quality"]["verdict"] for one in result["recordings"]))


def _plan(result, ax):
    for number, proposal in enumerate(result["proposals"], 1):
        ratios = [(i["then95"][1] - i["then95"][0]) / (i["now95"][1] - i["now95"][0]) for i in proposal["intervals"]
                  if i["now95"] and i["then95"] and None not in i["now95"] + i["then95"] and i["now95"][1] > i["now95"][0]]
        ax.plot(sorted(ratios), ".-", label=f"{number}: {proposal['excitation']}")
    ax.set(xlabel="parameters, by ratio", ylabel="interval then / now", yscale="log", title="the next test")
    ax.legend(fontsize="small")


def _response(result, ax):
    for level in result["levels"]:
        frequency = numpy.array([point["frequency"] for point in level["points"]])
        largest = 1e3 * numpy.array([max(point["amplitude"]) for point in level["points"]])
        stable = numpy.array([point["stable"] for point in level["points"]])
        line, = ax.plot(frequency, numpy.where(stable, largest, numpy.nan), label=level["level"])
        ax.plot(frequency, numpy.where(stable, numpy.nan, largest), ":", color=line.get_color())
    ax.set(xlabel="frequency [Hz]", ylabel="largest amplitude [mm]", title="periodic response, dotted: unstable")
    ax.legend()


def _modes(result, ax):
    frequency = [mode["frequency"] for mode in result["modes"]]
    ax.bar(range(1, len(frequency) + 1), frequency)
    ax.set(xlabel="mode", ylabel="natural frequency [Hz]")


_FIGURES = {"fit": _fit, "diagnose": _diagnose, "rigidity": _rigidity, "spectra": _spectra, "compare": _compare,
            "inspect": _inspect, "plan": _plan, "response": _response, "modes": _modes}


def plot_result(result, ax):
    ax = _axes(ax)
    if result.kind == "fit" and not result["parameters"]:
        ax.set_title("nothing is identified one by one")
        return ax
    _FIGURES[result.kind](result, ax)
    return ax
