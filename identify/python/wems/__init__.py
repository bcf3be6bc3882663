"""Equipment on elastomer mounts with stops: simulate it, identify it, explain where the simulation and the test part.

The functions are the commands of the programs; results are tables when printed, pictures by .plot(), and
dictionaries, equal to what --json writes, by .to_dict().
"""
import numpy

from . import _wems
from ._wems import version as __version__

# Built by pybind11 before 2.12, the module would read arrays of NumPy 2 in a wrong layout.
if int(numpy.__version__.split(".", maxsplit=1)[0]) >= 2 and not _wems.knows_numpy_2:
    raise ImportError(f"this wems was built for NumPy 1, and NumPy is {numpy.__version__}: `pip install .` builds one for it")

from .commands import compare, diagnose, fit, inspect, modes, plan, response, rigidity, schema, simulate, spectra
from .errors import InputError
from .model import Model
from .recording import Recording
from .results import Result

__all__ = ["InputError", "Model", "Recording", "Result", "compare", "diagnose", "fit", "inspect", "modes", "plan",
           "response", "rigidity", "schema", "simulate", "spectra", "__version__"]
