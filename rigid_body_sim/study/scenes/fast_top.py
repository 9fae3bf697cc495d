# SPDX-License-Identifier: Apache-2.0
"""Check of the fast top (notes, "Fast top").

It measures epsilon, slow precession and rapid nutation as the spin grows at constant P_alpha.
"""

import numpy as np

from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.study.scenes.heavy_top import SWINGS, Top, where_beta_rate_turns
from rigid_body_sim.study.scenes.limits import limit
from rigid_body_sim.theory import fast_top as theory

FASTER = (2.0, 4.0, 8.0)


def check(run):
    """Yield the quantities of the scene's top, spun 2, 4 and 8 times as fast at the same P_alpha.

    The faster it spins, the nearer its axis is to level.
    """
    top = Top(run)
    spin, height = top.P_gamma / top.I3, np.cos(top.beta)
    found = []
    for faster in FASTER:
        one = run.variant({'initial.euler_zyz': [0.0, np.arccos(height / faster), 0.0],
                           'initial.angular_velocity': [0.0, 0.0, spin * faster]})
        found.append(_measure(one, Top(one)))
    epsilon, precession, nutation, written = np.transpose(found)
    slowness = [1.0 / faster**2 * theory.slowness(top.P_gamma, top.I1, top.Mgl)
                for faster in FASTER]
    name = 'I1 M g l/P_gamma^2'
    yield from limit('epsilon = -I1 M g l/P_gamma^2', name, slowness, epsilon, 1, 0.05, 1e-5)
    yield from limit(
        'mean precession M g l/P_gamma', name, slowness, precession, 1.5, 0.1, 1e-7, written[-1])
    yield from limit('nutation P_gamma/I1', name, slowness, nutation, 1.5, 0.1, 1e-7,
                     theory.nutation_frequency_as_written(top.P_gamma, top.I1)
                     / theory.nutation_frequency(top.P_gamma, top.I1))


def _measure(run, top):
    """Return epsilon, mean precession and nutation, each over its formula, and the notes' error.

    The last one is the notes' precession over the corrected one.
    """
    half = np.pi * top.I1 / top.P_gamma
    turns = run.crossings(
        instruments.beta_rate, 0.05 * half, (2 * SWINGS + 1.5) * half, 80 * SWINGS)
    turns = turns[:2 * SWINGS + 1]
    turned = np.unwrap(instruments.alpha(run.states(turns)))
    mean = (turned[-1] - turned[0]) / (turns[-1] - turns[0])
    middle = where_beta_rate_turns(run, 0.5 * (turns[0] + turns[1]), 0.1 * half)
    epsilon = np.cos(run.read(instruments.beta, middle)[0]) - top.P_alpha / top.P_gamma
    Omega = np.pi * (len(turns) - 1) / (turns[-1] - turns[0])
    return (
        epsilon / theory.epsilon(top.P_gamma, top.I1, top.Mgl),
        mean / theory.precession_rate(top.P_gamma, top.Mgl),
        Omega / theory.nutation_frequency(top.P_gamma, top.I1),
        theory.precession_rate_as_written(top.P_gamma, top.I1, top.Mgl)
        / theory.precession_rate(top.P_gamma, top.Mgl),
    )
