# SPDX-License-Identifier: Apache-2.0
"""Group 5, long runs: a statistical test of whether a residual has a trend.

Stationary noise (anchored exact motion): least squares over the run gives a slope whose own
uncertainty is known from the scatter; a trend is a slope beyond 5 of these. Random walk (anchored
again at each tick): its steps are the noise, and their mean is compared with 5 of its own
uncertainty; a walk of n steps may reach 5 sqrt(n) of a step.
"""

import math
import os

import numpy as np

from rigid_body_sim.compilation.jit import compiled_allocating
from rigid_body_sim.motions.free_body import free_body
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.study.hard_cases.case import Case, Outcome

SIGMAS = 5.0
BLOCKS = 64
LONG = bool(os.environ.get('RIGID_BODY_SIM_SOAK'))
"""Whether to run the long form: 1e8 ticks, a day at 1 kHz, instead of 64,000."""
TICKS = 100_000_000 if LONG else 64_000
AT_ONCE = 100_000
"""States that are held in memory."""


def slope_in_sigmas(means, scatter):
    """Return the slope of block means over the run in units of its uncertainty.

    `scatter` is the uncertainty of one mean.
    """
    place = np.linspace(-1.0, 1.0, len(means))
    slope = place @ means / (place @ place)
    return (abs(slope) / (scatter / math.sqrt(place @ place)) if scatter > 0.0
            else (0.0 if slope == 0.0 else math.inf))


def residuals(simulation, states):
    """Return named residuals of States, relative to their scales, each of shape (n,)."""
    energy, momentum_squared = simulation.diagnose(states)
    q = states.orientation
    found = {'norm of q': np.einsum('ij,ij->i', q, q) - 1.0, 'energy': energy / energy[0] - 1.0}
    if simulation.scene.constraint.mechanism is Mechanism.FREE:
        found['L'] = momentum_squared / momentum_squared[0] - 1.0
        return found
    x, y, z, w = q.T
    I1, _, I3 = simulation.scene.body.about_origin.moments
    o1, o2, o3 = states.angular_velocity.T
    g = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), (z * z + w * w) - (x * x + y * y)
    P_alpha, P_gamma = I1 * (o1 * g[0] + o2 * g[1]) + I3 * o3 * g[2], I3 * o3
    # relative to the mean: the first value is rounded too
    return (found
            | {'p_alpha': P_alpha / P_alpha.mean() - 1.0, 'p_gamma': P_gamma / P_gamma[0] - 1.0})


def anchored(name):
    """Return the Outcome of the worst slope of an exact scene that is ticked.

    It takes 64,000 ticks of 1 ms spread over a day, or every one of 1e8.
    """
    simulation = Simulation(load_scene(name))
    in_block = TICKS // BLOCKS
    step = 1e-3 if LONG else 86400.0 / TICKS
    means, squares = [], []
    for block in range(BLOCKS):
        sums = {}
        for first in range(0, in_block, AT_ONCE):
            count = min(AT_ONCE, in_block - first)
            ticks = np.arange(count) + (first + block * in_block + 1)
            for key, values in residuals(simulation, simulation.states(ticks * step)).items():
                total = sums.setdefault(key, [0.0, 0.0])
                total[0], total[1] = total[0] + values.sum(), total[1] + (values * values).sum()
        means.append({key: total[0] / in_block for key, total in sums.items()})
        squares.append({key: total[1] / in_block for key, total in sums.items()})
    worst = 0.0
    for key in means[0]:
        values = np.array([mean[key] for mean in means])
        within = np.mean([square[key] for square in squares]) - values.mean() ** 2
        # the scatter of a block mean is taken between blocks, but is no less than that of
        # independent roundings
        scatter = max(values.std(), math.sqrt(max(within, 0.0) / in_block))
        worst = max(worst, slope_in_sigmas(values, scatter))
    return Outcome(worst, SIGMAS, 'sigma',
                   f'slope of norm, energy, momenta over {TICKS:,} states of a day, '
                   'stationary noise')


@compiled_allocating
def walk(parameters, start, ticks, every, moments, out):
    """Anchor again at every tick of 1 ms; store 2 E, L^2 and |q|^2 - 1 at every `every` ticks."""
    anchor, state = np.empty(free_body.ANCHOR_SIZE), start.copy()
    for k in range(ticks):
        free_body.anchor(parameters, state, anchor)
        free_body.state(anchor, (k + 1) * 1e-3, state)
        if (k + 1) % every == 0:
            row = (k + 1) // every - 1
            w1, w2, w3 = state[5], state[6], state[7]
            out[row, 0] = moments[0] * w1 * w1 + moments[1] * w2 * w2 + moments[2] * w3 * w3
            out[row, 1] = (moments[0] * moments[0] * w1 * w1 + moments[1] * moments[1] * w2 * w2
                           + moments[2] * moments[2] * w3 * w3)
            out[row, 2] = (state[1] * state[1] + state[2] * state[2] + state[3] * state[3]
                           + state[4] * state[4] - 1.0)


def anchored_anew():
    """Return the Outcome of the mean step of the walk."""
    scene = load_scene('free_body')
    out = np.empty((BLOCKS, 3))
    walk(free_body.parameters(scene), scene.initial.vector, TICKS, TICKS // BLOCKS,
         np.array(scene.body.about_center.moments), out)
    worst = 0.0
    for column in (0, 1):
        steps = np.diff(out[:, column] / out[0, column])
        worst = max(worst, abs(steps.mean()) / (steps.std() / math.sqrt(len(steps))))
    assert np.abs(out[:, 2]).max() < 1e-14
    return Outcome(
        worst, SIGMAS, 'sigma',
        f'mean step of energy and L^2 in {TICKS:,} ticks, each anchored anew: a random walk')


def cases():
    """Yield the cases."""
    why = ('a bias of a thousandth of an ulp a tick is 1e-11 after a day at 1 kHz, '
           'while noise hides it')
    for name in ('free_body', 'heavy_top'):
        yield Case(5, f'{name.replace("_", " ")}, a day', why, lambda name=name: anchored(name))
    yield Case(5, 'free body, anchored anew at each tick', f'{why}; every tick rounds the state',
               anchored_anew)
