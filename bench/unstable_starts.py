# SPDX-License-Identifier: Apache-2.0
"""What an unstable start costs: a body that stands upright but for a rate, until it falls.

    .venv/bin/python bench/unstable_starts.py [--json]

Each method that controls its steps follows the body until theory says that it leans; each figure
is the least of several runs. The last two figures are what a start alone costs: of a body that
turns slowly, which has to be looked at, and of a fast one.
"""

import argparse
import json
import math
import time

from rigid_body_sim.compilation.environment import processor
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.scene.scene import parse_scene

SCENE = """
scene: upright
body: {{mass: 1.0, inertia: [0.2, 0.1, 0.25], center_of_mass: [0, 0, 0.5]}}
constraint: pivot
effects: [gravity: {{g: 9.81}}, drag: {{linear: 0, angular: 0.001}}]
initial: {{euler_zyz: [0, {}, 0], angular_velocity: [{!r}, 0, 0]}}
"""
GROWTH = math.sqrt(4.905 / 0.45)    # 1/s, about x
RATES, SLOW, FAST = (1e-6, 1e-12, 1e-60, 1e-300), 0.3, 30.0
METHODS = ('dop8', 'gauss16', 'taylor')
REPEATS, STARTS = 5, 500


def seconds(run, count=1):
    """Return the least time of one of `count` calls, s."""
    found = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        for _ in range(count):
            run()
        found.append((time.perf_counter() - begin) / count)
    return min(found)


def measured(method):
    """Return the figures of a method: (what, seconds)."""
    for rate in RATES:
        scene = parse_scene(SCENE.format(0.0, rate))
        solver, start = Stepped(scene, method, accuracy=1e-9, horizon=220.0), scene.initial.vector
        leans, out = math.log(1.0 / rate) / GROWTH, start.copy()
        yield f'until it leans, from {rate:g} rad/s', seconds(
            lambda: solver.start(start).state(leans, out))    # noqa: B023 (called at once)
    for rate in SLOW, FAST:
        scene = parse_scene(SCENE.format(0.4, rate))
        solver, start = Stepped(scene, method, accuracy=1e-9), scene.initial.vector
        yield f'a start at {rate:g} rad/s', seconds(
            lambda: solver.start(start), STARTS)    # noqa: B023


def main():
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--json', action='store_true')
    options = parser.parse_args()
    found = {method: dict(measured(method)) for method in METHODS}
    if options.json:
        print(json.dumps({'processor': processor(), 'seconds': found}))
        return
    print(processor().split()[0])
    for method, figures in found.items():
        for what, took in figures.items():
            print(f'{method:8} {what:34} {1e3 * took:10.4f} ms')


if __name__ == '__main__':
    main()
