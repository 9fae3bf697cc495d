# SPDX-License-Identifier: Apache-2.0
"""Motions solved in closed form; the one that absorbs all of a scene makes the scene exact.

protocol.py says what a motion offers. docs/extending adds one step by step.

It may import ``mechanics`` and what lies below.
"""

import functools
import importlib
import inspect

from rigid_body_sim.errors import refuse_without
from rigid_body_sim.motions.protocol import Motion
from rigid_body_sim.scene.scene import kept

MOTIONS = ('rigid_body_sim.motions.free_body.free_body',
           'rigid_body_sim.motions.lagrange_top.lagrange_top',
           'rigid_body_sim.motions.pendulum.pendulum',
           'rigid_body_sim.motions.sliding_sphere',
           'rigid_body_sim.motions.damped_body',
           'rigid_body_sim.motions.driven_body',
           'rigid_body_sim.motions.fixed_axis',
           'rigid_body_sim.motions.torsion_pendulum',
           'rigid_body_sim.motions.lagrange_top.leaning_top',
           'rigid_body_sim.motions.pendulum.leaning_pendulum')
"""Modules in the order in which they are offered a scene; each is imported when its turn comes."""


@kept
def absorbing_motion(scene):
    """Return the motion module that solves the whole scene in closed form, or None."""
    for name in MOTIONS:
        motion = _module(name)
        if motion.absorbs(scene):
            return motion
    return None


@functools.cache
def _module(name):
    """Return a module of the table; raise BadInput for one that lacks what a Motion declares."""
    found = importlib.import_module(name)
    views = [view for view in vars(Motion) if not view.startswith('_')]
    refuse_without(found, [*inspect.get_annotations(Motion), *views], f'motion {name}',
                   'declare what it has none of as None')
    return found
