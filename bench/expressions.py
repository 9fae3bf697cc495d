# SPDX-License-Identifier: Apache-2.0
"""CPU time of scenes in expressions: taylor, gauss16 and dop8 beside heyoka on the same equations.

    PYTHONPATH=. .venv/bin/python bench/expressions.py [--json]

heyoka (Taylor series of variable order, compiled) gets the trees of the rates that taylor makes
its recurrences of. A run is a start and the final state, at the tolerance of each column; a figure
is the least of several turns in which the methods alternate, in microseconds, with the error of
the attitude to heyoka with 80-bit numbers (rad). Without heyoka the errors are those to dop8.
Ratios are reproducible, single times depend on the machine.
"""

import argparse
import importlib.util
import json
import platform
import time

import numpy as np
from heyoka_runs import runs_of

from rigid_body_sim.compilation.environment import processor
from rigid_body_sim.integrators.equations.expanded import Expanded
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.expressions import tree
from rigid_body_sim.scene.scene import parse_scene

ACCURACIES = (1e-6, 1e-9, 1e-12)
METHODS = ('dop8', 'gauss16', 'taylor')
DURATION, TURNS, COUNT = 10.0, 9, 5
BODY = '{mass: 1.3, inertia: [0.05, 0.08, 0.11]}'
TURNING = 'angular_velocity: [1, -2, 3]'
CASES = {
    'on a spring': (
        'k: 20, l: 0.2', "potential: {energy: '0.5*k*(sqrt((x - 0.05 + 0.2*qx*qz)^2 + y^2 + "
        "(z - 1)^2) - l)^2'}}, {gravity: {g: 9.81}", f'{{{TURNING}, velocity: [0.3, 0.2, 0]}}'),
    'gravity gradient': (
        'n: 1.5', "potential: {energy: '1.5*n^2*(0.05*(1 - 2*(qy^2 + qz^2))^2 + "
        "0.08*(2*(qx*qy - qz*qw))^2 + 0.11*(2*(qx*qz + qy*qw))^2)'}",
        f'{{orientation: [0.1, -0.4, 0.2, 0.888], {TURNING}}}'),
    'drag by the square': (
        'c: 0.3', "force: {value: ['-c*vx*sqrt(vx^2 + vy^2 + vz^2)', "
        "'-c*vy*sqrt(vx^2 + vy^2 + vz^2)', '-c*vz*sqrt(vx^2 + vy^2 + vz^2)'], at: [0, 0, 0.03], "
        'frame: world, books: heat}}, {gravity: {g: 9.81}', f'{{{TURNING}, velocity: [3, 0, 8]}}'),
    'controlled attitude, driven': (
        'p: 0.5, d: 0.02', "torque: {value: ['-2*p*qw*qx - d*wx + 0.1*sin(3*t)', "
        "'-2*p*qw*qy - d*wy', '-2*p*qw*qz - d*wz'], books: heat}", f'{{{TURNING}}}')}


def scene_of(case):
    """Return the scene of a case."""
    parameters, effects, initial = CASES[case]
    return parse_scene(f'scene: case\nparameters: {{{parameters}}}\nbody: {BODY}\n'
                       f'constraint: free\neffects: [{{{effects}}}]\ninitial: {initial}\n')


def heyoka_system(equations):
    """Return heyoka's variables and equations: the trees of the rates, operation by operation."""
    import heyoka
    names = [f'y{place}' for place in range(equations.kind.UNKNOWNS)]
    variables = heyoka.make_vars(*names)
    known = {f'_{name}': one for name, one in zip(names, variables, strict=True)}
    known |= {name: heyoka.expression(value) for name, value in equations.named.items()}
    operations = {
        '+': lambda a, b: a + b, '-': lambda a, b: a - b, '*': lambda a, b: a * b,
        '/': lambda a, b: a / b, 'negative': lambda a: -a, '^': lambda a, b: a ** b}
    made = {}
    for one in tree.parts(*equations.rates):
        if one.op == 'number':
            made[one] = heyoka.expression(one.args[0])
        elif one.op == 'name':
            made[one] = known[one.args[0]]
        else:
            act = operations.get(one.op) or getattr(heyoka, one.op)
            made[one] = act(*(made[arg] for arg in one.args))
    return [(one, made[rate]) for one, rate in zip(variables, equations.rates, strict=True)]


def ours(scene, method, accuracy):
    """Return act() and attitude() of a method."""
    run, out = Stepped(scene, method, accuracy=accuracy, horizon=DURATION).runner(), np.empty(14)

    def act():
        run(scene.initial.vector, DURATION, out)

    def attitude():
        act()
        return out[1:5]
    return act, attitude


def theirs(equations, start, tolerance, number=np.float64):
    """Return act() and attitude() of heyoka, in numbers of a type."""
    import heyoka
    start = start.astype(number)
    solver = heyoka.taylor_adaptive(heyoka_system(equations), start, tol=number(tolerance),
                                    fp_type=number)
    if number is np.float64:
        return runs_of(solver, start, DURATION, lambda state: state[:4])

    def attitude():
        solver.propagate_until(number(DURATION))
        return solver.state[:4].astype(float)
    return None, attitude


def measured(case, peer):
    """Return {method: {accuracy: (seconds, error in rad)}} of a case."""
    scene = scene_of(case)
    equations = Expanded(scene)
    _, start = equations.start(scene.initial.vector)
    found = {}
    truth = (theirs(equations, start, 1e-18, np.longdouble) if peer
             else ours(scene, 'dop8', 1e-15))[1]().copy()
    for accuracy in ACCURACIES:
        runs = {method: ours(scene, method, accuracy) for method in METHODS}
        if peer:
            runs['heyoka'] = theirs(equations, start, accuracy / DURATION)
        errors = {name: angle_between(*one(), *truth) for name, (_, one) in runs.items()}
        least = dict.fromkeys(runs, float('inf'))
        for _ in range(TURNS):
            for name, (act, _) in runs.items():
                begin = time.process_time()
                for _ in range(COUNT):
                    act()
                least[name] = min(least[name], (time.process_time() - begin) / COUNT)
        for name in runs:
            found.setdefault(name, {})[accuracy] = least[name], float(errors[name])
    return found


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--json', action='store_true')
    options = parser.parse_args()
    peer = importlib.util.find_spec('heyoka') is not None
    found = {case: measured(case, peer) for case in CASES}
    if options.json:
        print(json.dumps({'machine': processor(), 'python': platform.python_version(),
                          'cases': found}))
        return
    print(f'{processor().split()[0]}; us a run of {DURATION:g} s (error of the attitude, rad)')
    print(f'{"":42}' + ''.join(f'{accuracy:>20g}' for accuracy in ACCURACIES))
    for case, methods in found.items():
        for name, row in methods.items():
            print(f'{case + ", " + name:42}' + ''.join(
                f'{1e6 * seconds:>11.0f} ({error:.0e})' for seconds, error in row.values()))


if __name__ == '__main__':
    main()
