# SPDX-License-Identifier: Apache-2.0
"""Checks for effects of other packages: the views of an effect must fit together."""

import math
from typing import NamedTuple

import numpy as np

from rigid_body_sim.mechanics.energy import DIAGNOSIS_SIZE, POTENTIAL
from rigid_body_sim.mechanics.parameters import parameters
from rigid_body_sim.mechanics.potential import energies
from rigid_body_sim.scene.bodies import Body, make_body
from rigid_body_sim.scene.constraints import Free, Pivot
from rigid_body_sim.scene.constraints.protocol import Constraint
from rigid_body_sim.scene.effects.protocol import Effect
from rigid_body_sim.scene.scene import Scene
from rigid_body_sim.scene.state import State
from rigid_body_sim.simulation.simulation import Simulation

BODY = make_body(1.3, (0.05, 0.08, 0.11), (0.02, -0.03, 0.1))
DURATION = 1.0    # s
START = State.of(0.0, (0.1, -0.4, 0.2, math.sqrt(0.79)), (1.0, -2.0, 3.0))


class Residuals(NamedTuple):
    """The remainder of the ledger, relative to its largest term.

    Attributes
    ----------
    energy, momentum : float
        See mechanics/ledger.py.
    """

    energy: float
    momentum: float


def check_effect(effect: Effect, body: Body = BODY, constraint: Constraint | None = None,
                 bound: float = 1e-12) -> Residuals:
    """Check that the right-hand side, the potential and the ledger entries of an effect agree.

    A body runs for a second under the effect alone.

    Parameters
    ----------
    effect : Effect
        It must act continuously.
    body : Body, optional
        By default an asymmetric body whose centre of mass is off its origin.
    constraint : Constraint, optional
        By default free if the effect acts there, else a pivot.
    bound : float
        Largest residual that passes.

    Returns
    -------
    Residuals

    Raises
    ------
    AssertionError
        With the view that is missing, or with the residual that is too large and its likely cause.
    """
    if constraint is None:
        constraint = Free() if Free.mechanism in effect.mechanisms else Pivot()
    name, frame = effect.name, constraint.frame(body)
    assert effect.acting is not None, f'{name}: acting is None; only what acts can be checked'
    acting = effect.acting(frame, 0.0)
    booked = {one.books for one in acting}
    assert booked <= {'potential', 'work', 'heat'}, f'{name}: books {sorted(booked)}'
    assert ('potential' in booked) <= (effect.potential is not None), \
        f'{name}: books its power as potential, but the view potential is None'
    scene = Scene(name, '', body, constraint, (effect,), START, True, {})
    if effect.potential is not None:
        out = np.empty(DIAGNOSIS_SIZE)
        energies(scene).diagnose(parameters(scene), START.vector, out)
        assert np.isfinite(out[POTENTIAL]), f'{name}: its potential is {out[POTENTIAL]!r} J'
    simulation = Simulation(scene, 'dop8', accuracy=1e-13, rate=1.0 / DURATION)
    simulation.advance()
    ledger = simulation.ledger()
    found = Residuals(ledger['energy_residual'], ledger['momentum_residual'])
    assert abs(found.energy) <= bound, (
        f'{name}: energy residual {found.energy:.1e}, above {bound:.0e}: the potential is not '
        'the one whose force and torque act, or the power is booked in the wrong place')
    assert abs(found.momentum) <= bound, (
        f'{name}: momentum residual {found.momentum:.1e}, above {bound:.0e}: the components are '
        'in other axes than gives says')
    return found
