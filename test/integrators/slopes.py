# SPDX-License-Identifier: Apache-2.0
"""Slopes of errors over steps, without numba, as JSON: compiling each would take a minute.

From the source tree: NUMBA_DISABLE_JIT=1 PYTHONPATH=.:test python test/integrators/slopes.py
"""

import json
import math

import numpy as np
from data import smooth_cases

from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.scene import parse_scene

# method, case, time (s), numbers of steps
CASES = (
    ('semi_implicit_euler', 'driven_body', 4.0, (200, 400)),
    ('rk4', 'asymmetric_heavy_top', 0.4, (40, 80)),
    ('split2', 'asymmetric_heavy_top', 0.4, (40, 80)),
    ('split4', 'asymmetric_heavy_top', 0.4, (40, 80)), ('split6', 'driven_body', 4.0, (8, 16)),
    ('split8', 'asymmetric_heavy_top', 0.4, (20, 40)),
    ('gauss16', 'asymmetric_heavy_top', 0.4, (8, 12)))


def error(found, exact):
    """Return the error of the attitude (rad) and, relative to its size, of omega."""
    return (angle_between(*found[1:5], *exact[1:5])
            + np.abs(found[5:8] - exact[5:8]).max() / np.abs(exact[5:8]).max())


def slope(method, case, time, steps):
    """Return d log(error)/d log(step) between two numbers of steps."""
    scene = parse_scene(smooth_cases.text(case))

    def state(name, **control):
        out = np.empty(14)
        Stepped(scene, name, **control).start(scene.initial.vector).state(time, out)
        return out
    exact = state('dop8', accuracy=1e-14)
    errors = [error(state(method, step=time / n), exact) for n in steps]
    return math.log(errors[0] / errors[1]) / math.log(steps[1] / steps[0])


if __name__ == '__main__':
    print(json.dumps({case[0]: slope(*case) for case in CASES}))
