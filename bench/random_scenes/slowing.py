# SPDX-License-Identifier: Apache-2.0
"""Random scenes of bodies that drag or dry friction brings to rest, long before they end."""

import json

import numpy as np

from random_scenes.chance import Chance

TURNS = 60.0    # rad, about: what a body turns until it is slow
CONSTRAINTS = {'free': 4, 'pivot': 3, 'hinge': 3}
LATER = 1.0, 300.0    # duration over the time in which the body slows down
SLOWERS = ('number', 'number', 'matrix', 'square', 'dry')


def drawn(number, seed):
    """Return (YAML text, duration in s) of a random scene."""
    chance = Chance(f'{seed} {number} slowing')
    between, vector = chance.between, chance.vector
    constraint = chance.choices([*CONSTRAINTS], [*CONSTRAINTS.values()])[0]
    mass, size, spin = between(0.01, 10.0), between(0.02, 2.0), between(0.1, 100.0)
    a, b, c = (chance.uniform(0.2, 1.0) for _ in range(3))
    if chance.random() < 0.3:
        b = a
    inertia = [mass * size * size * x for x in (b * b + c * c, a * a + c * c, a * a + b * b)]
    slow = TURNS / spin * between(0.03, 1.0)    # s
    rate, effects, axis = 1.0 / slow, [], vector(1.0)
    place = [0.0, 0.0, 0.0]
    if constraint != 'free' and chance.random() < 0.6:
        place = vector(0.5 * size)
        weight = (0.3 * spin) ** 2 * size    # it swings at less than the spin
        effects.append(f'gravity: {{g: {weight!r}}}')
    slower = chance.choice(SLOWERS)
    if slower == 'dry' and constraint != 'hinge':
        slower = 'number'
    moment = min(inertia)
    parameters = {'k': moment * rate / spin, 'w0': spin}
    match slower:
        case 'dry':
            effects.append(f'dry_friction: {{torque: {moment * spin * rate!r}}}')
        case 'number':
            effects.append(f'drag: {{angular: {moment * rate!r}, linear: 0}}')
        case 'matrix':
            m = np.array([vector(1.0) for _ in range(3)])
            matrix = moment * rate * (m @ m.T + 0.5 * np.eye(3))
            matrix = 0.5 * (matrix + matrix.T)
            effects.append(f'drag: {{angular: {matrix.tolist()}, linear: 0}}')
        case 'square':
            speed = 'sqrt(wx^2 + wy^2 + wz^2)'
            torque = json.dumps([f'{-x!r}*k*abs(rate)*rate' for x in axis]
                                if constraint == 'hinge' else
                                [f'-k*{speed}*w{x}' for x in 'xyz'])
            effects.append(f'torque: {{value: {torque}, frame: body, books: heat}}')
    held, start = constraint, f'euler: {vector(1.0)}, angular_velocity: {vector(spin)}'
    if constraint == 'hinge':
        held = f'{{hinge: {{axis: {axis}}}}}'
        start = f'angle: {chance.uniform(-1.0, 1.0)!r}, rate: {spin!r}'
    return (f'scene: slowing_{number}\nparameters: {json.dumps(parameters)}\n'
            f'body: {{mass: {mass!r}, inertia: {inertia}, center_of_mass: {place}}}\n'
            f'constraint: {held}\neffects: [{", ".join(effects)}]\n'
            f'initial: {{{start}}}\n'), slow * between(*LATER)
