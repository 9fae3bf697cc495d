# SPDX-License-Identifier: Apache-2.0
"""Speed beside another version, or on another processor: closed forms, ensembles, stepped scenes.

    .venv/bin/python bench/beside.py ../other [--turns 5] [--only closed_forms stepped]
    .venv/bin/python bench/beside.py avx2

OTHER is a clone of this repository at another commit, or a processor (generic, avx2, avx512) that
numba then compiles for. Its processes and those of this tree take turns, with this tree first in
every other turn, on one machine with the same Python. A figure is the least time of all turns; the
ratio is that of the least times, and the range is that of the ratios of single turns. The exit
status is 1 if a ratio to another version is above LOST.

closed_forms and ensembles are the benches of each tree; stepped scenes run by the public interface
(the CPU time of a body over 20 s, its start included, and of a state every millisecond).
"""

import argparse
import datetime
import json
import os
import pathlib
import platform
import subprocess
import sys
import tempfile
import time

import numpy as np

TREE = pathlib.Path(__file__).resolve().parents[1]
LOST = 1.03
BENCHES = ('closed_forms', 'ensembles', 'stepped')
TOP = """scene: top
body: {mass: 1.0, inertia: [0.02, 0.025, 0.006], center_of_mass: [0.01, -0.015, 0.1]}
constraint: pivot
effects: [gravity: {g: 9.81}]
initial: {tilt: 0.6, angular_velocity: [1.0, -2.0, 40.0]}
"""
DRIVEN = """scene: driven
body: {mass: 1.0, inertia: [1.0, 1.5, 2.2]}
constraint: free
effects: [torque: {value: [0.3, -0.2, 0.5], frame: world}]
initial: {angular_velocity: [0.4, 3.0, 0.2]}
"""
METHODS = ('taylor', 'dop8', 'gauss16')
ACCURACIES = (1e-6, 1e-11)
BODIES, DURATION, REPEATS = 16, 20.0, 7


def stepped():
    """Return {row: least CPU seconds} of the tree that PYTHONPATH names, by its public names."""
    from rigid_body_sim import Simulation, ensemble, load_scene

    acts = {}
    for kind, text in (('top', TOP), ('driven', DRIVEN)):
        with tempfile.NamedTemporaryFile('w', suffix='.yaml') as file:
            file.write(text)
            file.flush()
            scene = load_scene(file.name)
        starts = np.tile(scene.initial.vector, (BODIES, 1))
        starts[:, 5:8] *= 1.0 + 0.01 * np.arange(BODIES)[:, np.newaxis]
        for method in METHODS:
            for accuracy in ACCURACIES:
                acts[f'{kind} by {method} to {accuracy:g}: a body'] = (
                    lambda scene=scene, starts=starts, method=method, accuracy=accuracy:
                    ensemble(scene, starts, [DURATION], method, accuracy), BODIES)
            times = np.arange(20_001) / 1000.0

            def dense(scene=scene, method=method, times=times):
                Simulation(scene, method, accuracy=1e-9).states(times)

            acts[f'{kind} by {method}: a state every ms'] = dense, len(times)
    found = {}
    for name, (act, count) in acts.items():
        act()
        least = np.inf
        for _ in range(REPEATS):
            begin = time.process_time()
            act()
            least = min(least, (time.process_time() - begin) / count)
        found[name] = least
    return found


def run(tree, settings, bench, more=()):
    """Return {row: least seconds} of a bench in a tree, with settings of the environment."""
    script = TREE / 'bench' / 'beside.py' if bench == 'stepped' else (
        tree / 'bench' / f'{bench}.py')
    words = ['--measure'] if bench == 'stepped' else ['--json']
    path = os.pathsep.join(filter(None, (str(tree), os.environ.get('PYTHONPATH'))))
    done = subprocess.run([sys.executable, script, *words, *more], cwd=tree, capture_output=True,
                          text=True, env=os.environ | settings | {'PYTHONPATH': path})
    if done.returncode:
        sys.exit(f'{tree}: {bench}: {done.stderr.strip().splitlines()[-1]}')
    found = json.loads(done.stdout)
    if bench == 'closed_forms':
        return {row: times['least'] for row, times in found['seconds'].items()}
    if bench == 'ensembles':
        return {row: 1.0 / rate for row, rate in found.items()}
    return found


def compare(other, settings, bench, turns):
    """Print a table of a bench; return the rows that lost."""
    ours, theirs, lost, more = {}, {}, [], ()
    if bench == 'closed_forms' and other != TREE:
        from closed_forms import SCENES  # not at the top: --measure runs in other trees
        # as many scenes as there: with more of them less of their states stays in the caches
        kinds = {row.partition(':')[0] for row in run(other, settings, bench)}
        more = '--only', *(kind for kind in SCENES if kind in kinds)
    for turn in range(turns):
        sides = (TREE, {}, ours, more), (other, settings, theirs, ())
        for tree, wanted, table, words in sides if turn % 2 == 0 else sides[::-1]:
            for row, seconds in run(tree, wanted, bench, words).items():
                table.setdefault(row, []).append(seconds)
    print(f'{bench:46} {"here, us":>10} {"other, us":>10}  ratio  of single turns')
    for row in ours:
        if row in theirs:
            a, b = np.array(ours[row]), np.array(theirs[row])
            ratio, single = a.min() / b.min(), a / b
            print(f'  {row:44} {a.min() * 1e6:10.3f} {b.min() * 1e6:10.3f} {ratio:6.3f}  '
                  f'{single.min():.3f} to {single.max():.3f}', flush=True)
            if ratio > LOST:
                lost.append(row)
    return lost


def main():
    """Compare two trees, or two processors."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    if '--measure' in sys.argv:    # in another tree, which may have other rooms than this one
        print(json.dumps(stepped()))
        return 0
    from rigid_body_sim.compilation.environment import processor
    from rigid_body_sim.study.machines.targets import TARGETS
    parser.add_argument('other', help=f'a clone at another commit, or {", ".join(TARGETS)}')
    parser.add_argument('--turns', type=int, default=5)
    parser.add_argument('--only', nargs='+', choices=BENCHES, default=BENCHES)
    options = parser.parse_args()
    settings = TARGETS.get(options.other, {})
    other = TREE if settings else pathlib.Path(options.other).resolve()
    print(f'{processor().split()[0]}, {platform.python_version()}, {datetime.date.today()}; '
          f'other: {options.other}')
    lost = [row for bench in options.only
            for row in compare(other, settings, bench, options.turns)]
    if settings:
        return 0
    print(f'Lost more than {LOST - 1:.0%}:', ', '.join(lost) or 'none')
    return int(bool(lost))


if __name__ == '__main__':
    sys.exit(main())
