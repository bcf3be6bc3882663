"""The commands as functions.

recording: a file's name or a Recording; model: a file's name or a Model. columns, geometry: files as on the command
line. progress(what, done): called as the steps begin; done is the share of the whole, 0 where it is not known.
Ctrl-C ends a command at its next step.
"""
import json
import numbers
import os

from . import _wems
from .errors import InputError
from .model import Model
from .recording import Recording
from .results import Result


def _path(file):
    return os.fspath(file) if file is not None else ""


def _recording(source):
    return (source.file, source._core) if isinstance(source, Recording) else (_path(source), None)


def _recordings(sources):
    if isinstance(sources, (str, os.PathLike, Recording)):
        sources = [sources]
    return [_recording(source) for source in sources]


def _model(source):
    return (source.file, source._core) if isinstance(source, Model) else (_path(source), None)


def _runs(recordings, model, validate, test, columns, geometry):
    return _wems.Runs(_recordings(recordings), _recordings(validate), _model(model), _path(test), _path(columns),
                      _path(geometry))


def _result(answer, kind):
    return Result(answer, kind, Model._wrap(answer.model) if answer.model is not None else None)


def inspect(recordings, *, model=None, columns=None, geometry=None, memory=2000, progress=None):
    """What is in recordings, what is suspicious, what can be identified from them."""
    answer = _wems.inspect(_recordings(recordings), _model(model), _path(columns), _path(geometry), memory, progress)
    return _result(answer, "inspect")


def rigidity(recording, model, *, columns=None, geometry=None, progress=None):
    """Does each part of a recording move as a rigid body?"""
    answer = _wems.rigidity(_recording(recording), _model(model), _path(columns), _path(geometry), progress)
    return _result(answer, "rigidity")


def spectra(recordings, *, model=None, columns=None, geometry=None, resolution=None, reference="", band=None, q=10,
            progress=None):
    """Frequency responses, transmissibility, densities, orders, shock response, margins. resolution, band: Hz."""
    answer = _wems.spectra(_recordings(recordings), _model(model), _path(columns), _path(geometry), resolution,
                           reference, band, q, progress)
    return _result(answer, "spectra")


def fit(recordings=(), model=None, *, validate=(), test=None, columns=None, geometry=None, free=(), method="auto",
        use="all", memory=2000, connection="", axis="", mass=None, start=None, end=None, law="model", timing=False,
        progress=None):
    """Stiffness, clearance, stops and damping with 95 % intervals; result.model is the fitted model.

    free: body parameters to identify too, by simulation any number of the model. method: auto, motion (the equations of
    motion), or simulation (free simulations, which need no derivatives). use: all, displacements or accelerations. validate: runs that judge. Of a
    single element on a test machine: connection, axis, mass (kg), start and end of the window (s), law: the model's
    shape, or the one that its tests show (found).
    """
    if use not in ("all", "displacements", "accelerations"):
        raise InputError(f"use is {use!r} (accepted: all, displacements, accelerations)", key="use")
    if method not in ("auto", "motion", "simulation"):
        raise InputError(f"method is {method!r} (accepted: auto, motion, simulation)", key="method")
    if axis not in ("", "x", "y", "z"):
        raise InputError(f"axis is {axis!r} (accepted: x, y, z)", key="axis")
    if law not in ("model", "found"):
        raise InputError(f"law is {law!r} (accepted: model, found)", key="law")
    answer = _wems.fit(_runs(recordings, model, validate, test, columns, geometry), list(free), method, use, memory,
                       connection, axis, mass, start, end, law, timing, progress)
    return _result(answer, "fit")


def diagnose(recordings=(), model=None, *, validate=(), test=None, columns=None, geometry=None, progress=None):
    """What the simulation gets wrong, and why; result.model is the extended model."""
    return _result(_wems.diagnose(_runs(recordings, model, validate, test, columns, geometry), progress), "diagnose")


def plan(recordings=(), model=None, *, test=None, columns=None, geometry=None, max_force=None, max_acceleration=None,
         max_displacement=None, max_stroke=None, sweep=None, rate=None, proposals=5, free=(), use="all", memory=2000,
         progress=None):
    """The next test, what it would tell, by how much. Limits in SI; sweep: Hz; rate: octaves per minute."""
    answer = _wems.plan(_runs(recordings, model, (), test, columns, geometry), max_force, max_acceleration,
                        max_displacement, max_stroke, sweep, rate, proposals, list(free), use, memory, progress)
    return _result(answer, "plan")


def compare(measured, simulated, *, model=None, columns=None, geometry=None, progress=None):
    """Errors of a simulated recording, channel by channel, by frequency band and by regime."""
    answer = _wems.compare(_recording(measured), _recording(simulated), _model(model), _path(columns),
                           _path(geometry), progress)
    return _result(answer, "compare")


def schema(command):
    """JSON Schema of a result's dictionary."""
    return json.loads(_wems.schema(command))


def _word(value):
    if isinstance(value, numbers.Integral):
        return str(int(value))
    return repr(float(value)) if isinstance(value, numbers.Real) else str(value)


# Options whose values stand with a colon between on the command line.
_RANGES = ("sweep", "dwell", "half_sine", "sawtooth", "trapezoid", "random", "frf", "response")


def _options(keywords):
    """The words of the command line: sweep=(5, 50) becomes --sweep 5:50, force={"z": 200} --force z=200."""
    words = []
    for name, value in keywords.items():
        if value is None or value is False:
            continue
        words.append("--" + name.replace("_", "-"))
        if isinstance(value, dict):
            words.append(",".join(f"{axis}={_word(size)}" for axis, size in value.items()))
        elif isinstance(value, (list, tuple)):
            words.append((":" if name in _RANGES else ",").join(map(_word, value)))
        elif value is not True:
            words.append(_path(value) if isinstance(value, os.PathLike) else _word(value))
    return words


def _simbody():
    try:
        from . import _simbody as module
    except ImportError as error:
        raise InputError("this installation has no Simbody (built with WEMS_BUILD_PLUGIN=OFF)") from error
    return module


def simulate(model, *, drive=None, motion=None, method="simbody", columns=None, progress=None,
             sweep=None, profile=None, dwell=None, half_sine=None, sawtooth=None, trapezoid=None, srs=None,
             random=None, psd=None, force=None, base_acceleration=None, base_displacement=None, rate=None,
             linear_rate=None, downwards=False, q=None, fade=None, duration=None, sample_rate=None, channels=None,
             noise=None, seed=None, accuracy=None):
    """A Recording of the model under a load or a base motion.

    drive: a recording whose load, base acceleration or (fast method) motion of the fixed part acts again; without it,
    an excitation with the options of the program: sweep=(5, 50), rate=4, force={"z": 200},
    base_acceleration={"z": "1.5g"}, dwell=(8, 10), psd="test.csv", noise={"displacement": 1e-6}.
    motion: a recording of relative displacements, along which the model's laws are followed instead: their forces.
    method: "simbody", or "fast" for the fixed-step forward model that identify uses.
    """
    options = {"sweep": sweep, "profile": profile, "dwell": dwell, "half_sine": half_sine, "sawtooth": sawtooth,
               "trapezoid": trapezoid, "srs": srs, "random": random, "psd": psd, "force": force,
               "base_acceleration": base_acceleration, "base_displacement": base_displacement, "rate": rate,
               "linear_rate": linear_rate, "downwards": downwards, "q": q, "fade": fade, "duration": duration,
               "sample_rate": sample_rate, "channels": channels, "noise": noise, "seed": seed, "accuracy": accuracy}
    if method not in ("simbody", "fast"):
        raise InputError(f"method is {method!r} (accepted: simbody, fast)", key="method")
    model = model if isinstance(model, Model) else Model(model)
    if motion is not None:
        motion = motion if isinstance(motion, Recording) else Recording(motion, columns)
        return Recording._wrap(_simbody().move_along(model._core, motion._core))
    if method == "simbody":
        if drive is not None:
            drive = drive if isinstance(drive, Recording) else Recording(drive, columns)
        core = _simbody().simulate(model._core, None if drive is None else drive._core, _options(options), progress)
        return Recording._wrap(core)
    given = [name for name, value in options.items() if value is not None and value is not False]
    if drive is None:
        drive = Recording._wrap(_simbody().excite(_options(options)))
    elif given:
        raise InputError(f"{', '.join(given)}: a drive is given already", key=given[0])
    return Recording._wrap(_wems.simulate_fast(_recording(drive), _model(model), _path(columns), progress))


def response(model, band, *, force=None, base_acceleration=None, harmonics=None, progress=None):
    """Periodic responses over a band (Hz) by continuation, every branch: force={"z": 200}, or force="z=100,200"."""
    model = model if isinstance(model, Model) else Model(model)
    words = _options({"response": band, "force": force, "base_acceleration": base_acceleration,
                      "harmonics": harmonics})
    return Result(_simbody().response(model._core, words, progress), "response")


def modes(model, *, frf=None, psd=None, force=None, base_acceleration=None, progress=None):
    """Natural frequencies, damping, effective masses, rest position.

    frf=(5, 50) adds transfer functions, psd="test.csv" the response to a random test, both along the axis of force
    or base_acceleration: base_acceleration="z".
    """
    model = model if isinstance(model, Model) else Model(model)
    words = _options({"modes": True, "frf": frf, "psd": psd, "force": force, "base_acceleration": base_acceleration})
    return Result(_simbody().modes(model._core, words, progress), "modes")
