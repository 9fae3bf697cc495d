# SPDX-License-Identifier: Apache-2.0
"""Random scenes of all constraints and effects, with extreme numbers, run in plain Python.

``python fuzzed_scenes.py FIRST END`` prints a line for each seed: refused, gave up, or runs and
the method. Bodies, effects and starts are said in all ways of the scene language. Some scenes get
commands, and some are interrupted at a random time and go on to the same bits.

Plain Python compiles nothing; it is a hundred times slower, so marches are bounded to a hundredth
of their work. Every scene is given SECONDS of the processor, after which an alarm interrupts it: a
run that goes on ignores interrupts and has no bound.
"""

import json
import math
import random
import signal
import sys
import time
import warnings

import numpy as np

from rigid_body_sim.choice import rounding, runs, trial_runs, trial_time
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.integrators.families import scipy_methods
from rigid_body_sim.integrators.marching import contact_course, switched, work
from rigid_body_sim.mechanics import events, quadrature
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

EXTREMES = (0.0, 1e-70, 1e-30, 1e-9, 1e-3, 1.0, 1e3, 1e6, 1e15, 1e40, 1e74)
OUTSIDE = 1e-310, 1e-160, 1e160, 1e308    # most keys refuse them
SHARE = 0.1      # share of the numbers that are extremes
FAR = 0.003      # share of the numbers that are outside
SECONDS = 30
TICKS = 3


class Slow(Exception):
    """A scene took longer than SECONDS."""


class Interrupt(BaseException):
    """What a KeyboardInterrupt would be."""


def number(source, signed=True):
    """Return an extreme or a usual number."""
    chance = source.random()
    size = (source.choice(OUTSIDE) if chance < FAR
            else source.choice(EXTREMES) if chance < SHARE
            else 10.0 ** source.uniform(-3.0, 3.0))
    return size * (source.choice((1, -1)) if signed else 1)


def vector(source):
    """Return three numbers."""
    return [number(source) if source.random() < 0.8 else 0.0 for _ in range(3)]


def moments(source):
    """Return moments of slim, nearly symmetric and other bodies."""
    a, b = 10.0 ** source.uniform(-3.0, 1.0), 10.0 ** source.uniform(-3.0, 1.0)
    return source.choice((
        [a, a, a * source.choice((1e-310, 1e-100, 1e-12, 1e-6, 1e-4, 1.0, 1.99))],
        [a, a * (1.0 + 1e-9), a * 10.0 ** source.uniform(-8.0, -3.0)],
        [number(source, signed=False)] * 3, [number(source, signed=False) for _ in range(3)],
        [a, b, max(a, b)], [a, b, abs(a - b) + source.random() * (a + b - abs(a - b))]))


EXPRESSIONS = ('-k*wx', '0.1*sin(w0*t)', 'k*tanh(Wz/w0)', 'exp(-t)*qx', 'k/(1 + x^2)', '-k*vy^3',
               'sqrt(k*k + y*y)', 'log(k)*qw', 'k*cos(z)', 'max(wx, wy) - k', 'abs(Wx)', 'k^0.5',
               'w0/(x - k)', 'tan(k*t)', 'where(z < k, -w0*z, 0)', 'k*sign(sin(w0*t))',
               '-k*sign(wz)', 'min(k*qx, w0)*(qy >= 0)', '-k*wy*abs(wy)')
OF_HINGE = ('-k*sin(angle)', '-k*rate', 'k*sign(rate)', 'where(angle > k, w0, -w0)',
            'max(rate, 0)*k', 'k*qx', 'w0*exp(wz)', 'abs(angle)')
ENERGIES = ('0.5*k*(z - 1)^2', 'k*qx^2*qw', '-k/sqrt(x^2 + y^2 + z^2)', 'k*cos(x*w0)', 'k*log(z)',
            'exp(k*y)', 'w0*(qx*qz - qy*qw)')


def positive(source):
    """Return a number that is not negative."""
    return number(source, signed=False)


def expressions(source, texts=EXPRESSIONS):
    """Return three numbers or expressions."""
    return [source.choice(texts) if source.random() < 0.5 else number(source) for _ in range(3)]


def torque(source, kind):
    """Return a torque that stays, comes in pieces, or is an expression."""
    more = {'frame': source.choice(('body', 'world'))}
    if source.random() < 0.5:
        more['books'] = source.choice(('work', 'heat'))
    texts = OF_HINGE if kind == 'hinge' else EXPRESSIONS
    times = source.choice(([0.001, 0.5], sorted((positive(source), positive(source))), [0.0]))
    return {'torque': source.choice((
        {'value': vector(source)}, {'value': expressions(source, texts)},
        {'times': times, 'values': [vector(source) for _ in times]})) | more}


def force(source, kind):
    """Return a force, at the centre of mass or at a point."""
    at = {'at': vector(source)} if source.random() < 0.5 else {}
    texts = OF_HINGE if kind == 'hinge' else EXPRESSIONS
    return {'force': {'value': expressions(source, texts),
                      'frame': source.choice(('body', 'world')),
                      'books': source.choice(('work', 'heat'))} | at}


def potential(source, kind):
    """Return a potential."""
    texts = (*ENERGIES, 'k*angle^2') if kind == 'hinge' else ENERGIES
    return {'potential': {'energy': source.choice(texts)}}


def spring(source, _):
    """Return a spring with or without length and damping."""
    more = {key: positive(source) for key in ('damping', 'length') if source.random() < 0.5}
    return {'spring': {'at': vector(source), 'anchor': vector(source),
                       'stiffness': positive(source)} | more}


def magnetic(source, _):
    """Return a moment in a field."""
    field = source.choice((vector(source), [0, 'k*z', 'w0 - k*y^2'], ['k*sin(w0*t)', 1.0, 0]))
    return {'magnetic': {'moment': vector(source), 'field': field}}


def strike(source, kind):
    """Return a strike at the start, in the third tick, or at any time."""
    found = {'impulse': vector(source), 'time': source.choice((0.0, 0.002, positive(source)))}
    if kind == 'table':
        found['impulse'][2] = 0.0
        place = source.choice(({'height': number(source)}, {'point': vector(source)}, {}))
        return {'strike': source.choice((found, {'speed': number(source)})) | place}
    places = [{'point': vector(source)}, {'point': vector(source)}, {}]
    if kind == 'hinge':
        places.append({'distance': number(source)})
    return {'strike': found | source.choice(places)
            | {'frame': source.choice(('body', 'world'))}}


def gravity(source, kind):
    """Return a weight, by its size or as a vector; above a plane a vector is refused."""
    share = 0.05 if kind == 'plane' else 0.3
    return {'gravity': {'g': vector(source) if source.random() < share else positive(source)}}


def gravity_gradient(source, _):
    """Return the pull of a distant body, at a place or on an orbit."""
    if source.random() < 0.5:
        return {'gravity_gradient': {'mu': positive(source), 'position': vector(source)}}
    normal, toward = source.choice((([0, 0, 1], [1, 2, 0]), ([1, 1, 0], [1, -1, 3])))
    return {'gravity_gradient': {'orbit': {'rate': number(source), 'normal': normal,
                                           'toward': toward}}}


def inner(source, _):
    """Return internal dissipation."""
    return {'internal_dissipation': {'coefficient': positive(source)}}


def matrix(source):
    """Return a coefficient of drag: a number, or a symmetric matrix that takes energy."""
    if source.random() < 0.6:
        return positive(source)
    a, b, c = positive(source), positive(source), positive(source)
    share = source.choice((0.0, 0.5, 1.0)) * math.sqrt(a) * math.sqrt(b)
    return [[a, share, 0.0], [share, b, 0.0], [0.0, 0.0, c]]


def drag(source, _):
    """Return a drag of one to four coefficients."""
    keys = source.choice((('linear', 'angular'), ('linear', 'angular'), ('quadratic',),
                          ('linear', 'angular', 'quadratic', 'angular_quadratic')))
    return {'drag': {key: matrix(source) for key in keys}}


def rotor(source, _):
    """Return a flywheel whose motor keeps its speed, or that turns freely, or under a torque."""
    return {'rotor': {'axis': vector(source)} | source.choice((
        {'momentum': number(source)}, {'inertia': positive(source), 'rate': number(source)},
        {'inertia': positive(source), 'rate': number(source), 'torque': number(source)}))}


def torsion(source, _):
    """Return a torsion spring."""
    more = {key: make(source) for key, make in (('damping', positive), ('angle', number))
            if source.random() < 0.5}
    return {'spring': {'stiffness': positive(source)} | more}


HELD = {gravity: 0.5, drag: 0.3, strike: 0.3, rotor: 0.15, magnetic: 0.15, potential: 0.15,
        spring: 0.15, force: 0.15}
"""Effects under every constraint but the ball's table: what makes each, and its weight."""
ACTING = {
    'free': HELD | {inner: 0.3, gravity_gradient: 0.15},
    'pivot': HELD | {inner: 0.15},
    'hinge': HELD | {torsion: 0.2,
                     lambda source, _: {'dry_friction': {'torque': positive(source)}}: 0.2},
    'table': {
        lambda source, _: {'sliding_friction': {'mu': positive(source), 'g': positive(source)}}: 1,
        strike: 0.3},
    'plane': {one: 0.4 * often for one, often in HELD.items()} | {
        gravity: 0.9, gravity_gradient: 0.05,
        lambda source, _: {'sliding_friction': {
            'mu': source.choice((positive(source), math.inf))}}: 0.7,
        lambda source, _: {'rolling_friction': {'dry': positive(source),
                                                'viscous': positive(source)}}: 0.2,
        lambda source, _: {'spinning_friction': {'radius': positive(source)}}: 0.2,
        lambda source, _: {'air_film': {'viscosity': positive(source)}}: 0.1}}


def effects(source, kind):
    """Return a list of effects that the constraint can have, several torques at once too."""
    found = [make(source, kind) for make, often in ACTING[kind].items() if source.random() < often]
    torques = {'table': (0,), 'plane': (0, 0, 0, 1)}.get(kind, (0, 0, 1, 2))
    return found + [torque(source, kind) for _ in range(source.choice(torques))]


SHAPES = {'rod': ('length',), 'lamina': ('width', 'height'), 'hoop': ('radius',),
          'disk': ('radius',), 'spherical_shell': ('radius',), 'solid_sphere': ('radius',),
          'cylinder': ('radius', 'length'), 'cone': ('radius', 'height'),
          'torus': ('radius', 'tube')}


def shape(source):
    """Return a shape."""
    name = source.choice((*SHAPES, 'box', 'ellipsoid'))
    three = {'box': 'size', 'ellipsoid': 'semi_axes'}.get(name)
    return {name: {three: [positive(source) for _ in range(3)]} if three else
            {key: positive(source) for key in SHAPES[name]}}


def body(source):
    """Return a body by moments, a tensor, a shape or parts."""
    center = source.choice(([0, 0, 0], [0, 0, number(source)], vector(source)))
    given = {'mass': positive(source), 'center_of_mass': center}
    a, b, c = moments(source)
    turned = [[0.36 * a + 0.64 * b, 0.48 * (a - b), 0.0],
              [0.48 * (a - b), 0.64 * a + 0.36 * b, 0.0], [0.0, 0.0, c]]
    solid = {'shape': shape(source), source.choice(('mass', 'density')): positive(source)}
    return source.choice((
        given | {'inertia': [a, b, c]}, given | {'inertia': [a, b, c]},
        given | {'inertia': turned},
        given | {'inertia': [a, b, c], 'inertia_about': 'origin',
                 'center_of_mass': [0, 0, 1e-3 * number(source)]},
        solid | ({'center_of_mass': center} if source.random() < 0.5 else {}),
        {'parts': [{'mass': positive(source), 'point': vector(source)},
                   {'mass': positive(source), 'inertia': moments(source), 'at': vector(source)},
                   {'density': positive(source), 'shape': {'box': {'size': [0.1, 1.0, 0.02]}},
                    'orientation': [0.1, 0.2, 0.3, 1.0]}]},
        {'parts': [{'mass': 2.0, 'shape': shape(source)},
                   {'mass': -0.1 * positive(source), 'shape': shape(source),
                    'at': [0.0, 0.0, 0.01]}]}))


def surface(source):
    """Return the body of one that has a surface, on a table."""
    a, b, c = (10.0 ** source.uniform(-2.0, 0.0) for _ in range(3))
    if source.random() < 0.2:
        a = positive(source)
    mass = positive(source)
    return source.choice((
        {'mass': mass, 'shape': {'ellipsoid': {'semi_axes': [a, b, c]}}},
        {'density': mass, 'shape': {'ellipsoid': {'semi_axes': [a, a, c]}}},
        {'mass': mass, 'shape': {'disk': {'radius': a}}},
        {'mass': mass, 'shape': {'hoop': {'radius': a}}},
        {'mass': mass, 'shape': {'torus': {'radius': a, 'tube': b}}},
        {'mass': mass, 'inertia': moments(source), 'center_of_mass': [0, 0, 0.1 * number(source)],
         'surface': {'sphere': {'radius': a}}},
        {'mass': mass, 'inertia': moments(source), 'center_of_mass': vector(source),
         'surface': {'ellipsoid': {'semi_axes': [a, b, c], 'center': [0, 0, 0.1 * c]}}}))


def orientation(source):
    """Return a way to say the orientation."""
    def turn():
        return [source.uniform(-4.0, 4.0) for _ in range(3)]
    return source.choice((
        {'orientation': [source.uniform(-1.0, 1.0) for _ in range(4)]}, {'euler_zyz': turn()},
        {'euler': turn()}, {'rotation_vector': source.choice((turn(), vector(source)))},
        {'tilt': number(source)}, {}))


def turning(source):
    """Return a way to say the angular velocity."""
    return source.choice((
        {'angular_velocity': vector(source)}, {'angular_velocity': vector(source)},
        {'angular_velocity_world': vector(source)}, {'angular_momentum': vector(source)},
        {'spin': number(source)}, {}))


def scene(seed):
    """Return the scene of a seed as plain data."""
    source = random.Random(seed)
    kind = source.choices(('free', 'pivot', 'hinge', 'table', 'plane'), (4, 4, 3, 1, 1))[0]
    found = {'scene': 'fuzzed', 'constraint': kind, 'effects': effects(source, kind),
             'parameters': {'k': number(source), 'w0': number(source)}}
    if kind == 'table':
        return found | {'body': {'mass': positive(source),
                                 'shape': {'solid_sphere': {'radius': positive(source)}}},
                        'initial': {'angular_velocity': vector(source),
                                    'velocity': [number(source), number(source), 0.0]}}
    start = orientation(source) | turning(source)
    if kind == 'plane':
        plane = source.choice(({}, {'restitution': source.random()},
                               {'normal': [number(source), 0.1, 1.0]}))
        moving = source.choice(({'rolling': True}, {'velocity': vector(source)},
                                {'position': [0, 0, 10.0 * positive(source)]}))
        return found | {'constraint': {'table': plane}, 'body': surface(source),
                        'initial': start | moving}
    found['body'] = body(source)
    if kind == 'hinge':
        axis = [source.uniform(-1.0, 1.0) for _ in range(3)]
        through = source.choice(({'through': vector(source)}, {'distance': number(source)}, {}))
        turned = orientation(source)
        return found | {'constraint': {'hinge': {'axis': axis} | through},
                        'initial': ({} if 'tilt' in turned else turned)
                        | {'rate': number(source), 'angle': number(source)}}
    if kind == 'pivot' and source.random() < 0.3:
        path = [source.choice((0, 'k*cos(w0*t)', '0.01*sin(300*t)', 'k*t', 'exp(-w0*t)'))
                for _ in range(3)]
        found['constraint'] = {'pivot': source.choice((
            {'at': vector(source)}, {'motion': path}, {'motion': path, 'at': vector(source)}))}
    if kind == 'free':
        start |= {'velocity': vector(source), 'position': vector(source)}
    elif source.random() < 0.2:
        start |= {'position': vector(source)}
    return found | {'initial': start}


def commands(source):
    """Return the commands of a tick, as calls of a Simulation."""
    def pushes():
        return {key: vector(source) for key in ('force', 'torque') if source.random() < 0.6} | {
            'frame': source.choice(('body', 'world'))}
    return [source.choice((('impulse', pushes()), ('hold', pushes()), ('release', {})))
            for _ in range(source.choice((1, 1, 2, 4)))]


def commanded(simulation, given):
    """Give a simulation the commands of a tick; one that is refused has no effect."""
    for name, settings in given:
        before = simulation.vector.copy()
        try:
            getattr(simulation, name)(**settings)
        except BadInput as refusal:
            in_one_line(refusal)
            assert simulation.vector.tobytes() == before.tobytes()


def interrupted(read, vector, seconds):
    """Interrupt a scene after some seconds of the processor; it goes on to the same state."""
    simulation = None
    left, _ = signal.setitimer(signal.ITIMER_VIRTUAL, max(seconds, 1e-6))
    signal.signal(signal.SIGVTALRM, interrupt)
    try:
        simulation = Simulation(read)
        for _ in range(TICKS):
            simulation.advance()
    except Interrupt:
        pass
    finally:
        signal.signal(signal.SIGVTALRM, alarm)
        signal.setitimer(signal.ITIMER_VIRTUAL, left)
    simulation = simulation or Simulation(read)
    simulation.advance(TICKS - simulation.tick)
    assert simulation.vector.tobytes() == vector.tobytes(), (simulation.vector, vector)


def in_one_line(refusal):
    """Return the text of a refusal, which is one line."""
    text = str(refusal)
    assert text.isprintable() and len(text) < 2000 and 'np.' not in text, text
    return text


def outcome(seed):
    """Return what becomes of a scene: refused, gave up, or runs and the method."""
    read, source = None, random.Random(f'{seed} run')
    does = source.choices(('nothing', 'commands', 'interrupt'), (6, 3, 2))[0]
    try:
        text = json.dumps(scene(seed)).replace('Infinity', '.inf')
        read, began = parse_scene(text), time.process_time()
        simulation = Simulation(read)
        for _ in range(TICKS):
            if does == 'commands':
                commanded(simulation, commands(source))
            simulation.advance()
            assert np.isfinite(simulation.vector).all(), simulation.vector
        if does == 'interrupt':
            seconds = source.random() * (time.process_time() - began)
            interrupted(parse_scene(text), simulation.vector, seconds)
        ledger = simulation.ledger()
        assert np.isfinite([*ledger.values()]).all(), ledger
        states = simulation.states(np.linspace(0.0, 10.0, 5)).vector
        assert np.isfinite(states).all(), states
    except (BadInput, NotConverged) as refusal:
        return f'{"refused" if read is None else "gave up"}: {in_one_line(refusal)}'
    return f'runs: {simulation.choice.method}'


def alarm(*_):
    """End a scene that takes too long."""
    raise Slow


def interrupt(*_):
    """Interrupt what runs, as the keyboard does."""
    raise Interrupt


def main(first, end):
    """Run the scenes of the seeds from the first to the end; return the exit status."""
    warnings.simplefilter('ignore')    # plain Python warns where compiled code makes inf
    work.FIRST_LOOK, work.MOST, work.PATIENCE, contact_course.EVENT = 16, 50.0, 1e4, 4
    switched.DEAR = scipy_methods.COST = work.SLOWER = 1
    quadrature.MOST, quadrature.EVENLY = 2 ** 10, 2 ** 4
    trial_runs.STEPS, trial_runs.STEPS_PER_RADIAN, trial_runs.FEW = 20, 5, 2
    events.LOOKS_A_TICK = 20
    trial_time.RADIANS = 0.5
    rounding.SIGNS, rounding.MOVED, runs.LOOKS = rounding.SIGNS[:1], rounding.MOVED[:1], 3
    signal.signal(signal.SIGVTALRM, alarm)
    bad = 0
    for seed in range(first, end):
        signal.setitimer(signal.ITIMER_VIRTUAL, SECONDS)
        began = time.process_time()
        try:
            found = outcome(seed)
        except Exception as error:
            found, bad = f'{type(error).__name__}: {error}', bad + 1
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        print(seed, f'{time.process_time() - began:.2f} s', found.replace('\n', ' '), flush=True)
    return min(bad, 1)


if __name__ == '__main__':
    sys.exit(main(*map(int, sys.argv[1:])))
