# SPDX-License-Identifier: Apache-2.0
"""Free body against 36 digits for all kinds of bodies (data/make_free_body.py); flips; flight."""

import json
import math
import pathlib
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from near import near

from rigid_body_sim.motions.free_body import anchor as anchors
from rigid_body_sim.motions.free_body import free_body as motion
from rigid_body_sim.motions.solver import loops
from rigid_body_sim.scene.bodies import IDENTITY, Body, Inertia
from rigid_body_sim.scene.constraints import Free
from rigid_body_sim.scene.effects.gravity import Gravity
from rigid_body_sim.scene.scene import Scene, parse_scene
from rigid_body_sim.scene.state import STATE_SIZE, State

RECORDS = json.loads((pathlib.Path(__file__).resolve().parents[2] / 'data'
                      / 'free_body.json').read_text())
EPSILON = np.finfo(float).eps


def parameters_of(moments, axes=IDENTITY, center_of_mass=(0.0, 0.0, 0.0), g=0.0):
    inertia = Inertia(tuple(moments), tuple(axes))
    body = Body(1.0, tuple(center_of_mass), inertia, inertia)
    effects = (Gravity(g),) if g else ()
    return motion.parameters(Scene('test', '', body, Free(), effects, State.of(), True, {}))


def anchored(parameters, start):
    anchor = np.empty(motion.ANCHOR_SIZE)
    motion.anchor(parameters, start, anchor)
    return anchor


def of_record(record):
    """Return the anchor of a reference case and its start."""
    parameters = parameters_of(record['moments'], *(record.get(key, default) for key, default in (
        ('axes', IDENTITY), ('center_of_mass', (0.0, 0.0, 0.0)), ('g', 0.0))))
    nothing = (0.0, 0.0, 0.0)
    start = State.of(0.0, record['orientation'], record['angular_velocity'],
                     record.get('position', nothing), record.get('velocity', nothing))
    return anchored(parameters, start.vector), start.vector


def at(anchor, time):
    out = np.empty(STATE_SIZE)
    motion.state(anchor, time, out)
    return out


def angle(found, expected):
    """Return the angle (rad) between an attitude and one given in digits."""
    with mp.workdps(50):
        p, q = [mp.mpf(float(x)) for x in found], [mp.mpf(x) for x in expected]
        x = p[3] * q[0] - p[0] * q[3] - p[1] * q[2] + p[2] * q[1]
        y = p[3] * q[1] - p[1] * q[3] - p[2] * q[0] + p[0] * q[2]
        z = p[3] * q[2] - p[2] * q[3] - p[0] * q[1] + p[1] * q[0]
        return float(2 * mp.atan2(mp.sqrt(x * x + y * y + z * z), abs(mp.fdot(p, q))))


def difference(found, expected):
    """Return the largest difference between numbers and numbers given in digits."""
    with mp.workdps(50):
        return float(max(abs(mp.mpf(float(a)) - mp.mpf(b))
                         for a, b in zip(found, expected, strict=True)))


@pytest.mark.parametrize('record', RECORDS, ids=lambda record: record['name'])
def test_reference(record):
    """Errors stay at the floor, although one ulp on the inputs makes up to 3 rad (separatrix).

    Rates have more digits than a double.
    """
    anchor, _ = of_record(record)
    size = math.hypot(*record['angular_velocity'])
    for state in record['states']:
        found, turned = at(anchor, state['time']), size * abs(state['time'])
        # measured: 1.1e-15 up to 100 rad; at most 0.25 eps |omega| t beyond (racket, 1e-40 off the
        # middle axis)
        assert angle(
            found[1:5], state['orientation']) < 2e-15 + 0.5 * EPSILON * turned, state['time']
        # measured: 1e-15; 0.035 eps |omega| t for the turned principal axes, which round omega at
        # the start
        assert difference(found[5:8], state['angular_velocity']) <= (
            2e-15 + 0.05 * EPSILON * turned) * size, state['time']
        if 'position' in state:
            fall = 4.0 + 0.5 * 9.81 * state['time'] ** 2 + 6.0 * state['time']
            # measured 1.1 ulp
            assert difference(found[8:11], state['position']) < 4.0 * EPSILON * fall
            assert (difference(found[11:14], state['velocity'])
                    < 4.0 * EPSILON * (10.0 + 9.81 * state['time']))


@pytest.mark.parametrize('record', RECORDS, ids=lambda record: record['name'])
def test_anchor_time_gives_the_start_back(record):
    anchor, start = of_record(record)
    found = at(anchor, start[0])
    assert found[5:8].tobytes() == start[5:8].tobytes()
    assert np.abs(found[1:5] - start[1:5]).max() <= 2.5e-16     # measured 1.7e-16
    assert np.abs(found[8:] - start[8:]).max() <= 4.0 * EPSILON * 10.0


@pytest.mark.parametrize(
    'record', [record for record in RECORDS if record['flips']], ids=lambda record: record['name'])
def test_flips_are_at_their_times(record):
    anchor, _ = of_record(record)
    time, count = 0.0, 0
    for flip in record['flips']:
        while count < flip['count']:
            time, code = motion.next_event(anchor, time)
            count += 1
        assert motion.EVENTS[code] == 'flip'
        assert time == near(float(mp.mpf(flip['time'])), 4.0 * EPSILON)     # measured 1.8 ulp


def test_no_flip_is_lost_in_a_long_jump_or_counted_twice():
    """Flips come every half period of omega_2, also where the motion is anchored beside one."""
    parameters = parameters_of((1.0, 2.0, 3.0))
    start = State.of(0.0, angular_velocity=(0.01, 5.0, 0.01)).vector
    anchor = anchored(parameters, start)
    times = np.arange(0.0, 200.0, 1e-2)
    states = np.empty((len(times), STATE_SIZE))
    loops(motion).states(anchor, times, states)
    changes = np.flatnonzero(np.signbit(states[1:, 6]) != np.signbit(states[:-1, 6]))
    found, time = [], 0.0
    while (time := motion.next_event(anchor, time)[0]) <= times[-1]:
        found.append(time)
    assert len(found) == len(changes) > 30
    assert all(times[change] <= flip <= times[change + 1]
               for change, flip in zip(changes, found, strict=True))
    assert motion.next_event(anchor, 1e6)[0] == near(
        1e6 + math.fmod(found[0] - 1e6, found[1] - found[0]) + found[1] - found[0], 1e-9)
    for beside, expected in ((-1e-9, found[3]), (1e-9, found[4])):
        again = anchored(parameters, at(anchor, found[3] + beside))
        # 1e-16 on omega_1 there, magnified
        assert motion.next_event(again, found[3] + beside)[0] == near(expected, 1e-8)


def test_a_wobble_is_no_flip():
    """The middle component of m stays below L/2: its changes of sign are not events."""
    start = State.of(0.0, angular_velocity=(0.1, 0.1, 5.0)).vector
    assert motion.next_event(anchored(parameters_of((1.0, 2.0, 3.0)), start), 0.0)[0] == math.inf
    assert motion.next_event(anchored(parameters_of((2.0, 2.0, 2.0)), start), 0.0)[0] == math.inf


def test_on_the_separatrix_the_body_turns_over_once_and_never_returns():
    """I = (3, 4, 6), omega = (2, c, 1): K is infinite; one lost bit would end it after 70 s."""
    for c in (-5.0, 0.0, 0.7):
        anchor = anchored(
            parameters_of((3.0, 4.0, 6.0)), State.of(0.0, angular_velocity=(2.0, c, 1.0)).vector)
        flip = motion.next_event(anchor, 0.0)[0]
        assert (flip < 10.0) == (c < 0.0)
        assert motion.next_event(anchor, 10.0)[0] > 1e30
        for time in (1e3, 1e9):
            assert at(anchor, time)[5:8] == pytest.approx(
                [0.0, math.sqrt(4.5 + c * c), 0.0], rel=1e-15, abs=1e-15)


def test_scene_file_is_absorbed():
    text = """
scene: thrown
body:
  mass: 2.0
  inertia: [[2.0, 0.1, 0.0], [0.1, 3.0, 0.2], [0.0, 0.2, 4.0]]
  center_of_mass: [0.1, 0.0, -0.2]
constraint: %s
effects: [gravity: {g: 9.81}%s]
initial: {angular_velocity: [0.3, 2.0, -0.4]}
"""
    scene = parse_scene(text % ('free', ''))
    assert motion.absorbs(scene)
    assert not motion.absorbs(parse_scene(text % ('pivot', '')))
    assert not motion.absorbs(parse_scene(text % ('free', ', drag: {linear: 0.1, angular: 0.1}')))
    # angular momentum about the centre of mass, by the tensor itself
    anchor = anchored(motion.parameters(scene), scene.initial.vector)
    tensor = np.array([[2.0, 0.1, 0.0], [0.1, 3.0, 0.2], [0.0, 0.2, 4.0]])
    later = State(at(anchor, 7.0))
    L = momentum_in_world(later, tensor)
    assert near(momentum_in_world(scene.initial, tensor), rel=2e-15) == L
    assert (later.position[2] + rotated(later, (0.1, 0.0, -0.2))[2]
            == near(-0.2 - 0.5 * 9.81 * 49.0 - 7.0 * 0.2, 1e-15))


def rotated(state, vector):
    u, w = state.orientation[:3], state.orientation[3]
    return vector + 2.0 * np.cross(u, np.cross(u, vector) + w * np.asarray(vector))


def momentum_in_world(state, tensor):
    return rotated(state, tensor @ state.angular_velocity)


@pytest.mark.parametrize('omega', [(2.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 2.0)])
def test_a_body_about_a_principal_axis_is_steady_and_one_beside_it_is_not(omega):
    moments = (1.0, 2.0, 3.0)
    assert anchors._is_principal(moments, omega)
    for k in range(3):
        beside = tuple(omega[n] or (1.0 if n == k else 0.0) for n in range(3))
        assert anchors._is_principal(moments, beside) == (beside == omega)
        assert anchors._is_principal((1.0, 1.0, 3.0), beside) == (
            beside == omega or beside[2] == 0.0)


@pytest.mark.parametrize('lost', [(2.0 ** -54, -2.0 ** -55, 0.0), (-2.0 ** -55, 2.0 ** -54, 0.0)])
def test_moments_of_one_double_are_sorted_by_what_was_lost(lost):
    small, middle = sorted(lost[:2])
    sizes = anchors.rotation_parameters(Inertia((1.0, 1.0, 2.0), lost=lost))
    assert np.isfinite(anchors.INERTIA.numbers(sizes)).all()
    in_order = anchors.rotation_parameters(Inertia((1.0, 1.0, 2.0), lost=(small, middle, 0.0)))
    assert sizes[:3] == in_order[:3]


@pytest.mark.parametrize(('small', 'large'), [
    (1.5, 0.7), (1.0, 1e-300), (1e-300, 1.0), (1e-200, 3e-190), (3e-190, -1e-200), (-2e-71, 1e-72),
    (0.0, 1e-250), (1e-280, 0.0), (0.0, 0.0)])
def test_the_discriminant_is_exact_to_the_last_digits_of_pairs_however_slow_the_body(small, large):
    """It is (c - a)/(a b c) (c (c - b) large^2 - a (b - a) small^2) for moments a, b, c."""
    sizes = anchors.rotation_parameters(Inertia((1.0, 2.0, 4.0)))
    numbers = np.array(anchors.INERTIA.numbers(sizes))
    a, b, c = Fraction(1, 8), Fraction(1, 4), Fraction(1, 2)    # in a unit of their own
    of_large, of_small = (Fraction(large) ** 2 * c * (c - b), Fraction(small) ** 2 * a * (b - a))
    factor = (c - a) / (a * b * c)
    (high, low), lift = anchors._discriminant(numbers, small, large)
    found = (Fraction(high) + Fraction(low)) * Fraction(lift) ** 2
    assert abs(found - factor * (of_large - of_small)) <= Fraction(1e-30) * factor * (
        of_large + of_small)


@pytest.mark.parametrize('size', [1e-249, 1e-100, 1e-71, 1e-69, 1.0, 1e69, 1e71, 1e100, 1.7e308])
@pytest.mark.parametrize('place', range(3))
def test_rates_are_scaled_by_powers_of_two_where_their_squares_would_leave_doubles(size, place):
    omega = [0.3 * size, 0.3 * size, 0.3 * size]
    omega[place] = -size
    scale, unscale = anchors._units(tuple(omega))
    assert scale * unscale == 1.0
    assert math.frexp(scale)[0] == 0.5
    assert 1e-150 < (scale * size) ** 2 < 1e150


def test_a_body_that_does_not_turn_in_all_time_is_taken_as_one_at_rest():
    assert anchors._units((1e-251, -1e-251, 0.0)) == (0.0, 1.0)
