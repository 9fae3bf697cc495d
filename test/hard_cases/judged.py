# SPDX-License-Identifier: Apache-2.0
"""A hard case is judged by its bound, and by what was measured when the case was last looked at.

A case that asks less than it did, or measures less, still lies within its bound. The errors are
kept with the pictures (kept.py); most are the same to the last bit on every machine, and a few are
sums by NumPy, whose last bits are the processor's.
"""

import json
import math
import os

import kept

from rigid_body_sim.study.hard_cases.trends import LONG

FILE = kept.FOLDER / 'hard_cases.json'
FACTOR = 2.0
NOTHING = 1e-18    # an error as small as that is none


def judge(case, outcome=None):
    """Run a case, unless its Outcome is given, and assert that it is as good as it was."""
    outcome = outcome or case.run()
    assert outcome.good, f'{outcome}; {case.why}'
    if LONG:
        return
    table = json.loads(FILE.read_text(encoding='utf-8'))
    found = {'group': case.group, 'error': outcome.error, 'bound': outcome.bound,
             'unit': outcome.unit}
    if os.environ.get('RIGID_BODY_SIM_KEEP'):
        table[case.name] = found
        FILE.write_text(json.dumps(table, indent=1, ensure_ascii=False) + '\n', encoding='utf-8')
    before = table[case.name]
    assert (found['group'], found['unit']) == (before['group'], before['unit'])
    assert math.isclose(found['bound'], before['bound'], rel_tol=1e-6), f'bound of {case.name}'
    assert abs(math.log((found['error'] + NOTHING) / (before['error'] + NOTHING))) < math.log(
        FACTOR), f'{case.name}: error {found["error"]!r}, it was {before["error"]!r}'
