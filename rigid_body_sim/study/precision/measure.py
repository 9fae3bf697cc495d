"""Error and CPU time of every runner on one problem.

Errors first, from coarse to fine until round-off or the limit of cost is met; then the timed runs, all in turn in one process, each several
times over, so that whatever else the machine does falls on all alike.
"""

import gc
import math
import statistics
import time

import numpy as np
from tqdm import tqdm

from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.rotations import rotate, rotate_back
from rigid_body_sim.study.precision.runner import RefusedError

SAMPLE = 1e-3
"""A timed sample takes at least this long, s."""
WORSE, NEAR = 4.0, 1e4
"""A sweep ends after two settings that are that much worse than the best one, if this is so near the floor: round-off has won."""


def measure(problem, reference, runners, limit, repeats, watch=None):
    """Return what was measured.

    Parameters
    ----------
    problem : suite.Problem
    reference : reference.Reference
    runners : list of runner.Runner
    limit : float
        CPU seconds that one run may take.
    repeats : int
        Timed samples of each run.
    watch : bool, optional
        Show progress (default: on a terminal).

    Returns
    -------
    dict
        ``lines``: for each runner name, control, is_peer, ``notes`` (what went wrong at some settings) and ``points``: setting, set_up (s),
        errors, residuals, cpu per simulated second: median, least, most; ``refused``: name -> reason.
    """
    balance = Balance(problem.scene)
    lines, refused, timed = [], {}, []
    for runner in tqdm(runners, desc=f'{problem.name}: errors', disable=None if watch is None else not watch, leave=False):
        points, notes = [], []
        try:
            for point, run in _sweep(problem, reference, runner, limit, balance, notes):
                points.append(point)
                timed.append((point, run))
        except (RefusedError, BadInput) as error:
            notes.append(str(error))
        if points:
            lines.append({'name': runner.name, 'control': runner.control, 'is_peer': runner.is_peer, 'points': points, 'notes': notes})
        else:
            refused[runner.name] = notes[0]
    samples, counts = [[] for _ in timed], [_count(run, problem.duration) for _, run in timed]
    gc.collect()
    gc.disable()
    try:
        for _ in tqdm(range(repeats), desc=f'{problem.name}: times', disable=None if watch is None else not watch, leave=False):
            for (_, run), own, count in zip(timed, samples, counts, strict=True):
                own.append(_sample(run, problem.duration, count))
    finally:
        gc.enable()
    for (point, _), own in zip(timed, samples):
        per_second = [value / problem.duration for value in own]
        point['cpu'] = {'median': statistics.median(per_second), 'least': min(per_second), 'most': max(per_second)}
    return {'lines': lines, 'refused': refused}


def _sweep(problem, reference, runner, limit, balance, notes):
    """Yield (point, run) from coarse to fine; what went wrong on the way is added to notes."""
    best, worse = math.inf, 0
    for setting in runner.settings:
        began = time.process_time()
        try:
            run = runner.make(setting)
            _go(run, problem.duration)    # compiles
            set_up = time.process_time() - began
            began = time.process_time()
            _go(run, problem.duration)
            first_run = time.process_time() - began
            final = np.array(run.state())
            states = np.array(list(_along(run, reference.times.tolist())))
            states[-1] = final
            if not np.isfinite(states).all():
                raise NotConverged(f'at {runner.control} {setting!r} it returns NaN in silence')
        except NotConverged as error:    # too coarse to hold; a finer one may do
            notes.append(str(error))
            continue
        angles, omegas = reference.errors(states)
        yield {'setting': setting, 'set_up': set_up, 'first_run': first_run, 'error': float(angles[-1]), 'largest_error': float(angles.max()),
               'omega_error': float(omegas[-1]), 'largest_omega_error': float(omegas.max()), **balance.residuals(final, reference)}, run
        worse = worse + 1 if angles[-1] > WORSE * best and best < NEAR * reference.floor[-1] else 0
        best = min(best, angles[-1])
        if worse == 2 or first_run > limit:
            return


def _go(run, end):
    run.start()
    run.to(end)


def _along(run, times):
    run.start()
    for time_ in times:
        run.to(time_)
        yield np.array(run.state())


def _count(run, end):
    """Return how many runs make a sample; the first ones of a short run, with cold caches, take ten times as long as later ones."""
    count = 1
    while _sample(run, end, count) * count < SAMPLE:
        count *= 2
    return count


def _sample(run, end, count):
    """Return the CPU seconds of a run, the mean of so many."""
    began = time.process_time()
    for _ in range(count):
        run.start()
        run.to(end)
    return (time.process_time() - began) / count


class Balance:
    """Energy and angular momentum of the turning alone, against what the reference has at the end: whatever is kept is compared with itself."""

    def __init__(self, scene):
        body, kind = scene.body, scene.constraint.kind
        inertia, gravity = body.about_origin if kind == 'pivot' else body.about_center, scene.effect('gravity')
        self._moments, self._axes = inertia.moments, inertia.axes
        # of a hinged body the centre of mass moves too
        self._arm = np.subtract(body.center_of_mass, scene.constraint.through) if kind == 'hinge' else np.array(body.center_of_mass)
        self._mass = body.mass if kind == 'hinge' else 0.0
        self._weight = body.mass * gravity.g if gravity and kind in ('pivot', 'hinge') else 0.0

    def of(self, q, omega):
        """Return energy (J) and angular momentum about the point of reference (world axes)."""
        m = np.array(rotate(*self._axes, *np.multiply(self._moments, rotate_back(*self._axes, *omega))))
        m += self._mass * np.cross(self._arm, np.cross(omega, self._arm))
        return 0.5 * np.dot(m, omega) + self._weight * rotate(*q, *self._arm)[2], np.array(rotate(*q, *m))

    def residuals(self, final, reference):
        """Return the residuals of a final state, relative to kinetic plus potential energy and to the momentum."""
        energy, momentum = self.of(final[:4] / np.linalg.norm(final[:4]), final[4:])
        omega = np.array([float(x) for x in reference.omega[-1]])
        true_energy, true_momentum = self.of(np.array([float(x) for x in reference.orientation[-1]]), omega)
        size = max(abs(true_energy), self._weight * float(np.linalg.norm(self._arm)))
        return {'energy_residual': abs(energy - true_energy) / size if size else 0.0,
                'momentum_residual': float(np.linalg.norm(momentum - true_momentum) / (np.linalg.norm(true_momentum) or 1.0))}
