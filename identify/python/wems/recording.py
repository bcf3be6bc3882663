"""Recordings as NumPy arrays."""
import os

import numpy

from . import _wems


class Recording:
    """Channels sampled at common times, in SI units: recording["mobile.1.az"], recording.time."""

    def __init__(self, file, columns=None):
        """Reads a file of any format that the programs read; `columns` is a column map (TOML)."""
        self._core = _wems.read_recording(os.fspath(file), os.fspath(columns or ""))

    @classmethod
    def _wrap(cls, core):
        recording = cls.__new__(cls)
        recording._core = core
        return recording

    @classmethod
    def from_arrays(cls, time, channels, units=None, name="recording"):
        """From arrays, which are copied once, checked and repaired as a file's columns are.

        time: s. channels: array of each channel's name. units: unit of each channel that is not in SI, such as "g".
        """
        units = units or {}
        columns = [("time", "s", numpy.asarray(time, dtype=float))]
        columns += [(key, units.get(key, ""), numpy.asarray(values, dtype=float)) for key, values in channels.items()]
        return cls._wrap(_wems.make_recording(name, columns))

    @property
    def file(self):
        return self._core.file

    @property
    def metadata(self):
        return self._core.metadata

    @property
    def warnings(self):
        return self._core.warnings

    @property
    def names(self):
        return self._core.names

    @property
    def time(self):
        """s; a view of the recording's own memory, which cannot be written to."""
        return self._core.time

    def __getitem__(self, name):
        """A channel in SI; a view of the recording's own memory, which cannot be written to."""
        return self._core.values(name)

    def __contains__(self, name):
        return name in self._core.names

    def __len__(self):
        return len(self._core.time)

    def unit(self, name):
        return self._core.unit(name)

    def write(self, file, digits=9):
        """Writes .csv, .trc, .sto or .mot; returns a sentence for each thing that the format cannot hold."""
        return self._core.write(os.fspath(file), digits)

    def to_pandas(self):
        """A pandas DataFrame over time."""
        import pandas

        frame = pandas.DataFrame({name: self[name] for name in self.names},
                                 index=pandas.Index(self.time, name="time"))
        frame.attrs["units"] = {name: self.unit(name) for name in self.names}
        return frame

    def to_xarray(self):
        """An xarray Dataset over time, each channel with its unit."""
        import xarray

        variables = {name: ("time", self[name], {"units": self.unit(name)}) for name in self.names}
        return xarray.Dataset(variables, coords={"time": ("time", self.time, {"units": "s"})},
                              attrs=dict(self.metadata))

    def plot(self, *names, ax=None):
        """Draws channels over time; without names those of the relative motion's ends along z, or all."""
        from . import plots

        return plots.plot_recording(self, names, ax)

    def __repr__(self):
        return f"<wems.Recording {self.file!r}, {len(self)} samples, {len(self.names)} channels>"
