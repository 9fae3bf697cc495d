# SPDX-License-Identifier: Apache-2.0
"""Random scenes of a convex body on a plane: YAML text and duration by seed and number."""

import json
import math

import numpy as np

from random_scenes.chance import Chance

SURFACES = 'sphere', 'ellipsoid', 'torus', 'disk'
LASTS = 4.0, 25.0        # times of a fall by the size of the body, s over s
G = 9.81
IN_WORDS = ("torque: {value: ['-k*T*wx/w0', '0.3*T*sin(w0*t)', 0], frame: body}",
            "force: {value: ['0.1*f*cos(w0*t)', 0, '0.05*f*sin(k*t)'], frame: world}",
            "potential: {energy: '0.02*f/s*(x^2 + k*y^2)'}")


def drawn(number, seed, slim=False):
    """Return (YAML text, duration in s) of a random scene.

    With `slim` the body is an ellipsoid whose least moment is 1e-6 to 1e-4 of the others, and its
    surface is turned against the principal axes.
    """
    chance = Chance(f'plane {seed} {number} {slim}')
    mass, size = chance.between(0.01, 10.0), chance.between(0.02, 0.5)
    surface, inertia = _body(chance, mass, size, slim)
    speed, fall = math.sqrt(G * size), math.sqrt(size / G)
    duration = round(chance.between(*LASTS) * fall, 3)
    if slim:    # the contact spins a slim body up at once
        least, *_, most = np.linalg.eigvalsh(inertia)
        duration = round(5.0 * duration * math.sqrt(least / most), 5)
    mu = chance.choice((0.0, math.inf, *(chance.uniform(0.02, 1.0) for _ in range(6))))
    laws, plane = _laws(chance, mass, size, speed, surface, mu), {}
    if chance.random() < 0.4:
        plane['normal'] = [chance.uniform(-0.35, 0.35), chance.uniform(-0.35, 0.35), 1.0]
    if chance.random() < 0.5:
        plane['restitution'] = chance.uniform(0.0, 0.95)
    effects = [f'gravity: {{g: {G}}}', *laws, *_more(chance, mass, size, speed, inertia, duration)]
    least = float(min(np.linalg.eigvalsh(inertia)))
    parameters = {'k': chance.uniform(0.2, 2.0), 'w0': chance.uniform(0.2, 2.0) / fall,
                  's': size, 'f': mass * G, 'T': 0.1 * least / fall ** 2}
    return (f'scene: plane_{number}\nparameters: {json.dumps(parameters)}\n'
            f'body: {{mass: {mass!r}, inertia: {json.dumps(inertia.tolist())}, '
            f'surface: {json.dumps(surface)}}}\n'
            f'constraint: {"{table: " + json.dumps(plane) + "}" if plane else "{table: {}}"}\n'
            f'effects: [{", ".join(effects)}]\n'
            f'initial: {_start(chance, plane, size, speed, mu, surface)}\n'), duration


def _body(chance, mass, size, slim):
    """Return the surface of a body, and its tensor."""
    kind = 'ellipsoid' if slim else chance.choice(SURFACES)
    offset = [size * chance.uniform(-0.3, 0.3) for _ in range(3)]
    center = chance.choice(([0.0, 0.0, 0.0], [0.0, 0.0, offset[2]], offset))
    semi = [size * chance.uniform(0.3, 1.0) for _ in range(3)]
    surface = {'sphere': {'radius': size, 'center': center},
               'ellipsoid': {'semi_axes': semi, 'center': center},
               'torus': {'radius': size, 'tube': size * chance.uniform(0.05, 0.5)},
               'disk': {'radius': size}}[kind]
    a, b, c = (chance.uniform(0.2, 1.0) ** 2 for _ in range(3))
    moments = np.array([b + c, c + a, a + b]) * mass * size * size / 5.0
    if slim:
        least = chance.between(1e-6, 1e-4)
        moments = np.array([1.0, 1.0 + 0.9 * least * chance.random(), least])
        moments *= mass * size * size / 5.0
    if kind in ('torus', 'disk') or chance.random() < 0.3:
        moments[0] = moments[1]
        if moments[2] > 2.0 * moments[0]:
            moments[2] = 1.9 * moments[0]
    tensor = np.diag(moments)
    if slim or (kind in ('sphere', 'ellipsoid') and chance.random() < 0.6):
        turn = chance.turn()
        tensor = turn @ tensor @ turn.T
        tensor = (tensor + tensor.T) / 2.0
    return {kind: surface}, tensor


def _laws(chance, mass, size, speed, surface, mu):
    """Return the laws of contact as YAML."""
    laws = [f'sliding_friction: {{mu: {".inf" if math.isinf(mu) else repr(mu)}}}'] if mu else []
    damping = mass * speed / size
    if chance.random() < 0.35:
        which = chance.choice(({'dry': chance.between(1e-3, 0.1)},
                               {'viscous': damping * chance.between(1e-3, 0.1)},
                               {'dry': chance.between(1e-3, 0.1),
                                'viscous': damping * chance.between(1e-3, 0.1)}))
        laws.append(f'rolling_friction: {json.dumps(which)}')
    if 0.0 < mu < math.inf and chance.random() < 0.35:
        laws.append(f'spinning_friction: {{radius: {size * chance.between(0.01, 0.2)!r}}}')
    if 'disk' in surface and chance.random() < 0.4:
        laws.append(f'air_film: {{viscosity: {damping / size * chance.between(1e-3, 0.03)!r}}}')
    return laws


def _more(chance, mass, size, speed, inertia, duration):
    """Return what else acts, as YAML: drag, springs, strikes, effects in the scene's words."""
    effects, least = [], float(min(np.linalg.eigvalsh(inertia)))
    rate = speed / size
    if chance.random() < 0.2:
        effects.append(f'drag: {{linear: {mass * rate * chance.between(1e-3, 0.1)!r}, '
                       f'angular: {least * rate * chance.between(1e-3, 0.1)!r}, '
                       f'quadratic: {mass / size * chance.between(1e-3, 0.05)!r}}}')
    if chance.random() < 0.2:
        length = chance.choice(('', f', length: {size * chance.uniform(0.2, 1.0)!r}'))
        effects.append(f'spring: {{at: {chance.vector(0.3 * size)}, '
                       f'anchor: {[*chance.vector(2.0 * size)[:2], 3.0 * size]}, '
                       f'stiffness: {mass * rate * rate * chance.between(0.01, 0.5)!r}, damping: '
                       f'{mass * rate * chance.choice((0.0, chance.between(1e-3, 0.1)))!r}'
                       f'{length}}}')
    if chance.random() < 0.12:
        effects.append(chance.choice(IN_WORDS))
    effects += [
        f'strike: {{impulse: {chance.vector(mass * speed * chance.between(0.1, 1))}, point: '
        f'{chance.vector(0.5 * size)}, time: {chance.uniform(0.0, duration)!r}}}'
        for _ in range(chance.choice((0, 0, 0, 1, 2)))]
    return effects


def _start(chance, plane, size, speed, mu, surface):
    """Return the start as YAML: in flight, sliding or rolling."""
    low, high = (0.25, 1.4) if 'disk' in surface or 'torus' in surface else (0.05, 3.0)
    angles = [chance.uniform(0.05, 3.0), chance.uniform(low, high), chance.uniform(0.05, 3.0)]
    parts = [f'euler_zyz: {angles}']
    spin = speed / size * chance.between(0.1, 8.0)
    parts.append(f'angular_velocity: {chance.vector(spin)}')
    how = chance.choice(('flight', 'touching', 'touching', 'rolling'))
    if how == 'rolling' and mu > 0.0:
        return f'{{{", ".join(parts)}, rolling: true}}'
    x, y, z = chance.vector(speed * chance.between(0.05, 2.0))
    if how == 'flight':
        normal = plane.get('normal', [0.0, 0.0, 1.0])
        high = size * chance.uniform(2.0, 4.0) / math.sqrt(sum(a * a for a in normal))
        parts += [f'velocity: {[x, y, z]}', f'position: {[high * a for a in normal]}']
    else:
        parts.append(f'velocity: {[x, y, 0.0]}')
    return f'{{{", ".join(parts)}}}'
