# SPDX-License-Identifier: Apache-2.0
"""CPU time of short runs, 0.1 to 5 s: ours, heyoka's and that of an RK4 written for each scene.

    .venv/bin/python bench/short_runs.py [--json] [--case NAME ...] [--durations 0.1 1 5]
        [--methods taylor gauss16 dop8]

A run is a start from new initial data and the final state, with the calls from Python. Peers
are at their best: heyoka has our form of the equations and keeps its compiled state; the RK4 is
compiled by numba from the equations of the scene, with no term that the scene lacks and no
array in its loop. All are swept over tolerances or steps. A figure is the least of interleaved
repeats of the cheapest run that reached the accuracy (rotation angle to heyoka with 80-bit
numbers); `auto` is what our choice takes for that accuracy and duration. heyoka must be
installed.
"""

import argparse
import json
import time

import heyoka
import numba
import numpy as np
from heyoka_runs import runs_of
from smooth_scenes import CASES, DRIVEN, in_frame

from rigid_body_sim.choice.choose import choose
from rigid_body_sim.compilation.environment import processor
from rigid_body_sim.integrators import METHODS, runnable
from rigid_body_sim.mechanics.parameters import moment_about_hinge
from rigid_body_sim.motions import absorbing_motion
from rigid_body_sim.numerics.rotations import angle_between, multiply
from rigid_body_sim.scene.scene import parse_scene

GOALS = (1e-3, 1e-6, 1e-9, 1e-12)
DURATIONS = (0.1, 1.0, 5.0)
REPEATS, SAMPLE = 15, 3e-4    # a sample takes at least so many seconds
OURS = ('taylor', 'gauss16', 'dop8')
TOLERANCES = 10.0 ** -np.arange(1.0, 15.0)
LEAST_STEPS, MOST_STEPS = 1, 2 ** 17

HINGED = ('body: {mass: 1.0, inertia: [0.02, 0.03, 0.01], center_of_mass: [0.1, 0, 0]}\n'
          'constraint: {hinge: {axis: [0, 1, 0], through: [0, 0, 0]}}\n'
          'effects: [gravity: {g: 9.81}, torque: {value: [0, 0.3, 0]}]\n'
          'initial: {angle: 0.5, rate: 2.0}\n')
SCENES = CASES | {
    'driven with drag': DRIVEN.format(
        '[1.0, 2.0, 3.0]', '{value: [0.3, -0.2, 0.5]}, drag: {angular: 0.1}', '[0.1, 2.0, 0.3]'),
    'top 1 with drag': CASES['top 1'].replace('[gravity:', '[drag: {angular: 0.002}, gravity:'),
    'driven hinge': HINGED,
    'damped hinge': HINGED.replace('torque: {value: [0, 0.3, 0]}', 'drag: {angular: 0.01}'),
    'racket': 'body: {mass: 1.0, inertia: [1.0, 2.0, 3.0]}\nconstraint: free\neffects: []\n'
              'initial: {angular_velocity: [0.01, 5.0, 0.01]}\n',
    'heavy top': 'body: {mass: 1.0, inertia: [0.03, 0.03, 0.01], inertia_about: origin, '
                 'center_of_mass: [0, 0, 0.1]}\nconstraint: pivot\neffects: [gravity: {g: 9.81}]\n'
                 'initial: {tilt: 0.5, angular_velocity: [0, 0, 60]}\n',
    'pendulum': HINGED.replace(', torque: {value: [0, 0.3, 0]}', '')}


def equations(scene):
    """Return the equations of a scene as texts: {unknown: its rate}, in the scene's frame."""
    torque, drag = scene.effect('torque'), scene.effect('drag')
    c = max(np.ravel(drag.angular)) if drag else 0.0
    if scene.constraint.axis is not None:
        # about y, with the arm along x where the angle is 0
        moment = float(moment_about_hinge(scene.body, scene.constraint))
        gravity, arm = scene.effect('gravity'), scene.constraint.arm(scene.body)
        weight = scene.body.mass * gravity.g * float(np.hypot(*arm[::2]))
        terms = [f'{float(weight / moment)!r} * cos(angle)']
        if torque:
            terms.append(f'{float(torque.values[0][1]) / moment!r}')
        if c:
            terms.append(f'{float(-c) / moment!r} * rate')
        return {'angle': 'rate', 'rate': ' + '.join(terms)}
    frame = scene.frame
    I1, I2, I3 = frame.moments
    rows = [['(qw * qw + qx * qx - qy * qy - qz * qz)', '2.0 * (qx * qy - qw * qz)',
             '2.0 * (qx * qz + qw * qy)'],
            ['2.0 * (qx * qy + qw * qz)', '(qw * qw - qx * qx + qy * qy - qz * qz)',
             '2.0 * (qy * qz - qw * qx)'],
            ['2.0 * (qx * qz - qw * qy)', '2.0 * (qy * qz + qw * qx)',
             '(qw * qw - qx * qx + qz * qz - qy * qy)']]
    gamma = [[], [], []]
    if scene.constraint.kind == 'pivot':
        s = [scene.body.mass * scene.effect('gravity').g * r for r in frame.arm]
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            gamma[k] += [(s[j], rows[2][i]), (-s[i], rows[2][j])]
    elif torque and torque.frame == 'world':
        for k in range(3):
            gamma[k] += [(value, rows[i][k]) for i, value in enumerate(torque.values[0])]
    elif torque:
        for k, value in enumerate(frame.from_body(torque.values[0])):
            gamma[k].append((value, '1.0'))
    found = {'qx': '0.5 * (qw * wx + qy * wz - qz * wy)',
             'qy': '0.5 * (qw * wy + qz * wx - qx * wz)',
             'qz': '0.5 * (qw * wz + qx * wy - qy * wx)',
             'qw': '-0.5 * (qx * wx + qy * wy + qz * wz)'}
    for k, (I, euler) in enumerate((
            (I1, ((I2 - I3) / I1, 'wy * wz')), (I2, ((I3 - I1) / I2, 'wz * wx')),
            (I3, ((I1 - I2) / I3, 'wx * wy')))):
        terms = [euler, *((factor / I, what) for factor, what in gamma[k])]
        if c:
            terms.append((-c / I, 'w' + 'xyz'[k]))
        terms = [f'{float(factor)!r} * ({what})' for factor, what in terms if factor != 0.0]
        found['w' + 'xyz'[k]] = ' + '.join(terms) or '0.0 * wx'
    return found


def start_of(scene, vector):
    """Return the unknowns of the equations at a start, a state vector."""
    if scene.constraint.axis is None:
        return list(map(float, in_frame(scene, vector)))
    _, y, _, w = vector[1:5]
    return [2.0 * float(np.arctan2(y, w)), float(vector[6])]


def heyoka_form(text, names):
    """Return heyoka's system of equations given as texts that are made here."""
    known = dict(zip(names, heyoka.make_vars(*names), strict=True)) | {
        'cos': heyoka.cos, 'sin': heyoka.sin}
    return [(known[name], eval(text[name], {}, known)) for name in names]


def rk4_of(text):
    """Return the compiled RK4 of equations: run(start, duration, steps, out)."""
    names = list(text)
    lines = ['def run(start, duration, steps, out):', '    h = duration / steps',
             f'    {", ".join(names)} = {", ".join(f"start[{k}]" for k in range(len(names)))}',
             f'    {", ".join("b_" + name for name in names)} = {", ".join(names)}',
             '    for _ in range(steps):',
             f'        {", ".join("b_" + name for name in names)} = {", ".join(names)}']
    for stage, part in enumerate(('0.5 * h', '0.5 * h', 'h', '')):
        lines += [f'        k{stage}_{name} = {text[name]}' for name in names]
        if part:
            lines += [f'        {name} = b_{name} + {part} * k{stage}_{name}' for name in names]
    lines += [f'        {name} = b_{name} + h / 6.0 * (k0_{name} + 2.0 * (k1_{name} + k2_{name}) '
              f'+ k3_{name})' for name in names]
    lines += [f'    out[{k}] = {name}' for k, name in enumerate(names)]
    made = {'cos': np.cos, 'sin': np.sin}
    exec('\n'.join(lines), made)
    return numba.njit(made['run'])


class Case:
    """One scene, and the runs of all who solve it."""

    def __init__(self, name):
        self.scene = parse_scene(f'scene: bench\n{SCENES[name]}')
        self.text, self.start = equations(self.scene), np.array(
            start_of(self.scene, self.scene.initial.vector))
        self.names = list(self.text)
        self.rk4, self.solvers = rk4_of(self.text), {}

    def attitude(self, numbers):
        """Return the quaternion of the frame, of a solution of the equations."""
        if len(numbers) == 2:
            half = 0.5 * float(numbers[0])
            return [0.0, np.sin(half), 0.0, np.cos(half)]
        q = np.array(numbers[:4], dtype=float)
        size = np.linalg.norm(q) if np.abs(q).max() < 2.0 else np.nan
        return q / size    # what has blown up is no attitude

    def exact(self, duration, start=None):
        """Return the final attitude by heyoka with 80-bit numbers, from the start or another."""
        solver = heyoka.taylor_adaptive(
            heyoka_form(self.text, self.names),
            [np.longdouble(x) for x in (self.start if start is None else start)],
            fp_type=np.longdouble, high_accuracy=True)
        solver.propagate_until(np.longdouble(duration))
        return self.attitude(solver.state)

    def ours(self, duration, method, accuracy):
        """Return act() and attitude() of one of our methods."""
        choice = choose(self.scene, method, accuracy, horizon=duration)
        start, out = self.scene.initial.vector, np.empty(14)
        axes = self.scene.frame.axes
        hinged = self.scene.constraint.axis is not None

        run = choice.runner()

        def act():
            run(start, duration, out)

        def attitude():
            act()
            return out[1:5].tolist() if hinged else multiply(*out[1:5].tolist(), *axes)
        return act, attitude

    def theirs(self, duration, tolerance):
        """Return act() and attitude() of heyoka, whose object stays."""
        if tolerance not in self.solvers:
            self.solvers[tolerance] = heyoka.taylor_adaptive(
                heyoka_form(self.text, self.names), self.start, tol=tolerance)
        return runs_of(self.solvers[tolerance], self.start, duration, self.attitude)

    def by_rk4(self, duration, steps):
        """Return act() and attitude() of the RK4."""
        start, out, run = self.start, np.empty(len(self.start)), self.rk4

        def act():
            run(start, duration, steps, out)

        def attitude():
            act()
            return self.attitude(out)
        return act, attitude

    def runs(self, duration, methods):
        """Yield (who, setting, act, attitude) from coarse to fine; ours by some methods."""
        closed = absorbing_motion(self.scene)
        if closed:
            yield 'exact', '', *self.ours(duration, 'exact', 1e-12)
        able = [method for method in runnable(self.scene)
                if method in methods and 'accuracy' in METHODS[method].TAKES]
        for method in able:
            for tolerance in TOLERANCES:
                yield method, f'{tolerance:.0e}', *self.ours(duration, method, tolerance)
        if not closed:
            for goal in GOALS:
                yield f'auto {goal:.0e}', '', *self.ours(duration, 'auto', goal)
        for tolerance in TOLERANCES * 1e-1:
            yield 'heyoka', f'{tolerance:.0e}', *self.theirs(duration, max(tolerance, 3e-16))
        steps = LEAST_STEPS
        while steps <= MOST_STEPS:
            yield 'rk4', str(steps), *self.by_rk4(duration, steps)
            steps = max(steps + 1, round(1.6 * steps))


def once(act):
    """Return the CPU time of one call, s."""
    begin = time.process_time()
    act()
    return time.process_time() - begin


def measure(case, duration, methods):
    """Return {who: {goal: (seconds a run, setting)}}; `auto` stands at the goal it was asked."""
    exact, candidates, seen = case.exact(duration), [], {}
    for who, setting, act, attitude in case.runs(duration, methods):
        found = attitude()
        error = angle_between(*found, *exact) if np.isfinite(found).all() else np.inf
        if who == 'rk4' and seen.get(who, np.inf) <= GOALS[-1]:
            continue
        seen[who] = min(seen.get(who, np.inf), error)
        count = max(1, min(400, int(SAMPLE / max(min(once(act) for _ in range(5)), 5e-7))))
        candidates.append([who, setting, act, error, count, np.inf])
    for _ in range(REPEATS):
        for row in candidates:
            begin = time.process_time()
            for _ in range(row[4]):
                row[2]()
            row[5] = min(row[5], (time.process_time() - begin) / row[4])
    table = {}
    for who, setting, _, error, _, spent in candidates:
        name, _, asked = who.partition(' ')
        for goal in GOALS:
            row = table.setdefault(name, {})
            good = float(asked) == goal if asked else error <= goal
            if good and spent < row.get(goal, (np.inf,))[0]:
                row[goal] = spent, f'{setting} {error:.0e}'.strip()
    return table


def report(name, duration, table):
    """Print one scene and duration; return (our best over the best peer, auto's over it)."""
    print(f'{name}, {duration:g} s: microseconds a run at ' +
          ', '.join(f'{goal:.0e}' for goal in GOALS))
    for who, row in table.items():
        print(f'  {who:8}', *(f'{1e6 * row[goal][0]:9.2f}' if goal in row else '        -'
                              for goal in GOALS))
    found = []
    for chosen in (('exact', *OURS), ('exact', 'auto')):
        ours = [min((table[who][goal][0] for who in chosen if goal in table.get(who, {})),
                    default=np.nan) for goal in GOALS]
        peer = [min((table[who][goal][0] for who in ('heyoka', 'rk4') if goal in table[who]),
                    default=np.nan) for goal in GOALS]
        found.append([a / b for a, b in zip(ours, peer, strict=True)])
    print('  over the best peer: best', *(f'{one:.2f}' for one in found[0]), '; auto',
          *(f'{one:.2f}' for one in found[1]), flush=True)
    return found


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--case', nargs='+', choices=SCENES, default=list(SCENES))
    parser.add_argument('--durations', nargs='+', type=float, default=list(DURATIONS))
    parser.add_argument('--methods', nargs='+', choices=OURS, default=list(OURS))
    parser.add_argument('--json', action='store_true')
    options = parser.parse_args()
    found, behind = {}, {}
    for name in options.case:
        case = Case(name)
        for duration in options.durations:
            table = measure(case, duration, options.methods)
            best, auto = report(name, duration, table)
            found[f'{name}, {duration:g} s'] = table
            for who, row in (('best', best), ('auto', auto)):
                counted = behind.setdefault((who, duration), [0, 0])
                counted[0] += sum(one > 1.0 for one in row)
                counted[1] += sum(one > 0.0 for one in row)
    for (who, duration), (worse, cells) in behind.items():
        print(f'{duration:g} s: a peer is cheaper than our {who} in {worse} of {cells} cells')
    if options.json:
        print(json.dumps({'processor': processor(), 'runs': {
            name: {who: {f'{goal:g}': value for goal, value in row.items()}
                   for who, row in table.items()} for name, table in found.items()}}))


if __name__ == '__main__':
    main()
