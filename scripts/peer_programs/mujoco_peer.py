"""MuJoCo: a free body on the same connections, with the forces in Python or as MuJoCo's own elements.

Own elements: an axis of a connection is a spatial tendon from the mobile end to a site LENGTH away along that axis, with
stiffness and damping; its length changes by the relative displacement (to q^2 / (2 LENGTH), nanometres). Stops are a second
tendon whose spring has a dead band (`springlength` with two values) as wide as the clearances: the trilinear law exactly.
MuJoCo's contacts and joint or tendon limits cannot stand for the stops: their force is the solution of a regularised
optimisation and depends on the bodies' inertia and on the acceleration without contact, not on penetration and a stiffness in N/m.
"""
import mujoco
import numpy as np
from mujoco import rollout

LENGTH = 1000.0  # m
FREE = 1e3  # m, dead band towards a side without stop


def make_xml(mount, own_elements):
    def numbers(values):
        return " ".join(repr(float(value)) for value in values)

    anchors, ends, tendons = [], [], []
    for i, name in enumerate(mount.names) if own_elements else ():
        ends.append(f'<site name="{name}" pos="{numbers(mount.arm[:, i])}"/>')
        for axis, letter in enumerate("xyz"):
            place = mount.arm[:, i] + LENGTH * np.eye(3)[axis]
            anchors.append(f'<site name="{name}{letter}" pos="{numbers(place)}"/>')
            path = f'<site site="{name}{letter}"/><site site="{name}"/></spatial>'
            tendons.append(f'<spatial stiffness="{mount.stiffness[axis, i]}" damping="{mount.damping[axis, i]}" '
                           f'springlength="{LENGTH}">{path}')
            if mount.both[axis, i] > 0:
                # The tendon shortens as q grows.
                band = LENGTH - np.clip([mount.upper[axis, i], mount.lower[axis, i]], -FREE, FREE)
                tendons.append(f'<spatial stiffness="{mount.both[axis, i]}" springlength="{numbers(band)}">{path}')
    motors = "".join(f'<motor joint="free" gear="{numbers(np.eye(6)[axis])}"/>' for axis in range(3))
    return (f'<mujoco><option gravity="0 0 0"><flag contact="disable"/></option><worldbody>{"".join(anchors)}<body>'
            f'<freejoint name="free"/><inertial pos="0 0 0" mass="{mount.mass}" diaginertia="{numbers(mount.inertia)}"/>'
            f'{"".join(ends)}</body></worldbody><tendon>{"".join(tendons)}</tendon><actuator>{motors}</actuator></mujoco>')


class Device:
    """The device of a problem in MuJoCo, stepped by one integrator."""

    def __init__(self, problem, own_elements, integrator, steps_per_sample):
        self.problem, self.steps = problem, steps_per_sample
        self.model = mujoco.MjModel.from_xml_string(make_xml(problem.mount, own_elements))
        self.model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
        self.model.opt.timestep = problem.times[1] / steps_per_sample
        self.data = mujoco.MjData(self.model)
        self.evaluations = (len(problem.times) - 1) * steps_per_sample * (4 if integrator == "rk4" else 1)

    def displacements(self, qpos):
        return self.problem.displacements(np.vstack([qpos.T, np.zeros((6, len(qpos)))]))

    def roll_out(self):
        """All steps in one call of the engine; the base's force is held over each step at its middle value."""
        problem, model, data = self.problem, self.model, self.data
        step = model.opt.timestep
        middle = (np.arange((len(problem.times) - 1) * self.steps) + 0.5) * step
        values = np.sin(problem.sweep.scale * np.expm1(problem.sweep.growth * middle))
        control = -problem.mount.mass * np.outer(values, problem.sweep.amplitude)
        start = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
        mujoco.mj_getState(model, data, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        states, _ = rollout.rollout(model, data, start, control[None])
        # A full state is time, qpos, qvel.
        return self.displacements(np.vstack([start[1:8], states[0, self.steps - 1::self.steps, 1:8]]))

    def step_by_step(self, apply):
        """Steps from Python, `apply(model, data)` before each where it is given."""
        model, data = self.model, self.data
        qpos = [data.qpos.copy()]
        for _ in self.problem.times[1:]:
            for _ in range(self.steps):
                if apply:
                    apply(model, data)
                mujoco.mj_step(model, data)
            qpos.append(data.qpos.copy())
        return self.displacements(np.array(qpos))

    def base_force(self, data):
        return -self.problem.mount.mass * self.problem.sweep.acceleration(data.time)

    def mount_force(self, data):
        """Force and moment of the mount and the base as forces along the free joint's coordinates."""
        mount, v = self.problem.mount, data.qvel
        R = mount.rotation(data.qpos[3:].tolist())
        force, moment = mount.wrench(data.qpos[:3], R, v[:3], v[3:])
        return np.concatenate([force + self.base_force(data), moment @ R])


def own_elements(problem, integrator, steps_per_sample):
    """Springs, dashpots and stops by MuJoCo's tendons, no Python between the steps."""
    device = Device(problem, True, integrator, steps_per_sample)
    return device.roll_out(), device.evaluations


def own_elements_exact_base(problem, steps_per_sample):
    """The same by RK4, the base's force at each stage from a Python callback."""
    device = Device(problem, True, "rk4", steps_per_sample)

    def add_base(model, data):
        data.qfrc_passive[:3] += device.base_force(data)

    return with_callback(device, add_base)


def forces_in_python(problem, steps_per_sample):
    """All forces at each stage of RK4 from a Python callback."""
    device = Device(problem, False, "rk4", steps_per_sample)

    def add_all(model, data):
        data.qfrc_passive[:] += device.mount_force(data)

    return with_callback(device, add_all)


def forces_before_step(problem, integrator, steps_per_sample):
    """All forces from Python once before each step, as a control loop does it."""
    def apply(model, data):
        data.qfrc_applied[:] = device.mount_force(data)

    device = Device(problem, False, integrator, steps_per_sample)
    return device.step_by_step(apply), device.evaluations


def without_forces(problem, integrator, steps_per_sample):
    """The engine alone on the free body: what no force, however fast, can undercut."""
    device = Device(problem, False, integrator, steps_per_sample)
    device.roll_out()
    return None, device.evaluations


def with_callback(device, callback):
    mujoco.set_mjcb_passive(callback)
    try:
        return device.step_by_step(None), device.evaluations
    finally:
        mujoco.set_mjcb_passive(None)
