# SPDX-License-Identifier: Apache-2.0
"""The table of methods: one file each, one line each.

A method is a module with NAME, ORDER, PRESERVES (what it keeps exactly), SOURCE (where it is published), NEEDS (the view of every effect
that it asks for, rigid_body_sim/scene/effects/views.py), HEAT (whether it runs scenes in which anything makes heat), TAKES (what controls it:
accuracy, step) and FAMILY (the module that makes its kernels).

It may import ``motions`` and what lies below.
"""

from rigid_body_sim.integrators.families import runge_kutta
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
from rigid_body_sim.scene.effects.views import Frame

METHODS = {method.NAME: method for method in (dop8, gauss16, taylor, split2, split4, split6, split8, rk4, semi_implicit_euler, lsoda, radau)}


def runnable(scene):
    """Return the names of the methods that can run a scene.

    Those that find the view they need in every effect (strikes are impulses), and bear the heat that the effects make. A ball on the table
    needs steps that end where sliding does, so a Runge-Kutta method that controls its error.
    """
    if scene.constraint.kind == 'table':
        return [name for name, method in METHODS.items() if method.FAMILY is runge_kutta and 'accuracy' in method.TAKES]
    effects = [effect for effect in scene.effects if effect.name != 'strike']
    frame = Frame.of(scene.body, scene.constraint)
    acting = [one for effect in effects if hasattr(effect, 'acting') for one in effect.acting(frame, 0.0)]
    hot = any(one.books == 'heat' for one in acting)
    return [name for name, method in METHODS.items()
            if all(hasattr(effect, method.NEEDS) for effect in effects) and (method.HEAT or not hot)]
