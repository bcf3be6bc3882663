"""Mount models with their parameters by name."""
import os

from . import _wems


class Model:
    """A mount model. Parameters have the names that results use: model["1.z.stiffness"] = 1e5 (SI units)."""

    def __init__(self, file, geometry=None):
        self._core = _wems.read_model(os.fspath(file), os.fspath(geometry or ""))
        self.file = os.fspath(file)

    @classmethod
    def _wrap(cls, core, file="model"):
        model = cls.__new__(cls)
        model._core = core
        model.file = file
        return model

    @classmethod
    def from_toml(cls, text, file="model.toml"):
        """A model from TOML text; `file` stands in messages, and the bracket's modes are looked for beside it."""
        return cls._wrap(_wems.parse_model(text, os.fspath(file)), os.fspath(file))

    def to_toml(self):
        return self._core.to_toml()

    def save(self, file):
        self._core.save(os.fspath(file))

    def copy(self):
        return Model._wrap(self._core.copy(), self.file)

    @property
    def name(self):
        return self._core.name

    @property
    def connections(self):
        """Position (m) of each connection by name."""
        return {name: position for name, position, _ in self._core.connections}

    def __getitem__(self, name):
        return self._core.get(name)

    def __setitem__(self, name, value):
        self._core.set(name, float(value))

    @staticmethod
    def unit(name):
        return _wems.parameter_unit(name)

    def parameters(self):
        """Value of each parameter of body, elastomers, stops and bracket modes, by name."""
        names = ["body.mass"] + [f"body.center_of_gravity.{axis}" for axis in "xyz"]
        names += [f"body.inertia.{key}" for key in ("Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")]
        for connection, _, stops in self._core.connections:
            for axis, sides in zip("xyz", stops):
                names += [f"{connection}.{axis}.{key}" for key in ("stiffness", "damping")]
                for side, there in zip("-+", sides):
                    if there:
                        names += [f"{connection}.{axis}.{side}.{key}" for key in ("clearance", "stiffness")]
        for mode in range(1, self._core.mode_count + 1):
            names += [f"{mode}.frequency", f"{mode}.damping_ratio"]
        return {name: self[name] for name in names}

    def __repr__(self):
        return f"<wems.Model {self.name!r}, connections {', '.join(self.connections)}>"
