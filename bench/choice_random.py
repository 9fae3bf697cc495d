# SPDX-License-Identifier: Apache-2.0
"""What `auto` promises on random scenes: error, expected error and ledger beside a truth.

    .venv/bin/python bench/choice_random.py [--seed 11] [--count 300] [--first 0] [--keep FILE]
                                            [--new | --slowing | --let-go]

Scenes are drawn from the whole scene language (random_scenes/draw.py): bodies from slim to nearly
symmetric, all constraints, gravity along any direction, several torques, drag of numbers and
matrices, internal dissipation, rotors, friction of a ball and of a hinge, strikes, forces,
potentials, springs, torsion springs, magnets, gravity gradients, expressions of time and state,
with kinks too, all ways to say the start. Convex bodies on a plane are in plane_random.py. With
--new each has only effects in the scene's own words (random_scenes/new_language.py), on pivots off
the origin and on a path too; with --slowing drag or dry friction brings each to rest
(random_scenes/slowing.py).

The truth shares no formula with the package: Newton's and Euler's equations in body axes with the
full tensor, by extrapolation with 64-bit mantissas (truth.py); Python evaluates the expressions.
The floor is what half an ulp on each number of the start does, by finite differences of the truth.
The error is the largest at 64 uneven times up to the duration that is drawn, or up to where 2000
steps of the truth lead: whatever turns more often than a thousand times ends there. Where a finer
run says that it is much larger between two of them, it is looked at there, too. Scenes with
expressions run in plain Python, in a process of their own: their kernels would take longer to
compile than to run, and the bits are the same. With --keep a run that was stopped resumes. Exit 1
unless on every scene

    the error is at most max(asked, 3 floor),
    the expected error is within a factor of 3 of max(error, floor), or says that nothing is known
        of the attitude (above 1e-2 rad),
    the ledger's residuals are below max(asked, floor) times 10 (a torsion spring that goes on from
    the other end of the angle leaves the difference of its energies, and no more),
    nothing hangs (120 s of the processor, 600 in plain Python, as the truth) and
    nothing is raised.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np
from random_scenes import let_go, new_language, slowing
from random_scenes.draw import drawn
from random_scenes.wide import WIDE

KINDS = 'plain', 'compiled'
COMPILES_LONG = 'potential', 'spring', 'magnetic', 'force', "'", '"'


def main():
    """Measure and print; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--seed', type=int, default=11)
    parser.add_argument('--count', type=int, default=300)
    parser.add_argument('--first', type=int, default=0)
    parser.add_argument('--keep', type=pathlib.Path, help='lines of JSON: what is in it stands')
    parser.add_argument('--new', action='store_true',
                        help="scenes of effects in the scene's own words only")
    parser.add_argument('--slowing', action='store_true',
                        help='scenes of bodies that come to rest only')
    parser.add_argument('--let-go', action='store_true',
                        help='scenes of bodies that begin at rest only')
    parser.add_argument('--only', choices=KINDS, help='the scenes that one process runs')
    options = parser.parse_args()
    if np.finfo(WIDE).nmant < 63:
        print('no 80-bit numbers here: nothing to compare with')
        return 0
    if options.only:
        return _run(options)
    print(f'{"":5}{"scene":44}{"s":>7}{"asked":>8}{"method":>9}{"told":>8}{"expected":>9}'
          f'{"error":>9}{"floor":>9}{"ledger":>9}', flush=True)
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        keep = options.keep or pathlib.Path(folder) / 'kept'
        _both(options, keep)
        results = _kept(keep, options.seed)
    return _told(options, results, time.monotonic() - began)


def _both(options, keep):
    """Run both kinds of scenes, each in a process."""
    each = []
    for kind in KINDS:
        settings = os.environ | ({'NUMBA_DISABLE_JIT': '1'} if kind == 'plain' else {})
        each.append(subprocess.Popen(
            [sys.executable, __file__, '--only', kind, '--keep', str(keep), '--seed',
             str(options.seed), '--count', str(options.count), '--first', str(options.first),
             *['--new'] * options.new, *['--slowing'] * options.slowing,
             *['--let-go'] * options.let_go], env=settings))
    for process in each:
        process.wait()


def _run(options):
    """Run the scenes of one kind that are not kept yet, and keep them."""
    from random_scenes.judge import judged
    results = _kept(options.keep, options.seed)
    draw = (slowing.drawn if options.slowing else let_go.drawn if options.let_go else
            new_language.drawn if options.new else drawn)
    for number in range(options.first, options.first + options.count):
        if number in results or _kind(draw(number, options.seed)[0]) != options.only:
            continue
        result = judged(number, options.seed, draw)
        print('\n'.join(line for line, *_ in result), flush=True)
        with options.keep.open('a') as file:
            file.write(json.dumps([options.seed, number, result]) + '\n')
    return 0


def _kind(text):
    acts = text[text.index('constraint:'):text.index('initial:')]
    return 'plain' if any(word in acts for word in COMPILES_LONG) else 'compiled'


def _kept(path, seed):
    """Return the results of a run before, number -> what judge.judged returns."""
    if not path or not path.exists():
        return {}
    rows = [json.loads(line) for line in path.read_text().splitlines()]
    return {number: result for own, number, result in rows if own == seed}


def _told(options, results, seconds):
    """Print a summary of the verdicts; return the exit status."""
    numbers = range(options.first, options.first + options.count)
    whole = [results[number] for number in numbers if len(results.get(number, ())) > 1]
    for rows in zip(*whole, strict=True):
        met, fits, balanced = (sum(column) for column in zip(*(row[1:] for row in rows),
                                                             strict=True))
        print(f'{met} of {len(rows)} met, {fits} foretold within a factor of 3, '
              f'{balanced} ledgers balanced')
    bad = [line for number in numbers for line, *good in results.get(number, ()) if not all(good)]
    missing = sum(number not in results for number in numbers)
    print('\n'.join(['what failed:', *bad] if bad else ['nothing failed']))
    print(f'{len(numbers) - len(whole) - missing} scenes raised or hung, {missing} did not run; '
          f'{seconds:.0f} s')
    return 1 if bad or missing else 0


if __name__ == '__main__':
    sys.exit(main())
