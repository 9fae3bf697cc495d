# SPDX-License-Identifier: Apache-2.0
"""Error and CPU time of every runner on one problem.

The errors come first, from coarse to fine until round-off or the limit of cost is met. The timed
runs follow, in turn in one process, each several times over, so that other load on the machine
affects all alike.
"""

import gc
import math
import statistics
import time

import numpy as np
from tqdm import tqdm

from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.study.precision.runner import RefusedError

SAMPLE = 1e-3
"""Least duration of a timed sample, s."""
WORSE, NEAR = 4.0, 1e4
"""Signs of round-off: a sweep ends after two settings whose error is WORSE times the best one,
if that is below NEAR times the floor."""


def measure(problem, reference, runners, limit, repeats, watch=None):
    """Return errors and CPU times of the runners on a problem.

    Parameters
    ----------
    problem : suite.Problem
    reference : reference.Reference
    runners : list of runner.Runner
    limit : float
        CPU seconds that one run may take.
    repeats : int
        Number of timed samples of each run.
    watch : bool, optional
        Whether to show progress (default: on a terminal).

    Returns
    -------
    dict
        ``lines``: for each runner name, variant, control, is_peer, ``notes`` (what went wrong at
        some settings) and ``points``: setting, set_up (s), errors, residuals, cpu per simulated
        second: median, least, most; ``refused``: name -> reason.
    """
    balance = Balance(problem.scene)
    lines, refused, timed = [], {}, []
    for runner in tqdm(runners, desc=f'{problem.name}: errors',
                       disable=None if watch is None else not watch, leave=False):
        points, notes = [], []
        try:
            for point, run in _sweep(problem, reference, runner, limit, balance, notes):
                points.append(point)
                timed.append(_Timed(run, point, notes, problem.duration))
        except (RefusedError, BadInput) as error:
            notes.append(str(error))
        if points:
            lines.append({'name': runner.name, 'variant': runner.variant,
                          'control': runner.control, 'is_peer': runner.is_peer, 'points': points,
                          'notes': notes})
        else:
            refused[runner.name] = notes[0]
    gc.collect()
    gc.disable()
    try:
        for _ in tqdm(range(repeats), desc=f'{problem.name}: times',
                      disable=None if watch is None else not watch, leave=False):
            for one in timed:
                one.sample()
    finally:
        gc.enable()
    for one in timed:
        one.tell()
    for line in lines:
        line['points'] = [point for point in line['points'] if 'cpu' in point]
        if not line['points']:
            refused[line['name']] = line['notes'][-1]
    return {'lines': [line for line in lines if line['points']], 'refused': refused}


def _sweep(problem, reference, runner, limit, balance, notes):
    """Yield (point, run) from coarse to fine; failures on the way are added to notes."""
    best, worse = math.inf, 0
    for setting in runner.settings:
        began = time.process_time()
        try:
            run = runner.make(setting)
            _go(run, problem.duration)    # the first run compiles
            set_up = time.process_time() - began
            began = time.process_time()
            _go(run, problem.duration)
            first_run = time.process_time() - began
            final = np.array(run.state())
            states = np.array(list(_along(run, reference.times.tolist())))
            states[-1] = final
            if not np.isfinite(states).all():
                raise NotConverged(f'at {runner.control} {setting!r} it returns NaN in silence')
        except NotConverged as error:    # the setting may be too coarse, and a finer one good
            notes.append(str(error))
            continue
        angles, omegas = reference.errors(states)
        yield {
            'setting': setting,
            'set_up': set_up,
            'first_run': first_run,
            'error': float(angles[-1]),
            'largest_error': float(angles.max()),
            'omega_error': float(omegas[-1]),
            'largest_omega_error': float(omegas.max()),
            **balance.residuals(final, reference),
        }, run
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


class _Timed:
    """The timed samples of a run.

    A run that fails now, though its first runs went well, is noted and has no time.
    """

    def __init__(self, run, point, notes, end):
        self._run, self._point, self._notes, self._end = run, point, notes, end
        self._samples, self._count, self._failed = [], 1, False

    def sample(self):
        """Time the run once more."""
        if self._failed:
            return
        try:
            # the first repetitions of a short run, with cold caches, take ten times as long
            while not self._samples and self._once() * self._count < SAMPLE:
                self._count *= 2
            self._samples.append(self._once())
        except NotConverged as error:
            self._failed = True
            self._notes.append(f'at {self._point["setting"]!r}, in a later run: {error}')

    def _once(self):
        """Return the CPU seconds of a run, the mean of as many as fill a sample."""
        began = time.process_time()
        for _ in range(self._count):
            _go(self._run, self._end)
        return (time.process_time() - began) / self._count

    def tell(self):
        """Store median, least and most per simulated second in the point."""
        if not self._failed:
            per_second = [value / self._end for value in self._samples]
            self._point['cpu'] = {
                'median': statistics.median(per_second),
                'least': min(per_second),
                'most': max(per_second),
            }


class Balance:
    """Energy and angular momentum of the rotation alone, compared with the reference's end.

    So quantities that are not conserved are compared with their own course.
    """

    def __init__(self, scene):
        body, kind = scene.body, scene.constraint.kind
        inertia, gravity = (
            (body.about_origin if kind == 'pivot' else body.about_center), scene.effect('gravity'))
        self._moments, self._axes = inertia.moments, inertia.axes
        # the centre of mass of a hinged body moves too
        self._arm = (np.subtract(body.center_of_mass, scene.constraint.through) if kind == 'hinge'
                     else np.array(body.center_of_mass))
        self._mass = body.mass if kind == 'hinge' else 0.0
        self._weight = body.mass * gravity.g if gravity and kind in ('pivot', 'hinge') else 0.0

    def of(self, q, omega):
        """Return energy (J) and angular momentum about the point of reference (world axes)."""
        m = np.array(rotate(
            *self._axes, *np.multiply(self._moments, rotate_back(*self._axes, *omega))))
        m += self._mass * np.cross(self._arm, np.cross(omega, self._arm))
        return (0.5 * np.dot(m, omega) + self._weight * rotate(*q, *self._arm)[2],
                np.array(rotate(*q, *m)))

    def residuals(self, final, reference):
        """Return the residuals of a final state.

        They are relative to kinetic plus potential energy, and to the momentum.
        """
        energy, momentum = self.of(final[:4] / np.linalg.norm(final[:4]), final[4:])
        omega = np.array([float(x) for x in reference.omega[-1]])
        true_energy, true_momentum = self.of(
            np.array([float(x) for x in reference.orientation[-1]]), omega)
        size = max(abs(true_energy), self._weight * float(np.linalg.norm(self._arm)))
        return {'energy_residual': abs(energy - true_energy) / size if size else 0.0,
                'momentum_residual': float(np.linalg.norm(momentum - true_momentum)
                                           / (np.linalg.norm(true_momentum) or 1.0))}
