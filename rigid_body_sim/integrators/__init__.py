# SPDX-License-Identifier: Apache-2.0
"""The table of methods: one file each, one line each.

protocols.py says what a method and its family declare. Which methods run a scene is derived from
these declarations and from the views of its effects, never listed by hand.

It may import ``motions`` and what lies below.
"""

from rigid_body_sim.integrators.equations.series import has_phases
from rigid_body_sim.integrators.methods import (
    dop8,
    gauss16,
    lsoda,
    radau,
    rk4,
    semi_implicit_euler,
    split2,
    split4,
    split6,
    split8,
    taylor,
)
from rigid_body_sim.integrators.registry import Methods
from rigid_body_sim.scene.constraints.protocol import Mechanism

METHODS = Methods({method.NAME: method for method in (
    dop8, gauss16, taylor, split2, split4, split6, split8, rk4, semi_implicit_euler, lsoda,
    radau)})
STEADY = gauss16
"""The method that replaces them where drag is stiff."""
GENERAL = dop8
"""The method that runs every scene, under any wrench, with the ledger: it stands in for methods
whose family does not account for these, and for motions while a wrench is held."""


def runnable(scene):
    """Return the names of the methods that can run a scene.

    They find the view that they need in every effect, allow the heat that the effects make, know
    the time and place of their stages if an effect depends on them, and stop at kinks if an effect
    has some. No method sees an effect that is only an impulse. On the table only methods that
    declare TABLE run; on a plane the general method, and where the phases have equations of their
    own for them taylor and gauss16.
    """
    if scene.constraint.mechanism is Mechanism.PLANE:
        return [GENERAL.NAME, taylor.NAME, gauss16.NAME] if has_phases(scene) else [GENERAL.NAME]
    if scene.constraint.mechanism is Mechanism.TABLE:
        return [name for name, method in METHODS.items() if method.TABLE]
    frame, hot, kinked = scene.frame, False, False
    in_field = frame.path is not None
    seen = []
    for effect in scene.effects:
        acting = effect.acting
        if acting is not None or effect.as_impulse is None:
            seen.append(effect)
        for one in acting(frame, 0.0) if acting is not None else ():
            hot = hot or one.books == 'heat' or one.of_motion
            kinked = kinked or bool(one.modes)
            in_field = in_field or one.in_field
    return list(METHODS.able(METHODS.views(seen), hot, kinked, in_field))
