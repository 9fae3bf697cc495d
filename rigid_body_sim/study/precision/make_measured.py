# SPDX-License-Identifier: Apache-2.0
"""Measure the costs by which auto chooses, and write rigid_body_sim/choice/measured.json.

They are measured on the problems of the suite without a closed form.

::

    .venv/bin/python -m rigid_body_sim.study.precision.make_measured [KIND ...]

It measures all kinds of scene, or the named ones (``pivot``, ``free`` ...); the others stay as
they are.
"""

import json
import statistics
import sys
import time

from tqdm import tqdm

from rigid_body_sim.choice import measured
from rigid_body_sim.motions import absorbing_motion
from rigid_body_sim.recording.about import machine
from rigid_body_sim.study.precision import measure, reference, runner, suite

LIMIT, REPEATS = 0.02, 7


def main(only=()):
    """Measure, and write the file."""
    gathered = {}
    for name in tqdm(suite.NAMES + suite.TRAINING):
        problem = suite.problem(name)
        if absorbing_motion(problem.scene) or (only and measured.kind(problem.scene) not in only):
            continue
        truth = reference.load(problem)
        controlled = [one for one in runner.ours(problem, truth) if one.control == 'accuracy']
        found = measure.measure(problem, truth, controlled, LIMIT, REPEATS)
        for line in found['lines']:
            rows = gathered.setdefault(measured.kind(problem.scene), {}).setdefault(
                line['name'], {})
            for point in line['points']:
                rows.setdefault(point['setting'], []).append((
                    point['largest_error'], point['cpu']['median'] / measured.pace(problem.scene)))
    kinds = {kind: {method: [entry for tolerance, found in sorted(rows.items(), reverse=True)
                             if (entry := _entry(tolerance, found))]
                    for method, rows in methods.items()}
             for kind, methods in gathered.items()}
    if only:
        kinds = measured.table()['kinds'] | kinds
    measured.FILE.write_text(json.dumps(
        {'made': time.strftime('%Y-%m-%d'), 'machine': machine(), 'kinds': kinds},
        indent=1) + '\n')


def _entry(tolerance, found):
    return {'tolerance': tolerance, 'error': float(f'{max(error for error, _ in found):.2e}'),
            'cost': float(f'{statistics.geometric_mean(cost for _, cost in found):.3e}')}


if __name__ == '__main__':
    main(sys.argv[1:])
