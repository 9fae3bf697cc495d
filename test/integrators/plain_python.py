# SPDX-License-Identifier: Apache-2.0
"""Solve cases without numba and print JSON: compiling each scene kind would take minutes.

From the source tree: NUMBA_DISABLE_JIT=1 PYTHONPATH=.:test python
test/integrators/plain_python.py METHOD accuracy|step VALUE [CASE ...]
"""

import json
import sys

import numpy as np
from data import smooth_cases

from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene


def solve(name, method, **control):
    """Return {time: {state (13), entries (5)}} of a case of smooth_cases.py."""
    scene, wrench, times = parse_scene(smooth_cases.text(name)), *smooth_cases.CASES[name][4:]
    solver = Stepped(scene, method, wrench=Wrench(*wrench) if wrench else None, **control).start(
        scene.initial.vector)
    out = np.empty((len(times), 14))
    solver.states(np.array(times), out)
    return {repr(time): {
                'state': out[k, 1:].tolist(), 'entries': solver.entries(time).tolist()}
            for k, time in enumerate(times)}


if __name__ == '__main__':
    method, control, value, *names = sys.argv[1:]
    print(json.dumps({name: solve(name, method, **{control: float(value)})
                      for name in names or smooth_cases.CASES}))
