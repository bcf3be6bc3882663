"""Periodic responses as a user of NumPy and SciPy follows them: harmonic balance, forces by alternating between frequency and
time, pseudo-arclength steps, each corrected by Newton's method; folds where the frequency turns.

M s'' + sum_i h_i f_i(h_i . s, h_i . s') = -M b a cos(2 pi f t), s the free coordinates, h_i the axis of spring i.
"""
import numpy as np
import scipy.linalg
import scipy.optimize

SAMPLES = 2048  # of a period: with a few hundred, a stop that closes between two samples makes folds that are none


class Spring:
    """Elastomer with dashpot and stops (side +1 or -1, clearance m, stiffness N/m)."""

    def __init__(self, axis, stiffness, damping, stops=(), cubic=0.0):
        self.axis, self.stiffness, self.damping, self.stops, self.cubic = np.asarray(axis, float), stiffness, damping, stops, cubic

    def bend(self, q):
        """What the force has beyond the linear spring, and its slope."""
        force, slope = self.cubic * q**3, 3 * self.cubic * q**2
        for side, clearance, stiffness in self.stops:
            depth = side * q - clearance
            force = force + side * stiffness * np.maximum(depth, 0)
            slope = slope + stiffness * (depth > 0)
        return force, slope


class HarmonicBalance:
    def __init__(self, mass, springs, base, harmonics):
        self.mass, self.springs, self.harmonics = np.asarray(mass, float), springs, harmonics
        n, self.size = len(self.mass), 2 * harmonics + 1
        phases = 2 * np.pi * np.arange(SAMPLES) / SAMPLES
        columns = [np.ones(SAMPLES)]
        for k in range(1, harmonics + 1):
            columns += [np.cos(k * phases), np.sin(k * phases)]
        self.to_time = np.array(columns).T
        self.to_harmonics = self.to_time.T * (np.append(1, np.full(2 * harmonics, 2)) / SAMPLES)[:, None]
        self.stiffness = sum(s.stiffness * np.outer(s.axis, s.axis) for s in springs)
        self.damping = sum(s.damping * np.outer(s.axis, s.axis) for s in springs)
        self.load = np.zeros((n, self.size))
        self.load[:, 1] = -self.mass @ np.asarray(base, float)

    def derive(self, f):
        """The derivative by time of coefficients, as a matrix, at 1 Hz times f."""
        matrix = np.zeros((self.size, self.size))
        for k in range(1, self.harmonics + 1):
            matrix[2 * k - 1, 2 * k], matrix[2 * k, 2 * k - 1] = 2 * np.pi * f * k, -2 * np.pi * f * k
        return matrix

    def residual(self, x, f):
        """Residual, its Jacobian and its derivative by the frequency; x is coordinates times coefficients, flat."""
        n = len(self.mass)
        X, D = x.reshape(n, self.size), self.derive(f)
        R = self.mass @ X @ (D @ D).T + self.damping @ X @ D.T + self.stiffness @ X - self.load
        J = np.kron(self.mass, D @ D) + np.kron(self.damping, D) + np.kron(self.stiffness, np.eye(self.size))
        for spring in self.springs:
            force, slope = spring.bend(self.to_time @ (spring.axis @ X))
            R = R + np.outer(spring.axis, self.to_harmonics @ force)
            J = J + np.kron(np.outer(spring.axis, spring.axis), self.to_harmonics @ (slope[:, None] * self.to_time))
        by_f = 2 / f * self.mass @ X @ (D @ D).T + 1 / f * self.damping @ X @ D.T
        return R.ravel(), J, by_f.ravel()

    def correct(self, x, f, along, unit, tolerance=1e-9):
        """Newton across the tangent; None where it fails."""
        for _ in range(12):
            R, J, by_f = self.residual(x, f)
            if np.abs(R).max() < tolerance * np.abs(self.load).max():
                return x, f
            matrix = np.block([[J, by_f[:, None] * unit[1]], [along[None, :-1] / unit[0], along[-1:]]])
            step = scipy.linalg.solve(matrix, np.append(-R, 0))
            x, f = x + step[:-1], f + unit[1] * step[-1]
        return None

    def tangent(self, x, f, before, unit):
        _, J, by_f = self.residual(x, f)
        matrix = np.block([[J * unit[0], by_f[:, None] * unit[1]], [before[None, :]]])
        along = scipy.linalg.solve(matrix, np.append(np.zeros(len(x)), 1))
        return along / np.linalg.norm(along)

    def follow(self, low, high, amplitude, longest=0.1):
        """Points (x, f) from low to high; folds: frequencies where the curve turns."""
        unit = (amplitude, (high - low) / 10)
        x = scipy.optimize.fsolve(lambda x: self.residual(x, low)[0], np.zeros(self.load.size), fprime=lambda x: self.residual(x, low)[1])
        f, step = low, longest
        along = self.tangent(x, f, np.append(np.zeros(len(x)), 1), unit)
        points, folds = [(x, f)], []
        while f < high:
            if step < 1e-7:
                raise RuntimeError(f"the curve could not be followed beyond {f} Hz")
            found = self.correct(x + step * unit[0] * along[:-1], f + step * unit[1] * along[-1], along, unit)
            turned = None if found is None else self.tangent(*found, along, unit)
            if found is None or turned @ along < 0.95:
                step *= 0.5
                continue
            if turned[-1] * along[-1] < 0:
                folds.append(self.find_fold(x, f, along, step, unit))
            (x, f), along = found, turned
            points.append((x, f))
            step = min(1.6 * step, longest)
        return points, folds

    def find_fold(self, x, f, along, step, unit):
        """The point between two steps whose tangent does not move the frequency."""
        def slope(length):
            point = self.correct(x + length * unit[0] * along[:-1], f + length * unit[1] * along[-1], along, unit)
            return self.tangent(*point, along, unit)[-1], point[1]
        length = scipy.optimize.brentq(lambda length: slope(length)[0], 0, step, xtol=1e-7 * step)
        return slope(length)[1]
