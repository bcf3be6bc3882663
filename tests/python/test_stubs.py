"""The type stubs name what the module has, and the functions have the options of the programs."""
import inspect
import os
import pathlib
import re
import subprocess
import sys

import pytest

import wems

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Of the command line alone: where results go, and its exit status.
OUTPUT = {"help", "help-all", "version", "output", "json", "report", "quiet", "fail-on", "limit", "strict"}
# Options that a keyword cannot have as its name, and what takes their place.
RENAMED = {"from": "start", "to": "end", "from-csv": "drive", "response": "band"}
# Of a run without an end in sight: in Python Ctrl-C and an exception of progress end it.
RUN_ALONE = {"time-limit"}


def list_options(*words):
    text = subprocess.run([*words, "--help"], capture_output=True, text=True, check=True).stdout
    return set(re.findall(r"^\s+(?:-\w,\s*)?--([a-z-]+)", text, re.MULTILINE)) - OUTPUT


def list_keywords(function):
    return set(inspect.signature(function).parameters)


def test_stubs_are_the_module(tmp_path):
    (tmp_path / "private").write_text(
        r"wems\.(commands|errors|model|plots|recording|results|_wems|_simbody)(\..*)?" + "\n", encoding="utf-8")
    done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "wems", "--concise", "--mypy-config-file",
                           ROOT / "pyproject.toml", "--allowlist", "private", "--ignore-unused-allowlist"],
                          capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("command", ["inspect", "rigidity", "spectra", "fit", "diagnose", "plan", "compare"])
def test_options_of_identify(command):
    missing = {RENAMED.get(name, name.replace("-", "_")) for name in list_options(os.environ["WEMS_IDENTIFY"], command)}
    assert missing - list_keywords(getattr(wems, command)) == set()


def test_options_of_simulate():
    asked = {RENAMED.get(name, name.replace("-", "_"))
             for name in list_options(os.environ["WEMS_SIMULATE"]) - RUN_ALONE}
    elsewhere = {"modes"}  # a function of its own
    known = list_keywords(wems.simulate) | list_keywords(wems.response) | list_keywords(wems.modes)
    assert asked - elsewhere - known == set()
