# SPDX-License-Identifier: Apache-2.0
"""Motions solved in closed form; the one that absorbs all of a scene makes the scene exact.

protocol.py says what a motion offers. docs/extending.md adds one step by step.

It may import ``mechanics`` and what lies below.
"""

import functools
import importlib

from rigid_body_sim.scene.scene import kept

MOTIONS = ('rigid_body_sim.motions.free_body.free_body',
           'rigid_body_sim.motions.lagrange_top.lagrange_top',
           'rigid_body_sim.motions.pendulum.pendulum',
           'rigid_body_sim.motions.sliding_sphere',
           'rigid_body_sim.motions.damped_body',
           'rigid_body_sim.motions.driven_body',
           'rigid_body_sim.motions.fixed_axis')
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
    return importlib.import_module(name)
