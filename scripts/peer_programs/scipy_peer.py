"""SciPy: solve_ivp on the NumPy right-hand side, and the reference, which stops at each contact."""
import numpy as np
from scipy.integrate import solve_ivp

# s. Of the reference: solve_ivp sees a contact only where a step ends on its other side; one that comes and goes within this
# is at most some micrometres deep.
LONGEST_STEP = 5e-4


def simulate(problem, method, rtol):
    """Displacements at the samples, evaluations of the right-hand side."""
    problem.evaluations = 0
    result = solve_ivp(problem.rates, problem.times[[0, -1]], problem.initial(), method=method, t_eval=problem.times,
                       rtol=rtol, atol=rtol * problem.TYPICAL)
    if not result.success:
        raise RuntimeError(f"solve_ivp {method}: {result.message}")
    return problem.displacements(result.y), problem.evaluations


def reference(problem, rtol):
    """Displacements at the samples by DOP853, each stretch between two contacts integrated with the smooth equations that
    hold there, up to the instant when a stop closes or opens; and the number of these instants."""
    mount, end = problem.mount, problem.times[-1]
    places = [(axis, i, side) for side in (1, -1) for axis, i in np.argwhere(mount.stop["+" if side > 0 else "-"] > 0)]

    def make_event(axis, i, side, closed):
        clearance = mount.clearance["+" if side > 0 else "-"][axis, i]
        row = mount.arm[:, i]

        def penetration(t, y):
            return side * (y[axis] + mount.rotation(y[3:7])[axis] @ row - row[axis]) - clearance

        penetration.terminal = True
        # Once closed it can only open, which keeps the rounding at the start of a stretch from counting as a contact.
        penetration.direction = -1 if closed[axis, i] == side else 1
        return penetration

    closed = np.zeros(mount.arm.shape)
    t, y, states, contacts = 0.0, problem.initial(), [problem.initial()[:, None]], 0
    while True:
        rest = problem.times[problem.times > t]
        result = solve_ivp(lambda t, y: problem.rates(t, y, closed), (t, end), y, method="DOP853", t_eval=rest, rtol=rtol,
                           atol=rtol * problem.TYPICAL, max_step=LONGEST_STEP, events=[make_event(*place, closed) for place in places])
        states.append(np.reshape(result.y, (13, -1)))
        if result.status != 1:
            break
        which = next(k for k, times in enumerate(result.t_events) if len(times))
        axis, i, side = places[which]
        t, y = result.t_events[which][0], result.y_events[which][0]
        closed = closed.copy()
        closed[axis, i] = 0 if closed[axis, i] == side else side
        contacts += 1
    states = np.hstack(states)
    assert states.shape[1] == len(problem.times)
    return problem.displacements(states), contacts
