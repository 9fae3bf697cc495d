# SPDX-License-Identifier: Apache-2.0
"""Error and cost of `auto` on scenes outside its table, compared with the best choice.

    .venv/bin/python bench/choice.py [--json]

The references are those of test/data/choice.json. The exit status is 1 if an error is more than 10
times what was asked, or the cost more than twice the best. Costs are CPU times, medians of
interleaved repeats.
"""

import argparse
import json
import pathlib
import statistics
import sys
import time

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / 'test' / 'data'))
import choice_cases  # noqa: E402

from rigid_body_sim.choice import measured  # noqa: E402
from rigid_body_sim.choice.choose import choose  # noqa: E402
from rigid_body_sim.errors import NotConverged  # noqa: E402
from rigid_body_sim.integrators import METHODS, runnable  # noqa: E402
from rigid_body_sim.integrators.solver import Stepped  # noqa: E402
from rigid_body_sim.numerics.rotations import angle_between  # noqa: E402
from rigid_body_sim.scene.effects.wrench import Wrench  # noqa: E402
from rigid_body_sim.scene.scene import parse_scene  # noqa: E402

REFERENCE = json.loads((ROOT / 'test' / 'data' / 'choice.json').read_text())
MISSED, COSTLY, REPEATS, COUNT = 10.0, 2.0, 7, 5


def candidates(scene, duration):
    """Yield ((method, tolerance), solver prototype) of every entry of the table for the scene."""
    for method in runnable(scene):
        for entry in measured.rows(scene).get(method, []):
            if ('accuracy' in METHODS[method].TAKES
                    and entry['cost'] < 10.0 * measured.rows(scene)['dop8'][0]['cost']):
                yield ((method, entry['tolerance']),
                       Stepped(scene, method, entry['tolerance'], horizon=duration))


def error_of(prototype, scene, name, duration):
    """Return the error of the attitude at the end (rad), or inf if the method gives up."""
    out = np.empty(14)
    try:
        prototype.start(scene.initial.vector).state(duration, out)
    except NotConverged:
        return float('inf')
    return float(angle_between(*out[1:5], *map(float, REFERENCE[name]['orientation'])))


def timed(prototype, scene, duration, out):
    """Return the CPU time of a run, s."""
    began = time.process_time()
    for _ in range(COUNT):
        prototype.start(scene.initial.vector).state(duration, out)
    return (time.process_time() - began) / COUNT


def studied(name):
    """Yield the results of auto on one case, one for each accuracy."""
    scene, duration, out = (parse_scene(choice_cases.text(name)), choice_cases.CASES[name][-1],
                            np.empty(14))
    made = dict(candidates(scene, duration))
    errors = {key: error_of(one, scene, name, duration) for key, one in made.items()}
    sound = {key: one for key, one in made.items() if errors[key] < float('inf')}
    times = {key: [] for key in sound}
    for _ in range(REPEATS):
        for key, one in sound.items():
            times[key].append(timed(one, scene, duration, out))
    for accuracy in choice_cases.ACCURACIES:
        choice = choose(scene, accuracy=accuracy, horizon=duration)
        choice.solver(scene.initial.vector, Wrench()).state(duration, out)
        key = choice.method, choice.tolerance
        enough = max(accuracy, REFERENCE[name]['floor'])
        best = min((statistics.median(times[other])
                    for other in sound if errors[other] <= enough), default=None)
        cost = statistics.median(times[key]) if key in times else float('inf')
        yield {'scene': name, 'accuracy': accuracy, 'method': choice.method,
               'tolerance': choice.tolerance, 'expected': choice.expected_error,
               'error': errors[key], 'cost': cost, 'over_best': cost / best if best else 1.0,
               'good': errors[key] <= MISSED * enough and (best is None or cost <= COSTLY * best)}


def main():
    """Measure and print; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--json', action='store_true')
    options = parser.parse_args()
    rows = [row for name in choice_cases.CASES for row in studied(name)]
    if options.json:
        print(json.dumps(rows, indent=2))
    else:
        print(f'{"scene":22}{"asked":>9}{"method":>10}{"told":>9}{"expected":>11}{"error":>11}'
              f'{"us":>9}{"/ best":>8}')
        for row in rows:
            print(f'{row["scene"]:22}{row["accuracy"]:9.0e}{row["method"]:>10}'
                  f'{row["tolerance"]:9.0e}{row["expected"]:11.1e}{row["error"]:11.1e}'
                  f'{row["cost"] * 1e6:9.1f}{row["over_best"]:8.2f}'
                  f'{"" if row["good"] else "  MISSED"}')
    return 0 if all(row['good'] for row in rows) else 1


if __name__ == '__main__':
    sys.exit(main())
