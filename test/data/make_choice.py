# SPDX-License-Identifier: Apache-2.0
"""Make choice.json: final attitudes of the cases of choice_cases.py to 34 digits, and floors.

They are Taylor series of the study.

PYTHONPATH=. python test/data/make_choice.py
"""

import json
import pathlib
from concurrent.futures import ProcessPoolExecutor

import choice_cases
from mpmath import mp

from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.study.precision import reference


def made(name):
    """Return the record of a case."""
    found = reference.compute(
        parse_scene(choice_cases.text(name)), choice_cases.CASES[name][-1], draws=4)
    print(name, found.digits, found.floor[-1], flush=True)
    return {'orientation': [mp.nstr(x, 34) for x in found.orientation[-1]],
            'floor': float(f'{found.floor[-1]:.3e}')}


if __name__ == '__main__':
    with ProcessPoolExecutor(2) as pool:
        records = dict(zip(choice_cases.CASES, pool.map(made, choice_cases.CASES)))
    pathlib.Path(__file__).with_name('choice.json').write_text(json.dumps(records, indent=1)
                                                               + '\n')
