# SPDX-License-Identifier: Apache-2.0
"""Error and cost of `auto` on random scenes: tops, driven and damped bodies, hinges.

    .venv-peers/bin/python bench/choice_random.py [--seed 11] [--count 14]

Bodies, spins, torques and drag are random; motions last 0.5 to 300 s. The reference is heyoka with
80-bit numbers and a tolerance of 1e-18; the floor is the effect of half an ulp on the start. The
exit status is 1 if an error is more than 10 times what was asked, or the cost more than twice that
of the best choice; where the floor is above 1e-3 rad nothing can be asked.
"""

import argparse
import dataclasses
import math
import random
import statistics
import sys
import time

import numpy as np

from rigid_body_sim.choice import measured
from rigid_body_sim.choice.choose import choose
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators import runnable
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.study.precision.peers import given, heyoka_taylor
from rigid_body_sim.study.precision.suite import Problem

ACCURACIES, METHODS, REPEATS, COUNT = (
    (1e-3, 1e-6, 1e-9, 1e-12), ('taylor', 'gauss16', 'dop8'), 5, 3)
MISSED, COSTLY, SENSELESS = 10.0, 2.0, 1e-3
KINDS = ('top', 'top with drag', 'driven', 'damped', 'driven and damped', 'driven hinge',
         'damped hinge')


def made_up(number, chance):
    """Return the problem of a random scene."""
    def between(low, high):
        return math.exp(chance.uniform(math.log(low), math.log(high)))

    def vector(size):
        v = np.array([chance.gauss(0.0, 1.0) for _ in range(3)])
        return (v / np.linalg.norm(v) * size).round(6).tolist()
    kind, size = chance.choice(KINDS), between(0.01, 3.0)
    a, b, c = (chance.uniform(0.05, 1.0) for _ in range(3))
    inertia = [round(x * size, 8) for x in (b + c, a + c, a + b)]
    mass, spin, duration = (round(between(0.1, 10.0), 4), between(0.3, 150.0),
                            round(between(0.5, 300.0), 3))
    if 'hinge' in kind:
        spin = between(0.1, 20.0)
    while spin * duration > 6000.0:
        duration = round(duration / 2.0, 3)
    effects, about, initial = [], '', f'{{angular_velocity: {vector(spin)}}}'
    place = (vector(math.sqrt(min(inertia) / mass) * chance.uniform(0.05, 0.4))
             if 'top' in kind else vector(between(0.05, 0.6)))
    if 'top' in kind:
        constraint, about = 'pivot', f', inertia_about: origin, center_of_mass: {place}'
        angles = [round(chance.uniform(0.05, 3.0), 3) for _ in range(3)]
        initial = f'{{euler_zyz: {angles}, angular_velocity: {vector(spin)}}}'
    elif 'hinge' in kind:
        constraint, about = f'{{hinge: {{axis: {vector(1.0)}}}}}', f', center_of_mass: {place}'
        initial = f'{{angle: {chance.uniform(-2.0, 2.0):.3f}, rate: {spin:.3f}}}'
    else:
        constraint = 'free'
    if constraint != 'free':
        effects.append(f'gravity: {{g: {chance.choice((9.81, 1.62, 3.7))}}}')
    if 'driven' in kind:
        torque = vector(between(0.01, 0.5) * min(inertia) * max(spin, 1.0))
        effects.append(f'torque: {{value: {torque}, frame: {chance.choice(("world", "body"))}}}')
    if 'damped' in kind or 'drag' in kind:
        effects.append(f'drag: {{linear: {between(1e-3, 0.3) * mass:.5f}, '
                       f'angular: {between(1e-4, 0.1) * min(inertia):.6f}}}')
    text = (f'scene: random_{number}\nbody: {{mass: {mass}, inertia: {inertia}{about}}}\n'
            f'constraint: {constraint}\n'
            f'effects: [{", ".join(effects)}]\ninitial: {initial}\n')
    return Problem(f'random_{number}', kind, duration, parse_scene(text))


def truth(problem, chance):
    """Return the attitude at the end, and the effect of half an ulp on the start (rad)."""
    numbers = given.of(problem)

    def end(one):
        run = heyoka_taylor.smooth_run(one, 1e-18, np.longdouble)
        run.start()
        run.to(problem.duration)
        return run.state()[:4]
    best, start = end(numbers), numbers.start.astype(np.longdouble)
    signs = np.array([[chance.choice((-1, 1)) for _ in start] for _ in range(2)])
    moved = (dataclasses.replace(numbers, start=start * (1 + np.longdouble(2) ** -53 * row))
             for row in signs)
    return best, max(float(angle_between(*best, *end(one))) for one in moved)


def studied(problem, chance):
    """Yield the results of auto on a problem, one for each accuracy."""
    scene, duration, out = problem.scene, problem.duration, np.empty(14)
    best, floor = truth(problem, chance)

    def error_of(solver):
        try:
            solver.state(duration, out)
        except NotConverged:
            return math.inf
        return float(angle_between(*out[1:5], *best))
    made = {(method, entry['tolerance']):
            Stepped(scene, method, entry['tolerance'], horizon=duration)
            for method in METHODS if method in runnable(scene)
            for entry in measured.rows(scene).get(method, [])}
    errors = {key: error_of(one.start(scene.initial.vector)) for key, one in made.items()}
    times = {key: [] for key in made if errors[key] < math.inf}
    for _ in range(REPEATS):
        for key, own in times.items():
            began = time.process_time()
            for _ in range(COUNT):
                made[key].start(scene.initial.vector).state(duration, out)
            own.append((time.process_time() - began) / COUNT)
    costs = {key: statistics.median(own) for key, own in times.items()}
    for accuracy in ACCURACIES:
        choice, enough = choose(scene, accuracy=accuracy, horizon=duration), max(accuracy, floor)
        error = error_of(choice.solver(scene.initial.vector, Wrench()))
        cheapest = min((cost for key, cost in costs.items() if errors[key] <= enough),
                       default=None)
        over = (costs.get((choice.method, choice.tolerance), math.nan) / cheapest
                if cheapest else math.nan)
        good = floor > SENSELESS or (error <= MISSED * enough and not over > COSTLY)
        yield choice, error, floor, over, good


def main():
    """Measure and print; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--seed', type=int, default=11)
    parser.add_argument('--count', type=int, default=14)
    options = parser.parse_args()
    chance, all_good = random.Random(options.seed), True
    print(f'{"scene":22}{"s":>8}{"asked":>8}{"method":>10}{"told":>8}{"expected":>10}'
          f'{"error":>10}{"floor":>10}{"/ best":>8}')
    for number in range(options.count):
        problem = made_up(number, chance)
        for choice, error, floor, over, good in studied(problem, chance):
            all_good &= good
            print(f'{problem.about:22}{problem.duration:8.2f}{choice.accuracy:8.0e}'
                  f'{choice.method:>10}{choice.tolerance:8.0e}{choice.expected_error:10.1e}'
                  f'{error:10.1e}{floor:10.1e}{over:8.2f}{"" if good else "  MISSED"}',
                  flush=True)
    return 0 if all_good else 1


if __name__ == '__main__':
    sys.exit(main())
