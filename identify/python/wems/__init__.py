"""Equipment on elastomer mounts with stops: simulate it, identify it, explain where the simulation and the test part.

The functions are the commands of the programs; results are tables when printed, pictures by .plot(), and
dictionaries, equal to what --json writes, by .to_dict().
"""
from ._wems import version as __version__
from .commands import compare, diagnose, fit, inspect, modes, plan, response, rigidity, schema, simulate, spectra
from .errors import InputError
from .model import Model
from .recording import Recording
from .results import Result

__all__ = ["InputError", "Model", "Recording", "Result", "compare", "diagnose", "fit", "inspect", "modes", "plan",
           "response", "rigidity", "schema", "simulate", "spectra", "__version__"]
