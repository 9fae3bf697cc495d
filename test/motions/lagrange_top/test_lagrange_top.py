# SPDX-License-Identifier: Apache-2.0
"""Lagrange top against 34 digits of the equations of motion, and through its hard spots.

test/data/make_lagrange_top.py makes the references.
"""

import json
import math
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest
from mpmath import mp, mpf
from tops import HEAVY, ROUND, UPRIGHT, anchored, at, many

from rigid_body_sim.motions.lagrange_top import lagrange_top as motion
from rigid_body_sim.numerics.rotations import from_euler_zyz

ROOT = pathlib.Path(__file__).resolve().parents[3]
CASES = json.loads((ROOT / 'test' / 'data' / 'lagrange_top.json').read_text())
MOMENTS = [(name, k) for name, case in CASES.items() for k in range(len(case['states']))]
# cases whose top's axes are not the body's: the turn into them rounds like a change of the inputs
TURNED = ('axis_x_hanging', 'axis_y', 'ball_on_a_string')


def distance(found, exact):
    """Return the length of the difference from exact numbers in decimal digits."""
    with mp.workdps(50):
        return float(mp.sqrt(mp.fsum((mpf(float(x)) - mpf(y)) ** 2
                                     for x, y in zip(found, exact, strict=True))))


def invariants(body, states):
    """Return energy, P_alpha and P_gamma (in units of I1) of states, and the sizes of their terms.

    The body has e3 = z.
    """
    I1, _, I3 = body['moments']
    k = body['mass'] * body['g'] * body['center'][2] / I1
    x, y, z, w = states[:, 1:5].T
    o1, o2, o3 = states[:, 5:8].T
    g1, g2, g3 = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), (z * z + w * w) - (x * x + y * y)
    across = o1 * g1 + o2 * g2
    n = I3 / I1 * o3
    kinetic = 0.5 * (o1 * o1 + o2 * o2)
    size = np.abs(across).max() + np.abs(n).max()
    return (np.array([kinetic + k * g3, across + n * g3, n]),
            np.array([kinetic.max() + abs(k), size, size]))


@pytest.mark.without_numba
@pytest.mark.parametrize(('name', 'k'), MOMENTS)
def test_states_agree_with_34_digits(name, k):
    case = CASES[name]
    exact = case['states'][k]
    parameters, anchor = anchored(case, case['orientation'], case['angular_velocity'])
    state = at(anchor, exact['time'])
    attitude, rate = ((2.0, 1.0) * np.array([distance(state[1:5], exact['orientation']),
                                             distance(state[5:8], exact['angular_velocity'])]))
    pull = parameters[motion.PARAMETERS.part('pull').first]
    size = math.hypot(*case['angular_velocity'], math.sqrt(pull))
    conditioning = exact['sensitivity'] if name in TURNED else (0.0, 0.0)
    # the worst is 1.2e-15 rad (loops, at 0.1 s: rounding of the doubles themselves is 2e-16), also
    # after 1e6 s, where one ulp on the inputs makes up to 1e-8 rad; of the angular velocity 5e-16
    # of its size
    assert attitude <= max(2e-15, conditioning[0])
    assert rate <= max(1e-15 * size, conditioning[1])


@pytest.mark.parametrize('name', CASES)
def test_the_start_comes_back(name):
    case = CASES[name]
    _, anchor = anchored(case, case['orientation'], case['angular_velocity'], time=3.7)
    state = at(anchor, 3.7)
    size = math.hypot(*case['angular_velocity'], math.sqrt(case['g'] / 0.1))
    assert state[0] == 3.7
    np.testing.assert_allclose(
        state[1:5], np.array(case['orientation']) / np.linalg.norm(case['orientation']), rtol=0.0,
        atol=6e-16)
    np.testing.assert_allclose(state[5:8], case['angular_velocity'], rtol=0.0, atol=6e-16 * size)
    assert not state[8:].any()


@pytest.mark.parametrize(('name', 'tilt'), [
    ('nearly_sleeping_1e-200', 1e-200), ('nearly_sleeping_1e-9', 1e-9),
    ('swinging_1e-300', 1e-300), ('swinging_1e-9', 1e-9),
    ('falling_1e-9', 1e-6)])
def test_a_tiny_tilt_keeps_its_digits(name, tilt):
    # an absolute error of 1e-16 is nothing to the attitude, but decides when an unstable top falls
    # after the next anchor
    case = CASES[name]
    _, anchor = anchored(case, case['orientation'], case['angular_velocity'])
    exact = case['states'][0]
    state = at(anchor, exact['time'])
    q = [float(x) for x in exact['orientation']]
    small = [1, 2] if abs(q[0]) < 0.5 and abs(q[1]) < 0.5 else [3, 4]
    assert 0.0 < np.abs(state[small]).max() < 10.0 * tilt
    # 5e-14
    np.testing.assert_allclose(state[small], [q[k - 1] for k in small], rtol=0.0,
                               atol=2e-13 * np.abs(state[small]).max())
    omega = [float(x) for x in exact['angular_velocity']][:2]
    np.testing.assert_allclose(
        state[5:7], omega, rtol=0.0, atol=2e-13 * max(np.abs(omega).max(), tilt))


@pytest.mark.parametrize(
    'name', [name for name, case in CASES.items() if 'turning_points' in case])
def test_turning_points_are_found_to_round_off(name):
    case = CASES[name]
    _, anchor = anchored(case, case['orientation'], case['angular_velocity'])
    first, second = (mpf(time) for time in case['turning_points'])
    half = second - first
    index = motion.turning_index(anchor, float(first + half / 2))
    assert motion.turning_index(anchor, float(first - half / 2)) == index - 1.0
    for k in (0, 1, -1, 10 ** 6):
        # turning points are counted, so their times do not drift: the error is that of one
        # rounding, 2e-16 of the time
        assert (abs(motion.turning_time(anchor, index + k) - first - k * half)
                <= 1e-15 * half + 3e-16 * abs(first + k * half))
    if name == 'tiny_nutation':     # slighter than what doubles show: no event
        assert motion.next_event(anchor, 0.0)[0] == math.inf
    else:
        assert motion.next_event(anchor, float(first + half / 2)) == (
            motion.turning_time(anchor, index + 1.0), 0)


@pytest.mark.parametrize(('orientation', 'omega'),
                         [(from_euler_zyz(0.2, 0.5, 0.1), (0.0, 0.0, 60.0)),
                          (from_euler_zyz(0.2, 1.5, 0.1), (2.0, -1.0, -10.0))])
def test_events_are_the_sign_changes_of_the_rise(orientation, omega):
    _, anchor = anchored(HEAVY, orientation, omega)
    times = np.linspace(-3.0, 7.0, 200001)
    states = many(anchor, times)
    x, y, z, w = states[:, 1:5].T
    rise = 2.0 * (x * z - w * y) * states[:, 6] - 2.0 * (y * z + w * x) * states[:, 5]
    changes = np.flatnonzero(np.diff(np.sign(rise)) != 0.0)
    assert (len(changes) == motion.turning_index(anchor, 7.0) - motion.turning_index(anchor, -3.0)
            > 25)
    found, after = [], -3.0
    while (after := motion.next_event(anchor, after)[0]) <= 7.0:
        found.append(after)
    np.testing.assert_allclose(found, times[changes], rtol=0.0, atol=5.1e-5)
    height = (z * z + w * w) - (x * x + y * y)
    lowest = [height[k]
              for k, time in zip(changes, found)
              if motion.turning_index(anchor, time + 1e-6) % 2.0 == 0.0]
    assert max(lowest) - min(lowest) < 1e-6 < height.max() - max(lowest)
    np.testing.assert_allclose(min(lowest), height.min(), rtol=0.0, atol=1e-6)


@pytest.mark.parametrize('name',
                         ['heavy_top', 'loops', 'hanging_top', 'falling_heavy_top',
                          'spherical_pendulum', 'through_upright'])
def test_invariants_over_a_million_seconds(name):
    case = CASES[name]
    _, anchor = anchored(case, case['orientation'], case['angular_velocity'])
    states = many(anchor, np.linspace(0.0, 1e6, 20001))
    values, sizes = invariants(case, states)
    residual = (values - values[:, :1]) / sizes[:, None]
    # round-off without a trend: the mean of either half is as good as that of the other
    assert np.abs(residual).max() <= 2e-15                              # 1.3e-15
    # 6e-18
    halves = residual[:, :10000].mean(axis=1) - residual[:, 10001:].mean(axis=1)
    assert np.abs(halves).max() <= 2e-17
    norm = np.linalg.norm(states[:, 1:5], axis=1)
    assert np.abs(norm - 1.0).max() <= 4.5e-16


@pytest.mark.parametrize(
    ('body', 'orientation', 'omega'),
    [(HEAVY, from_euler_zyz(0.2, 0.5, 0.1), (0.0, 0.0, 60.0)),
     (HEAVY, from_euler_zyz(0.2, 2.5, 0.1), (9.0, 5.0, -3.0)), (HEAVY, UPRIGHT, (1e-9, 0.0, 20.0)),
     (HEAVY, [1.0, 0.0, 0.0, 0.0], (13.0, 0.0, 7.0)),
     (ROUND, [0.6, 0.0, 0.0, 0.8], (0.0, 3.0, 0.0))])
def test_the_quaternion_is_continuous(body, orientation, omega):
    _, anchor = anchored(body, orientation, omega)
    states = many(anchor, np.arange(-20.0, 20.0, 1e-3))
    steps = np.linalg.norm(np.diff(states[:, 1:5], axis=0), axis=1)
    fastest = np.linalg.norm(states[:, 5:8], axis=1).max()
    assert steps.max() <= 0.5 * fastest * 1.001e-3 + 1e-15
    assert np.vdot(at(anchor, 0.0)[1:5], orientation) > 0.0


@pytest.mark.parametrize('omega', [(0.3, 0.0, 60.0), (9.0, -5.0, -3.0)])
def test_bulk_and_single_states_have_the_same_bits(omega):
    _, anchor = anchored(HEAVY, from_euler_zyz(0.3, 0.5, 0.0), omega)
    times = np.random.default_rng(3).uniform(-100.0, 1000.0, 517)
    np.testing.assert_array_equal(many(anchor, times), [at(anchor, time) for time in times])
    np.testing.assert_array_equal(
        many(anchor, times[:3]), [at(anchor, time) for time in times[:3]])


def test_flow_composes_with_new_anchors():
    # jumps of random lengths, each from a new anchor, against one jump: the error walks at random
    _, anchor = anchored(HEAVY, from_euler_zyz(0.3, 0.5, 0.0), (0.5, -0.2, 40.0))
    parameters, again = anchored(HEAVY, from_euler_zyz(0.3, 0.5, 0.0), (0.5, -0.2, 40.0))
    random, time, state = np.random.default_rng(1), 0.0, at(again, 0.0)
    for _ in range(1000):
        time += random.uniform(-0.5, 1.0)
        motion.state(again, time, state)
        motion.anchor(parameters, state.copy(), again)
    assert time > 100.0
    # every new anchor rounds its start, and one ulp there makes up to 2e-12 rad at the end
    # (40 rad/s for 250 s): sqrt(1000 / 3) of them
    # 4.3e-11
    np.testing.assert_allclose(state[1:8], at(anchor, time)[1:8], rtol=0.0, atol=2e-10)


def test_the_same_without_numba():
    names = ['heavy_top', 'falling_1e-9', 'through_hanging', 'separatrix_in_a_plane']
    program = ('import json, sys; from tops import anchored, at; cases = '
               'json.loads(sys.stdin.read()); '
               'print(json.dumps([[at(anchored(c, c["orientation"], c["angular_velocity"])[1], '
               's["time"]).tolist() for s in c["states"]] '
               'for c in cases]))')
    done = subprocess.run(
        [sys.executable, '-c', program], input=json.dumps([CASES[name] for name in names]),
        capture_output=True, text=True,
        env={**os.environ, 'NUMBA_DISABLE_JIT': '1', 'PYTHONPATH': f'{ROOT}:{ROOT / "test"}'},
        check=True, timeout=120)
    plain = json.loads(done.stdout)
    for name, states in zip(names, plain, strict=True):
        case = CASES[name]
        _, anchor = anchored(case, case['orientation'], case['angular_velocity'])
        for state, exact in zip(states, case['states'], strict=True):
            np.testing.assert_allclose(state, at(anchor, exact['time']), rtol=0.0, atol=2e-14)
