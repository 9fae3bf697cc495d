# SPDX-License-Identifier: Apache-2.0
"""Questions to the peers about dissipation and commands.

They ask for the same numbers that behaviour.py measures for this package.
"""

import math

import numpy as np

from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.study.hard_cases import beside
from rigid_body_sim.study.hard_cases.case import Question

INERTIA = 1.0, 2.0, 3.0
MOMENTS = np.array(INERTIA)
STATES = 400


def _passed(run, seconds):
    """Yield (time, omega) of a started Run at the times that behaviour.py uses."""
    for time in np.linspace(0.0, seconds, STATES)[1:]:
        run.to(float(time))
        yield float(time), np.array(run.state()[4:7])


def never_rises(scene, seconds, ended):
    """Ask for the largest rise of the excess over L^2/(2 I_max), and for the excess at the end.

    The remainder counts if the excess must have ended.
    """
    start = scene.initial.angular_velocity

    def measure(run):
        excess = [_excess(start)] + [_excess(omega) for _, omega in _passed(run, seconds)]
        scale = 0.5 * float(MOMENTS @ np.square(start))
        if not np.isfinite(excess).all():
            return math.nan
        return max(float(np.diff(excess).max()), abs(excess[-1]) if ended else 0.0) / scale
    return beside.smooth(scene, seconds, 'of the energy', measure)


def _excess(omega):
    m = MOMENTS * omega
    return 0.5 * float(m @ omega) - float(m @ m) / (2.0 * MOMENTS[2])


def stays(scene, seconds):
    """Ask how far omega has moved from the value that it must keep (rad/s)."""
    def measure(run):
        return float(max(np.abs(omega - scene.initial.angular_velocity).max()
                         for _, omega in _passed(run, seconds)))
    return beside.smooth(scene, seconds, 'rad/s', measure)


def leaves(scene, seconds, expected):
    """Ask for the error of the time when the body leaves the smallest axis (s)."""
    def measure(run):
        for time, omega in _passed(run, seconds):
            if math.hypot(2.0 * omega[1], 3.0 * omega[2]) > 1.0:
                return abs(time - expected)
        return 'never leaves'
    return beside.smooth(scene, seconds, 's', measure)


def cancel(impulses):
    """Ask for the change of omega (rad/s) that opposite angular impulses (N m s, body) leave.

    Each is added to omega in turn, and omega is compared 0.1 s later.
    """
    racket = load_scene('tennis_racket')

    def ask(module):
        def omega_after(omega):
            scene = load_scene(
                'tennis_racket', [f'initial.angular_velocity={[float(x) for x in omega]}'])
            found = []

            def measure(run):
                run.to(0.1)
                found.extend(run.state()[4:7])
                return 0.0
            beside.smooth(scene, 0.1, 'rad/s', measure).ask(module)
            return np.array(found)
        quiet = struck = omega_after(racket.initial.angular_velocity)
        for impulse in impulses:
            struck = struck + np.array(impulse) / MOMENTS
        return float(np.abs(omega_after(struck) - omega_after(quiet)).max())
    return Question(0.2, 'rad/s', ask)
