"""The reports of all commands on short runs of the shipped device, as a reader gets them."""
import re
import subprocess
from pathlib import Path


def call(*command, folder):
    subprocess.run([str(part) for part in command], cwd=folder, check=True, stdout=subprocess.DEVNULL)


def make_reports(simulate, identify, device, folder):
    """Writes NAME.html into `folder` for each command with --report, `fit` twice; returns their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    text = Path(device).read_text().replace('modes = "', f'modes = "{Path(device).parent}/')
    (folder / "device.toml").write_text(text)
    # Axial stiffnesses 30 % low, three tolerances: a diagnosis has something to say.
    (folder / "believed.toml").write_text(re.sub(r"stiffness = 1\.0e5", "stiffness = 0.7e5", text))
    sweep = ["--sweep", "5:50", "--rate", 60, "--noise", "displacement=1e-6,acceleration=0.01", "--quiet"]
    call(simulate, "device.toml", *sweep, "--force", "z=600", "-o", "axial.csv", "--report", "simulate.html", folder=folder)
    (folder / "psd.csv").write_text("5,0.001\n100,0.001\n")
    call(simulate, "device.toml", "--modes", "--frf", "5:100", "--psd", "psd.csv", "--base-acceleration", "z", "--quiet",
         "--report", "modes.html", folder=folder)
    call(simulate, "device.toml", "--response", "25:45", "--force", "z=150,300", "--harmonics", 7, "--quiet",
         "--report", "response.html", folder=folder)
    call(simulate, "device.toml", *sweep, "--force", "x=120,y=150", "-o", "lateral.csv", folder=folder)
    call(simulate, "believed.toml", "--from-csv", "axial.csv", "-o", "believed.csv", "--quiet", folder=folder)
    # A second system that recorded the load alone, half a second behind.
    with open(folder / "axial.csv") as run, open(folder / "load.csv", "w") as load:
        rows = [line.split(",") for line in run if not line.startswith("#")]
        column = rows[0].index(next(name for name in rows[0] if name.startswith("load.fz")))
        load.write("time [s],load.fz [N]\n")
        load.writelines(f"{float(row[0]) + 0.5:.4f},{row[column].strip()}\n" for row in rows[1:])
    runs = ["axial.csv", "lateral.csv"]
    commands = {
        "convert": ["convert", "axial.csv", "axial.sto"],
        "merge": ["merge", "axial.csv", "load.csv", "-o", "merged.csv", "--common", "load.fz"],
        "set": ["set", "device.toml", "1.z.stiffness*=1.1", "-o", "set.toml"],
        "rigidity": ["rigidity", "axial.csv", "--model", "device.toml"],
        "fit": ["fit", *runs, "--model", "believed.toml"],
        "element": ["fit", "axial.csv", "--model", "device.toml", "--connection", 4, "--axis", "z"],
        "diagnose": ["diagnose", "axial.csv", "--validate", "lateral.csv", "--model", "believed.toml"],
        "plan": ["plan", "axial.csv", "--model", "believed.toml", "--max-force", 600],
        "spectra": ["spectra", *runs, "--model", "device.toml"],
        "inspect": ["inspect", "axial.csv"],
        "compare": ["compare", "axial.csv", "believed.csv", "--model", "device.toml"],
        "surface": ["surface", "axial.csv", "--connection", 4, "--axis", "z"],
    }
    for name, arguments in commands.items():
        call(identify, *arguments, "--report", f"{name}.html", folder=folder)
    return [folder / f"{name}.html" for name in ["simulate", "modes", "response", *commands]]
