"""Work and precision: what a contestant's settings cost and reach on a group of cases, and its time at a given error."""
import math
from dataclasses import dataclass

import numpy as np


@dataclass
class Measured:
    """One setting on all cases of a group."""
    setting: tuple
    time: float  # s, all cases
    error: float  # largest of a marker over the largest displacement, geometric mean of the cases
    metres: float  # the same, absolute, largest of the cases
    evaluations: int  # of all cases


def measure(contestant, cases):
    """Every setting of a contestant on every case."""
    rows = []
    for setting in contestant.settings:
        relative, absolute, time, evaluations = [], [], 0.0, 0
        for case in cases:
            q, count, spent = contestant.run(case, *setting)
            error = float(np.abs(q - case.reference).max())
            absolute.append(error)
            relative.append(error / float(np.abs(case.reference).max()))
            time += spent
            evaluations += count
        rows.append(Measured(setting, time, math.exp(np.mean(np.log(relative))), max(absolute), evaluations))
    return rows


def time_at(rows, target):
    """Time that an error costs: between the settings along straight lines in both logarithms; the coarsest setting's where that
    is already better; None where no setting reaches it."""
    front = []
    for row in sorted(rows, key=lambda row: row.time):
        if not front or row.error < front[-1].error:
            front.append(row)
    for coarse, fine in zip([None, *front], front):
        if fine.error > target:
            continue
        if coarse is None:
            return fine.time
        part = math.log(coarse.error / target) / math.log(coarse.error / fine.error)
        return coarse.time * (fine.time / coarse.time) ** part
    return None
