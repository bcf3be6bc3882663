"""The Python module: the same answers as the programs, errors with their place, arrays without copies, Ctrl-C."""
import html
import json
import os
import pathlib
import re
import signal
import subprocess
import threading
import time

import numpy
import pytest

import wems

MODELS = pathlib.Path(os.environ["WEMS_MODELS"])
IDENTIFY = os.environ["WEMS_IDENTIFY"]
SIMULATE = os.environ["WEMS_SIMULATE"]


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """Two short runs of the shipped device, and a model whose axial elastomers are 20 % too stiff."""
    where = tmp_path_factory.mktemp("runs")
    (where / "smallsat_bracket.csv").write_bytes((MODELS / "smallsat_bracket.csv").read_bytes())
    for name, force in (("run.csv", "z=40"), ("other.csv", "x=30,z=30")):
        subprocess.run([SIMULATE, MODELS / "smallsat_wems.toml", "--sweep", "8:40", "--rate", "60", "--force", force,
                        "--noise", "displacement=1e-6,acceleration=0.01", "-q", "-o", where / name], check=True)
    text = (MODELS / "smallsat_wems.toml").read_text(encoding="utf-8")
    (where / "believed.toml").write_text(text.replace("stiffness = 1.0e5", "stiffness = 1.2e5"), encoding="utf-8")
    old = os.getcwd()
    os.chdir(where)
    yield where
    os.chdir(old)


def read_lead(result, file):
    """The first sentence of a report."""
    result.report(file)
    return html.unescape(re.search(r'<p class="lead">(.*?)</p>', pathlib.Path(file).read_text(encoding="utf-8")).group(1))


def call(*arguments):
    output = subprocess.run([IDENTIFY, *arguments, "--json", "-"], capture_output=True, text=True, check=True).stdout
    text = subprocess.run([IDENTIFY, *arguments], capture_output=True, text=True, check=True).stdout
    return json.loads(output), text


@pytest.mark.parametrize("command, arguments, answer", [
    ("inspect", ["run.csv"], lambda: wems.inspect("run.csv")),
    ("rigidity", ["run.csv", "--model", "believed.toml"], lambda: wems.rigidity("run.csv", "believed.toml")),
    ("spectra", ["run.csv", "--band", "9:30"], lambda: wems.spectra("run.csv", band=(9, 30))),
    ("fit", ["run.csv", "--model", "believed.toml"], lambda: wems.fit("run.csv", "believed.toml")),
    ("compare", ["run.csv", "other.csv"], lambda: wems.compare("run.csv", "other.csv")),
])
def test_same_as_the_program(folder, command, arguments, answer):
    data, text = call(command, *arguments)
    result = answer()
    assert result.to_dict() == data
    assert str(result) == text
    assert result.plot() is not None


def test_diagnosis_names_the_cause(folder):
    steps = []
    result = wems.diagnose("run.csv", "believed.toml", validate="other.csv", progress=lambda what, _: steps.append(what))
    # The truth is known: the axial stiffnesses were made 20 % too large, beyond their tolerance of 10 %.
    assert "elastomer_stiffness" in [cause["cause"] for cause in result["causes"]]
    assert result["error_after"]["validation"] < result["error_before"]["validation"]
    assert abs(result.model["1.z.stiffness"] - 1e5) < abs(1.2e5 - 1e5) / 4
    assert "reading" in steps and len(steps) > 2
    assert result["inputs"][0]["sha256"] and result["tolerances"]
    assert result.plot() is not None
    # The report begins with the cause that explains most, beside what the model has.
    lead = read_lead(result, "diagnosis.html")
    first = max(result["causes"], key=lambda cause: cause["gain_db"])
    name = re.search(r"\d\.z\.stiffness", lead).group()
    value = float(re.search(r" is ([\d.]+) ± ", lead).group(1))
    assert first["cause"] == "elastomer_stiffness" and "where the model has 120 N/mm" in lead
    assert abs(1e3 * value / result.model[name] - 1) < 0.01
    assert f"{round(100 * first['share'])} % of the error" in lead


TELESCOPE = """
name = "telescope on three isolators"
[body]
mass = 40.0
center_of_gravity = [0.0, 0.0, 0.2]
inertia = [1.2, 1.2, 0.6]
""" + "".join(f"""
[[connection]]
name = "{name}"
position = {position}
x = {{ stiffness = 5e4, damping = 80.0 }}
y = {{ stiffness = 5e4, damping = 80.0 }}
z = {{ stiffness = 1e5, damping = 150.0 }}
""" for name, position in (("front", [0.2, 0.0, 0.0]), ("left", [-0.1, 0.17, 0.0]), ("right", [-0.1, -0.17, 0.0])))


def record_telescope(model, seed, level):
    """What one accelerometer at each isolator and one on the table record."""
    run = wems.simulate(model, sweep=(5, 30), rate=60, base_acceleration=level, seed=seed,
                        noise={"acceleration": 0.02, "base": 0.02})
    kept = [name for name in run.names if name.startswith("base.") or ".a" in name and name.startswith("mobile.")]
    return wems.Recording.from_arrays(run.time, {name: run[name] for name in kept}, name=f"run {seed}")


def test_three_accelerometers_are_enough(folder):
    # Three of one axis determine three motions with none to spare, so that no fault of theirs can show.
    believed = wems.Model.from_toml(TELESCOPE)
    aged = believed.copy()
    aged["front.z.stiffness"] = 7e4
    runs = [record_telescope(aged, seed, level) for seed, level in ((1, {"x": 1, "z": 1}), (2, {"y": 1, "z": 1}))]
    found = wems.diagnose(runs[0], believed, validate=runs[1])
    stiffness = {p["name"]: p["value"] for cause in found["causes"] for p in cause["parameters"]}
    assert abs(stiffness["front.z.stiffness"] / 7e4 - 1) < 0.02
    # All channels of the telescope in g, labelled m/s^2: one line, and no values.
    wrong = wems.Recording.from_arrays(runs[0].time, {name: runs[0][name] * (1 if name.startswith("base") else 1 / 9.80665)
                                                      for name in runs[0].names})
    with pytest.raises(wems.InputError) as error:
        wems.fit(wrong, believed)
    assert "slow motion" in str(error.value)


def test_rigidity_knows_the_sensors_of_the_model(folder):
    text = (folder / "believed.toml").read_text(encoding="utf-8")
    (folder / "sensors.toml").write_text(text + '\n[[sensor]]\nchannel = "mobile.3.z"\ngain = 1.05\n', encoding="utf-8")
    subprocess.run([SIMULATE, "sensors.toml", "--sweep", "8:40", "--rate", "120", "--force", "z=40",
                    "--noise", "displacement=1e-6", "-q", "-o", "scaled.csv"], check=True)
    suspects = wems.rigidity("scaled.csv", "believed.toml")["suspects"]
    assert [suspect["channel"] for suspect in suspects] == ["mobile.3.z"]
    assert wems.rigidity("scaled.csv", "sensors.toml")["suspects"] == []


def test_levels_overlaid(folder):
    model = wems.Model(MODELS / "smallsat_wems.toml")
    options = {"sweep": (8, 25), "rate": 60}
    levels = [wems.simulate(model, force={"z": level}, **options) for level in (40, 20)]
    text = str(wems.spectra(levels, model=model)).split("\n", maxsplit=1)[0]
    drive = re.match(r"From ([\d.]+) N RMS to ([\d.]+) N RMS", text)
    assert abs(float(drive.group(2)) / float(drive.group(1)) - 2) < 0.02
    peaks = re.search(r"goes from (\S+) at (\S+) Hz to (\S+) at (\S+) Hz", text)
    low, high = (float(peaks.group(k)) for k in (1, 3))  # no stop is reached: linear, the response over the load is the same
    assert abs(high / low - 1) < 0.01 and peaks.group(2) == peaks.group(4)


def test_comparison_is_drawn(folder):
    result = wems.compare("run.csv", "run.csv", model="believed.toml")
    assert "off by 0 mm RMS, 0 % of the measured" in read_lead(result, "same.html")
    page = pathlib.Path("same.html").read_text(encoding="utf-8")
    for title in ("Envelope of the relative", "Around the largest motion", "Order 1 at", "Spectrum of the relative"):
        assert title in page


def test_models_by_name(folder):
    model = wems.Model("believed.toml")
    assert model["1.z.stiffness"] == 1.2e5 and model.unit("1.z.stiffness") == "N/m"
    copy = model.copy()
    copy["1.z.stiffness"] = 9e4
    assert model["1.z.stiffness"] == 1.2e5
    assert wems.Model.from_toml(copy.to_toml(), "believed.toml").parameters() == copy.parameters()
    with pytest.raises(wems.InputError):
        model["1.z.stiffness"] = -1
    assert model["1.z.stiffness"] == 1.2e5
    with pytest.raises(wems.InputError) as error:
        model["nothing"]  # pylint: disable=pointless-statement
    assert "nothing" in str(error.value)


def test_errors_have_their_place(folder):
    pathlib.Path("bad.toml").write_text("[body]\nmass = -1.0\n", encoding="utf-8")
    with pytest.raises(wems.InputError) as error:
        wems.Model("bad.toml")
    assert error.value.file == "bad.toml" and error.value.problem
    pathlib.Path("bad.csv").write_text("time [s],mobile.1.z [m]\n0,0\n1,x\n", encoding="utf-8")
    with pytest.raises(wems.InputError) as error:
        wems.Recording("bad.csv")
    assert error.value.line == 3 and "mobile.1.z" in error.value.key + error.value.problem
    with pytest.raises(wems.InputError):
        wems.fit("run.csv", "believed.toml", use="nothing")


def test_arrays_without_copies(folder):
    recording = wems.Recording("run.csv")
    z = recording["mobile.1.z"]
    assert z.base is not None and not z.flags.writeable
    assert z.__array_interface__["data"] == recording["mobile.1.z"].__array_interface__["data"]
    del recording
    assert numpy.isfinite(z).all()  # the values live as long as their view
    again = wems.Recording("run.csv")
    made = wems.Recording.from_arrays(again.time, {name: again[name] for name in again.names}, name="run.csv")
    assert made.names == again.names
    assert all((made[name] == again[name]).all() for name in made.names)
    # A recording in memory is fitted as its file is.
    file, memory = wems.fit("run.csv", "believed.toml"), wems.fit(made, wems.Model("believed.toml"))
    assert memory["parameters"] == file["parameters"]
    assert memory["inputs"][-1]["sha256"] is None
    g = wems.Recording.from_arrays(again.time, {"mobile.1.az": again["mobile.1.az"] / 9.80665}, {"mobile.1.az": "g"})
    assert numpy.allclose(g["mobile.1.az"], again["mobile.1.az"], rtol=1e-12)


def test_pandas_and_xarray(folder):
    pandas, xarray = pytest.importorskip("pandas"), pytest.importorskip("xarray")
    recording = wems.Recording("run.csv")
    frame = recording.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and frame["load.fz"].iloc[100] == recording["load.fz"][100]
    data = recording.to_xarray()
    assert isinstance(data, xarray.Dataset) and data["load.fz"].attrs["units"] == "N"


def test_fast_model_is_the_program(folder):
    # The recording comes from Simbody, the other integrator of the same equations; what differs is noise of 1e-6 m.
    driven = wems.simulate(MODELS / "smallsat_wems.toml", drive="run.csv", method="fast")
    assert wems.compare("run.csv", driven, model=MODELS / "smallsat_wems.toml")["error"] < 0.02


def test_fast_model_is_simbody(folder):
    model = wems.Model(MODELS / "smallsat_wems.toml")
    options = {"sweep": (8, 20), "rate": 120, "force": {"z": 40}}
    exact = wems.simulate(model, **options)
    fast = wems.simulate(model, method="fast", **options)
    for name in ("mobile.1.z", "fixed.4.z"):
        assert numpy.abs(fast[name] - exact[name]).max() < 0.01 * numpy.abs(exact[name]).max()
    replayed = wems.simulate(model, drive=exact)
    assert numpy.abs(replayed["mobile.1.z"] - exact["mobile.1.z"]).max() < 0.01 * numpy.abs(exact["mobile.1.z"]).max()
    driven = wems.simulate(model, drive="run.csv", method="fast")
    assert wems.compare("run.csv", driven, model=model)["error"] < 0.02


def test_response_and_modes(folder):
    model = wems.Model(MODELS / "smallsat_wems.toml")
    found = wems.modes(model)
    lowest = found["modes"][0]["frequency"]
    curve = wems.response(model, (0.8 * lowest, 1.2 * lowest), force={"x": 1})
    points = curve["levels"][0]["points"]
    peak = max(points, key=lambda point: max(point["amplitude"]))
    assert abs(peak["frequency"] - lowest) < 0.03 * lowest  # a small force: the response is linear
    assert curve.plot() is not None and found.plot() is not None


def test_an_exception_of_progress_ends_the_command(folder):
    def stop(what, done):
        raise RuntimeError(what)

    with pytest.raises(RuntimeError):
        wems.fit("run.csv", "believed.toml", progress=stop)


def test_interrupt_ends_the_command(folder):
    begun = threading.Event()
    threading.Thread(target=lambda: (begun.wait(), os.kill(os.getpid(), signal.SIGINT))).start()
    with pytest.raises(KeyboardInterrupt):
        wems.diagnose("run.csv", "believed.toml", validate="other.csv", progress=lambda what, _: begun.set())


def test_the_lock_is_released(folder):
    counted, over = [0], threading.Event()

    def count():
        while not over.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before = counted[0]
    wems.fit("run.csv", "believed.toml")
    during = counted[0] - before
    over.set()
    thread.join()
    assert during > 5  # a fit takes some 0.2 s; held, the lock would leave none but those of the polls


def test_a_prescribed_motion_gives_the_force_of_the_law(folder):
    (folder / "element.toml").write_text(
        'name = "spring"\n[body]\nmass = 1.0\ninertia = [1.0, 1.0, 1.0]\n[[connection]]\nname = "1"\n'
        "position = [0.0, 0.0, 0.0]\n[connection.z]\nstiffness = 2000.0\n", encoding="utf-8")
    t = numpy.arange(200) / 100
    q = 1e-3 * numpy.sin(7 * t)
    (folder / "motion.csv").write_text(
        "time [s],relative.1.z [m]\n" + "\n".join(f"{a},{b}" for a, b in zip(t, q)) + "\n", encoding="utf-8")
    forces = wems.simulate("element.toml", motion="motion.csv")
    assert numpy.allclose(numpy.asarray(forces["force.1.z"]), 2000 * q, rtol=1e-9, atol=1e-12)
