# SPDX-License-Identifier: Apache-2.0
"""The reference integrators of the study against references made another way, and their cache.

The references in test/data are made by Gragg's extrapolation.
"""

import dataclasses
import json
import pathlib
import types
from typing import ClassVar

import numpy as np
import pytest
from data import smooth_cases
from mpmath import mp, mpf

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.study.precision import inputs, reference, suite
from rigid_body_sim.study.precision.ball import Ball
from rigid_body_sim.study.precision.taylor import Turning

DATA = pathlib.Path(__file__).resolve().parent.parent.parent / 'data'
SMOOTH = json.loads((DATA / 'smooth.json').read_text())
BITS = 152


def apart(one, other):
    """Return the largest difference of two attitudes (up to the sign of q) or vectors."""
    return float(min(max(abs(a - s * b) for a, b in zip(one, other))
                     for s in ((1, -1) if len(one) == 4 else (1,))))


# measured: at most 5e-33, the last of 34 digits of a rate of 60 rad/s
@pytest.mark.parametrize(('name', 'time'), [
    ('asymmetric_heavy_top', 0.05), ('skew_heavy_top', 0.1), ('driven_body', 1.0),
    ('driven_in_pieces', 2.0), ('thrown_with_drag', 0.3),
    ('damped_top', 0.1), ('major_axis_relaxation', 1.0)])
def test_taylor_series_agree_with_extrapolation(name, time):
    with mp.workprec(BITS + 64):
        motion = Turning(inputs.of(parse_scene(smooth_cases.text(name)), inputs.exactly), BITS)
        q, omega = motion.go(time)
        expected = [mpf(x) for x in SMOOTH[name][repr(time)]['state']]
        assert apart(q, expected[:4]) < 1e-33
        assert apart(omega, expected[4:7]) < 1e-31


def test_a_hinge_swings_by_its_one_equation():
    """The energy of the swing phi'' = -k sin phi is conserved to the digits carried."""
    scene = suite.problem('separatrix_pendulum').scene
    with mp.workprec(BITS + 64):
        given = inputs.of(scene, inputs.exactly)
        moment = mpf(0.48) + mpf(2) * mpf(0.4) ** 2
        q, omega = Turning(given, BITS).go(0.7)
        height = -mpf(0.4) * (1 - 2 * (q[0] ** 2 + q[1] ** 2))
        energy = moment * omega[1] ** 2 / 2 + 2 * mpf(9.81) * height
        start = moment * given.omega[1] ** 2 / 2 - 2 * mpf(9.81) * mpf(0.4)
        assert abs(energy - start) < 1e-40


def test_a_torsion_spring_swings_as_its_formula_says():
    """I phi'' = -k (phi - a) - c phi', from phi = 0: an oscillation that dies out."""
    scene = parse_scene('scene: door\nbody: {mass: 1, inertia: [1, 2, 3]}\n'
                        'constraint: {hinge: {axis: [0, 0, 1]}}\n'
                        'effects: [spring: {stiffness: 8, angle: 0.5, damping: 0.75}]\n'
                        'initial: {angle: 0.25, rate: 2}\n')
    time, rate = 1.5, mpf(2)
    with mp.workprec(BITS + 64):
        q, _ = Turning(inputs.of(scene, inputs.exactly), BITS).go(time)
        slack, decay = mpf(0.25), mpf(0.75) / 6
        omega = mp.sqrt(mpf(8) / 3 - decay ** 2)
        phi = slack + mp.exp(-decay * time) * (
            -slack * mp.cos(omega * time) + (rate - decay * slack) / omega * mp.sin(omega * time))
        assert abs(q[2] - mp.sin((phi + mpf(0.25)) / 2)) < 1e-16    # the start is in doubles
        assert abs(2 * mp.atan2(q[2], q[3]) - 2 * mp.atan2(*scene.initial.orientation[2:])
                   - phi) < 1e-40


def test_drag_by_squares_slows_a_spin_as_its_formula_says():
    """I omega' = -(Q + D l^3) omega^2 about a principal axis, l the distance of the centre."""
    scene = parse_scene('scene: vane\nbody: {mass: 1, inertia: [1, 2, 2.5], '
                        'inertia_about: origin, center_of_mass: [0.5, 0, 0]}\n'
                        'constraint: pivot\neffects: [drag: {quadratic: 2, '
                        'angular_quadratic: 0.5}]\ninitial: {angular_velocity: [0, 0, 4]}\n')
    with mp.workprec(BITS + 64):
        _, omega = Turning(inputs.of(scene, inputs.exactly), BITS).go(1.5)
        assert abs(omega[2] - 4 / (1 + mpf(3) / 4 * 4 * mpf(3) / 2 / mpf(2.5))) < 1e-40
        assert omega[:2] == (0, 0)


def test_a_tied_body_keeps_its_energy():
    """That of the spring is k (d - l)^2/2; the reference forms its torque alone."""
    scene = suite.problem('tied_top').scene
    with mp.workprec(BITS + 64):
        given = inputs.of(scene, inputs.exactly)
        (at, anchor, stiffness, length), = given.ties

        def energy(q, omega):
            spin = inputs.turned_back(given.axes, omega)
            far = [a - b for a, b in zip(inputs.turned(q, at), anchor)]
            stretch = mp.sqrt(inputs.dot(far, far)) - length
            return (inputs.dot(given.moments, [w * w for w in spin]) / 2
                    + given.mass * given.g * inputs.turned(q, given.arm)[2]
                    + stiffness * stretch ** 2 / 2)
        moved = Turning(given, BITS).go(0.1)
        assert abs(energy(*moved) - energy(given.orientation, given.omega)) < 1e-40


OBEYED = {
    'pivot': ('{mass: 0.5, inertia: [0.75, 1, 0.875], inertia_about: origin, center_of_mass: '
              '[0.125, -0.25, 0.5]}', 'pivot',
              '[gravity: {g: 9.75}, torque: {value: [0.25, -0.5, 1], frame: body}, '
              'torque: {times: [0.125], values: [[-1, 2, 0]], frame: world}, drag: {linear: 0.5, '
              'angular: 0.125, quadratic: 0.75, angular_quadratic: 0.25}, spring: {at: '
              '[0.5, 0.25, -0.125], anchor: [1, -2, 0.5], stiffness: 8, length: 0.75}]',
              '{orientation: [0.1, -0.5, 0.3, 0.8], angular_velocity: [1, -2, 3]}'),
    'hinge': ('{mass: 0.5, inertia: [0.75, 1, 0.875], inertia_about: origin, center_of_mass: '
              '[0.125, -0.25, 0.5]}', '{hinge: {axis: [0.48, -0.6, 0.64]}}',
              '[gravity: {g: 9.75}, torque: {times: [0, 0.125], values: [[0.25, -0.5, 1], '
              '[3, 1, -2]]}, drag: {linear: 0.5, angular: 0.125, quadratic: 0.75, '
              'angular_quadratic: 0.25}, spring: {stiffness: 8, angle: 0.5, damping: 0.75}]',
              '{orientation: [0.1, -0.5, 0.3, 0.8], rate: 2.5}'),
    'free': ('{mass: 0.5, inertia: [0.75, 1, 0.875]}', 'free',
             '[torque: {value: [0.25, -0.5, 1], frame: body}, torque: {times: [0.125], '
             'values: [[-1, 2, 0]], frame: world}, internal_dissipation: {coefficient: 0.0625}, '
             'drag: {angular: 0.125}]',
             '{orientation: [0.1, -0.5, 0.3, 0.8], angular_velocity: [1, -2, 3]}')}


def torque_by_hand(kind, q, w, angle, later):
    """Return the torque on a body of OBEYED, in its axes, by the formula of each effect."""
    def total(*vectors):
        return tuple(map(sum, zip(*vectors)))

    def scaled(factor, vector):
        return tuple(factor * x for x in vector)
    arm, axis = (mpf(0.125), mpf(-0.25), mpf(0.5)), tuple(map(mpf, (0.48, -0.6, 0.64)))
    down = scaled(-0.5 * 9.75, inputs.turned_back(q, (0, 0, 1)))
    moving = inputs.cross(w, arm)
    speed, rate = (mp.sqrt(inputs.dot(v, v)) for v in (moving, w))
    drag = total(inputs.cross(arm, scaled(-0.5 - 0.75 * speed, moving)),
                 scaled(-0.125 - 0.25 * rate, w))
    if kind == 'hinge':
        return total(inputs.cross(arm, down), drag, (3, 1, -2) if later else (0.25, -0.5, 1),
                     scaled(-8 * (angle - 0.5) - 0.75 * rate, inputs.unit(axis)))
    couples = total((0.25, -0.5, 1), inputs.turned_back(q, (-1, 2, 0)) if later else (0, 0, 0))
    if kind == 'free':
        return total(couples, scaled(-0.125, w))
    at = (0.5, 0.25, -0.125)
    far = total(inputs.turned_back(q, (1, -2, 0.5)), scaled(-1, at))
    pull = scaled(8 * (1 - 0.75 / mp.sqrt(inputs.dot(far, far))), far)
    return total(inputs.cross(arm, down), drag, couples, inputs.cross(at, pull))


@pytest.mark.parametrize('kind', OBEYED)
@pytest.mark.parametrize('later', [False, True])
def test_a_body_obeys_its_equations_on_its_way_under_all_effects_at_once(kind, later):
    """I w' = m x (w + u) + torque and q' = q (w + u)/2, before and after torques jump at 1/8 s.

    The derivatives are differences over 2^-50 s within a series. Measured: 6e-14 of the rates.
    """
    body, constraint, effects, initial = OBEYED[kind]
    scene = parse_scene(f'scene: a\nbody: {body}\nconstraint: {constraint}\neffects: {effects}\n'
                        f'initial: {initial}\n')
    time, h = 0.13 if later else 0.005, 2.0 ** -50
    with mp.workprec(BITS + 64):
        given = inputs.of(scene, inputs.exactly)
        (q, w), (q1, w1) = (Turning(given, 96).go(t) for t in (time, time + h))
        moments = (mpf(0.75), mpf(1), mpf(0.875))
        m = tuple(i * x for i, x in zip(moments, w))
        u = tuple(mpf(0.0625) * x for x in inputs.cross(m, w)) if kind == 'free' else inputs.ZERO
        turning = tuple(map(sum, zip(w, u)))
        turn = inputs.product(inputs.product(
            [-x for x in given.orientation[:3]] + [given.orientation[3]], q), (0, 0, 0, 1))
        angle = 2 * mp.asin(inputs.dot(turn[:3], given.axis)) if given.axis else mpf(0)
        torque = torque_by_hand(kind, q, w, angle, later)
        if kind == 'hinge':
            n = given.axis
            moment = inputs.dot([i * x for i, x in zip(moments, n)], n)
            expected = tuple(x * inputs.dot(torque, n) / moment for x in n)
        else:
            expected = tuple((a + b) / i for a, b, i in zip(
                inputs.cross(m, turning), torque, moments))
        found = tuple((b - a) / h for a, b in zip(w, w1))
        assert apart(found, expected) < 1e-12 * max(map(abs, expected))
        spun = inputs.product(q, (*turning, mpf(0)))
        assert apart([(b - a) / h for a, b in zip(q, q1)], [x / 2 for x in spun]) < 1e-12


@pytest.mark.parametrize(('constraint', 'effect'), [
    ('free', 'gravity_gradient: {mu: 3e14, position: [7e6, 0, 0]}'),
    ('free', 'gravity: {g: [0, 1, 9]}'), ('free', 'drag: {quadratic: 0.1}'),
    ('free', "torque: {value: ['-wx', 0, 0]}"), ('free', 'rotor: {axis: [0, 0, 1], momentum: 1}'),
    ('pivot', 'spring: {at: [0, 0, 1], anchor: [1, 0, 0], stiffness: 2, damping: 0.1}'),
    ('free', 'spring: {at: [0, 0, 1], anchor: [1, 0, 0], stiffness: 2}'),
    ('pivot', 'drag: {quadratic: [[1, 0, 0], [0, 2, 0], [0, 0, 2]]}'),
    ('pivot', 'internal_dissipation: {coefficient: 0.1}'),
    ("{pivot: {motion: [0, 0, '0.1*sin(t)']}}", 'gravity: {g: 9.81}')])
def test_what_no_reference_knows_is_refused(constraint, effect):
    """They were left out without a word: every method erred by the whole effect."""
    scene = parse_scene('scene: a\nbody: {mass: 1, inertia: [1, 2, 2.5], center_of_mass: '
                        f'[0, 0, 0.1]}}\nconstraint: {constraint}\neffects: [{effect}]\n'
                        'initial: {angular_velocity: [1, 0, 0]}\n')
    with pytest.raises(BadInput, match='no reference is made for'):
        reference.compute(scene, 1.0)


@pytest.mark.parametrize('name', ['side spin', 'masse'])
def test_a_ball_agrees_with_extrapolation(name):
    case = json.loads((DATA / 'sliding_sphere.json').read_text())[name]
    body = (f'{{mass: 1.0, inertia: [{case["ratio"] * case["radius"] ** 2!r}, '
            f'{case["ratio"] * case["radius"] ** 2!r}, '
            f'{case["ratio"] * case["radius"] ** 2!r}], radius: {case["radius"]!r}}}')
    vx, vy = case['velocity']
    scene = parse_scene(f'scene: ball\nbody: {body}\nconstraint: table\n'
                        f'effects: [sliding_friction: {{mu: {case["mu"]!r}, g: {case["g"]!r}}}]\n'
                        f'initial: {{orientation: {list(case["orientation"])}, angular_velocity: '
                        f'{case["angular_velocity"]}, '
                        f'velocity: [{vx!r}, {vy!r}, 0.0]}}\n')
    with mp.workprec(BITS + 64):
        motion = Ball(inputs.of(scene, inputs.exactly), BITS)
        for row in case['states']:
            time = float.fromhex(row['time'])
            if time < 0.0:
                continue
            q, omega = motion.go(time)
            expected = [mpf(x) for x in row['state']]
            # the scene's moment a^2 k is rounded once: 1e-16 of the rates
            assert apart(q, expected[:4]) < 1e-13
            assert apart(omega, expected[4:7]) < 1e-12


def ball(**given):
    """Return a billiard ball at rest, of 2 kg and 1/4 m on a table with mu g = 3 m/s^2."""
    zero, moment = (mpf(0),) * 3, mpf(2) / 5 * 2 / 16
    return Ball(types.SimpleNamespace(**{
        'moments': (moment,) * 3, 'mass': mpf(2), 'radius': mpf(1) / 4, 'mu': mpf(3) / 10,
        'g': mpf(10), 'orientation': (mpf(0), mpf(0), mpf(0), mpf(1)), 'omega': zero,
        'velocity': zero, 'strikes': (), **given}), BITS)


def test_a_ball_slides_then_rolls_as_its_formulas_say():
    """Omega grows by 5 mu g/(2 a) until v = a omega, at 2 v/(7 mu g): then 5/7 of v is left."""
    with mp.workprec(BITS + 64):
        growth, rolls = mpf(30), 2 * mpf(7) / 21
        made = ball(velocity=(mpf(7), mpf(0), mpf(0)))
        assert made.time == 0.0
        for time in (0.25, 0.5, 1.0, 2.5):
            q, omega = made.go(time)
            slid = min(mpf(time), rolls)
            angle = growth * slid ** 2 / 2 + growth * slid * (time - slid)
            assert apart(omega, (0, growth * slid, 0)) < 1e-43
            assert apart(q, (0, mp.sin(angle / 2), 0, mp.cos(angle / 2))) < 1e-43
        assert made.time == 2.5


@pytest.mark.parametrize(('velocity', 'spin'), [
    ((0.3, 0.0), (0.0, 3.0)), ((0.0, 0.7), (-7.0, 0.0)), ((0.6, -0.3), (3.0, 6.0))])
def test_a_ball_that_rolls_but_for_the_rounding_of_its_start_rolls_on(velocity, spin):
    with mp.workprec(BITS + 64):
        omega = (*map(mpf, spin), mpf(0.5))
        made = ball(velocity=(*map(mpf, velocity), mpf(0)), omega=omega, radius=mpf(0.1))
        q, turned = made.go(3.0)
        assert apart(inputs.turned(q, turned), omega) < 1e-43


def test_without_friction_a_ball_keeps_its_spin():
    with mp.workprec(BITS + 64):
        for none in ('mu', 'g'):
            made = ball(**{none: mpf(0)}, velocity=(mpf(1), mpf(0), mpf(0)),
                        omega=(mpf(0), mpf(0), mpf(2)))
            q, omega = made.go(1.5)
            assert apart(omega, (0, 0, 2)) < 1e-43
            assert apart(q, (0, 0, mp.sin(mpf(1.5)), mp.cos(mpf(1.5)))) < 1e-43


@pytest.mark.parametrize(('height', 'along', 'across', 'slides'), [
    ('0.1', 3, 4, False), ('0.05', 3, 4, True), ('-0.1', 3, 0, True), ('0.1', 0, 4, False)])
def test_a_cue_turns_a_ball_by_the_height_at_which_it_strikes(height, along, across, slides):
    """I omega = h J across: at 2/5 of the radius above the centre the ball rolls at once."""
    with mp.workprec(BITS + 64):
        impulse, h = (mpf(along), mpf(across), mpf(0)), mpf(height)
        made = ball(strikes=((0.5, impulse, inputs.ZERO, h, 'world'),),
                    omega=(mpf(0), mpf(0), mpf(1)))
        q, omega = made.go(0.5)
        moment = made._given.moments[0]
        struck = (-across * h / moment, along * h / moment, mpf(1))
        assert apart(inputs.turned(q, omega), struck) < 1e-43
        assert apart(made._v, (mpf(along) / 2, mpf(across) / 2)) < 1e-43
        assert apart(q, (0, 0, mp.sin(mpf(1) / 4), mp.cos(mpf(1) / 4))) < 1e-43
        q, omega = made.go(0.75)
        assert (apart(inputs.turned(q, omega), struck) > 1e-3) == slides


def test_a_ball_is_struck_at_a_point_of_the_body_where_it_is_by_then():
    """The point (0, 0.2, 0) has gone round by w t = 1/2 rad; there is no friction."""
    with mp.workprec(BITS + 64):
        impulse, lever = (mpf(1), mpf(2), mpf(0)), (mpf(0), mpf(1) / 5, mpf(0))
        made = ball(strikes=((0.5, impulse, lever, mpf(0), 'world'),), mu=mpf(0),
                    omega=(mpf(0), mpf(0), mpf(1)))
        q, omega = made.go(0.5)
        x, y = -mp.sin(mpf(1) / 2) / 5, mp.cos(mpf(1) / 2) / 5
        assert apart(inputs.turned(q, omega), (
            0, 0, 1 + (2 * x - y) / made._given.moments[0])) < 1e-43


@pytest.mark.parametrize('frame', ['body', 'world'])
@pytest.mark.parametrize('constraint', ['free', '{hinge: {axis: [0, 0, 1]}}'])
def test_a_strike_changes_the_spin_by_its_moment(constraint, frame):
    """A body that turns about z by w t = 1 rad is struck in its x-y plane: I w' = (r x J)_z."""
    hinged = constraint != 'free'
    initial = '{rate: 2}' if hinged else '{angular_velocity: [0, 0, 2]}'
    scene = parse_scene(
        'scene: a\nbody: {mass: 1.5, inertia: [1, 2, 2.5], center_of_mass: [0.5, 0, 0]}\n'
        f'constraint: {constraint}\neffects: [strike: {{impulse: [3, -1, 0], point: '
        f'[0.25, 2, 0], time: 0.5, frame: {frame}}}]\ninitial: {initial}\n')
    with mp.workprec(BITS + 64):
        made = Turning(inputs.of(scene, inputs.exactly), BITS)
        angle = mpf(1) if frame == 'world' else mpf(0)
        jx, jy = (3 * mp.cos(angle) - mp.sin(angle), -3 * mp.sin(angle) - mp.cos(angle))
        x, moment = (mpf('0.25'), mpf('2.5') + mpf('1.5') / 4) if hinged else (
            mpf('-0.25'), mpf('2.5'))
        assert apart(made.go(0.25)[1], (0, 0, 2)) < 1e-40
        assert apart(made.go(0.5)[1], (0, 0, 2 + (x * jy - 2 * jx) / moment)) < 1e-40
        assert apart(made.go(1.0)[1], (0, 0, 2 + (x * jy - 2 * jx) / moment)) < 1e-40


def test_products_of_vectors_and_quaternions_are_those_of_the_books():
    """Of the units i j = k and so on; turning by q is q v q*."""
    unit = {name: tuple(int(k == place) for k in range(4)) for place, name in enumerate('ijk1')}
    for a, b, c in ('ijk', 'jki', 'kij', 'i1i', '1jj', 'k1k', '111'):
        assert inputs.product(unit[a], unit[b]) == unit[c]
        if c != a != b != c:
            assert inputs.product(unit[b], unit[a]) == tuple(-x for x in unit[c])
            assert inputs.cross(unit[a][:3], unit[b][:3]) == unit[c][:3]
            assert inputs.cross(unit[b][:3], unit[a][:3]) == tuple(-x for x in unit[c][:3])
    for a in 'ijk1':
        assert inputs.product(unit[a], unit[a]) == tuple(
            x if a == '1' else -x for x in unit['1'])
    assert inputs.dot((1, 2, 3), (4, 5, 6)) == 32
    q, v = tuple(mpf(x) / 10 for x in (1, 5, -5, 7)), (mpf(2), mpf(-3), mpf(5))
    turned = inputs.product(inputs.product(q, (*v, mpf(0))), (-q[0], -q[1], -q[2], q[3]))[:3]
    assert apart(inputs.turned(q, v), turned) < 1e-14
    assert apart(inputs.turned_back(q, turned), v) < 1e-14
    assert inputs.unit((mpf(3), mpf(0), mpf(-4))) == (mpf(3) / 5, 0, mpf(-4) / 5)


@pytest.mark.parametrize('name', suite.NAMES + suite.ON_A_PLANE)
def test_every_problem_has_a_reference_of_this_very_scene(name):
    found = reference.load(suite.problem(name))
    assert found.digits >= 25.0
    assert found.times[-1] == suite.problem(name).duration
    assert (found.floor > 0.0).all()
    assert all(len(mp.nstr(x, 34)) > 25 for x in found.orientation[-1] if x)


@pytest.mark.parametrize('name', suite.ON_A_PLANE)
def test_references_on_a_plane_are_those_of_the_shipped_scenes(name):
    found, rows = reference.load(suite.problem(name)), json.loads(
        (DATA / 'plane_scenes.json').read_text())[name]
    with mp.workdps(40):
        kept = dict(zip(rows['times'], rows['orientations']))
        both = [k for k, time in enumerate(found.times.tolist()) if time in kept]
        assert len(both) == 4
        for k in both:
            assert apart(found.orientation[k], list(map(mpf, kept[found.times[k]]))) < 1e-29


def test_a_reference_computed_now_is_the_cached_one():
    problem, parts = suite.problem('ball_slip_to_roll'), []
    cached = reference.load(problem)
    now = reference.compute(problem.scene, problem.duration, draws=1, progress=parts.append)
    assert parts == sorted(parts) and parts[-1] == 1.0
    with mp.workprec(BITS):
        assert max(map(apart, cached.orientation, now.orientation)) < 1e-33
        assert max(map(apart, cached.omega, now.omega)) < 1e-31


class Drifting:
    """A motion whose omega is wrong by a part that the bits tell; the attitude is at rest."""

    wrong: ClassVar = {}

    def __init__(self, given, bits):
        self.omega = given.omega[0] * (1 + self.wrong[bits])

    def go(self, time):
        return (mpf(0), mpf(0), mpf(0), mpf(1)), (mpf(0), self.omega * time, mpf(0))


def spun(rate, monkeypatch, check, floor, draws=3, progress=lambda part: None):
    """Return the Reference of a body by the made-up motion."""
    monkeypatch.setattr(reference, 'Turning', Drifting)
    monkeypatch.setattr(Drifting, 'wrong', {
        reference.BITS: mpf(0), reference.CHECK_BITS: check, reference.FLOOR_BITS: floor})
    scene = parse_scene('scene: a\nbody: {mass: 1, inertia: [1, 2, 2.5]}\nconstraint: free\n'
                        f'effects: []\ninitial: {{angular_velocity: [{rate!r}, 0, 0]}}\n')
    return reference.compute(scene, 4.0, draws, progress)


def test_digits_are_those_in_which_two_computations_agree_at_every_time(monkeypatch):
    """The rate at 4 s is 12 rad/s: its difference is relative; absolute below 1 rad/s."""
    found = spun(3.0, monkeypatch, mpf(2) ** -100, mpf(0))
    assert found.times.tolist() == [k / 8 for k in range(1, 33)]
    assert found.digits == pytest.approx(100.0 * np.log10(2.0), abs=1e-12)
    found = spun(0.125, monkeypatch, mpf(2) ** -100, mpf(0))    # 0.5 rad/s at the end
    assert found.digits == pytest.approx(101.0 * np.log10(2.0), abs=1e-12)


def test_digits_end_where_the_computations_are_the_same(monkeypatch):
    assert spun(3.0, monkeypatch, mpf(0), mpf(0)).digits == pytest.approx(60.0, abs=1e-12)


def test_the_share_that_is_done_rises_evenly_to_one(monkeypatch):
    """There are two runs and one for each draw, of 32 times each."""
    parts = []
    spun(3.0, monkeypatch, mpf(0), mpf(0), draws=3, progress=parts.append)
    assert parts == pytest.approx([k / 160 for k in range(1, 161)], abs=1e-15)


def test_the_floor_is_the_largest_effect_of_half_an_ulp(monkeypatch):
    """That of 3 is 2^-52; signs are drawn, and one of them adds to what is wrong anyway."""
    found = spun(3.0, monkeypatch, mpf(0), mpf(2) ** -52, draws=8)
    rate = 2.0**-52 * (1.0 + 3.0)
    assert found.floor_omega == pytest.approx(rate * found.times, rel=1e-12, abs=0.0)
    assert (found.floor == 0.0).all()


@pytest.mark.parametrize('size', [1.0, -1.0, 2.5])
@pytest.mark.parametrize('angle', [0.0, 1e-25, 0.3, 1.0, 3.1])
def test_distances_are_angles_and_lengths_whatever_the_size_and_sign_of_a_quaternion(size, angle):
    half = mpf(angle) / 2
    with mp.workprec(200):
        start = tuple(mpf(x) / 2 for x in (1, -1, 1, 1))
        turned = inputs.product(start, (mp.sin(half), mpf(0), mpf(0), mp.cos(half)))
        true = reference.Reference(np.zeros(2), [start] * 2, [(mpf(1), mpf(2), mpf(3))] * 2,
                                   np.zeros(2), np.zeros(2), 34.0)
        given = [start, tuple(size * x for x in turned)]
        spin = [(mpf(1), mpf(2), mpf(3)), (mpf(1) + mpf(2)**-90, mpf(2), mpf(3))]
    # outside mpmath works with 53 bits
    angles, lengths = true.distances(given, spin)
    assert angles == pytest.approx([0.0, angle], rel=1e-15, abs=1e-40)
    assert lengths.tolist() == [0.0, 2.0**-90]
    angles, lengths = true.errors(np.array([[0.5, -0.5, 0.5, 0.5, 1.0, 2.0, 3.0],
                                            [-0.5, 0.5, -0.5, -0.5, 1.0, 2.0, 3.5]]))
    assert (angles.tolist(), lengths.tolist()) == ([0.0, 0.0], [0.0, 0.5])


def test_a_reference_is_saved_to_34_digits(tmp_path, monkeypatch):
    monkeypatch.setattr(reference, 'FOLDER', tmp_path)
    problem = suite.problem('racket')
    with mp.workprec(reference.BITS):
        third = mpf(1) / 3
        made = reference.Reference(
            np.array([1.0, problem.duration]), [(third,) * 4] * 2, [(third, mpf(0), -third)] * 2,
            np.array([1.23456e-15, 0.0]), np.array([2.0, 9.87654e-9]), 31.4159)
        reference.save('racket', problem, made)
        found = reference.load(problem)
        assert abs(found.orientation[1][3] - third) < 1e-34
        assert abs(found.omega[0][2] + third) < 1e-34
    assert found.times.tolist() == [1.0, problem.duration]
    assert (found.floor.tolist(), found.floor_omega.tolist()) == (
        [1.235e-15, 0.0], [2.0, 9.877e-9])
    assert found.digits == 31.4
    longer = dataclasses.replace(problem, duration=101.0)
    assert reference.load(longer) is None
    assert reference.load(dataclasses.replace(problem, scene=suite.problem(
        'driven_body').scene)) is None
    assert reference.load(dataclasses.replace(problem, name='nowhere')) is None


def of(constraint, effects, initial='{angular_velocity: [1, 0, 0]}', center='[0.25, 0, 0.5]'):
    """Return the numbers that the references get for a scene."""
    return inputs.of(parse_scene(
        'scene: a\nbody: {mass: 1, inertia: [1, 2, 2.5], '
        f'center_of_mass: {center}}}\nconstraint: {constraint}\neffects: [{effects}]\n'
        f'initial: {initial}\n'), inputs.exactly)


def test_what_a_scene_lacks_is_zero():
    made = of('free', '')
    assert (made.g, made.linear, made.angular, made.inner, made.mu, made.radius, made.stiffness,
            made.slack, made.quadratic, made.angular_quadratic) == (0,) * 10
    assert (made.arm, made.axis, made.couples, made.strikes, made.ties) == (
        (0, 0, 0), None, (), (), ())


def test_arms_and_levers_are_from_the_point_of_reference_and_from_the_centre_of_mass():
    made = of('{hinge: {axis: [0, 0, 2], through: [1, 0, 0.25]}}',
              'strike: {impulse: [0, 1, 0], point: [2, 0.5, 1], time: 2}, '
              'strike: {impulse: [0, 2, 0], point: [1, 0, 0], time: 1}', '{}')
    assert (made.arm, made.axis) == ((-0.75, 0, 0.25), (0, 0, 1))
    assert [(time, impulse, lever) for time, impulse, lever, *_ in made.strikes] == [
        (1.0, (0, 2, 0), (0.75, 0, -0.5)), (2.0, (0, 1, 0), (1.75, 0.5, 0.5))]


def test_springs_are_read_as_they_are_written():
    made = of('pivot', 'spring: {at: [0, 0, 1], anchor: [1, 2, 3], stiffness: 4}')
    assert made.ties == (((0, 0, 1), (1, 2, 3), 4, 0),)
    made = of('pivot', 'spring: {at: [0, 0, 1], anchor: [1, 2, 3], stiffness: 4, length: 0.5}',
              '{angular_velocity: [1, 0, 0], position: [0.5, 0.25, 1]}')
    assert made.ties == (((0, 0, 1), (0.5, 1.75, 2), 4, 0.5),)
    hinge = '{hinge: {axis: [0, 0, 1]}}'
    made = of(hinge, 'spring: {stiffness: 8}, drag: {angular: 0.5}', '{rate: 2}')
    assert (made.stiffness, made.slack, made.angular) == (8, 0, 0.5)
    made = of(hinge, 'spring: {stiffness: 8, angle: 0.75, damping: 0.25}, drag: {angular: 0.5}',
              '{angle: 0.5}')
    assert (made.stiffness, made.slack, made.angular) == (8, 0.25, 0.75)
    with pytest.raises(BadInput, match='several torsion springs'):
        of(hinge, 'spring: {stiffness: 8}, spring: {stiffness: 8}', '{}')


def test_half_an_ulp_moves_equal_numbers_together_and_leaves_zero():
    move = inputs.Moved(3)
    with mp.workprec(BITS):
        assert move(0.03) == move(0.03)
        assert abs(move(0.03) - mpf(0.03)) == mpf(float(np.spacing(0.03))) / 2
        assert move(0.0) == 0
    numbers = [1.0 + k / 64.0 for k in range(64)]
    with mp.workprec(BITS):
        shifts = [(move(x) - mpf(x)) / mpf(float(np.spacing(x))) for x in numbers]
        assert set(shifts) == {mpf(1) / 2, -mpf(1) / 2}
        assert 20 < shifts.count(mpf(1) / 2) < 44    # drawn
