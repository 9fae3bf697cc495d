# SPDX-License-Identifier: Apache-2.0
"""Speed of ensembles, in closed form and stepped; the latter against heyoka's batches.

    .venv/bin/python bench/ensembles.py [--case 'top 2' 'driven body'] [--goal 1e-6] [--json]

Times are CPU seconds of all threads, medians of interleaved repeats, and include the Python around
the kernels. A stepped case, one of short_runs.py, runs for 20 s to an error of at most 1e-9 rad,
the largest of CHECKED bodies. heyoka, where it is installed, gets the same equations; the set-up
of its batches is left out.
"""

import argparse
import importlib.util
import json
import statistics
import time

import numpy as np

from rigid_body_sim import ensemble
from rigid_body_sim.choice.choose import choose
from rigid_body_sim.numerics.rotations import angle_between, multiply
from rigid_body_sim.scene.scene import load_scene

CLOSED = {'free body': 'asymmetric_top', 'racket': 'tennis_racket', 'Lagrange top': 'heavy_top'}
BODIES, TIMES, REPEATS = 20_000, 50, 7
MANY, CHECKED, DURATION, GOAL = 512, 16, 20.0, 1e-9
SPREAD = 0.02    # largest relative change of the rates at the start


def starts_of(scene, count):
    """Return count starts around that of a scene."""
    starts = np.tile(scene.initial.vector, (count, 1))
    starts[:, 5:8] *= 1.0 + SPREAD * np.random.default_rng(5).uniform(-1.0, 1.0, (count, 3))
    return starts


def closed():
    """Yield (name, callable, states)."""
    for kind, name in CLOSED.items():
        scene = load_scene(name)
        for times in (1, TIMES):
            starts = starts_of(scene, BODIES // times)
            at = np.linspace(0.5, 20.0, times)
            yield (f'{kind}, {times} times a body',
                   lambda scene=scene, starts=starts, at=at: ensemble(scene, starts, at),
                   len(starts) * times)


def stepped(case, goal):
    """Yield (name, callable, bodies times seconds) of a stepped case, run to an error.

    `auto` is the ensemble as a user asks for it; its error, that of the worst of CHECKED bodies,
    may be larger than the goal.
    """
    import heyoka
    from short_runs import Case, heyoka_form, start_of
    made = Case(case)
    scene, hinged = made.scene, made.scene.constraint.axis is not None
    starts = starts_of(scene, MANY)
    unknowns = [np.array(start_of(scene, start)) for start in starts]
    exact = [made.exact(DURATION, start) for start in unknowns[:CHECKED]]
    axes = scene.frame.axes

    def error_of(attitudes):
        return max(angle_between(*q, *truth) for q, truth in zip(attitudes, exact, strict=True))

    def ours(accuracy):
        chosen = choose(scene, 'taylor', accuracy, horizon=DURATION)
        return lambda: ensemble(scene, starts, [DURATION], chosen)

    def error_of_ours(act):
        found = [body.orientation[0] for body in act()[:CHECKED]]
        return error_of(found if hinged else [multiply(*q, *axes) for q in found])

    def theirs(size, tolerance):
        solver = heyoka.taylor_adaptive_batch(
            heyoka_form(made.text, made.names), np.zeros((len(made.names), size)), tol=tolerance)
        batches = [np.array(unknowns[k:k + size]).T for k in range(0, MANY, size)]

        def act():
            found = []
            for start in batches:
                solver.set_time(0.0)
                solver.state[:] = start
                solver.propagate_until(DURATION)
                found.append(solver.state.T.copy())
            return np.concatenate(found)
        return act
    for digits in np.arange(1.0, 15.0, 0.5):
        act = ours(10.0 ** -digits)
        if error_of_ours(act) <= goal:
            yield f'{case}, taylor to {10.0 ** -digits:.0e}', act, MANY * DURATION
            break

    def act():
        return ensemble(scene, starts, [DURATION], accuracy=goal, horizon=DURATION)
    yield f'{case}, auto, error {error_of_ours(act):.0e}', act, MANY * DURATION
    # the width of its registers, or twice that
    for size in sorted({heyoka.recommended_simd_size(), 8}):
        for digits in np.arange(1.0, 16.0, 0.5):
            act = theirs(size, 10.0 ** -digits)
            if error_of([made.attitude(one) for one in act()[:CHECKED]]) <= goal:
                yield (f'{case}, heyoka in batches of {size} to {10.0 ** -digits:.0e}', act,
                       MANY * DURATION)
                break


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--case', nargs='+', default=['top 1'],
                        help='cases without a closed form (top 1)')
    parser.add_argument('--goal', type=float, default=GOAL, help=f'their error, rad ({GOAL:g})')
    parser.add_argument('--stepped', action='store_true', help='no closed forms')
    parser.add_argument('--json', action='store_true')
    options = parser.parse_args()
    rows = [] if options.stepped else list(closed())
    if importlib.util.find_spec('heyoka') is not None:
        rows += [row for case in options.case for row in stepped(case, options.goal)]
    for _, act, _ in rows:
        act()
    times = {what: [] for what, _, _ in rows}
    for _ in range(REPEATS):
        for what, act, count in rows:
            begin = time.process_time()
            act()
            times[what].append((time.process_time() - begin) / count)
    rates = {what: 1.0 / statistics.median(values) for what, values in times.items()}
    if options.json:
        print(json.dumps(rates, indent=2))
        return
    print('for each CPU second: states in closed form, else bodies times seconds')
    for what, rate in rates.items():
        print(f'  {what:60} {rate:12.0f}')
    if importlib.util.find_spec('heyoka') is None:
        print('  stepped ones not measured: heyoka, which they are measured against, '
              'is not installed (pip install heyoka==7.13.2)')


if __name__ == '__main__':
    main()
