# SPDX-License-Identifier: Apache-2.0
"""Confirmation of scenes: each quantity by each way of solving, and the ways compared."""

import numpy as np

from rigid_body_sim.choice.choose import methods_for
from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.study.scenes import inertia_tensors
from rigid_body_sim.study.scenes.experiment import SMOOTH, Experiment
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.study.scenes.systems import SYSTEMS

TIMES = 41      # number of times at which two ways are compared


def confirm(scene):
    """Return a list of rows, one for each quantity: {method: Quantity}.

    Methods are ``exact``, if a motion solves the scene, and the smooth one on the full equations;
    ``both`` heads their comparison.
    """
    if scene.name not in SYSTEMS:
        raise BadInput(scene.name, 'no formula of the notes applies to it',
                       f'the scenes with formulas are {", ".join(SYSTEMS)}')
    system, shipped = SYSTEMS[scene.name], load_scene(scene.name)
    for what, own, meant in (('constraint', scene.constraint.kind, shipped.constraint.kind),
                             ('effects', _effects(scene), _effects(shipped))):
        if own != meant:
            raise BadInput(scene.name, f'the {what} here: {own}',
                           f'the formulas of this scene are for {meant}')
    ways = [method for method in ('exact', SMOOTH) if method in methods_for(scene)]
    rows = _rows({way: system.check(Experiment(scene, way, system.accuracy)) for way in ways})
    return rows + ([{'both': _agreement(scene, system, ways)}] if len(ways) == 2 else [])


def _effects(scene):
    """Return the names of the effects, in order."""
    return ', '.join(effect.name for effect in scene.effects) or 'none'


def confirm_shapes():
    """Return the rows of the table of inertia tensors."""
    return _rows({method: inertia_tensors.check(method) for method in inertia_tensors.METHODS})


def _rows(quantities):
    """Return the rows of quantities that several methods measured, in the order of the first."""
    columns = {way: list(found) for way, found in quantities.items()}
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def _agreement(scene, system, ways):
    """Return the difference of two methods, as a Quantity.

    It is the angle between attitudes or the difference of omega relative to its largest size.
    """
    times = np.linspace(0.0, system.seconds, TIMES)
    first, second = (Experiment(scene, way, system.accuracy).states(times) for way in ways)
    angle = max(angle_between(*p, *q)
                for p, q in zip(first.orientation, second.orientation, strict=True))
    size = np.linalg.norm(first.angular_velocity, axis=1).max()
    rate = (np.linalg.norm(first.angular_velocity - second.angular_velocity, axis=1).max()
            / (size or 1.0))
    return Quantity(f'attitude and omega, {ways[0]} against {ways[1]}, {system.seconds:g} s', 0.0,
                    float(max(angle, rate)), system.tolerance, absolute=True)
