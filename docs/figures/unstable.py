# SPDX-License-Identifier: Apache-2.0
"""When a body falls that stands upright all but exactly, by auto and by an adaptive method."""

import math

import numpy as np
from scipy.integrate import solve_ivp

from figures.style import MEASURED, ORANGE, THEORY, label, panels
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

SCENE = """
scene: upright
body: {{mass: 1.0, inertia: [0.2, 0.1, 0.25], center_of_mass: [0, 0, 0.5]}}
constraint: pivot
effects: [gravity: {{g: 9.81}}, drag: {{linear: 0, angular: 0.001}}]
initial: {{angular_velocity: [{!r}, 0, 0]}}
"""
MOMENT, WEIGHT, DRAG = 0.45, 4.905, 0.001    # about x, kg m^2; M g r, N m; N m s
EXPONENTS = [6, 9, 12, 16, 20, 30, 45, 60, 90, 130, 180, 240, 300]
LEANS = math.radians(30.0)
LAST = 250.0    # s


def falls(times, angles):
    """Return the first time at which a body leans by 30 degrees, or infinity."""
    leans = np.abs(angles) > LEANS
    return times[leans.argmax()] if leans.any() else math.inf


def ours(rate):
    """Return when the body of the scene falls, s."""
    times = np.arange(0.0, LAST, 0.02)
    found = Simulation(parse_scene(SCENE.format(rate)), horizon=LAST, rate=50.0).states(times)
    return falls(times, 2.0 * np.arcsin(found.orientation[:, 0]))


def adaptive(rate):
    """Return when it falls by SciPy's DOP853 with tolerances of 1e-9, s."""
    with np.errstate(invalid='ignore'):    # of errors that are 0 it divides 0 by 0
        found = solve_ivp(
            lambda t, y: (y[1], (WEIGHT * math.sin(y[0]) - DRAG * y[1]) / MOMENT), (0.0, LAST),
            (0.0, rate), method='DOP853', rtol=1e-9, atol=1e-9, dense_output=True)
    times = np.arange(0.0, LAST, 0.02)
    return falls(times, found.sol(times)[0])


def draw():
    """Return the figure."""
    figure, [axes] = panels()
    exponents = np.array(EXPONENTS, dtype=float)
    grows = (math.sqrt(0.25 * DRAG * DRAG + MOMENT * WEIGHT) - 0.5 * DRAG) / MOMENT
    # from rate/(2 r) e^(r t), and the last part of the fall: tan(x/4) grows as e^(r t)
    theory = np.log(8.0 * grows * math.tan(0.25 * LEANS) * 10.0 ** exponents) / grows
    axes.plot(exponents, theory, label='theory: ln(1/rate)/r', **THEORY)
    axes.plot(exponents, [ours(10.0 ** -k) for k in EXPONENTS], label='auto',
              **MEASURED)
    found = np.array([adaptive(10.0 ** -k) for k in EXPONENTS])
    axes.plot(exponents[found < math.inf], found[found < math.inf], color=ORANGE, marker='s',
              linestyle='', label='DOP853 of SciPy, 1e-9')
    stands = exponents[found == math.inf]
    axes.plot(stands, np.full(len(stands), LAST), color=ORANGE, marker='^', linestyle='',
              label='the same: still upright')
    axes.set_ylim(0.0, LAST + 10.0)
    label(axes, 'rate at the start, 10^-n rad/s: n', 'time until it leans by 30 degrees (s)',
          loc='lower right')
    return figure
