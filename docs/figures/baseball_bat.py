# SPDX-License-Identifier: Apache-2.0
"""Reaction of the hand to a blow, against where the bat is hit."""

import numpy as np

from figures.style import BLACK, GREY, MEASURED, THEORY, WRONG, label, panels, run
from rigid_body_sim.theory import baseball_bat as theory

LENGTH, A, M, J = 0.55, 0.2, 0.9, 2.0


def draw():
    """Return the figure."""
    figure, (axes,) = panels()
    d = np.linspace(0.0, 0.85, 50)
    axes.axhline(0.0, color=GREY, linewidth=0.5)
    axes.plot(d, theory.reaction_ratio(d, LENGTH, A), label='1 − d/l′, l′ = l + a²/l', **THEORY)
    axes.plot(d, theory.reaction_ratio_as_written(d, LENGTH, A),
              label='the brace of the notes, l′² = l² + a²', **WRONG)
    some = np.linspace(0.05, 0.85, 9)
    # momentum of the centre of mass against the blow: M l phi' = J - J_R
    rates = np.array([
        run('baseball_bat', f'strike.distance={one}').states([0.0]).angular_velocity[0, 2]
        for one in some])
    axes.plot(some, 1.0 - M * LENGTH * rates / J, label='measured', **MEASURED)
    rate = run('baseball_bat').states([0.0]).angular_velocity[0, 2]
    axes.plot(LENGTH + A**2 / LENGTH, 1.0 - M * LENGTH * rate / J, 's', color=BLACK,
              markerfacecolor='none', label='the blow of the table')
    label(axes, 'distance d of the blow from the hand (m)', 'reaction of the hand F$_R$/F')
    return figure
