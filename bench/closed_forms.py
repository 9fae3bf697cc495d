# SPDX-License-Identifier: Apache-2.0
"""Cost of one state in closed form, and of a state every millisecond; RK4 and heyoka.

    .venv/bin/python bench/closed_forms.py [--only 'free body' pendulum] [--json]

RK4 is compiled; heyoka is measured where it is installed. Every figure is the median of
interleaved repeats in one run; "call" includes the call from Python. Ratios are reproducible,
single times depend on the machine.
"""

import argparse
import json
import platform
import statistics
import time

import numpy as np

from rigid_body_sim.compilation.environment import processor
from rigid_body_sim.compilation.jit import HAVE_NUMBA, compiled_allocating
from rigid_body_sim.motions import absorbing_motion
from rigid_body_sim.motions.solver import Exact
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.scene.state import STATE_SIZE

FALLING = {'effects': [{'gravity': {'g': 9.81}}, {'drag': {'linear': 0.1}}]}
DAMPED = {'body.inertia': [1.0, 1.0, 1.0], 'effects': [{'drag': {'angular': 0.1}}]}
WORLD = {'body.inertia': [1.0, 1.0, 1.0],
         'effects': [{'torque': {'value': [0.5, 0.1, 0.0], 'frame': 'world'}}]}
MOTOR = {'effects': [{'torque': {'value': [0.0, 0.1, 0.1]}}, {'drag': {'angular': 0.01}}]}
SCENES = {'free body': ('tennis_racket', {}), 'free body, generic': ('asymmetric_top', {}),
          'Lagrange top': ('heavy_top', {}), 'pendulum': ('kater_pendulum', {}),
          'ball': ('billiard_follow', {}), 'free body, linear drag': ('tennis_racket', FALLING),
          'pivot without weight': ('tennis_racket', {'constraint': 'pivot'}),
          'sphere, angular drag': ('tennis_racket', DAMPED),
          'axial torque': ('driven_body', {}),
          'sphere, torque in the world': ('tennis_racket', WORLD),
          'hinge, torque and drag': ('tennis_racket', {
              **MOTOR, 'constraint': {'hinge': {'axis': [0, 0, 1]}}, 'initial': {'rate': 2.0}})}
MILLISECONDS = 20_000
REPEATS = 15


@compiled_allocating
def _rk4(I1, I2, I3, w, q, h, steps):
    """Advance body rates and attitude of a free body by classical Runge-Kutta steps.

    It is what a careful user would write with numba.
    """
    y = np.empty(7)
    y[:3], y[3:] = w, q
    k, sum_, probe = np.empty(7), np.empty(7), np.empty(7)
    for _ in range(steps):
        probe[:] = y
        sum_[:] = 0.0
        for stage in range(4):
            w1, w2, w3, x, yy, z, s = probe
            k[0], k[1], k[2] = ((I2 - I3) / I1 * w2 * w3, (I3 - I1) / I2 * w3 * w1,
                                (I1 - I2) / I3 * w1 * w2)
            k[3], k[4] = 0.5 * (s * w1 + yy * w3 - z * w2), 0.5 * (s * w2 + z * w1 - x * w3)
            k[5], k[6] = 0.5 * (s * w3 + x * w2 - yy * w1), -0.5 * (x * w1 + yy * w2 + z * w3)
            sum_ += k * (1.0 if stage in (0, 3) else 2.0)
            probe = y + k * (h if stage == 2 else 0.5 * h)
        y += h / 6.0 * sum_
    return y


def timed(act, count):
    """Return seconds per unit of one call of `act` that does `count` units."""
    begin = time.perf_counter()
    act()
    return (time.perf_counter() - begin) / count


def cases(kinds=tuple(SCENES)):
    """Yield (name, callable, units per call) of these kinds of scenes, and of the others' solvers.

    Each kind has 2 MB of states, so times of states every millisecond rise with their number.
    """
    for kind in kinds:
        name, overrides = SCENES[kind]
        scene = load_scene(name, overrides)
        solver = Exact(scene, absorbing_motion(scene))
        start, out = scene.initial.vector, np.empty(STATE_SIZE)
        motion, parameters, started = solver.motion, solver._parameters, solver.start(start)
        anchor, anchored, state = np.empty(motion.ANCHOR_SIZE), started.anchor, motion.state
        times, many = np.arange(1, MILLISECONDS + 1) / 1000.0, np.empty((MILLISECONDS, STATE_SIZE))

        def one(state=state, anchored=anchored, out=out):
            for k in range(2000):
                state(anchored, 0.05 * k, out)

        def from_start(motion=motion, parameters=parameters, start=start, anchor=anchor, out=out):
            for k in range(1000):
                motion.anchor(parameters, start, anchor)
                motion.state(anchor, 0.1 * k, out)

        yield f'{kind}: a state, call', one, 2000
        yield f'{kind}: anchor and state, two calls', from_start, 1000
        yield (f'{kind}: a state every ms, each',
               lambda started=started, times=times, many=many: started.states(times, many),
               MILLISECONDS)
    yield ('RK4 compiled by numba, racket: a step of 20 ms',
           lambda: _rk4(1.0, 2.0, 3.0, np.array([0.01, 5.0, 0.01]),
                        np.array([0.0, 0.0, 0.0, 1.0]), 0.02, 5000), 5000)
    yield from heyoka_cases()


def heyoka_cases():
    """Yield heyoka's cost for the racket: final state after 100 s, and a state every ms.

    The final state has an error of 1e-9.
    """
    try:
        import heyoka
    except ImportError:
        return
    w1, w2, w3, x, y, z, s = heyoka.make_vars('w1', 'w2', 'w3', 'x', 'y', 'z', 's')
    system = [(w1, -1.0 * w2 * w3), (w2, 1.0 * w3 * w1), (w3, -1.0 / 3.0 * w1 * w2),
              (x, 0.5 * (s * w1 + y * w3 - z * w2)), (y, 0.5 * (s * w2 + z * w1 - x * w3)),
              (z, 0.5 * (s * w3 + x * w2 - y * w1)),
              (s, -0.5 * (x * w1 + y * w2 + z * w3))]
    start = [0.01, 5.0, 0.01, 0.0, 0.0, 0.0, 1.0]
    # at 1e-13 the racket's final error after 100 s is about 1e-9
    final = heyoka.taylor_adaptive(system, start, tol=1e-13)
    dense = heyoka.taylor_adaptive(system, start, tol=1e-13)
    grid = np.arange(0, MILLISECONDS + 1) / 1000.0

    def run():
        final.time = 0.0
        final.state[:] = start
        final.propagate_until(100.0)

    def output():
        dense.time = 0.0
        dense.state[:] = start
        dense.propagate_grid(grid)

    yield 'heyoka, racket: final state after 100 s', run, 1
    yield 'heyoka, racket: a state every ms, each', output, MILLISECONDS


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--json', action='store_true')
    parser.add_argument('--only', nargs='+', choices=SCENES, default=list(SCENES),
                        help='kinds of scenes (all)')
    options = parser.parse_args()
    rows = list(cases(options.only))
    for _, act, _ in rows:
        act()
    times = {what: [] for what, _, _ in rows}
    for _ in range(REPEATS):
        for what, act, count in rows:
            times[what].append(timed(act, count))
    result = {what: {'median': statistics.median(values), 'least': min(values),
                     'most': max(values)} for what, values in times.items()}
    if options.json:
        print(json.dumps({'machine': processor().split()[0],
                          'python': platform.python_version(), 'compiled': HAVE_NUMBA,
                          'seconds': result}, indent=2))
        return
    print(f'{"microseconds":62} median  least   most')
    for what, row in result.items():
        print(f'{what:60} {row["median"] * 1e6:8.3f} {row["least"] * 1e6:7.3f} '
              f'{row["most"] * 1e6:7.3f}')


if __name__ == '__main__':
    main()
