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
    effects = [effect for effect in scene.effects
               if effect.acting is not None or effect.as_impulse is None]
    frame = scene.frame
    acting = [one for effect in effects if effect.acting is not None
              for one in effect.acting(frame, 0.0)]
    hot = any(one.books == 'heat' or one.of_motion for one in acting)
    kinked = any(one.modes for one in acting)
    in_field = frame.path is not None or any(one.in_field for one in acting)
    shown = {view for view in {method.NEEDS for method in METHODS.values()}
             if all(getattr(effect, view) is not None for effect in effects)}
    return [name for name, method in METHODS.items()
            if method.NEEDS in shown
            and (method.HEAT or not hot) and (method.FIELD or not in_field)
            and (method.FAMILY.KINKS or not kinked)]
