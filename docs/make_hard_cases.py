# SPDX-License-Identifier: Apache-2.0
"""Make docs/hard_cases.md and its figure from the output of `hard_cases --peers --json`.

The path of that output is the only argument.

::

    .venv-peers/bin/python -m rigid_body_sim hard_cases --peers --json > hard_cases.json
    .venv/bin/python docs/make_hard_cases.py hard_cases.json
"""

import datetime
import json
import os
import pathlib
import sys

import matplotlib
import numpy as np

matplotlib.use('Agg')
import matplotlib.pyplot as plt

from rigid_body_sim.compilation import environment
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.study.hard_cases.beside import PATIENCE

DOCS = pathlib.Path(__file__).resolve().parent
HEAD = """# Which cases are hard, and what they do to general simulators

`python -m rigid_body_sim hard_cases` runs them all and exits with 1 if one of ours fails; with
`--peers` the programs of `requirements/peers.txt` run beside it. `make study-full` makes this
page. An empty cell means that the peer was not asked.

Ours is the error at the worst reference time (at least 34 digits, up to 1e6 s), beside the bound
that the problem allows: the round-off floor and the effect of conditioning. Peers run as their
users run them, with steps of 1 ms or a tolerance of 1e-12, and are asked at one earlier time only
(`at`). Their cells give the error in the unit of that column (3.1 rad is upside down), or what
they say: "no answer" within 20 s, "NaN" without a warning, "refuses", "fails". For contact the
engines use their own models, and the integrators Coulomb's law as their user writes it
(`study/hard_cases/sliding_ball.py`); opposite impulses are added to omega as they come.
"""
WORDS = {'NaN in silence': 'NaN', f'no answer in {PATIENCE:g} s': 'no answer'}
TAIL = """
## Energy is no proof

![Energy error and attitude error of RK4 beside the separatrix over 60 s](images/hard_cases.png)

*RK4 with steps of 1 ms, one ulp beside the separatrix of I = (3, 4, 6): the energy error stays at
round-off, but the attitude is wrong by {late:.0e} rad after 40 s and by {most:.0e} rad when the
body turns over. Only a reference shows it, so every case here is compared with one, or with a law
that a wrong state breaks.*
"""
LONG = """
## What takes long

Measured by the parts of `make soak` in `test/hard_cases` on 2 cores of an AMD EPYC (Zen 5), 21
November 2026, random scenes not to their full number. The short forms run in every `make test`.

| what | how much | found |
| --- | --- | --- |
| free body, anchored: slope of norm, energy, L^2 | 1e8 ticks, a day at 1 kHz, 21 s of CPU \
| 1.6 of 5 sigma |
| heavy top, anchored: slope of norm, energy, p_alpha, p_gamma | 1e8 ticks, 27 s | 1.5 of 5 sigma |
| free body, anchored anew at each tick: mean step of the walk | 1e8 ticks, 51 s | 1.3 of 5 sigma |
| mutated scene files | 100,000, 3 min | a tenth are scenes, the others get one line |
| random scenes under random commands | 5,500 of 40,000 \
| residuals: 2.0 (energy), 2.8 (momentum) of 8 ulp |
| kernels with one sign or term wrong | 13, 5 min | each is found out by its test |
| scenes that ship, methods, commands: the bits | other processors, libraries, Pythons \
| [the same bits on every machine](machines.md) |

These defects were found and mended. Three files ended in a traceback (a centre of mass 1e308 m
away, a hinge 1e160 m away, a moment of 5e-324 kg m^2 under a torque), and one in NaN (a strike of
1e308 N s). Versions of Python disagreed in `sum()` of floats, which keeps what it rounds away from
3.12 on, so a body of three parts had another mass there. On round bodies, or where little accuracy
was asked for, dissipation was followed in steps of its own rate for ever, because the rate ended
at once and the steps chattered on that edge; now it dies away smoothly. One case is still slow: a
strong dissipation of a body nearly round about its largest axis, which keeps a wobble alive
(I = (1, 2, 2 + 1e-9) at c dt = 1000: 4e5 steps a second).
"""


def main(path):
    """Write the page and the figure."""
    found = json.loads(pathlib.Path(path).read_text())
    names = list(next((row['peers'] for row in found['cases'] if row['peers']), {}))
    lines = [HEAD]
    for group in dict.fromkeys(row['group'] for row in found['cases']):
        rows = [row for row in found['cases'] if row['group'] == group]
        asked = [name for name in names if any(row['peers'].get(name, '') != '' for row in rows)]
        lines += [f'## {group.capitalize()}\n',
                  _row(['case', 'why it is hard', 'ours', 'bound', *(['at'] if asked else []),
                        *asked])]
        lines.append(_row(['---'] * (4 + bool(asked) + len(asked))))
        for row in rows:
            peers = [_peer(row['peers'].get(name, '')) for name in asked]
            at = ([f'{row["peer_time"]:g} s, {row["peer_unit"]}' if row['peers'] else '']
                  if asked else [])
            mark = '' if row['good'] else ' **fails**'
            lines.append(_row([
                row['case'], row['why'], f'{row["error"]:.1e} {row["unit"]}{mark}',
                f'{row["bound"]:.1e}', *at, *peers]))
        lines.append('')
    if found['peers_not_installed']:
        lines.append(f'Not installed for this run: {", ".join(found["peers_not_installed"])}.\n')
    now = datetime.datetime.now(datetime.UTC)
    lines.append(f'Made on {os.cpu_count()} cores of a {environment.processor().split()[0]}, '
                 f'{now.day} {now:%B %Y}.\n')
    late, most = figure()
    DOCS.joinpath('hard_cases.md').write_text(
        '\n'.join(lines) + TAIL.format(late=late, most=most) + LONG)


def _row(cells):
    return f'| {" | ".join(cells)} |'


def _peer(value):
    return WORDS.get(value, value.partition(':')[0]) if isinstance(value, str) else f'{value:.0e}'


def figure():
    """Draw energy and attitude errors of RK4 beside the separatrix; return two of the latter.

    Those after 40 s and at most, rad.
    """
    scene = parse_scene('scene: beside\nbody: {mass: 1.0, inertia: [3.0, 4.0, 6.0]}\n'
                        'constraint: free\neffects: []\n'
                        'initial: {angular_velocity: [2.0, 0.7, 1.0000000000000002]}\n')
    times = np.linspace(0.05, 60.0, 1200)
    exact, stepped = Simulation(scene), Simulation(scene, 'rk4', step=1e-3)
    truth, found = exact.states(times), stepped.states(times)
    energy = np.abs(exact.diagnose(found)[0] / exact.energy - 1.0)
    wrong = [angle_between(*p, *q)
             for p, q in zip(truth.orientation, found.orientation, strict=True)]
    axes = plt.figure(figsize=(8.0, 3.6), layout='constrained').gca()
    axes.semilogy(times, wrong, color='tab:red', label='attitude (rad)')
    axes.semilogy(times, np.maximum(energy, 1e-17), '.', ms=2, color='tab:blue',
                  label='energy (relative)')
    axes.set(xlabel='time (s)', ylabel='error of RK4, 1 ms', ylim=(1e-17, 10.0), xlim=(0.0, 60.0))
    axes.legend(loc='center left')
    axes.grid(alpha=0.3)
    plt.gcf().savefig(DOCS / 'images' / 'hard_cases.png', dpi=120)
    return wrong[np.searchsorted(times, 40.0)], max(wrong)


if __name__ == '__main__':
    main(sys.argv[1])
