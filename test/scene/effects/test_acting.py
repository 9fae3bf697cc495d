# SPDX-License-Identifier: Apache-2.0
"""The force and the torque of every effect at random states, by hand in world axes.

The body has principal axes and a centre of mass askew to its origin; it is free, held at its
origin, carried there on a path, or on an axis beside it. What expressions know is worked out from
the motion of the origin.
"""

import importlib
import typing

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.effects.gravity import Gravity
from rigid_body_sim.scene.effects.internal_dissipation import ENDED
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene

TENSOR = [[0.3, 0.01, 0.02], [0.01, 0.4, -0.03], [0.02, -0.03, 0.5]]
CENTER = np.array([0.1, -0.2, 0.3])
MASS = 2.0
THROUGH = np.array([0.2, 0.1, -0.1])
CONSTRAINTS = {'free': 'free', 'pivot': 'pivot',
               'carried': "{pivot: {motion: ['sin(k*t)', 't^2', '0.3*t']}}",
               'hinge': f'{{hinge: {{axis: [1, 2, 2], through: {THROUGH.tolist()}}}}}'}
POINTS = {'free': CENTER, 'pivot': np.zeros(3), 'carried': np.zeros(3), 'hinge': THROUGH}
PUSHED = 'free', 'carried'    # forces count


class Now(typing.NamedTuple):
    """A state: time, turn body -> world, omega (body), place and velocity of the origin."""

    t: float
    turn: Rotation
    omega: np.ndarray
    place: np.ndarray
    velocity: np.ndarray

    def names(self):
        """Return what expressions know."""
        world = self.turn.apply(self.omega)
        known = dict(zip(('qx', 'qy', 'qz', 'qw'), self.turn.as_quat(), strict=True), t=self.t)
        for letters, values in (('wx wy wz', self.omega), ('Wx Wy Wz', world),
                                ('x y z', self.place), ('vx vy vz', self.velocity)):
            known |= zip(letters.split(), values, strict=True)
        return known

    def at(self, point):
        """Return the place and the velocity of a point of the body (body axes)."""
        arm = self.turn.apply(point)
        return self.place + arm, self.velocity + np.cross(self.turn.apply(self.omega), arm)


def drawn(kind, seed):
    draw = np.random.default_rng(seed)
    turn, omega = Rotation.random(random_state=seed), draw.normal(size=3)
    place, velocity = draw.normal(size=(2, 3))
    if kind not in PUSHED:    # the held point stays in the world's origin
        arm = turn.apply(POINTS[kind])
        place, velocity = -arm, -np.cross(turn.apply(omega), arm)
    return Now(float(draw.uniform(0.1, 2.0)), turn, omega, place, velocity)


def scene_of(effects, kind):
    return parse_scene(
        f'scene: s\nparameters: {{k: 1.7}}\nbody: {{mass: {MASS}, inertia: {TENSOR}, '
        f'center_of_mass: {CENTER.tolist()}}}\nconstraint: {CONSTRAINTS[kind]}\n'
        f'effects: [{effects}]\ninitial: {{}}\n')


def function(kernel):
    """Return a kernel as plain Python: compiling each one takes longer than all of this."""
    module, _, name = kernel.partition(':')
    found = getattr(importlib.import_module(module), name)
    return getattr(found, 'py_func', found)


def pushed(effect, frame, now, time=None):
    """Return force (at the centre of mass) and torque (about the point of reference), in world."""
    total = {'force': np.zeros(3), 'torque': np.zeros(3)}
    turn = now.turn * Rotation.from_quat(frame.axes)
    omega = Rotation.from_quat(frame.axes).inv().apply(now.omega)
    # what is not `in_field` is given the velocity of the point of reference, if it moves
    velocity = now.at(frame.point)[1] if frame.pushed else np.zeros(3)
    for one in effect.acting(frame, now.t if time is None else time):
        more = (now.t, *now.at(frame.point)[0]) if one.in_field else ()
        found = function(one.kernel)(*one.values, *turn.as_quat(), *omega,
                                     *velocity, *more)
        total[one.gives] += turn.apply(found) if one.gives == 'torque' else found
    return total['force'], total['torque']


def energy(effect, frame, now):
    one = effect.potential(frame)
    turn = now.turn * Rotation.from_quat(frame.axes)
    return function(one.kernel)(*one.values, *turn.as_quat(), *now.at(CENTER)[0])


def at_point(now, point, force, kind):
    """Return force and torque (world) of a force at a point of the body."""
    torque = np.cross(now.turn.apply(np.subtract(point, POINTS[kind])), force)
    return (np.array(force) if kind in PUSHED else np.zeros(3)), torque


def weight(now, kind):
    return at_point(now, CENTER, [0.0, 0.0, -9.81 * MASS], kind)


def field(now, kind, g=(1.0, 2.0, -9.0)):
    return at_point(now, CENTER, MASS * np.array(g), kind)


def rotor(now, kind, momentum=1.5, motor=0.0):
    axis, omega = now.turn.apply([2.0, -1.0, 2.0]) / 3.0, now.turn.apply(now.omega)
    return np.zeros(3), -(momentum + motor * now.t) * np.cross(omega, axis) - motor * axis


def dry_friction(now, kind):
    axis = np.array([1.0, 2.0, 2.0]) / 3.0
    return np.zeros(3), -0.4 * np.sign(axis @ now.omega) * now.turn.apply(axis)


def linear_drag(now, kind):
    return at_point(now, CENTER, -0.7 * now.at(CENTER)[1], kind)


def angular_drag(now, kind):
    return np.zeros(3), -0.3 * now.turn.apply(now.omega)


def both_drags(now, kind):
    return tuple(a + b for a, b in zip(linear_drag(now, kind), angular_drag(now, kind),
                                       strict=True))


def shaped_drags(now, kind):
    """Return the same with matrices, in body axes, and with squares."""
    v, omega = now.turn.inv().apply(now.at(CENTER)[1]), now.omega
    force = -(np.array(MATRIX) + 0.4 * np.linalg.norm(v) * np.eye(3)) @ v
    couple = -(0.2 * np.eye(3) + np.linalg.norm(omega) * np.array(MATRIX)) @ omega
    pushed, moment = at_point(now, CENTER, now.turn.apply(force), kind)
    return pushed, moment + now.turn.apply(couple)


def body_torque(now, kind):
    return np.zeros(3), now.turn.apply([1.0, -2.0, 3.0])


def world_torque(now, kind):
    return np.zeros(3), np.array([1.0, -2.0, 3.0])


def formula(now):
    n = now.names()
    return np.array([n['wx'] * n['qy'] - 1.7, np.sin(n['Wz']) + n['qw'] ** 2, 2.0 - n['Wx']])


def formula_in_field(now):
    n = now.names()
    more = n['x'] * n['vy'], n['t'] * n['vz'] - n['y'], n['z'] * n['vx']
    return np.add(formula(now), more)


FORMULA = ['wx*qy - k', 'sin(Wz) + qw^2', '2 - Wx']
IN_FIELD = [f'{one} + {more}' for one, more in zip(
    FORMULA, ('x*vy', 't*vz - y', 'z*vx'), strict=True)]
AT = np.array([0.4, -0.1, 0.7])


def text(formulas):
    return str(formulas).replace("'", '"')


def spring(now, kind, length=0.0, damping=0.0):
    place, velocity = now.at(AT)
    d = place - [1.0, 0.5, -2.0]
    size = np.linalg.norm(d)
    force = -3.0 * (size - length) * d / size
    along = velocity @ d / size ** 2 * d if length else velocity
    return at_point(now, AT, force - damping * along, kind)


def gradient(now, kind):
    n = now.turn.inv().apply([2.0, -1.0, 2.0]) / 3.0
    return np.zeros(3), now.turn.apply(np.cross(n, np.array(TENSOR) @ n) * 3.0 * 5.0 / 27.0)


ORBIT = 'gravity_gradient: {orbit: {rate: 1.3, normal: [1, 2, -2], toward: [4, -4, -2]}}'


def gradient_on_orbit(now, kind):
    """Return that with mu/r^3 = rate^2, by the directions toward and normal x toward."""
    turned = 1.3 * now.t
    world = np.cos(turned) * np.array([2.0, -2.0, -1.0]) - np.sin(turned) * np.array([2, 1, 2])
    n = now.turn.inv().apply(world) / 3.0
    return np.zeros(3), now.turn.apply(np.cross(n, np.array(TENSOR) @ n) * 3.0 * 1.3 ** 2)


def magnet(now, kind):
    m = now.turn.apply([0.2, -0.5, 1.1])
    return np.zeros(3), np.cross(m, [0.3, 0.1, -0.7])


def magnet_in_field(now, kind):
    """B = (x y, z^2, k x): F = grad (m . B) at the body's origin."""
    m, (x, y, z) = now.turn.apply([0.2, -0.5, 1.1]), now.place
    force, moment = at_point(now, np.zeros(3), [
        m[0] * y + m[2] * 1.7, m[0] * x, 2.0 * m[1] * z], kind)
    return force, moment + np.cross(m, [x * y, z * z, 1.7 * x])


MATRIX = [[0.5, 0.1, -0.2], [0.1, 0.7, 0.05], [-0.2, 0.05, 0.9]]
SHAPED = f'drag: {{linear: {MATRIX}, quadratic: 0.4, angular: 0.2, angular_quadratic: {MATRIX}}}'
AS_NUMBERS = (f'drag: {{linear: {np.diag([0.7] * 3).tolist()}, '
              f'angular: {np.diag([0.3] * 3).tolist()}}}')
HERE = 'at: [0.4, -0.1, 0.7]'
SPRING = 'spring: {at: [0.4, -0.1, 0.7], anchor: [1, 0.5, -2], stiffness: 3'
ROTOR = 'rotor: {axis: [4, -2, 4], momentum: 1.5}'
EVERYWHERE, NO_AXIS, FREE = (*CONSTRAINTS,), ('free', 'pivot', 'carried'), ('free',)
CASES = {
    'gravity: {g: 9.81}': (weight, EVERYWHERE),
    'gravity: {g: [1, 2, -9]}': (field, EVERYWHERE),
    **{f'gravity: {{g: {g}}}': (lambda now, kind, g=g: field(now, kind, g), FREE)
       for g in ([0, 0, 9], [0, 2, -9], [1, 0, -9], [0, 0, -0.5])},
    ROTOR: (rotor, EVERYWHERE),
    'rotor: {axis: [4, -2, 4], inertia: 0.5, rate: 3, torque: 0.7}': (
        lambda now, kind: rotor(now, kind, 1.5, 0.7), EVERYWHERE),
    'rotor: {axis: [4, -2, 4], inertia: 0.5, rate: 3}': (rotor, FREE),
    'dry_friction: {torque: 0.4}': (dry_friction, ('hinge',)),
    'drag: {linear: 0.7}': (linear_drag, EVERYWHERE),
    'drag: {angular: 0.3}': (angular_drag, EVERYWHERE),
    'drag: {linear: 0.7, angular: 0.3}': (both_drags, EVERYWHERE),
    AS_NUMBERS: (both_drags, EVERYWHERE),
    SHAPED: (shaped_drags, EVERYWHERE),
    'torque: {value: [1, -2, 3]}': (body_torque, EVERYWHERE),
    'torque: {value: [1, -2, 3], frame: world}': (world_torque, EVERYWHERE),
    f'torque: {{value: {text(FORMULA)}}}': (
        lambda now, kind: (np.zeros(3), now.turn.apply(formula(now))), EVERYWHERE),
    f'torque: {{value: {text(IN_FIELD)}, frame: world}}': (
        lambda now, kind: (np.zeros(3), formula_in_field(now)), NO_AXIS),
    'force: {value: [1, -2, 3]}': (
        lambda now, kind: at_point(now, CENTER, now.turn.apply([1.0, -2.0, 3.0]), kind),
        EVERYWHERE),
    f'force: {{value: {text(FORMULA)}, {HERE}}}': (
        lambda now, kind: at_point(now, AT, now.turn.apply(formula(now)), kind), EVERYWHERE),
    f'force: {{value: {text(IN_FIELD)}, {HERE}, frame: world}}': (
        lambda now, kind: at_point(now, AT, formula_in_field(now), kind), NO_AXIS),
    f'{SPRING}}}': (spring, NO_AXIS),
    f'{SPRING}, length: 0.8}}': (
        lambda now, kind: spring(now, kind, 0.8), NO_AXIS),
    f'{SPRING}, damping: 0.6}}': (
        lambda now, kind: spring(now, kind, 0.0, 0.6), NO_AXIS),
    f'{SPRING}, length: 0.8, damping: 0.6}}': (
        lambda now, kind: spring(now, kind, 0.8, 0.6), NO_AXIS),
    'gravity_gradient: {mu: 5, position: [2, -1, 2]}': (gradient, FREE),
    ORBIT: (gradient_on_orbit, FREE),
    'magnetic: {moment: [0.2, -0.5, 1.1], field: [0.3, 0.1, -0.7]}': (magnet, EVERYWHERE),
    'magnetic: {moment: [0.2, -0.5, 1.1], field: ["x*y", "z^2", "k*x"]}': (
        magnet_in_field, NO_AXIS),
}
PLACES = [(effects, kind) for effects, (_, kinds) in CASES.items() for kind in kinds]


@pytest.mark.parametrize(('effects', 'kind'), PLACES)
def test_what_acts_is_what_the_formula_says(effects, kind):
    scene = scene_of(effects, kind)
    effect, frame = scene.effects[0], scene.frame
    for seed in range(3):
        now = drawn(kind, seed)
        for found, expected in zip(pushed(effect, frame, now), CASES[effects][0](now, kind),
                                   strict=True):
            assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize('effects', ['gravity_gradient: {mu: 5, position: [2, -1, 2]}', ORBIT])
def test_a_gradient_turns_a_body_on_a_plane_as_a_free_one(effects):
    """Its frame there has not the principal axes."""
    scene = parse_scene(
        f'scene: s\nbody: {{mass: {MASS}, inertia: {TENSOR}, surface: {{sphere: {{radius: 1}}}}'
        '}\nconstraint: {table: {}}\neffects: [gravity: {g: 9.8}, sliding_friction: {mu: 0.2}, '
        f'{effects}]\ninitial: {{}}\n')
    for seed in range(3):
        now = drawn('free', seed)
        _, found = pushed(scene.effect('gravity_gradient'), scene.frame, now)
        assert found == pytest.approx(CASES[effects][0](now, 'free')[1], rel=1e-12, abs=1e-12)


@pytest.mark.parametrize(('effects', 'kind'), [*PLACES, ('wrench', 'free'), ('wrench', 'pivot')])
def test_what_is_told_of_each_force_is_true_of_it(effects, kind):
    """Along a line through the space of its arguments the differences of a polynomial end."""
    scene = scene_of('' if effects == 'wrench' else effects, kind)
    wrench = Wrench((1.0, -2.0, 3.0), (0.5, 0.7, -0.2), 'body')
    effect = wrench if effects == 'wrench' else scene.effects[0]
    begin, way = np.random.default_rng(3).normal(size=(2, 14))
    binomial = np.array([1, -8, 28, -56, 70, -56, 28, -8, 1])
    for one in effect.acting(scene.frame, 1.0):
        kernel, count = function(one.kernel), 14 if one.in_field else 10
        line = np.array([kernel(*one.values, *(0.1 * begin + step * way)[:count])
                         for step in range(-4, 5)])
        ends = np.abs(binomial @ line).max() < 1e-11 * np.abs(line).max()
        # an expression may be one and need not say so
        by_hand = one.kernel.startswith('rigid_body_sim.scene.effects.')
        assert ends or not one.polynomial
        assert one.polynomial or not ends or not by_hand
        moved = [kernel(*one.values, *(begin + np.isin(np.arange(14), places))[:count])
                 for places in ([], range(4, 10), [10])]
        assert one.of_motion == (moved[1] != moved[0] and one.books != 'heat')
        assert one.timed if moved[2] != moved[0] else not (one.timed and by_hand)
        # whose momentum is inside of the body
        assert one.inner == effects.startswith('rotor')


POTENTIALS = ('gravity: {g: 9.81}', 'gravity: {g: [1, 2, -9]}', f'{SPRING}}}',
              f'{SPRING}, length: 0.8}}',
              'gravity_gradient: {mu: 5, position: [2, -1, 2]}',
              'magnetic: {moment: [0.2, -0.5, 1.1], field: [0.3, 0.1, -0.7]}',
              'magnetic: {moment: [0.2, -0.5, 1.1], field: ["x*y", "z^2", "k*x"]}')
POTENTIAL = 'potential: {energy: "k*x*qy + qx^2*z - cos(y*qw) + 0.3*qz"}'


@pytest.mark.parametrize(('effects', 'kind'), [
    *((effects, kind) for effects in POTENTIALS for kind in CASES[effects][1]),
    (POTENTIAL, 'free'), (POTENTIAL, 'pivot'), ('potential: {energy: "qx*qy + 2*qz^2"}', 'hinge')])
def test_a_potential_falls_by_the_work_of_what_acts(effects, kind):
    """Along any small motion that the constraint allows, by differences: dU = -F dx - Gamma da."""
    scene = scene_of(effects, kind)
    effect, frame = scene.effects[0], scene.frame
    now, h = drawn(kind, 5), 1e-6
    force, torque = pushed(effect, frame, now)
    for k in range(6 if kind == 'free' else 3):
        step = np.eye(6)[k] * h

        def moved(sign, step=step):
            turn = Rotation.from_rotvec(sign * step[:3]) * now.turn
            point = now.at(POINTS[kind])[0] + sign * step[3:]
            place = point - turn.apply(POINTS[kind])
            # the quaternion goes on without a jump of its sign
            q = turn.as_quat()
            q = q if q @ now.turn.as_quat() > 0.0 else -q
            return energy(effect, frame, now._replace(turn=Rotation.from_quat(q), place=place))
        slope = (moved(1.0) - moved(-1.0)) / (2.0 * h)
        work = (torque @ step[:3] + force @ step[3:]) / h
        assert slope == pytest.approx(-work, rel=1e-7, abs=1e-8)


def test_a_torque_in_pieces_begins_at_its_times():
    scene = scene_of('torque: {times: [1, 2.5], values: [[1, 2, 3], [0, 0, -4]], frame: world}',
                     'free')
    torque, frame = scene.effects[0], scene.frame
    now = drawn('free', 0)
    for time, value in ((0.999, [0, 0, 0]), (1.0, [1, 2, 3]), (2.499, [1, 2, 3]),
                        (2.5, [0, 0, -4]), (99.0, [0, 0, -4])):
        assert pushed(torque, frame, now, time)[1] == pytest.approx(value, abs=1e-15)
    assert torque.bounds(scene.body, scene.constraint).torque == 4.0
    assert torque.breakpoints == (1.0, 2.5)


@pytest.mark.parametrize('frame', ['body', 'world'])
def test_a_torque_in_pieces_may_be_booked_as_heat(frame):
    text = ('scene: s\nbody: {{mass: 1, inertia: [1, 2, 3]}}\nconstraint: free\neffects: [torque: '
            '{{times: [1], values: [[1, 2, 3]], frame: {}{}}}]\ninitial: {{}}\n')
    for given, books in ((', books: heat', 'heat'), (', books: work', 'work'), ('', 'work')):
        scene = parse_scene(text.format(frame, given))
        assert [one.books for one in scene.effects[0].acting(scene.frame, 1.0)] == [books]


def test_a_wrench_is_held_if_a_part_of_it_is_not_zero():
    assert not Wrench()
    assert Wrench(force=(0.0, 1.0, 0.0))
    assert Wrench(torque=(0.0, 0.0, 1.0))


@pytest.mark.parametrize('kind', ['free', 'pivot', 'hinge'])
@pytest.mark.parametrize('axes', ['world', 'body'])
def test_a_held_wrench_acts_at_the_centre_of_mass_in_its_own_axes(kind, axes):
    wrench = Wrench((1.0, -2.0, 3.0), (0.5, 0.7, -0.2), axes)
    scene, now = scene_of('', kind), drawn(kind, 2)
    force, torque = (np.array(one) if axes == 'world' else now.turn.apply(one)
                     for one in (wrench.force, wrench.torque))
    at_center, moment = at_point(now, CENTER, force, kind)
    found = pushed(wrench, scene.frame, now)
    assert found[0] == pytest.approx(at_center, abs=1e-13)
    assert found[1] == pytest.approx(moment + torque, abs=1e-13)


OPERATIONS = {'+': lambda a, b: a + b, '-': lambda a, b: a - b, '*': lambda a, b: a * b,
              '/': lambda a, b: a / b, '^': lambda a, b: a ** b, 'negative': lambda a: -a,
              'sqrt': np.sqrt, 'sin': np.sin, 'cos': np.cos}


def value(one, known):
    """Return the value of a tree."""
    if one.op == 'number':
        return one.args[0]
    return known[one.args[0]] if one.op == 'name' else OPERATIONS[one.op](
        *(value(arg, known) for arg in one.args))


def by_formulas(formulas, frame, now):
    """Return force and torque (world) of the formulas of a power series."""
    turn = now.turn * Rotation.from_quat(frame.axes)
    known = now.names() | dict(formulas.parameters)
    if formulas.of_frame:
        omega = Rotation.from_quat(frame.axes).inv().apply(now.omega)
        place, velocity = now.at(frame.point)
        known |= now._replace(turn=turn, omega=omega, place=place, velocity=velocity).names()
    force, torque = ([value(one, known) for one in trees]
                     for trees in (formulas.force, formulas.torque))
    return np.array(force), (turn if formulas.of_frame else now.turn).apply(torque)


@pytest.mark.parametrize(('effects', 'kind'), [
    place for place in PLACES if not place[0].startswith('dry')])
def test_a_power_series_is_given_the_same(effects, kind):
    """Pull: constant + arm x R^T force + R^T couple + drag omega; a free body is moved by it."""
    scene, now = scene_of(effects, kind), drawn(kind, 4)
    effect, frame = scene.effects[0], scene.frame
    pull, turn = effect.series(frame, 0.0), now.turn * Rotation.from_quat(frame.axes)
    omega = Rotation.from_quat(frame.axes).inv().apply(now.omega)
    torque = turn.apply(pull.constant) + np.array(pull.couple or np.zeros(3))
    if pull.drag:
        torque = torque + turn.apply(np.array(pull.drag) @ omega)
    force = np.array(pull.force or np.zeros(3)) - pull.slowing * now.at(CENTER)[1]
    if kind != 'free':
        torque = torque + np.cross(turn.apply(frame.arm), force)
    for formulas in pull.formulas:
        pushing, turning = by_formulas(formulas, frame, now)
        assert kind == 'free' or not pushing.any()    # the torque has its moment
        force, torque = force + pushing, torque + turning
    expected_force, expected_torque = CASES[effects][0](now, kind)
    assert torque == pytest.approx(expected_torque, rel=1e-12, abs=1e-12)
    if kind == 'free':
        assert force == pytest.approx(expected_force, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize('kind', ['pivot', 'hinge', 'free'])
def test_damping_is_the_part_of_drag_in_proportion_to_velocity(kind):
    """It is the same at a pivot that moves; a matrix slows no flight."""
    for effects in (SHAPED, 'drag: {linear: 0.7, angular: 0.3}'):
        scene = scene_of(effects, kind)
        frame, linear = scene.frame, [[0.7, 0, 0], [0, 0.7, 0], [0, 0, 0.7]]
        C, K = (MATRIX, 0.2) if effects == SHAPED else (linear, 0.3)
        R = Rotation.from_quat(frame.axes).as_matrix()
        arm = np.cross(np.eye(3), R @ frame.arm) * (kind != 'free')    # omega -> omega x r
        expected = R.T @ (-K * np.eye(3) - arm @ np.array(C) @ arm.T) @ R
        frames = [frame]
        if kind == 'pivot':
            frames.append(scene_of(effects, 'carried').frame)
        for one in frames:
            damping = scene.effects[0].damping(one)
            assert np.array(damping.drag) == pytest.approx(expected, rel=1e-13, abs=1e-15)
            assert damping.slowing == (0.7 if kind == 'free' and effects != SHAPED else 0.0)


def test_a_number_slows_a_flight_with_squares_beside_it():
    scene = scene_of('drag: {linear: 0.7, quadratic: 0.2}', 'free')
    damping = scene.effects[0].damping(scene.frame)
    assert (damping.drag, damping.slowing) == (None, 0.7)
    assert scene_of('drag: {linear: 0.7}', 'free').effects[0].series(scene.frame, 0.0).drag is None


@pytest.mark.parametrize('kind', CONSTRAINTS)
def test_the_point_of_a_moving_pivot_carries_the_body_by_its_mass_times_acceleration(kind):
    """-M a at the centre of mass; a = (-k^2 sin(k t), 2, 0). It acts where the pivot moves."""
    effect = scene_of('', 'carried').effects[-1]
    frame, now = scene_of('', kind).frame, drawn(kind, 6)
    a = np.array([-1.7 ** 2 * np.sin(1.7 * now.t), 2.0, 0.0])
    expected = np.cross(now.turn.apply(CENTER), -MASS * a) * (kind == 'carried')
    found = pushed(effect, frame, now)
    assert not found[0].any()
    assert found[1] == pytest.approx(expected, rel=1e-13, abs=1e-14)
    of_series = np.zeros(3)
    for formulas in effect.series(frame, 0.0).formulas:
        of_series = of_series + by_formulas(formulas, frame, now)[1]
    assert of_series == pytest.approx(expected, rel=1e-13, abs=1e-14)
    assert bool(effect.acting(frame, 0.0)) == (kind == 'carried')


def test_a_moving_pivot_at_the_centre_of_mass_turns_nothing_but_is_seen():
    scene = parse_scene("scene: s\nbody: {mass: 2, inertia: [1, 2, 2.5]}\n"
                        "constraint: {pivot: {motion: [0, 0, 'sin(t)']}}\n"
                        'effects: []\ninitial: {}\n')
    [acting] = scene.effects[-1].acting(scene.frame, 0.0)
    assert (acting.values, acting.gives, acting.books) == ((0.0, 0.0, 0.0), 'torque', 'work')
    assert acting.polynomial


def test_a_torsion_spring_turns_toward_its_angle_and_its_damping_against_the_rate():
    effects = 'spring: {stiffness: 3, angle: 0.5, damping: 0.6}'
    scene = scene_of(effects, 'hinge')
    effect, frame, n = scene.effects[0], scene.frame, np.array([1.0, 2.0, 2.0]) / 3.0
    start = Rotation.from_quat(frame.hinge.zero)
    for angle, rate in ((0.3, 0.7), (0.9, -0.4), (-2.0, 1.0)):
        turn = start * Rotation.from_rotvec(angle * n)
        now = Now(0.0, turn, rate * n, -turn.apply(THROUGH), np.zeros(3))
        for damping in (0.6, 0.0):
            one = effect if damping else scene_of(
                effects.replace(', damping: 0.6', ''), 'hinge').effects[0]
            expected = (-3.0 * (angle - 0.5) - damping * rate) * turn.apply(n)
            assert pushed(one, frame, now)[1] == pytest.approx(expected, rel=1e-13, abs=1e-14)
            of_series = np.zeros(3)
            for formulas in one.series(frame, 0.0).formulas:
                known = now.names() | {'angle': angle, 'rate': rate}
                of_series = of_series + [value(part, known) for part in formulas.torque]
            assert turn.apply(of_series) == pytest.approx(expected, rel=1e-13, abs=1e-14)
            assert energy(one, frame, now) == near(1.5 * (angle - 0.5) ** 2, rel=1e-13)
        assert [one.books for one in effect.acting(frame, 0.0)] == ['potential', 'heat']


def test_dry_friction_switches_where_the_rate_changes_its_sign():
    scene = scene_of('dry_friction: {torque: 0.4}', 'hinge')
    [acting] = scene.effects[0].acting(scene.frame, 0.0)
    kernel, switches = function(acting.kernel), function(acting.switching)
    n = Rotation.from_quat(scene.frame.axes).inv().apply(np.array([1.0, 2.0, 2.0]) / 3.0)
    for omega in np.random.default_rng(1).normal(size=(12, 3)):
        rest = 0.5, -0.5, 0.5, 0.5, *omega, 1.0, 2.0, 3.0
        assert switches(*acting.values, *rest) == (near(n @ omega, rel=1e-13),)
        assert kernel(*acting.values, *rest) == near(-0.4 * np.sign(n @ omega) * n, rel=1e-13)
        # a mode stands for the sign that a switch had before
        for mode in (1.0, -1.0):
            values = list(acting.values)
            values[acting.modes[0]] = mode
            assert kernel(*values, *rest) == near(-0.4 * mode * n, rel=1e-13)
    assert kernel(*acting.values, 0.0, 0.0, 0.0, 1.0, *[0.0] * 6) == (0.0, 0.0, 0.0)
    assert (acting.grip, scene.effects[0].grip) == (0.4, 0.4)


@pytest.mark.parametrize(('effects', 'momentum'), [
    (ROTOR, 1.5), ('rotor: {axis: [4, -2, 4], inertia: 0.5, rate: 3, torque: 0.7}', 2.9)])
def test_a_rotor_carries_its_momentum_along_its_axis(effects, momentum):
    """At 2 s; what turns the other way carries the opposite."""
    scene = scene_of(effects, 'free')
    for sign, one in ((1.0, scene.effects[0]), (-1.0, scene.effects[0].opposite)):
        carried = one.momentum(scene.frame)
        found = Rotation.from_quat(scene.frame.axes).apply(
            function(carried.kernel)(*carried.values, 2.0))
        assert found == pytest.approx(sign * momentum * np.array([2.0, -1.0, 2.0]) / 3.0)
    assert scene.effects[0].bounds(scene.body, scene.constraint).torque == near(
        0.0 if effects == ROTOR else 0.7, rel=1e-15)


@pytest.mark.parametrize('axes', [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1]])
@pytest.mark.parametrize(('moments', 'omega', 'fading'), [
    ((0.3, 0.5, 0.7), (0.3, -0.5, 0.7), ()), ((0.3, 0.5, 0.7), (0.0, 0.4, 0.7), ()),
    ((0.3, 0.5, 0.7), (0.8, 0.0, 1.2), ()), ((0.3, 0.5, 0.7), (0.0, 0.0, 2.0), ()),
    # rates with the component along the least axis fade with it, the others with m across the
    # largest one
    ((0.3, 0.5, 0.7), (1e3 * ENDED, -0.3, 0.7), ()),
    ((0.3, 0.5, 0.7), (1e-3 * ENDED, 0.3, 0.7), (1, 2)),
    ((0.3, 0.5, 0.7), (1e3 * ENDED, 1e3 * ENDED, 0.7), ()),
    ((0.3, 0.5, 0.7), (-1e-3 * ENDED, 1e-3 * ENDED, 0.7), (0, 1, 2)),
    ((0.3, 0.3, 0.7), (1e-3 * ENDED, 0.3, 0.7), ()),
    ((0.3, 0.7, 0.7), (1e-3 * ENDED, 0.3, 0.7), (1, 2)),
    ((0.3, 0.7, 0.7), (1e3 * ENDED, 0.3, 0.7), ())])
def test_inner_parts_turn_the_axes_until_a_wobble_is_too_small_to_show(
        axes, moments, omega, fading):
    """By c m x omega, until what is left of m is 2^-54 of it."""
    I, w, order = np.array(moments)[axes], np.array(omega)[axes], np.argsort(axes)
    turning = function('rigid_body_sim.scene.effects.internal_dissipation:turning')
    found = np.array(turning(2.0, *I, 0.0, 0.0, 0.0, 1.0, *w, 0.0, 0.0, 0.0))[order]
    expected = np.array([2.0 * (I[k - 2] - I[k - 1]) * w[k - 2] * w[k - 1] for k in range(3)])
    for k, (one, full) in enumerate(zip(found, expected[order], strict=True)):
        if k in fading:
            assert abs(one) <= 1e-5 * abs(full)
        else:
            assert one == near(full, rel=1e-5)


@pytest.mark.parametrize('g', ['[0, 0, -1.6]', '1.6'])
def test_a_field_along_minus_z_is_one_that_has_closed_forms(g):
    assert scene_of(f'gravity: {{g: {g}}}', 'free').effects == (Gravity(1.6),)
    assert scene_of('gravity: {g: [0, 0, 0]}', 'free').effects == (Gravity(0.0),)
    with pytest.raises(BadInput, match=r'gravity\.g: got -0\.1'):
        scene_of('gravity: {g: -0.1}', 'free')
