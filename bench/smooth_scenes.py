# SPDX-License-Identifier: Apache-2.0
"""CPU time of smooth scenes without a closed form, ours and heyoka's, by accuracy reached.

    .venv/bin/python bench/smooth_scenes.py [--json] [--case NAME ...]

The scenes are random asymmetric heavy tops and driven bodies, over 20 s and 100 s. A run is a
start from new initial data and the final state, with the calls from Python; heyoka's object stays
and gets the data. Both are swept over their tolerances; a figure is the median of interleaved
repeats of the cheapest run that reached the accuracy (rotation angle to heyoka with 80-bit
numbers). heyoka, a compiled Taylor method, gets the same equations. A state every millisecond is
timed too. Ratios are reproducible, single times depend on the machine.

Bodies on a plane are shipped scenes, beside the final states of 34 digits in
test/data/plane_scenes.json: `auto` and the methods that run them asked for accuracies, without
heyoka.
"""

import argparse
import importlib.util
import json
import pathlib
import platform
import statistics
import time

import numpy as np
from heyoka_runs import runs_of

from rigid_body_sim.choice.choose import choose
from rigid_body_sim.compilation.environment import processor
from rigid_body_sim.compilation.jit import HAVE_NUMBA
from rigid_body_sim.integrators import METHODS, runnable
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import load_scene, parse_scene

GOALS = {1e-3: 0.25, 1e-6: 0.33, 1e-9: 0.4, 1e-12: 0.4}
"""Accuracy, and the share of heyoka's time that is aimed at."""
DURATIONS = (20.0, 100.0)
REPEATS, COUNT = 9, 5
MILLISECONDS = np.arange(20_001) / 1000.0
DENSE = 1e-9    # accuracy of both final states where a state every millisecond is timed
STILL = Wrench()
PLANES = json.loads(
    (pathlib.Path(__file__).parents[1] / 'test/data/plane_scenes.json').read_text())
INVERSION = 'tippe_top', 1e-9, 5e-3
"""The goal on a plane: the scene, the accuracy, and the CPU time, s."""


def _drawn_top(seed):
    """Return the text of a random asymmetric heavy top.

    Moments about the pivot, place of the centre of mass, tilt and rates are random.
    """
    draw = np.random.default_rng(seed)
    sides = draw.uniform(0.03, 0.12, 3)
    center = np.append(draw.uniform(-0.02, 0.02, 2), draw.uniform(0.06, 0.15))
    at_center = (np.sum(sides ** 2) - sides ** 2) / 3.0
    about_origin = np.diag(at_center) + center @ center * np.eye(3) - np.outer(center, center)
    rates = np.append(draw.uniform(-3.0, 3.0, 2), draw.uniform(20.0, 60.0))
    return (f'body: {{mass: 1.0, inertia: {about_origin.tolist()}, inertia_about: origin, '
            f'center_of_mass: {center.tolist()}}}\n'
            f'constraint: pivot\neffects: [gravity: {{g: 9.81}}]\n'
            f'initial: {{tilt: {draw.uniform(0.2, 1.2)}, angular_velocity: {rates.tolist()}}}\n')


DRIVEN = ('body: {{mass: 1.0, inertia: {}}}\nconstraint: free\neffects: [torque: {}]\n'
          'initial: {{angular_velocity: {}}}\n')
CASES = {
    'top 1': _drawn_top(1), 'top 2': _drawn_top(2), 'top 3': _drawn_top(3),
    'driven body': DRIVEN.format(
        '[1.0, 2.0, 3.0]', '{value: [0.3, -0.2, 0.5]}', '[0.1, 2.0, 0.3]'),
    'driven in world axes': DRIVEN.format(
        '[1.0, 1.5, 2.2]', '{value: [0.3, -0.2, 0.5], frame: world}', '[0.4, 3.0, 0.2]')}


def heyoka_system(scene):
    """Return heyoka's equations of a scene, in the scene's frame.

    They are those of rigid_body_sim/integrators/equations/turning.py, with the terms that the
    scene has.
    """
    import heyoka

    qx, qy, qz, qw, wx, wy, wz = heyoka.make_vars('qx', 'qy', 'qz', 'qw', 'wx', 'wy', 'wz')
    frame, torque = scene.frame, scene.effect('torque')
    I1, I2, I3 = frame.moments
    rows = [[None] * 3, [None] * 3,
            [2.0 * (qx * qz - qw * qy), 2.0 * (qy * qz + qw * qx),
             qw * qw - qx * qx + qz * qz - qy * qy]]
    if torque and torque.frame == 'world':
        rows[0] = [qw * qw + qx * qx - qy * qy - qz * qz, 2.0 * (qx * qy - qw * qz),
                   2.0 * (qx * qz + qw * qy)]
        rows[1] = [2.0 * (qx * qy + qw * qz), qw * qw - qx * qx + qy * qy - qz * qz,
                   2.0 * (qy * qz - qw * qx)]

    def total(*terms):
        terms = [factor * what for factor, what in terms if factor != 0.0]
        return sum(terms[1:], terms[0]) if terms else 0.0

    if scene.constraint.kind == 'pivot':
        s1, s2, s3 = (scene.body.mass * scene.effect('gravity').g * r for r in frame.arm)
        g1, g2, g3 = rows[2]
        gamma = [total((s3, g2), (-s2, g3)), total((s1, g3), (-s3, g1)),
                 total((s2, g1), (-s1, g2))]
    elif torque.frame == 'world':
        gamma = [total(*((value, rows[i][k]) for i, value in enumerate(torque.values[0])))
                 for k in range(3)]
    else:
        gamma = list(frame.from_body(torque.values[0]))
    euler = [(I2 - I3) / I1 * (wy * wz), (I3 - I1) / I2 * (wz * wx), (I1 - I2) / I3 * (wx * wy)]
    return [(qx, 0.5 * (qw * wx + qy * wz - qz * wy)), (qy, 0.5 * (qw * wy + qz * wx - qx * wz)),
            (qz, 0.5 * (qw * wz + qx * wy - qy * wx)),
            (qw, -0.5 * (qx * wx + qy * wy + qz * wz)),
            *((w, e + g / moment) for w, e, g, moment in zip(
                (wx, wy, wz), euler, gamma, (I1, I2, I3), strict=True))]


def in_frame(scene, vector):
    """Return q and omega of a state vector in the scene's frame."""
    from rigid_body_sim.numerics.rotations import multiply, rotate_back
    axes = scene.frame.axes
    return [*multiply(*vector[1:5], *axes), *rotate_back(*axes, *vector[5:8])]


def exact_attitude(scene, duration, vector):
    """Return the frame's final attitude by heyoka with 80-bit numbers, from a state vector."""
    import heyoka
    start = [np.longdouble(x) for x in in_frame(scene, vector)]
    solver = heyoka.taylor_adaptive(
        heyoka_system(scene), start, fp_type=np.longdouble, high_accuracy=True)
    solver.propagate_until(np.longdouble(duration))
    return np.array(solver.state[:4], dtype=float)


def our_run(scene, duration, method, accuracy):
    """Return act(), a start and the final state, and attitude(), which also returns the latter."""
    from rigid_body_sim.numerics.rotations import multiply
    choice, start, out = (choose(scene, method, accuracy, horizon=duration),
                          scene.initial.vector, np.empty(14))
    axes, run = scene.frame.axes, choice.runner()

    def act():
        run(start, duration, out)

    def attitude():
        act()
        return multiply(*out[1:5], *axes)
    return act, attitude


def heyoka_run(scene, duration, tolerance):
    """Return the functions of our_run for heyoka."""
    import heyoka
    start = in_frame(scene, scene.initial.vector)
    solver = heyoka.taylor_adaptive(heyoka_system(scene), start, tol=tolerance)
    return runs_of(solver, start, duration, lambda y: y[:4] / np.linalg.norm(y[:4]))


def timed(act, count):
    """Return the CPU time of a run, s."""
    begin = time.process_time()
    for _ in range(count):
        act()
    return (time.process_time() - begin) / count


def measure(name, duration):
    """Return {who: {goal: (seconds a run, setting)}}; who is one of our methods, or heyoka."""
    scene = parse_scene(f'scene: bench\n{CASES[name]}')
    exact, runs = exact_attitude(scene, duration, scene.initial.vector), []
    able = [method for method in runnable(scene)
            if method in ('taylor', 'gauss16', 'dop8') and 'accuracy' in METHODS[method].TAKES]
    for digits in np.arange(0.5, 15.0, 0.5):
        runs += [[method, f'{10.0 ** -digits:.0e}',
                  *our_run(scene, duration, method, 10.0 ** -digits)] for method in able]
        runs.append(['heyoka', f'{10.0 ** -(digits + 2.0):.0e}',
                     *heyoka_run(scene, duration, 10.0 ** -(digits + 2.0))])
    for run in runs:
        run[3] = angle_between(*run[3](), *exact)
        run.append([])
    for _ in range(REPEATS):
        for run in runs:
            run[4].append(timed(run[2], COUNT))
    table = {}
    for goal in GOALS:
        for who, setting, _, error, times in runs:
            row, median = table.setdefault(who, {}), statistics.median(times)
            if error <= goal and median < row.get(goal, (np.inf,))[0]:
                row[goal] = median, setting
    return table


def measure_dense(name):
    """Return {who: CPU seconds a state} for a state every millisecond, start included."""
    import heyoka
    scene = parse_scene(f'scene: bench\n{CASES[name]}')
    start, out = in_frame(scene, scene.initial.vector), np.empty((len(MILLISECONDS), 14))
    solver = heyoka.taylor_adaptive(heyoka_system(scene), start, tol=DENSE * 1e-3)
    choice = choose(scene, 'auto', DENSE, horizon=float(MILLISECONDS[-1]))

    def theirs():
        solver.time = 0.0
        solver.state[:] = start
        solver.propagate_grid(MILLISECONDS)

    def ours():
        choice.solver(scene.initial.vector, STILL).states(MILLISECONDS, out)
    acts, times = {f'auto: {choice.method}': ours, 'heyoka': theirs}, {}
    for act in acts.values():
        act()
    for _ in range(REPEATS):
        for who, act in acts.items():
            times.setdefault(who, []).append(timed(act, 1) / len(MILLISECONDS))
    return {who: statistics.median(values) for who, values in times.items()}


def measure_on_a_plane(name):
    """Return {method: {accuracy asked: (least seconds of a run, error in rad)}} to the last time.

    A run is a start and the final state. The choice of `auto` is made before.
    """
    case, scene, table = PLANES[name], load_scene(name), {}
    duration, true = case['times'][-1], [float(x) for x in case['orientations'][-1]]
    for method in ('auto', *runnable(scene)):
        for goal in GOALS:
            act, attitude = our_run(scene, duration, method, goal)
            error = angle_between(*attitude(), *true)
            table.setdefault(method, {})[goal] = min(
                timed(act, 1) for _ in range(REPEATS)), error
    return table


def print_on_a_plane(name, table):
    """Print what was measured on a plane."""
    print(f'{name} on its plane, {PLANES[name]["times"][-1]:g} s: CPU ms (error, rad)\n  {"":10}'
          + ''.join(f'{goal:>20.0e}' for goal in GOALS))
    for method, row in table.items():
        cells = [f'{seconds * 1e3:.2f} ({error:.0e})' for seconds, error in row.values()]
        print(f'  {method:10}' + ''.join(f'{cell:>20}' for cell in cells), flush=True)
    aimed, goal, most = INVERSION
    if name == aimed:
        seconds, _ = table['auto'][goal]
        print(f'  aimed at for {goal:.0e}: at most {most * 1e3:g} ms; '
              f'{"reached" if seconds <= most else "not reached"}')


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--json', action='store_true')
    parser.add_argument('--case', nargs='*', default=[*PLANES, *CASES],
                        choices=[*PLANES, *CASES])
    options = parser.parse_args()
    planes = {name: measure_on_a_plane(name) for name in options.case if name in PLANES}
    if not options.json:
        for name, table in planes.items():
            print_on_a_plane(name, table)
    options.case = [name for name in options.case if name in CASES]
    if not options.case and not options.json:
        return
    if importlib.util.find_spec('heyoka') is None:
        print('Smooth scenes not measured: heyoka, which they are measured against, '
              'is not installed (pip install heyoka==7.13.2)')
        return
    results, dense = {}, {}
    if not options.json:
        aims = ', '.join(f'{part} at {goal:.0e}' for goal, part in GOALS.items())
        print('CPU microseconds of a run, and in brackets its part of the time of heyoka; '
              f'aimed at: {aims}')
    for name in options.case:
        for duration in DURATIONS:
            results[f'{name}, {duration:g} s'] = table = measure(name, duration)
            if options.json:
                continue
            print(f'{name}, {duration:g} s\n  {"":10}'
                  + ''.join(f'{goal:>20.0e}' for goal in GOALS))
            for who, row in table.items():
                peers = table['heyoka']
                cells = ['-' if goal not in row else f'{row[goal][0] * 1e6:.1f}' + (
                    f' ({row[goal][0] / peers[goal][0]:.2f})'
                    if goal in peers and who != 'heyoka' else '') for goal in GOALS]
                print(f'  {who:10}' + ''.join(f'{cell:>20}' for cell in cells), flush=True)
        dense[name] = measure_dense(name)
        if not options.json:
            print(f'{name}: a state every millisecond, us each: '
                  + ', '.join(f'{who} {seconds * 1e6:.3f}'
                              for who, seconds in dense[name].items()), flush=True)
    if options.json:
        print(json.dumps({
            'machine': processor().split()[0], 'python': platform.python_version(),
            'compiled': HAVE_NUMBA,
            'runs': {name: {who: {f'{goal:.0e}': cell for goal, cell in row.items()}
                            for who, row in table.items()} for name, table in results.items()},
            'dense': dense,
            'on a plane': {name: {method: {f'{goal:.0e}': cell for goal, cell in row.items()}
                                  for method, row in table.items()}
                           for name, table in planes.items()}}, indent=2))


if __name__ == '__main__':
    main()
