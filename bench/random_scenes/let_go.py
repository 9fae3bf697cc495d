# SPDX-License-Identifier: Apache-2.0
"""Random scenes of bodies that begin at rest: let go, or turned by a torque and stopped again.

Nothing at the start tells how fast they will turn, and springs, potentials and expressions have no
bounds. Half of the torsion springs swing so often that even looks would see them turn back only.
"""

import json
import math

import numpy as np

from random_scenes.chance import Chance

KINDS = {'torsion': 3, 'spring': 3, 'potential': 2, 'weight': 1, 'stopped': 3}
PERIOD = 0.05, 5.0              # s
OFTEN = 16, 32, 64, 96, 128     # periods that repeat with 64 even looks
PERIODS = 3.0, 60.0
SHORTEST = 1e-6                 # share of the time between two pulses that a pulse takes at least


def drawn(number, seed):
    """Return (YAML text, duration in s) of a random scene."""
    chance = Chance(f'{seed} {number} let go')
    between, vector = chance.between, chance.vector
    kind = chance.choices([*KINDS], [*KINDS.values()])[0]
    mass, size, period = between(0.01, 10.0), between(0.02, 2.0), between(*PERIOD)
    a, b, c = (chance.uniform(0.2, 1.0) for _ in range(3))
    inertia = [mass * size * size * x for x in (b * b + c * c, a * a + c * c, a * a + b * b)]
    rate, duration = math.tau / period, period * between(*PERIODS)
    held, place, start = 'pivot', [0.0, 0.0, 0.0], f'euler: {vector(1.0)}'
    match kind:
        case 'torsion':
            axis = vector(1.0)
            moment = float(np.array(axis) ** 2 @ inertia)
            held, start = f'{{hinge: {{axis: {axis}}}}}', f'angle: {chance.uniform(0.2, 1.5)!r}'
            if chance.random() < 0.5:
                duration = period * chance.choice(OFTEN)
            effect = f'spring: {{stiffness: {moment * rate * rate!r}}}'
        case 'spring':
            stiffness = min(inertia) * rate * rate / (size * size)
            effect = (f'spring: {{at: {vector(size)}, anchor: {vector(2.0 * size)}, '
                      f'stiffness: {stiffness!r}}}')
        case 'potential':
            energy = min(inertia) * rate * rate
            effect = 'potential: ' + json.dumps({'energy': f'{energy!r}*(qx^2 + 0.3*qy*qw)'})
        case 'weight':
            place = vector(0.5 * size)
            effect = f'gravity: {{g: {rate * rate * size!r}}}'
        case 'stopped':
            held = chance.choice(['free', 'pivot'])
            effect, last = _pulses(chance, min(inertia) * rate, period)
            duration = last * between(1.0, 100.0)
    return (f'scene: let_go_{number}\n'
            f'body: {{mass: {mass!r}, inertia: {inertia}, center_of_mass: {place}}}\n'
            f'constraint: {held}\neffects: [{effect}]\ninitial: {{{start}}}\n'), duration


def _pulses(chance, momentum, period):
    """Return a torque that gives a body a momentum (kg m^2/s) and takes it back; its end, s."""
    gap = period * chance.between(0.1, 3.0)
    long = gap * chance.between(SHORTEST, 1.0)
    # a body that is pushed about one of its axes is at rest again in the end; any other tumbles on
    push = [0.0, 0.0, 0.0]
    push[chance.randrange(3)] = momentum / long
    if chance.random() < 0.3:
        push = chance.vector(momentum / long)
    begin = period * chance.random()
    times = [begin, begin + long, begin + long + gap, begin + 2.0 * long + gap]
    none = [0.0, 0.0, 0.0]
    values = [push, none, [-x for x in push], none]
    return f'torque: {{times: {times}, values: {values}, frame: body}}', times[-1]
