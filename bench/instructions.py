# SPDX-License-Identifier: Apache-2.0
"""Instructions of a step, counted by callgrind: what a scene does not list costs nothing.

    .venv/bin/python bench/instructions.py [--json]

Counts are repeatable where times are not. Every case is counted with all effects in the table of
effects, and with only those that its scene lists, as in a program that cannot know the others. A
count is the difference between 2 N and N steps, so that the cost of a start cancels. One more
scene lists drag besides and must take more; otherwise the counting would miss effects. All code is
compiled for a generic x86-64, because callgrind does not know the newest instructions. The
benchmark takes a minute. Then effects in expressions are counted beside the same ones written by
hand: a step may take 1.3 times as many. The exit status is 1 if an absent effect costs more than
1 %, a listed one less, or an expression more than 1.3. It needs valgrind; without it nothing is
counted, and one line says so.
"""

import argparse
import gc
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np

from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.scene.effects import EFFECTS
from rigid_body_sim.scene.scene import parse_scene

TOP = """scene: counted
body: {mass: 1.0, inertia: [0.03, 0.02, 0.01], inertia_about: origin, center_of_mass: [0, 0, 0.1]}
constraint: pivot
effects: [gravity: {g: 9.81}]
initial: {tilt: 0.5, angular_velocity: [0, 0, 60]}
"""
DRIVEN = """scene: counted
body: {mass: 1.0, inertia: [1.0, 2.0, 3.0]}
constraint: free
effects: [torque: {value: [0.03, -0.02, 0.05]}]
initial: {angular_velocity: [0.1, 2.0, 0.3]}
"""
DRAGGED = TOP.replace('}]\n', '}, drag: {linear: 0.5, angular: 0.01}]\n')
# an effect in expressions beside the same one written by hand, on the body's axes and on others
WRITTEN = {
    'drag': (DRIVEN.replace('}]\n', '}, drag: {angular: 0.01}]\n'),
             DRIVEN.replace('}]\n', "}, torque: {value: ['-0.01*wx', '-0.01*wy', '-0.01*wz'], "
                                     'books: heat}]\n')),
    'weight': (TOP, TOP.replace('gravity: {g: 9.81}', "potential: {energy: "
                                "'0.981*(qw^2 - qx^2 - qy^2 + qz^2)'}")),
    'drag, skew axes': tuple(
        text.replace('[1.0, 2.0, 3.0]', '[[1, 0.1, 0.2], [0.1, 2, 0.3], [0.2, 0.3, 2.5]]')
        for text in (DRIVEN.replace('}]\n', '}, drag: {angular: 0.01}]\n'),
                     DRIVEN.replace('}]\n', "}, torque: {value: ['-0.01*wx', '-0.01*wy', "
                                             "'-0.01*wz'], books: heat}]\n")))}
STEP, STEPS = 1e-3, 20_000
ALLOWED = 0.01
WRITTEN_ALLOWED = 1.3
DRAG_COSTS = 'a step of dop8, asymmetric heavy top with drag'


def steps(text):
    """Return act(n), which takes n steps of dop8 from the start."""
    scene, out = parse_scene(text), np.empty(14)
    solver = Stepped(scene, 'dop8', step=STEP)

    def act(n):
        solver.start(scene.initial.vector).state(n * STEP, out)
    return act


# name: (scene, effects that it lists)
CASES = {'a step of dop8, asymmetric heavy top': (TOP, ('gravity',)),
         'a step of dop8, driven body': (DRIVEN, ('torque',)),
         DRAG_COSTS: (DRAGGED, ('gravity', 'drag'))}
KNOWN = 'all', 'listed'
MADE = 'by hand', 'expressed'


def march(control):
    """Run every case; `control(*arguments)` talks to callgrind."""
    every = dict(EFFECTS)
    gc.disable()
    for number, (text, listed) in enumerate(CASES.values()):
        for known in KNOWN:
            for name in [name for name in every if known == 'listed' and name not in listed]:
                del EFFECTS[name]
            act = steps(text)
            # the first call loads more, and a long one more than a short one
            for label, count in (('first', STEPS), ('once', STEPS), ('twice', 2 * STEPS)):
                control('-z')
                act(count)
                control(f'--dump={number}.{known}.{label}')
            EFFECTS.clear()
            EFFECTS.update(every)
    for name, texts in WRITTEN.items():
        for made, text in zip(MADE, texts, strict=True):
            act = steps(text)
            for label, count in (('first', STEPS), ('once', STEPS), ('twice', 2 * STEPS)):
                control('-z')
                act(count)
                control(f'--dump={_plain(name)}.{_plain(made)}.{label}')


def _plain(name):
    """Return a name as a dump may have it."""
    return re.sub(r'\W+', '_', name)


def callgrind_control(*arguments):
    """Send arguments to the callgrind that runs this process."""
    subprocess.run(['callgrind_control', *arguments, str(os.getpid())], check=True,
                   stdout=subprocess.DEVNULL)


def counted():
    """Return {case: {known: instructions}}."""
    environment = os.environ | {'NUMBA_CPU_NAME': 'generic', 'NUMBA_CPU_FEATURES': '',
                                'PYTHONHASHSEED': '0'}
    # The start-up code of the ROS wheels has already run this Python anew, so its child is not
    # run anew under valgrind.
    child = [sys.executable, __file__, '--march']
    subprocess.run([*child, 'alone'], env=environment, check=True)    # this run compiles
    with tempfile.TemporaryDirectory() as folder:
        valgrind = ['valgrind', '--quiet', '--tool=callgrind', '--instr-atstart=no',
                    f'--callgrind-out-file={folder}/out']
        subprocess.run([*valgrind, *child, 'counted'], env=environment, check=True,
                       stderr=subprocess.DEVNULL)
        totals = {}
        for path in pathlib.Path(folder).glob('out.*'):
            profile = path.read_text()
            label = re.search(r'^desc: Trigger: dump (\S+)', profile, re.MULTILINE)
            if label:
                totals[label.group(1)] = int(
                    re.search(r'^totals: (\d+)', profile, re.MULTILINE).group(1))
    def one(key):
        return (totals[f'{key}.twice'] - totals[f'{key}.once']) / STEPS
    return ({case: {known: one(f'{number}.{known}') for known in KNOWN}
             for number, case in enumerate(CASES)},
            {name: {made: one(f'{_plain(name)}.{_plain(made)}') for made in MADE}
             for name in WRITTEN})


def main():
    """Count and print; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--json', action='store_true')
    parser.add_argument('--march', choices=('alone', 'counted'), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.march:
        control = callgrind_control if options.march == 'counted' else lambda *_: None
        control('--instr=on')
        march(control)
        return 0
    if shutil.which('valgrind') is None:
        print('Instructions not counted: valgrind is not installed (apt install valgrind)')
        return 0
    counts, written = counted()
    worst = max(abs(count['all'] / count['listed'] - 1.0) for count in counts.values())
    drag = counts[DRAG_COSTS]['all'] / next(iter(counts.values()))['all'] - 1.0
    dearest = max(one['expressed'] / one['by hand'] for one in written.values())
    good = worst <= ALLOWED < drag and dearest <= WRITTEN_ALLOWED
    if options.json:
        print(json.dumps({'instructions': counts, 'worst': worst, 'allowed': ALLOWED,
                          'drag_costs': drag, 'expressed': written, 'good': good}))
    else:
        print(f'{"instructions, effects known:":52}{"all":>12}{"listed ones":>12}'
              f'{"ratio - 1":>12}')
        for case, count in counts.items():
            print(f'{case:52}{count["all"]:>12.1f}{count["listed"]:>12.1f}'
                  f'{count["all"] / count["listed"] - 1.0:>+12.3%}')
        print(f'drag, once listed, costs {drag:+.1%}')
        print(f'{"instructions, an effect:":52}{"by hand":>12}{"expressed":>12}{"ratio":>12}')
        for name, count in written.items():
            print(f'{"a step of dop8, " + name:52}{count["by hand"]:>12.1f}'
                  f'{count["expressed"]:>12.1f}{count["expressed"] / count["by hand"]:>12.3f}')
    return int(not good)


if __name__ == '__main__':
    sys.exit(main())
