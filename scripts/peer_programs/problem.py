"""The problem that all programs solve: the rigid mobile part of a mount on its connections, its base shaken by a sweep.

Seen from the base, which moves without turning:

    m p'' = F - m a(t),      I w' = R^T T - w x I w,      e' = e (0, w) / 2

p the centre of gravity from its place at rest, e the unit quaternion of the orientation R, w the angular velocity in the
body's axes; F and T (about the centre of gravity) the sum over connections and axes of -f(q, q'), with
f = k q + c q' + stops, at the mobile ends. Written for NumPy with whole arrays for all connections at once.
"""
import math
import tomllib

import numpy as np


class Sweep:
    """sin(2 pi f0 (2^(r t) - 1) / (r ln 2)) times a constant acceleration, r in octaves per second."""

    def __init__(self, first, octaves_per_minute, acceleration):
        self.growth = octaves_per_minute / 60 * math.log(2)
        self.scale = 2 * math.pi * first / self.growth
        self.amplitude = np.array(acceleration, float)

    def value(self, t):
        return math.sin(self.scale * math.expm1(self.growth * t))

    def acceleration(self, t):
        return self.amplitude * self.value(t)


class Mount:
    """Mass, connections and laws of a model file that uses nothing beyond mass, stiffness, damping and stops."""

    def __init__(self, model_file):
        with open(model_file, "rb") as file:
            model = tomllib.load(file)
        body = model["body"]
        self.mass = body["mass"]
        self.inertia = np.array(body["inertia"], float)
        self.center = np.array(body["center_of_gravity"], float)
        self.names = [connection["name"] for connection in model["connection"]]
        self.position = np.array([connection["position"] for connection in model["connection"]]).T  # 3 x n
        shape = self.position.shape
        self.stiffness, self.damping = np.zeros(shape), np.zeros(shape)
        self.clearance = {side: np.full(shape, np.inf) for side in "+-"}
        self.stop = {side: np.zeros(shape) for side in "+-"}
        for i, connection in enumerate(model["connection"]):
            for axis, name in enumerate("xyz"):
                law = connection[name]
                self.stiffness[axis, i] = law["stiffness"]
                self.damping[axis, i] = law.get("damping", 0)
                for stop in law.get("stops", []):
                    self.clearance[stop["side"]][axis, i] = stop["clearance"]
                    self.stop[stop["side"]][axis, i] = stop["stiffness"]
        self.arm = self.position - self.center[:, None]  # of the ends from the centre of gravity, body axes
        # Both sides in one expression: q - clip(q, -c, c) is the penetration, signed; a side without stop never clips.
        self.lower, self.upper = -self.clearance["-"], self.clearance["+"]
        self.both = np.where(np.isfinite(self.upper), self.stop["+"], self.stop["-"])
        one_stiffness = (self.stop["+"] == self.stop["-"]) | ~np.isfinite(self.upper) | ~np.isfinite(self.lower)
        assert one_stiffness.all(), "both stops of an axis must have one stiffness"

    def rotation(self, e):
        """R of a quaternion of any length."""
        w, x, y, z = e
        s = 2 / (w * w + x * x + y * y + z * z)
        return np.array([[1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
                         [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
                         [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)]])

    def displacement(self, p, e):
        """Relative displacements, 3 x n."""
        return p[:, None] + self.rotation(e) @ self.arm - self.arm

    def wrench(self, p, R, v, w, closed=None):
        """Force, and moment about the centre of gravity, on the body in the base's axes; w in body axes.

        `closed` (3 x n, -1 0 +1) says which stops act and on which side, in place of the displacements: the smooth
        equations between two contacts.
        """
        arm = R @ self.arm
        wx, wy, wz = (R @ w).tolist()
        q = p[:, None] + arm - self.arm
        rate = v[:, None] + np.array([[0, -wz, wy], [wz, 0, -wx], [-wy, wx, 0]]) @ arm
        if closed is None:
            depth = q - np.minimum(np.maximum(q, self.lower), self.upper)
        else:
            depth = np.where(closed > 0, q - self.upper, np.where(closed < 0, q - self.lower, 0.0))
        f = self.stiffness * q + self.damping * rate + self.both * depth
        moment = arm @ f.T
        return -f.sum(axis=1), np.array([moment[2, 1] - moment[1, 2], moment[0, 2] - moment[2, 0], moment[1, 0] - moment[0, 1]])


class Problem:
    """A mount, its sweep and its samples: right-hand side and initial state for y = (p, e, p', w)."""

    # Sizes of the states' entries, which absolute tolerances are multiples of.
    TYPICAL = np.repeat([1e-3, 1e-2, 0.2, 2.0], [3, 4, 3, 3])

    def __init__(self, mount, sweep, duration, sample_rate):
        self.mount, self.sweep = mount, sweep
        self.times = np.arange(round(duration * sample_rate) + 1) / sample_rate
        self.evaluations = 0

    def initial(self):
        y = np.zeros(13)
        y[3] = 1
        return y

    def rates(self, t, y, closed=None):
        self.evaluations += 1
        mount = self.mount
        R = mount.rotation(y[3:7].tolist())
        spin = y[10:]
        force, moment = mount.wrench(y[:3], R, y[7:10], spin, closed)
        e0, e1, e2, e3, _, _, _, wx, wy, wz = y[3:].tolist()
        tx, ty, tz = (moment @ R).tolist()
        ix, iy, iz = mount.inertia.tolist()
        out = np.empty(13)
        out[:3] = y[7:10]
        out[3:7] = (-0.5 * (e1 * wx + e2 * wy + e3 * wz), 0.5 * (e0 * wx + e2 * wz - e3 * wy),
                    0.5 * (e0 * wy + e3 * wx - e1 * wz), 0.5 * (e0 * wz + e1 * wy - e2 * wx))
        out[7:10] = force / mount.mass - self.sweep.acceleration(t)
        out[10:] = ((tx - wy * wz * (iz - iy)) / ix, (ty - wz * wx * (ix - iz)) / iy, (tz - wx * wy * (iy - ix)) / iz)
        return out

    def displacements(self, states):
        """Relative displacements of states (13 x samples): samples x 3 n, connection by connection."""
        mount = self.mount
        R = np.moveaxis(mount.rotation(states[3:7]), 2, 0)
        q = states[:3].T[:, :, None] + R @ mount.arm - mount.arm
        return q.transpose(0, 2, 1).reshape(len(q), -1)
