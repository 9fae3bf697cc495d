# SPDX-License-Identifier: Apache-2.0
"""Ball on a table: against 34 digits, against hand calculations, and through its hard spots."""

import json
import math
import os
import pathlib
import subprocess
import sys
import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.mechanics.ledger import ANGULAR_IMPULSE, DISSIPATED, ENTRIES_SIZE
from rigid_body_sim.motions import sliding_sphere as motion
from rigid_body_sim.numerics.ramped_rotation import HALF_STEP
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.state import STATE_SIZE

ROOT = pathlib.Path(__file__).resolve().parents[2]
RECORDS = json.loads((ROOT / 'test' / 'data' / 'sliding_sphere.json').read_text())
EPSILON = np.finfo(float).eps
BALL = (0.028575, 0.4, 0.17, 0.2, 9.81)    # radius, k, mass, mu, g


def start_of(velocity=(0.0, 0.0), spin=(0.0, 0.0, 0.0), orientation=(0.0, 0.0, 0.0, 1.0),
             radius=BALL[0], time=0.0):
    return np.array([time, *orientation, *spin, 0.0, 0.0, radius, *velocity, 0.0])


def anchored(start, parameters=BALL):
    anchor = np.empty(motion.ANCHOR_SIZE)
    motion.anchor(np.array(parameters), start, anchor)
    return anchor


def at(anchor, time):
    out = np.empty(STATE_SIZE)
    motion.state(anchor, time, out)
    return out


def entries_at(anchor, time):
    out = np.empty(ENTRIES_SIZE)
    motion.entries(anchor, time, out)
    return out


def kinetic(state, parameters=BALL):
    a, k, M = parameters[:3]
    return 0.5 * M * (state[11:14] @ state[11:14] + k * a * a * state[5:8] @ state[5:8])


def world_spin(state):
    return np.array(rotate(*state[1:5], *state[5:8]))


@pytest.mark.parametrize(('mechanism', 'acting', 'moment', 'taken'), [
    (Mechanism.TABLE, ['friction'], 0.1, True), (Mechanism.TABLE, [], 0.1, True),
    (Mechanism.PLANE, ['friction'], 0.1, False), (Mechanism.FREE, [], 0.1, False),
    (Mechanism.TABLE, ['friction', None], 0.1, False), (Mechanism.TABLE, [None], 0.1, False),
    (Mechanism.TABLE, ['friction'], 0.0, False)])
def test_it_takes_a_ball_with_moments_on_a_table_under_its_contact_alone(
        mechanism, acting, moment, taken):
    scene = types.SimpleNamespace(
        constraint=types.SimpleNamespace(mechanism=mechanism),
        acting=[types.SimpleNamespace(contact=contact) for contact in acting],
        body=types.SimpleNamespace(about_center=types.SimpleNamespace(moments=(moment,) * 3)))
    assert motion.absorbs(scene) is taken


# parts of a state and the size against which their errors are counted
PARTS = {'orientation': slice(1, 5), 'angular_velocity': slice(5, 8), 'position': slice(8, 10),
         'velocity': slice(11, 13)}


def conditioning(parameters, start, time, part):
    """Return what one ulp on every input does to a part of the state, summed over the inputs."""
    plain = at(anchored(start, parameters), time)[part]
    total = 0.0
    for vector, places in (
            (start, (1, 2, 3, 4, 5, 6, 7, 11, 12)), (np.array(parameters), (0, 1, 3, 4))):
        for place in places:
            nudged = vector.copy()
            nudged[place] = np.nextafter(nudged[place], math.inf)
            case = (nudged, parameters) if vector is start else (start, nudged)
            total += np.linalg.norm(at(anchored(*case), time)[part] - plain)
    return (total + np.linalg.norm(at(
        anchored(start, parameters), np.nextafter(time, math.inf))[part] - plain))


@pytest.mark.parametrize('name', RECORDS)
def test_reference(name):
    record = RECORDS[name]
    parameters = np.array([record['radius'], record['ratio'], 0.17, record['mu'], record['g']])
    start = start_of(
        record['velocity'], record['angular_velocity'], record['orientation'], record['radius'])
    anchor = anchored(start, parameters)
    # worst measured 2 epsilon (fast spin)
    assert motion.rolling_onset(anchor) == near(float(record['onset']), 3.0 * EPSILON)
    for entry in record['states']:
        time = float.fromhex(entry['time'])
        values = [float(value) for value in entry['state']]
        expected = np.array([time, *values[:9], record['radius'], *values[9:], 0.0])
        state = at(anchor, time)
        for part, where in PARTS.items():
            floor = (2.0 * EPSILON
                     * max(np.linalg.norm(expected[where]), np.linalg.norm(start[where])))
            # worst measured: 0.68 of this (attitude 2.2e-14 after 500 rad, fast spin); the others
            # are below 0.35
            bound = floor + conditioning(parameters, start, time, where)
            assert np.linalg.norm(state[where] - expected[where]) <= bound, (part, entry['time'])


def test_struck_at_the_centre_rolls_after_two_sevenths():
    """Notes: t = 2 v0/(7 mu g), final speed 5 v0/7, by then 12 v0^2/(49 mu g) away."""
    v0, mu, g = 1.5, *BALL[3:]
    anchor = anchored(start_of((v0, 0.0)))
    onset = motion.rolling_onset(anchor)
    state = at(anchor, onset)
    assert onset == near(2.0 * v0 / (7.0 * mu * g), 1e-15)
    assert motion.next_event(anchor, 0.0) == (onset, 0)
    assert motion.next_event(anchor, onset)[0] == math.inf
    assert state[11] == near(5.0 * v0 / 7.0, 1e-15)
    assert state[8] == near(12.0 * v0 * v0 / (49.0 * mu * g), 1e-15)
    assert world_spin(state)[1] == near(state[11] / BALL[0], 1e-15)


@pytest.mark.parametrize('h', [-0.9, -0.3, 0.2, 0.41, 0.7, 1.0])
def test_struck_off_the_centre(h):
    """On both sides of h = 2a/5: t = 2 |v0 - a omega0|/(7 mu g) and v = (5/7) v0 (1 + h/a).

    Above it friction points forward.
    """
    a, _, M, mu, g = BALL
    v0 = 2.0
    anchor = anchored(start_of((v0, 0.0), (0.0, 2.5 * v0 * h / a, 0.0)))
    onset = motion.rolling_onset(anchor)
    assert onset == near(2.0 * v0 * abs(1.0 - 2.5 * h) / (7.0 * mu * g), 1e-14)
    assert at(anchor, onset)[11] == near(5.0 / 7.0 * v0 * (1.0 + h), 1e-14)
    assert motion.reaction(anchor, 0.5 * onset) == near(
        (math.copysign(mu * M * g, h - 0.4), 0.0, M * g), 1e-14)
    assert motion.reaction(anchor, onset) == (0.0, 0.0, M * g)


def test_struck_at_two_fifths_rolls_at_once():
    rng = np.random.default_rng(2)
    for _ in range(500):
        a, v0, direction = (
            rng.uniform(0.01, 1.0), 10.0 ** rng.uniform(-3, 3), rng.uniform(0.0, 2.0 * math.pi))
        velocity = v0 * np.array([math.cos(direction), math.sin(direction)])
        h = 2.0 * a / 5.0
        rate = 2.5 * h / (a * a)
        anchor = anchored(
            start_of(velocity, (-rate * velocity[1], rate * velocity[0], 0.0), radius=a),
            (a, *BALL[1:]))
        assert motion.rolling_onset(anchor) == 0.0
        assert motion.next_event(anchor, -1.0)[0] == math.inf
        assert motion.slip(anchor, 0.0) == (0.0, 0.0)
        assert np.array_equal(at(anchor, 7.0)[11:13], velocity)


def test_a_hair_off_two_fifths_slides():
    """The snap is no wider than rounding: 1e-14 off the height still slides as predicted."""
    for off in (1e-14, -1e-14):
        anchor = anchored(start_of((2.0, 0.0), (0.0, 2.0 / BALL[0] * (1.0 + off), 0.0)))
        assert motion.rolling_onset(anchor) == near(
            4.0 / (7.0 * BALL[3] * BALL[4]) * abs(off), 0.05)


def test_draw_shot_comes_back():
    anchor = anchored(start_of((1.0, 0.0), (0.0, -140.0, 0.0)))
    onset = motion.rolling_onset(anchor)
    turning = 1.0 / (BALL[3] * BALL[4])
    assert at(anchor, turning)[11] == pytest.approx(0.0, abs=1e-15)
    assert at(anchor, turning)[8] == near(0.5 * turning, 1e-15)
    assert at(anchor, onset)[11] == near((1.0 - 0.4 * BALL[0] * 140.0) / 1.4, 1e-14)
    assert at(anchor, onset)[11] < 0.0


def test_masse_runs_on_a_parabola():
    """The slip keeps its direction, so the path is a parabola; side spin is untouched."""
    anchor = anchored(start_of((1.5, 0.0), (70.0, 20.0, 40.0)))
    onset = motion.rolling_onset(anchor)
    u = np.array(motion.slip(anchor, 0.0))
    for share in (0.2, 0.5, 0.9):
        time = share * onset
        state = at(anchor, time)
        assert motion.slip(anchor, time) == near(tuple((1.0 - share) * u), 1e-13)
        assert state[8:10] == near(np.array([1.5, 0.0]) * time
                                   - 0.5 * BALL[3] * BALL[4] * time * time * u / np.linalg.norm(u),
                                   1e-14)
        spin = world_spin(state)
        assert spin[2] == near(40.0, 1e-14)
        assert (state[11] - BALL[0] * spin[1], state[12] + BALL[0] * spin[0]) == near(
            motion.slip(anchor, time), 1e-12)
    assert at(anchor, onset)[11:13] == near(
        ((1.5 + 0.4 * BALL[0] * 20.0) / 1.4, -0.4 * BALL[0] * 70.0 / 1.4), 1e-14)


def test_without_friction_it_glides():
    parameters = (*BALL[:3], 0.0, 0.0)
    start = start_of((1.0, -2.0), (3.0, 4.0, 12.0))
    anchor, state = anchored(start, parameters), at(anchored(start, parameters), 0.1)
    assert motion.rolling_onset(anchor) == math.inf
    assert np.array_equal(state[11:13], start[11:13])
    assert motion.slip(anchor, 0.1) == motion.slip(anchor, 0.0) != (0.0, 0.0)
    assert state[4] == near(math.cos(0.65), 1e-15)
    assert state[5:8] == near(start[5:8], 1e-15)
    assert not entries_at(anchor, 0.1).any()
    assert motion.next_event(anchor, 0.0)[0] == math.inf
    assert motion.reaction(anchor, 0.1) == (0.0, 0.0, 0.0)


def test_hardly_any_friction():
    for mu in (1e-6, 1e-100, 5e-324):
        state = at(anchored(start_of((1.0, 0.0), (0.0, 0.0, 5.0)), (*BALL[:3], mu, 9.81)), 2.0)
        assert np.isfinite(state).all()
        assert state[11] == near(1.0 - 2.0 * 9.81 * mu, 1e-15)
        assert state[4] == near(math.cos(5.0), 1e-15 if mu < 1e-99 else 1e-3)


def test_energy_lost_is_heat():
    """Kinetic energy balances the work of friction; so do spin and the torque of the table."""
    rng = np.random.default_rng(7)
    for _ in range(200):
        start = start_of(rng.normal(size=2) * 3.0, rng.normal(size=3) * 80.0)
        anchor = anchored(start)
        onset = motion.rolling_onset(anchor)
        for time in (-0.3 * onset, 0.4 * onset, onset, 2.0 * onset):
            state = at(anchor, time)
            balance = kinetic(state) + entries_at(anchor, time)[DISSIPATED] - kinetic(start)
            # worst measured 2.3 epsilon
            assert abs(balance) <= 6.0 * EPSILON * max(kinetic(start), kinetic(state))
            gained = BALL[1] * BALL[2] * BALL[0] ** 2 * (world_spin(state) - world_spin(start))
            size = (BALL[1] * BALL[2] * BALL[0] ** 2
                    * max(np.linalg.norm(start[5:8]), np.linalg.norm(state[5:8])))
            # worst measured 5.8 epsilon
            assert (np.linalg.norm(gained - entries_at(anchor, time)[ANGULAR_IMPULSE])
                    <= 12.0 * EPSILON * size)


def test_rolling_does_not_chatter():
    """Anchored at every millisecond for 10 s it never slips, and the velocity keeps all bits."""
    anchor = anchored(start_of((1.2, -0.7), (30.0, 15.0, 60.0), (0.5, -0.5, 0.1, 0.7)))
    onset = motion.rolling_onset(anchor)
    state = at(anchor, onset)
    velocity, spin = state[11:13].copy(), world_spin(state)[2]
    for k in range(10000):
        anchor = anchored(state)
        assert motion.rolling_onset(anchor) == state[0]
        assert motion.slip(anchor, state[0] + 0.3) == (0.0, 0.0)
        state = at(anchor, onset + 0.001 * (k + 1))
        assert np.array_equal(state[11:13], velocity)
    # the vertical spin goes 10000 times into body axes and back, half an ulp of omega each way at
    # random; measured 42 epsilon of omega, and 540 when rotations.normalised rounds to one side
    assert world_spin(state)[2] == near(
        spin, 100.0 * EPSILON * np.linalg.norm(state[5:8]) / abs(spin))


@pytest.mark.parametrize('spin', [(30.0, -40.0, 0.0), (30.0, -40.0, 90.0)])
def test_anchored_anew_while_sliding(spin):
    """Two thousand anchors along the slide end where one does, in onset and attitude."""
    start = start_of((1.5, 0.4), spin)
    anchor = anchored(start)
    onset, state = motion.rolling_onset(anchor), start
    for k in range(1, 2001):
        state = at(anchored(state), k * onset / 2000.0 * 0.999)
    assert motion.rolling_onset(anchored(state)) == near(onset, 1e-13)
    # every anchor rounds omega by half an ulp, and equal decrements round alike:
    # 2000 * 7e-15 rad/s * 2 s = 3e-11; measured 4e-12
    assert at(anchored(state), 2.0)[1:5] == pytest.approx(at(anchor, 2.0)[1:5], abs=3e-11)


def test_struck_again_at_the_very_onset():
    """A blow at the instant when rolling begins: it slides again, from the rolling velocity."""
    anchor = anchored(start_of((1.5, 0.0)))
    onset = motion.rolling_onset(anchor)
    state = at(anchor, onset)
    state[12] += 0.5
    again = anchored(state)
    assert motion.slip(again, onset) == pytest.approx((0.0, 0.5), rel=1e-14, abs=1e-15)
    assert motion.rolling_onset(again) == near(onset + 1.0 / (7.0 * BALL[3] * BALL[4]), 1e-14)
    assert at(again, 2.0)[11:13] == near((1.5 * 5.0 / 7.0, 0.5 * 5.0 / 7.0), 1e-14)


def test_attitude_is_continuous():
    """The quaternion never jumps, at the checkpoints of the slide, the onset or the anchor."""
    anchor = anchored(start_of((3.0, 1.0), (20.0, -90.0, 70.0)))
    onset = motion.rolling_onset(anchor)
    times = np.linspace(-0.5 * onset, 1.5 * onset, 20001)
    states = np.array([at(anchor, time) for time in times])
    rates, jumps = (np.linalg.norm(states[:, 5:8], axis=1),
                    np.linalg.norm(np.diff(states[:, 1:5], axis=0), axis=1))
    assert (jumps <= 0.5 * np.maximum(rates[1:], rates[:-1]) * np.diff(times) * (
        1.0 + 1e-6) + 1e-14).all()
    # measured 1
    assert np.abs(np.linalg.norm(states[:, 1:5], axis=1) - 1.0).max() <= 2.0 * EPSILON


def test_long_before_and_long_after():
    """A million seconds either way: finite, unit, and after the onset plain rolling."""
    anchor = anchored(start_of((1.0, 0.0), (0.0, 0.0, 30.0)))
    onset = motion.rolling_onset(anchor)
    assert at(anchor, 1e6)[8] == near(6.0 / 7.0 * onset + 5.0 / 7.0 * (1e6 - onset), 1e-15)
    before = at(anchor, -1e6)
    assert before[11] == near(1.0 + BALL[3] * BALL[4] * 1e6, 1e-15)
    assert np.linalg.norm(before[1:5]) == pytest.approx(1.0, abs=1e-15)


def test_enormous_blow_stays_finite():
    anchor = anchored(start_of((1e300, 0.0), (0.0, 1e299, 1e299)))
    assert motion.rolling_onset(anchor) > 1e299
    assert np.isfinite(at(anchor, 0.001)).all()


PLAIN = """
import json, sys
import numpy as np
from rigid_body_sim.compilation.jit import HAVE_NUMBA
from rigid_body_sim.motions import sliding_sphere as motion
assert not HAVE_NUMBA
anchor, out = np.empty(motion.ANCHOR_SIZE), np.empty(14)
motion.anchor(np.array(json.loads(sys.argv[1])), np.array(json.loads(sys.argv[2])), anchor)
states = []
for time in json.loads(sys.argv[3]):
    motion.state(anchor, time, out)
    states.append(out.tolist())
print(json.dumps(states))
"""


@pytest.mark.parametrize(('velocity', 'spin', 'steps'), [
    # steps of 2^-52 in the speed v = 1, of which eight for each 1 of |v| + a |omega| are rounding
    ((1.0, 0.0), (0.0, 2.0, 0.0), 16), ((0.0, 1.0), (-2.0, 0.0, 0.0), 16),
    ((-1.0, 0.0), (0.0, -2.0, 0.0), 16), ((1.0, 0.0), (0.0, 2.0, 20.0), 88),
    ((0.0, 1.0), (-2.0, 0.0, -20.0), 88)])
def test_a_slip_below_the_rounding_of_all_speeds_is_none(velocity, spin, steps):
    """A ball of radius 0.5 rolls where v = 0.5 omega; eight ulp of the speeds count as none."""
    for more, slides in ((steps - 2, False), (steps + 3, True)):
        grown = tuple(part * (1.0 + more * EPSILON) for part in velocity)
        anchor = anchored(start_of(grown, spin, radius=0.5), (0.5, 0.4, 2.0, 0.2, 9.81))
        assert (motion.load_slide(anchor).u > 0.0) == slides
        assert (motion.next_event(anchor, -1.0)[0] < math.inf) == slides
        assert motion.next_event(anchor, 9.0) == (math.inf, 0)


@pytest.mark.parametrize(('velocity', 'spin'), [
    ((3.0, 1.0), (5.0, -7.0, 30.0)),      # it turns faster at the end
    ((0.5, -0.2), (90.0, 140.0, 30.0))])    # and at the start
def test_checkpoints_are_a_step_of_the_series_apart(velocity, spin):
    """Half the angle turned at the larger rate, in steps of two times HALF_STEP."""
    anchor = anchored(start_of(velocity, spin))
    a, k, _, mu, g = BALL
    slip = np.array([velocity[0] - a * spin[1], velocity[1] + a * spin[0]])
    duration = k / (1.0 + k) * np.linalg.norm(slip) / (mu * g)
    turned = mu * g * duration / (k * a) * np.array([-slip[1], slip[0]]) / np.linalg.norm(slip)
    rates = [np.linalg.norm(spin), np.hypot(np.linalg.norm(spin[:2] + turned), spin[2])]
    steps = 0.25 * duration * max(rates) / HALF_STEP
    track = motion.load_track(anchor)
    assert 1 < track.count == 1 + int(steps) <= motion.CHECKPOINTS
    assert track.interval == near(duration / track.count, rel=1e-12)
    assert 1 + int(0.25 * duration * min(rates) / HALF_STEP) < track.count


@pytest.mark.parametrize(('velocity', 'spin', 'count'), [
    ((10.0, 0.0), (0.0, 0.0, 0.0), 1),      # it turns about one axis
    ((10.0, 0.0), (0.0, 0.0, 1e4), 1),      # fast about another one: nothing is gained
    # slowly about another one while the rate along the ramp is within reach of 0
    ((10.0, 0.0), (0.1, 0.0, 0.0), 32), ((10.0, 0.0), (0.1, -200.0, 0.0), 32),
    ((20.0, 0.0), (0.1, 200.0, 0.0), 1),    # which it has left before,
    ((10.0, 0.0), (0.1, -3000.0, 0.0), 1)])    # or does not reach
def test_a_long_slide_has_all_checkpoints_where_it_turns_about_two_axes(velocity, spin, count):
    anchor = anchored(start_of(velocity, spin))
    track = motion.load_track(anchor)
    assert track.count == count
    assert track.interval == near(motion.load_duration(anchor) / count, rel=1e-15)


def test_a_ball_at_rest_neither_slides_nor_turns():
    anchor = anchored(start_of())
    assert motion.load_slide(anchor).u == 0.0
    assert (at(anchor, 2.0)[1:] == start_of()[1:]).all()


def test_the_same_without_numba():
    start = start_of((1.5, 0.4), (30.0, -40.0, 90.0))
    times = [-0.1, 0.05, 0.2, 3.0]
    anchor = anchored(start)
    command = [
        sys.executable, '-c', PLAIN, *(json.dumps(list(part)) for part in (BALL, start, times))]
    environment = {**os.environ, 'NUMBA_DISABLE_JIT': '1'}
    answer = subprocess.run(command, text=True, check=True, capture_output=True, cwd=ROOT,
                            env=environment, timeout=120)
    for time, state in zip(times, json.loads(answer.stdout), strict=True):
        assert at(anchor, time) == pytest.approx(np.array(state), rel=1e-13, abs=1e-14)
