"""Cost of smooth scenes without a closed form, by accuracy reached: gauss16, dop8 and RK4 beside heyoka (its own Taylor method, compiled).

    .venv/bin/python bench/smooth_scenes.py [--json] [--case NAME ...]

Asymmetric heavy tops and a driven body. Every method is swept over its tolerances or steps; a figure is the least time of interleaved
repeats, CPU microseconds per simulated second for the final state, set-up excluded, of the cheapest run that reached the accuracy (rotation
angle to heyoka in extended precision). heyoka gets the same equations. Ratios hold, single times depend on the machine. Needs heyoka.
"""

import argparse
import importlib.util
import json
import math
import platform
import time

import numpy as np

from rigid_body_sim.compiled import HAVE_NUMBA, processor
from rigid_body_sim.integrators.stepped import Stepped
from rigid_body_sim.rotations import angle_between
from rigid_body_sim.scenes import parse_scene

GOALS = (1e-3, 1e-6, 1e-9, 1e-12)
REPEATS = 15
TOP = 'pivot', '[gravity: {g: 9.81}]'
CASES = {
    'fast top': (*TOP, '{mass: 1.0, inertia: [0.03, 0.02, 0.01], inertia_about: origin, center_of_mass: [0, 0, 0.1]}',
                 '{tilt: 0.5, angular_velocity: [0, 0, 60]}', 20.0),
    'nearly symmetric top': (*TOP, '{mass: 1.0, inertia: [0.03, 0.028, 0.01], inertia_about: origin, center_of_mass: [0, 0, 0.1]}',
                             '{tilt: 0.5, angular_velocity: [0, 0, 60]}', 20.0),
    'flat top': (*TOP, '{mass: 1.0, inertia: [0.02, 0.03, 0.025], inertia_about: origin, center_of_mass: [0, 0, 0.1]}',
                 '{tilt: 0.8, angular_velocity: [1, 2, 30]}', 20.0),
    'skew slow top': (*TOP, '{mass: 1.0, inertia: [0.03, 0.02, 0.015], inertia_about: origin, center_of_mass: [0.02, 0.01, 0.1]}',
                      '{tilt: 1.0, angular_velocity: [1, 2, 5]}', 5.0),
    'driven body': ('free', '[torque: {value: [0.03, -0.02, 0.05]}]', '{mass: 1.0, inertia: [1.0, 2.0, 3.0]}',
                    '{angular_velocity: [0.1, 2.0, 0.3]}', 100.0),
    'driven body in world axes': ('free', '[torque: {value: [0.3, -0.2, 0.5], frame: world}]', '{mass: 1.0, inertia: [1.0, 1.5, 2.2]}',
                                  '{angular_velocity: [0.4, 3.0, 0.2]}', 50.0)}


def heyoka_system(scene):
    """Return heyoka's equations: those of rigid_body_sim/integrators/turning.py, written for what the scene has."""
    import heyoka
    qx, qy, qz, qw, wx, wy, wz = heyoka.make_vars('qx', 'qy', 'qz', 'qw', 'wx', 'wy', 'wz')
    pivoted, torque = scene.constraint.kind == 'pivot', scene.effect('torque')
    I1, I2, I3 = (scene.body.about_origin if pivoted else scene.body.about_center).moments
    rows = [[None] * 3, [None] * 3, [2.0 * (qx * qz - qw * qy), 2.0 * (qy * qz + qw * qx), qw * qw - qx * qx + qz * qz - qy * qy]]
    if torque and torque.frame == 'world':
        rows[0] = [qw * qw + qx * qx - qy * qy - qz * qz, 2.0 * (qx * qy - qw * qz), 2.0 * (qx * qz + qw * qy)]
        rows[1] = [2.0 * (qx * qy + qw * qz), qw * qw - qx * qx + qy * qy - qz * qz, 2.0 * (qy * qz - qw * qx)]

    def total(*terms):
        terms = [factor * what for factor, what in terms if factor != 0.0]
        return sum(terms[1:], terms[0]) if terms else 0.0

    gamma = [0.0, 0.0, 0.0]
    if pivoted:
        s1, s2, s3 = (scene.body.mass * scene.effect('gravity').g * c for c in scene.body.center_of_mass)
        g1, g2, g3 = rows[2]
        gamma = [total((s3, g2), (-s2, g3)), total((s1, g3), (-s3, g1)), total((s2, g1), (-s1, g2))]
    elif torque.frame == 'world':
        gamma = [total(*((value, rows[i][k]) for i, value in enumerate(torque.values[0]))) for k in range(3)]
    else:
        gamma = list(torque.values[0])
    euler = [(I2 - I3) / I1 * (wy * wz), (I3 - I1) / I2 * (wz * wx), (I1 - I2) / I3 * (wx * wy)]
    return [(qx, 0.5 * (qw * wx + qy * wz - qz * wy)), (qy, 0.5 * (qw * wy + qz * wx - qx * wz)), (qz, 0.5 * (qw * wz + qx * wy - qy * wx)),
            (qw, -0.5 * (qx * wx + qy * wy + qz * wz)),
            *((w, e + g / moment) for w, e, g, moment in zip((wx, wy, wz), euler, gamma, (I1, I2, I3), strict=True))]


def exact_attitude(scene, duration):
    """Return the final attitude by heyoka with 80-bit numbers."""
    import heyoka
    start = [np.longdouble(x) for x in scene.initial.vector[1:8]]
    solver = heyoka.taylor_adaptive(heyoka_system(scene), start, fp_type=np.longdouble, high_accuracy=True)
    solver.propagate_until(np.longdouble(duration))
    return np.array(solver.state[:4], dtype=float)


def runs(scene, duration):
    """Yield (method, setting, act): act() makes one run and returns (seconds, attitude)."""
    import heyoka
    out, speed = np.empty(14), np.linalg.norm(scene.initial.angular_velocity)

    def ours(solver):
        def act():
            started = solver.start(scene.initial.vector)
            begin = time.perf_counter()
            started.state(duration, out)
            return time.perf_counter() - begin, out[1:5]
        return act

    for digits in np.arange(1.0, 15.5, 0.5):
        for method in ('gauss16', 'dop8'):
            yield method, f'accuracy 1e-{digits}', ours(Stepped(scene, method, accuracy=10.0 ** -digits))
    for angle in np.geomspace(0.2, 4.0, 30):
        steps = math.ceil(duration * speed / angle)
        yield 'dop8', f'{steps} steps', ours(Stepped(scene, 'dop8', step=duration / steps))
        for digits in (2.0, 5.0, 8.0, 11.0, 14.0):
            yield 'gauss16', f'{steps} steps, sweeps to 1e-{digits}', ours(Stepped(scene, 'gauss16', accuracy=10.0 ** -digits,
                                                                                   step=duration / steps))
    for angle in np.geomspace(0.002, 0.4, 12):
        steps = math.ceil(duration * speed / angle)
        yield 'rk4', f'{steps} steps', ours(Stepped(scene, 'rk4', step=duration / steps))
    for digits in np.arange(2.0, 17.0, 0.5):
        for high in (False, True) if digits > 12.0 else (False,):
            solver = heyoka.taylor_adaptive(heyoka_system(scene), scene.initial.vector[1:8].tolist(), tol=10.0 ** -digits, high_accuracy=high)

            def act(solver=solver):
                solver.time = 0.0
                solver.state[:] = scene.initial.vector[1:8]
                begin = time.perf_counter()
                solver.propagate_until(duration)
                return time.perf_counter() - begin, solver.state[:4]

            yield 'heyoka', f'tol 1e-{digits}{", high accuracy" if high else ""}', act


def measure(name):
    """Return {method: {goal: (microseconds per simulated second, setting)}} of a case."""
    constraint, effects, body, initial, duration = CASES[name]
    scene = parse_scene(f'scene: bench\nbody: {body}\nconstraint: {constraint}\neffects: {effects}\ninitial: {initial}\n')
    exact, found = exact_attitude(scene, duration), []
    for method, setting, act in runs(scene, duration):
        try:
            act()
            seconds, q = act()
        except ArithmeticError:    # a step too long for the method
            continue
        found.append([method, setting, act, angle_between(*q, *exact), seconds])
    # of each method and goal only the runs that may be the cheapest are timed again, turn by turn
    kept = [run for run in found if any(run[3] <= goal and run[4] <= 1.6 * min(
        other[4] for other in found if other[0] == run[0] and other[3] <= goal) for goal in GOALS)]
    for _ in range(REPEATS):
        for run in kept:
            run[4] = min(run[4], run[2]()[0])
    table = {}
    for method in dict.fromkeys(run[0] for run in kept):
        for goal in GOALS:
            fit = [(run[4] / duration * 1e6, run[1]) for run in kept if run[0] == method and run[3] <= goal]
            if fit:
                table.setdefault(method, {})[goal] = min(fit)
    return table


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--json', action='store_true')
    parser.add_argument('--case', nargs='*', default=list(CASES), choices=list(CASES))
    options = parser.parse_args()
    if importlib.util.find_spec('heyoka') is None:
        print('Smooth scenes not measured: heyoka, which they are measured against, is not installed (pip install heyoka==7.13.2)')
        return
    results = {}
    for name in options.case:
        results[name] = table = measure(name)
        if options.json:
            continue
        print(f'{name}\n  {"us per simulated s":12}' + ''.join(f'{goal:>20.0e}' for goal in GOALS))
        for method, row in table.items():
            cells = []
            for goal in GOALS:
                peer = table.get('heyoka', {}).get(goal)
                cells.append('-' if goal not in row else f'{row[goal][0]:.2f}' + (f' ({row[goal][0] / peer[0]:.2f})' if peer else ''))
            print(f'  {method:18}' + ''.join(f'{cell:>20}' for cell in cells), flush=True)
        print('  cheapest gauss16: ' + '; '.join(setting for _, setting in table.get('gauss16', {}).values()), flush=True)
    if options.json:
        print(json.dumps({'machine': processor().split()[0], 'python': platform.python_version(), 'compiled': HAVE_NUMBA, 'results': {
            name: {method: {f'{goal:.0e}': cell for goal, cell in row.items()} for method, row in table.items()}
            for name, table in results.items()}}, indent=2))


if __name__ == '__main__':
    main()
