# SPDX-License-Identifier: Apache-2.0
"""Tops for tests: scenes of bodies on a pivot, and anchored states of `lagrange_top`."""

import json
import math

import numpy as np

from rigid_body_sim.motions.lagrange_top import lagrange_top as motion
from rigid_body_sim.motions.solver import loops
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import STATE_SIZE

HEAVY = {'moments': [0.03, 0.03, 0.01], 'mass': 1.0, 'center': [0.0, 0.0, 0.1], 'g': 9.81}
# k = M g h/I1 = 1, n = omega_3
ROUND = {'moments': [1.0, 1.0, 1.0], 'mass': 1.0, 'center': [0.0, 0.0, 0.5], 'g': 2.0}
UPRIGHT = [0.0, 0.0, 0.0, 1.0]


def scene_of(body, orientation=UPRIGHT, omega=(0.0, 0.0, 0.0), effects=None, extra=''):
    effects = [{'gravity': {'g': body['g']}}] if effects is None else effects
    return parse_scene(json.dumps({
        'scene': 'top', 'constraint': 'pivot', 'effects': effects,
        'body': {'mass': body['mass'], 'inertia': body['moments'], 'inertia_about': 'origin',
                 'center_of_mass': body['center']},
        'initial': {'orientation': list(orientation), 'angular_velocity': list(omega)}}) + extra)


def anchored(body, orientation, omega, time=0.0):
    """Return parameters and anchor."""
    parameters = motion.parameters(scene_of(body))
    start = np.array([time, *orientation, *omega, *np.zeros(6)], dtype=float)
    anchor = np.full(motion.ANCHOR_SIZE, math.nan)
    motion.anchor(parameters, start, anchor)
    return parameters, anchor


def at(anchor, time):
    out = np.full(STATE_SIZE, math.nan)
    motion.state(anchor, time, out)
    return out


def many(anchor, times):
    out = np.full((len(times), STATE_SIZE), math.nan)
    loops(motion).states(anchor, np.asarray(times, dtype=float), out)
    return out
