"""What is compared: each program and method with the settings that buy accuracy, coarsest first."""
import time
from dataclasses import dataclass
from typing import Callable

from peer_programs import mujoco_peer, scipy_peer


@dataclass
class Case:
    """A level of the sweep, for all programs, with the reference that their errors are taken against."""
    name: str
    problem: object
    programs: object
    reference: object = None
    contacts: int = 0


@dataclass
class Contestant:
    """`run(case, *setting)` gives displacements, evaluations, CPU time (s) for each of the settings."""
    name: str
    run: Callable
    settings: list


def timed(function):
    """A run inside this process, with its CPU time."""
    def run(case, *setting):
        start = time.process_time()
        q, evaluations = function(case.problem, *setting)
        return q, evaluations, time.process_time() - start
    return run


FORWARD = Contestant("forward model", lambda case, steps: case.programs.forward(steps), [(1,), (2,), (4,), (8,), (16,)])

STEPS = (1, 2, 4, 8)

PEERS = [
    Contestant("Simbody, as `simulate`", lambda case, *setting: case.programs.simbody(*setting),
               [(accuracy, 1e-3) for accuracy in (1e-5, 1e-7, 1e-9)]),
    Contestant("Simbody, steps up to 5 ms", lambda case, *setting: case.programs.simbody(*setting),
               [(accuracy, 5e-3) for accuracy in (1e-3, 1e-5, 1e-7)]),
    Contestant("SciPy DOP853", timed(scipy_peer.simulate), [("DOP853", rtol) for rtol in (1e-4, 1e-6, 1e-8)]),
    Contestant("SciPy LSODA", timed(scipy_peer.simulate), [("LSODA", rtol) for rtol in (1e-4, 1e-6, 1e-8)]),
    Contestant("SciPy Radau", timed(scipy_peer.simulate), [("Radau", rtol) for rtol in (1e-3, 1e-5)]),
    Contestant("MuJoCo RK4, own elements", timed(mujoco_peer.own_elements), [("rk4", n) for n in STEPS]),
    Contestant("MuJoCo RK4, own elements, base in Python", timed(mujoco_peer.own_elements_exact_base), [(n,) for n in STEPS]),
    Contestant("MuJoCo RK4, forces in Python", timed(mujoco_peer.forces_in_python), [(n,) for n in (1, 2, 4)]),
    Contestant("MuJoCo implicitfast, own elements", timed(mujoco_peer.own_elements), [("implicitfast", n) for n in (1, 8, 64)]),
    Contestant("MuJoCo implicitfast, forces in Python", timed(mujoco_peer.forces_before_step), [("implicitfast", n) for n in (1, 4)]),
]

# The engine on the free body: a lower bound, not a contestant.
BARE = Contestant("MuJoCo RK4, no forces", timed(mujoco_peer.without_forces), [("rk4", 1)])
