# SPDX-License-Identifier: Apache-2.0
"""What the package promises of random convex bodies on a plane, beside a truth.

    .venv/bin/python bench/plane_random.py [--seed 11] [--count 100] [--first 0] [--keep FILE]
                                           [--slim]

Scenes are drawn from the whole language of the plane (random_scenes/plane_draw.py): spheres whose
centre of mass is off the middle, ellipsoids with turned tensors, tori, disks with a sharp edge; on
level and inclined planes; mu from 0 to 1 and infinite, restitution, rolling and spinning friction,
films of air, drag, springs, strikes, expressions; starts in flight, sliding and rolling. With
--slim the bodies are ellipsoids with moments of 1e-6 to 1e-4 of the others about skew axes.

The truth shares no formula with the package: Newton and Euler in the world frame with 64-bit
mantissas, its own contact and its own events (random_scenes/plane_truth.py). It says where it
does not know: low rings, grazes, several directions in which a slip may begin, and events that
half an ulp decides. `auto`, dop8, taylor and gauss16 run each scene at two accuracies in plain
Python (the bits are the same), in a process of its own. With --keep a run that was stopped
resumes. Exit 1 unless in each run

    the error at 24 times is at most max(asked, 3 floor), for `auto`; a named method may tell more,
    the expected error is within a factor of 3 of max(error, floor), or nothing is told,
    the ledger's residuals are below max(asked, floor) times 10,
    the events are those of the truth, with their times,
    nothing hangs (900 s for a scene and its truth) and nothing is raised but a refusal in a line.
"""

import os

os.environ['NUMBA_DISABLE_JIT'] = '1'

import argparse
import json
import multiprocessing
import pathlib
import sys
import time

import numpy as np
from random_scenes.plane_judge import judged
from random_scenes.wide import WIDE

LONGEST = 900    # s of a scene
VERDICTS = 'met', 'foretold within a factor of 3', 'ledgers balanced', 'lists of events right'


def main():
    """Measure and print; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--seed', type=int, default=11)
    parser.add_argument('--count', type=int, default=100)
    parser.add_argument('--first', type=int, default=0)
    parser.add_argument('--keep', type=pathlib.Path, help='lines of JSON: what is in it stands')
    parser.add_argument('--slim', action='store_true', help='slim bodies about skew axes')
    options = parser.parse_args()
    if np.finfo(WIDE).nmant < 63:
        print('no 80-bit numbers here: nothing to compare with')
        return 0
    print(f'{"":5}{"scene":44}{"s":>7}{"asked":>8}{"method":>12}{"expected":>9}{"error":>9}'
          f'{"floor":>9}{"ledger":>9}{"late":>9}  n', flush=True)
    began, results = time.monotonic(), _kept(options.keep, [options.seed, options.slim])
    for number in range(options.first, options.first + options.count):
        if number not in results:
            results[number] = _within(number, options)
            print('\n'.join(line for line, *_ in results[number]), flush=True)
            if options.keep:
                with options.keep.open('a') as file:
                    file.write(json.dumps([[options.seed, options.slim], number,
                                           results[number]]) + '\n')
    numbers = range(options.first, options.first + options.count)
    return _told([results[number] for number in numbers], time.monotonic() - began)


def _within(number, options):
    """Judge a scene in a process of its own, which is ended if it takes too long."""
    context = multiprocessing.get_context('fork')
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(
        target=lambda: sender.send(judged(number, options.seed, options.slim)))
    process.start()
    found = [(f'{number:4} takes more than {LONGEST} s  HANGS', 'raised', ())]
    if receiver.poll(LONGEST):
        try:
            found = receiver.recv()
        except EOFError:
            found = [(f'{number:4} its process has ended  RAISED', 'raised', ())]
    process.kill()
    process.join()
    return found


def _kept(path, own):
    """Return the results of a run before, number -> what plane_judge.judged returns."""
    if not path or not path.exists():
        return {}
    rows = [json.loads(line) for line in path.read_text().splitlines()]
    return {number: result for of, number, result in rows if of == own}


def _told(results, seconds):
    """Print a summary of the verdicts; return the exit status."""
    rows = [row for result in results for row in result]
    for kind in 'auto', 'named':
        verdicts = [row[2] for row in rows if row[1] == kind]
        print(f'{kind}: {len(verdicts)} runs, ' + ', '.join(
            f'{sum(map(bool, column))} {what}'
            for what, column in zip(VERDICTS, zip(*verdicts, strict=True), strict=False)))
    others = {kind: sum(row[1] == kind for row in rows)
              for kind in ('refused', 'unknown', 'senseless', 'raised')}
    print(', '.join(f'{count} scenes {kind}' for kind, count in others.items()))
    partly = sum(any('known until' in row[0] for row in result) for result in results)
    print(f'{partly} scenes known to the truth up to some time only; {seconds:.0f} s')
    bad = [row[0] for row in rows if not all(row[2]) or row[1] == 'raised']
    print('\n'.join(['what failed:', *bad] if bad else ['nothing failed']))
    return 1 if bad else 0


if __name__ == '__main__':
    sys.exit(main())
