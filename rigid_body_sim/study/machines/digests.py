# SPDX-License-Identifier: Apache-2.0
"""Digests of the cases: what has to be the same, bit for bit, in every process on every machine.

::

    python -m rigid_body_sim.study.machines.digests               # compare with those kept
    python -m rigid_body_sim.study.machines.digests --write       # keep those of this machine
    python -m rigid_body_sim.study.machines.digests --json        # print them
"""

import argparse
import hashlib
import json
import pathlib
import sys
import time

import numpy as np

from rigid_body_sim.study.machines.cases import cases

KEPT = pathlib.Path(__file__).with_name('digests.json')


def digest(found):
    """Return the first 80 bits of the SHA-256 of arrays of doubles (their bytes) and texts."""
    total = hashlib.sha256()
    for part in found:
        total.update(part.encode() if isinstance(part, str)
                     else np.ascontiguousarray(part, dtype='<f8').tobytes())
    return total.hexdigest()[:20]


def compute(names=None, seconds=None):
    """Return case -> part -> digest of all cases, or of some; `seconds` is filled with times."""
    found = {}
    for name, case in cases().items():
        if names is None or name in names:
            begin = time.perf_counter()
            try:
                found[name] = {part: digest(arrays) for part, arrays in case.of().items()}
            except Exception as error:
                found[name] = {'failed': f'{type(error).__name__}: {error}'}
            if seconds is not None:
                seconds[name] = time.perf_counter() - begin
    return found


if __name__ == '__main__':
    seconds={}
    found = compute(None, seconds)
    print(json.dumps({'digests':found,'seconds':seconds}, indent=1))
