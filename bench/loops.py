# SPDX-License-Identifier: Apache-2.0
"""CPU time that a loop over starts, or over scenes, pays besides the runs themselves.

    PYTHONPATH=. .venv/bin/python bench/loops.py [--json] [--case NAME ...]

Microseconds of the processor, the least of many turns, Python included; scenes are parsed before.
`another body` is each time one that was not run before, of a kind that was. Single times depend on
the machine.
"""

import argparse
import gc
import json
import time

from rigid_body_sim.compilation.environment import processor
from rigid_body_sim.scene.scene import changed_scene, load_scene
from rigid_body_sim.simulation.simulation import Simulation

NAMED = {'accuracy': 1e-6, 'horizon': 1.0}
CASES = {
    # name: (scene that ships, what is added to it, the number that changes, settings)
    'free body': ('tennis_racket', {}, 'body.inertia.1', {}),
    'top': ('heavy_top', {}, 'body.inertia.2', {}),
    'hinge': ('kater_pendulum', {}, 'body.mass', {}),
    'damped hinge': ('kater_pendulum',
                     {'effects': [{'torque': {'value': [0.1, 0.1, 0.1]}},
                                  {'drag': {'angular': 0.01}}]}, 'body.mass', {}),
    'ball': ('billiard_follow', {}, 'body.mass', {}),
    'damped flight': ('tennis_racket', {'effects': [{'gravity': {'g': 9.81}},
                                                    {'drag': {'linear': 0.1}}]}, 'body.mass', {}),
    'driven body by taylor': ('tennis_racket',
                              {'effects': [{'torque': {'value': [0.3, -0.2, 0.5]}}]},
                              'body.inertia.1', NAMED | {'integrator': 'taylor'}),
    'damped top by taylor': ('heavy_top', {'effects': [{'gravity': {'g': 9.81}},
                                                       {'drag': {'angular': 0.002}}]},
                             'body.inertia.2', NAMED | {'integrator': 'taylor'}),
    'rolling disk by dop8': ('rolling_disk', {}, 'body.mass', NAMED | {'integrator': 'dop8'})}
COLUMNS = 'restart', 'scene run before', 'and one state', 'another body', 'with_'
TURNS, COUNT, TIME = 15, 100, 0.1


def value_of(mapping, key):
    """Return the number at a key with dots."""
    for part in key.split('.'):
        mapping = mapping[int(part) if isinstance(mapping, list) else part]
    return mapping


def microseconds(do, given):
    """Return the CPU time of do(one) for each one that is given."""
    given = list(given)
    gc.collect()
    gc.disable()
    began = time.process_time()
    for one in given:
        do(one)
    spent = time.process_time() - began
    gc.enable()
    return 1e6 * spent / len(given)


def measured(name):
    """Return column -> microseconds of a case."""
    scene, added, key, settings = CASES[name]
    base = changed_scene(load_scene(scene), added)
    size = value_of(base.mapping, key)
    made = iter(range(1, 10 ** 6))

    def another():
        return changed_scene(base, {key: size * (1.0 + 1e-7 * next(made))})

    simulation, starts = Simulation(base, **settings), [base.initial.vector] * COUNT
    simulation.states([TIME])
    turns = [(
        microseconds(simulation.restart, starts),
        microseconds(lambda _: Simulation(base, **settings), starts),
        microseconds(lambda _: Simulation(base, **settings).states([TIME]), starts),
        microseconds(lambda one: Simulation(one, **settings), [another() for _ in starts]),
        microseconds(lambda k: simulation.with_({key: size * (1.0 + 1e-7 * k)}),
                     [next(made) for _ in starts])) for _ in range(TURNS)]
    return dict(zip(COLUMNS, map(min, zip(*turns, strict=True)), strict=True))


def main():
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--json', action='store_true', help='print JSON')
    parser.add_argument('--case', nargs='+', choices=CASES, default=CASES, help='these only')
    options = parser.parse_args()
    found = {name: measured(name) for name in options.case}
    if options.json:
        print(json.dumps({'processor': processor().split()[0], 'cases': found}, indent=1))
        return
    print(f'{"us":24}' + ''.join(f'{column:>18}' for column in COLUMNS))
    for name, row in found.items():
        print(f'{name:24}' + ''.join(f'{row[column]:18.1f}' for column in COLUMNS))


if __name__ == '__main__':
    main()
