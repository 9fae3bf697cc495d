# SPDX-License-Identifier: Apache-2.0
"""Compute the digests of all cases and compare them with the stored ones, valid everywhere.

::

    python -m rigid_body_sim.study.machines.digests           # exit status 1 if one differs
    python -m rigid_body_sim.study.machines.digests --json    # the digests of this machine
    python -m rigid_body_sim.study.machines.digests --write   # store them: another arithmetic

After an intended change of the arithmetic, rewrite the file and note it in CHANGELOG.rst: earlier
recordings then resimulate within a tolerance, no longer to the bit.
"""

import hashlib
import sys

import numpy as np

from rigid_body_sim import command_line
from rigid_body_sim.simulation import arithmetic
from rigid_body_sim.study.machines.cases import cases


def digest(parts):
    """Return the first 80 bits of the SHA-256 of arrays of doubles and texts."""
    total = hashlib.sha256()
    for part in parts:
        total.update(part.encode() if isinstance(part, str)
                     else np.ascontiguousarray(part, dtype='<f8').tobytes())
    return total.hexdigest()[:20]


def compute(wanted=lambda name, case: True):
    """Return case -> part -> digest; a case that fails has the part `failed`: the error's text."""
    found = {}
    for name, case in cases().items():
        if wanted(name, case):
            try:
                found[name] = {part: digest(of) for part, of in case.run().items()}
            except Exception as error:    # one case that fails must not hide the others
                found[name] = {'failed': f'{type(error).__name__}: {error}'}
    return found


def different(found, kept):
    """Return 'case: part' for each digest that differs, or that one side lacks."""
    pairs = ((name, part) for name in sorted({*found, *kept})
             for part in sorted({*found.get(name, ()), *kept.get(name, ())}))
    return [f'{name}: {part}' for name, part in pairs
            if found.get(name, {}).get(part) != kept.get(name, {}).get(part)]


def main(arguments=None):
    """Run the subcommand; return the exit status."""
    parser = command_line.parser('digests', 'Compute the digests of all scenes and methods and '
                                 'compare them with those kept, the same on every machine.',
                                 'python -m rigid_body_sim.study.machines.digests')
    way = parser.add_mutually_exclusive_group()
    way.add_argument('--json', action='store_true', help='print the digests of this machine')
    way.add_argument('--write', action='store_true', help='keep the digests of this machine')
    options = parser.parse_args(arguments)
    found = compute()
    if options.json:
        command_line.print_json(found)
        return command_line.GOOD
    if options.write:
        arithmetic.FILE.write_text(arithmetic.written(found), encoding='utf-8')
        return command_line.GOOD
    apart = different(found, arithmetic.digests())
    print('\n'.join([*apart, f'{len(found)} cases, {len(apart)} digests differ']))
    return command_line.CHECK_FAILED if apart else command_line.GOOD


if __name__ == '__main__':
    sys.exit(main())
