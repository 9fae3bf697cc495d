# SPDX-License-Identifier: Apache-2.0
"""Make references/*.json: the suite's references and the floors of its problems.

A reference is a Taylor series in fixed point. If its file exists already, the script prints how
far the new states are from those in it. References of bodies on a plane are made by
test/data/make_plane_scenes.py.

::

    .venv/bin/python -m rigid_body_sim.study.precision.make_references [NAME ...]
"""

import sys
from concurrent.futures import ProcessPoolExecutor

from rigid_body_sim.study.precision import reference, suite


def make(name):
    """Compute and write one reference, and return a report of one line."""
    problem = suite.problem(name)
    found, before = reference.compute(problem.scene, problem.duration), reference.load(problem)
    reference.save(name, problem, found)
    said = (f'{name}: {found.digits:.1f} digits, '
            f'floor at the end {found.floor[-1]:.2e} rad, {found.floor_omega[-1]:.2e} rad/s')
    if before is None:
        return said
    angles, lengths = found.distances(before.orientation, before.omega)
    return f'{said}; from the file before {angles.max():.0e} rad, {lengths.max():.0e} rad/s'


if __name__ == '__main__':
    with ProcessPoolExecutor(2) as pool:
        for line in pool.map(make, sys.argv[1:] or suite.NAMES + suite.TRAINING):
            print(line, flush=True)
