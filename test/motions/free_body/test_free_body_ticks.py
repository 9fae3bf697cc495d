# SPDX-License-Identifier: Apache-2.0
"""Free body, tick by tick: bits, trends under re-anchoring, continuity, invariants."""

import hashlib
import math
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from near import near

from rigid_body_sim.compilation.jit import HAVE_NUMBA, compiled_allocating
from rigid_body_sim.errors import BadInput
from rigid_body_sim.motions.free_body import free_body as motion
from rigid_body_sim.motions.solver import loops
from rigid_body_sim.numerics.rotations import angle_between, rotate
from rigid_body_sim.scene.bodies import Body, Inertia
from rigid_body_sim.scene.constraints import Free
from rigid_body_sim.scene.scene import Scene
from rigid_body_sim.scene.state import STATE_SIZE, State

ROOT = pathlib.Path(__file__).resolve().parents[3]
EPSILON = np.finfo(float).eps
# one for every form of the series, with and without the centre of mass at the origin
MOTIONS = {'circular': ((2.0, 3.0, 4.0), (0.7, -0.4, 1.1)),
           'hyperbolic': ((1.0, 2.0, 3.0), (0.01, 5.0, 0.01)),
           'separatrix': ((3.0, 4.0, 6.0), (2.0, -0.7, 1.0)),
           'symmetric': ((1.0, 1.0, 0.3), (1.0, 0.3, -2.0)),
           'steady': ((0.4, 0.4, 0.4), (0.7, -0.4, 1.1)),
           'long axis': ((2.0, 3.0, 4.0), (-1.5, 0.2, 0.1))}


def parameters_of(moments, center_of_mass=(0.0, 0.0, 0.0)):
    inertia = Inertia(tuple(float(moment) for moment in moments))
    return motion.parameters(Scene(
        'test', '', Body(1.0, center_of_mass, inertia, inertia), Free(), (), State.of(), True, {}))


def start_of(omega, time=0.0):
    return State.of(time, (0.1, 0.2, -0.3, 0.9273618495495704), omega, (1.0, 2.0, 3.0),
                    (0.1, -0.2, 0.3)).vector


def anchored(parameters, start):
    anchor = np.empty(motion.ANCHOR_SIZE)
    motion.anchor(parameters, start, anchor)
    return anchor


def at(anchor, time):
    out = np.empty(STATE_SIZE)
    motion.state(anchor, time, out)
    return out


def through(anchor, times):
    out = np.empty((len(times), STATE_SIZE))
    loops(motion).states(anchor, times, out)
    return out


@pytest.mark.parametrize('name', MOTIONS)
@pytest.mark.parametrize('center', [(0.0, 0.0, 0.0), (0.1, -0.2, 0.3)])
def test_many_states_have_the_bits_of_single_ones(name, center):
    """Vector code and scalar code do the same operations; order and company do not matter."""
    moments, omega = MOTIONS[name]
    anchor = anchored(parameters_of(moments, center), start_of(omega, 0.3))
    times = np.random.default_rng(1).uniform(-50.0, 1000.0, 1003)
    together = through(anchor, times)
    for k in (0, 1, 7, 127, 128, 500, 1001, 1002):
        assert together[k].tobytes() == at(anchor, times[k]).tobytes()
        assert through(anchor, times[k:k + 3])[0].tobytes() == together[k].tobytes()
    assert through(anchor, times[::-1].copy())[::-1].tobytes() == together.tobytes()
    one_by_one = np.empty_like(together)
    loops(motion).one_by_one(anchor, times, one_by_one)
    assert one_by_one.tobytes() == together.tobytes()


@pytest.mark.skipif(not HAVE_NUMBA, reason='a million states take minutes without numba')
def test_single_jump_of_1e6_s_equals_a_million_ticks():
    for moments, omega in MOTIONS.values():
        anchor = anchored(parameters_of(moments), start_of(omega))
        ticks = through(anchor, np.arange(1.0, 1e6 + 1.0))
        assert ticks[-1].tobytes() == at(anchor, 1e6).tobytes()
        assert ticks[123456].tobytes() == at(anchor, 123457.0).tobytes()


@pytest.mark.parametrize('name', MOTIONS)
def test_sign_of_the_quaternion_is_continuous(name):
    moments, omega = MOTIONS[name]
    size = math.hypot(*omega)
    anchor = anchored(parameters_of(moments), start_of(omega))
    states = through(anchor, np.linspace(-40.0, 400.0, 80001))
    steps = np.einsum('ij,ij->i', states[1:, 1:5], states[:-1, 1:5])
    fastest = max(moments) / min(moments) * size
    assert steps.min() > math.cos(0.5 * fastest * 440.0 / 80000) - 1e-15
    assert at(anchor, 0.0)[4] > 0.0


def test_ensemble_has_the_bits_of_single_runs():
    parameters = np.array([parameters_of(moments) for moments, _ in MOTIONS.values()])
    starts = np.array([start_of(omega, 0.1 * k) for k, (_, omega) in enumerate(MOTIONS.values())])
    times = np.linspace(-1.0, 30.0, 11)
    out = np.empty((len(starts), len(times), STATE_SIZE))
    loops(motion).ensemble(parameters, starts, times, out)
    for k, start in enumerate(starts):
        assert out[k].tobytes() == through(anchored(parameters[k], start), times).tobytes()
    many = np.repeat(starts[:1], 200, axis=0)
    out = np.empty((200, 1, STATE_SIZE))
    loops(motion).ensemble(parameters[:1], many, times[3:4], out)
    assert (out == at(anchored(parameters[0], starts[0]), times[3])).all()


BITS = """
import sys
import hashlib
sys.path.insert(0, sys.argv[1])
import test_free_body_ticks as ticks
print(ticks.digest())
"""


def digest():
    """Return a hash of some hundred states of all kinds."""
    bits = hashlib.sha256()
    rng = np.random.default_rng(7)
    for n in range(150):
        moments = rng.uniform(1.0, 2.0, 3)
        if n % 5 == 0:
            moments[1] = moments[0]
        omega = rng.normal(size=3) * (1.0 if n % 3 else 10.0 ** rng.uniform(-300.0, 0.0, 3))
        bits.update(at(anchored(parameters_of(moments, (0.1, 0.0, 0.2)), start_of(omega.tolist())),
                       10.0 ** rng.uniform(-3.0, 5.0)).tobytes())
    return bits.hexdigest()


def test_same_bits_in_another_process_with_and_without_numba():
    """No function of the C library but sqrt, frexp and ldexp, which are exact, takes part."""
    here = digest()
    for setting in ('0', '1'):
        environment = {**os.environ, 'NUMBA_DISABLE_JIT': setting,
                       'PYTHONPATH': f'{ROOT}{os.pathsep}{ROOT / "test"}'}
        done = subprocess.run(
            [sys.executable, '-c', BITS, str(pathlib.Path(__file__).parent)], env=environment,
            capture_output=True, text=True, check=True, timeout=120)
        assert done.stdout.strip() == here


@compiled_allocating
def reanchored(parameters, start, tick, ticks, every, moments, out):
    """Anchor anew at every tick; fill out with 2 E, L^2 and |q|^2 - 1 of every so many."""
    anchor, state = np.empty(motion.ANCHOR_SIZE), start.copy()
    for k in range(ticks):
        motion.anchor(parameters, state, anchor)
        motion.state(anchor, (k + 1) * tick, state)
        if (k + 1) % every == 0:
            w1, w2, w3 = state[5], state[6], state[7]
            row = (k + 1) // every - 1
            out[row, 0] = moments[0] * w1 * w1 + moments[1] * w2 * w2 + moments[2] * w3 * w3
            out[row, 1] = (moments[0] * moments[0] * w1 * w1 + moments[1] * moments[1] * w2 * w2
                           + moments[2] * moments[2] * w3 * w3)
            out[row, 2] = (state[1] * state[1] + state[2] * state[2] + state[3] * state[3]
                           + state[4] * state[4] - 1.0)


@pytest.mark.skipif(not HAVE_NUMBA, reason='100,000 anchors take minutes without numba')
@pytest.mark.parametrize('name', MOTIONS)
def test_anchored_anew_at_every_tick_energy_and_momentum_walk_at_random(name):
    """After 100,000 ticks a walk of half ulps leaves 3.5e-14, a trend of 0.01 ulp 1.1e-13."""
    moments, omega = MOTIONS[name]
    ticks, every = 100_000, 1000
    out = np.empty((ticks // every, 3))
    reanchored(parameters_of(moments), start_of(omega), 1e-3, ticks, every, np.array(moments), out)
    I, w = np.array(moments), np.array(omega)
    for column, at_start in ((0, I @ (w * w)), (1, (I * I) @ (w * w))):
        residual = out[:, column] / at_start - 1.0
        assert np.abs(residual).max() < 9e-14           # measured 3e-14 (separatrix), else 2e-14
        steps = np.diff(residual)
        assert abs(steps.mean()) < 4.0 * steps.std() / math.sqrt(len(steps)) + 1e-17
    assert np.abs(out[:, 2]).max() < 5.0 * EPSILON      # measured 3


@pytest.mark.parametrize('name', ['circular', 'symmetric', 'steady', 'long axis'])
def test_jumps_there_and_back_compose(name):
    """Jumps of random lengths, each from a new anchor, end where one jump ends.

    The errors are a walk of ulps, magnified by the shear of the motion.
    """
    moments, omega = MOTIONS[name]
    parameters, rng = parameters_of(moments), np.random.default_rng(3)
    times = np.append(
        np.cumsum(rng.choice([-1.0, 1.0], 200) * 10.0 ** rng.uniform(-9.0, 1.0, 200)), 0.0)
    state = start_of(omega)
    for time in times:
        state = at(anchored(parameters, state), time)
    start = start_of(omega)
    assert angle_between(*state[1:5], *start[1:5]) < 1e-13      # measured 2e-14
    assert np.abs(state[5:8] - start[5:8]).max() < 1e-13


def test_thousand_radians_a_tick_and_1e_12_rad_a_second():
    """Both on one body: the fast spin stays on its cone, the slow component does not drown."""
    parameters = parameters_of((2.0, 3.0, 4.0))
    anchor = anchored(parameters, start_of((1e-12, 1e-12, 1e6)))
    states = through(anchor, np.arange(0.0, 10.0, 1e-3))
    assert (states[:, 7] == 1e6).all()
    # wobble: omega_1/sqrt(I2 (I3 - I2)) and omega_2/sqrt(I1 (I3 - I1)) on a circle
    wobble = states[:, 5] ** 2 / 3.0 + states[:, 6] ** 2 / 4.0
    assert wobble == near(wobble[0], 1e-14)
    slow = anchored(parameters, start_of((7e-13, -4e-13, 1.1e-12)))
    state = at(slow, 1e-9)
    assert state[5:8] == near(np.array((7e-13, -4e-13, 1.1e-12)), 1e-15)


def test_a_needle_beyond_the_range_is_refused():
    with pytest.raises(BadInput, match='0 for a rod'):
        parameters_of((1.0, 1.0, 1e-140))


moment = st.floats(1e-6, 1.0)
component = st.one_of(st.just(0.0), st.floats(-1.0, 1.0), st.floats(-1e-9, 1e-9))


@settings(max_examples=300, deadline=None, derandomize=True)
@given(a=moment, b=moment, share=st.one_of(st.just(0.0), st.floats(1e-100, 1.0)),
       exponent=st.integers(-30, 30), omega=st.tuples(component, component, component),
       speed=st.integers(-12, 6), turned=st.floats(-1e6, 1e6))
def test_any_body_keeps_energy_momentum_and_unit_quaternion(
        a, b, share, exponent, omega, speed, turned):
    """Every inertia with |a - b| <= c <= a + b, rods without spin; L is constant in the world."""
    moments = np.array((a, b, abs(a - b) + share * (a + b - abs(a - b)))) * 10.0 ** exponent
    omega = np.where(moments > 0.0, omega, 0.0) * 10.0 ** speed
    size = math.hypot(*omega)
    start = start_of(omega.tolist())
    state = at(anchored(parameters_of(moments), start), turned / size if size > 1e-200 else turned)
    assert np.isfinite(state).all()
    assert abs(state[1:5] @ state[1:5] - 1.0) < 5.0 * EPSILON
    before, after = start[5:8], state[5:8]
    scale = (moments * before * before).sum()
    assert abs((moments * after * after).sum() - scale) <= 2e-14 * max(scale, 1e-300)
    L = np.array(rotate(*start[1:5], *(moments * before)))
    assert (np.abs(np.array(rotate(*state[1:5], *(moments * after))) - L).max()
            <= 2e-14 * math.hypot(*L))
