# SPDX-License-Identifier: Apache-2.0
"""Motions solved in closed form, one file each; the one that absorbs all of a scene makes the scene exact.

A motion declares in `absorbs(scene)` which constraint, effects and bodies it solves whole; `docs/design.md` says how a motion file is built.

It may import ``mechanics`` and what lies below.
"""

import importlib

MOTIONS = ('free_body.free_body', 'lagrange_top.lagrange_top', 'pendulum.pendulum', 'sliding_sphere')


def absorbing_motion(scene):
    """Return the motion module that solves the whole scene in closed form, or None."""
    for name in MOTIONS:
        motion = importlib.import_module(f'rigid_body_sim.motions.{name}')
        if motion.absorbs(scene):
            return motion
    return None
