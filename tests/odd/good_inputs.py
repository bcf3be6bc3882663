"""Good inputs that the commands read beside the odd ones, or while they are killed."""
import shutil
import subprocess
from pathlib import Path


def write_good_inputs(folder, simulate, models):
    """model.toml with its modes, and good.csv and good2.csv: a force along z, one along x and y, half a second to one second each."""
    for name in ("smallsat_wems.toml", "smallsat_bracket.csv"):
        shutil.copy(Path(models) / name, folder)
    (folder / "smallsat_wems.toml").rename(folder / "model.toml")
    for name, level in (("good.csv", "z=200"), ("good2.csv", "x=80,y=50")):
        subprocess.run([simulate, "model.toml", "--sweep", "5:50", "--rate", "200", "--force", level, "--sample-rate", "500",
                        "--noise", "displacement=1e-6,acceleration=0.01", "--seed", "1", "-q", "-o", name], cwd=folder, check=True)
