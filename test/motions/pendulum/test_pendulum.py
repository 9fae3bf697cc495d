# SPDX-License-Identifier: Apache-2.0
"""Bodies on hinges: against 34 digits of the equation of motion, and through their hard spots."""

import itertools
import json
import math
import os
import subprocess
import sys

import numpy as np
import pytest
from motions.hinged import (
    HANGING,
    RECORDS,
    ROOT,
    UPRIGHT,
    anchored,
    anchored_by,
    at,
    bearing,
    random_scene,
    recorded,
    scene_of,
    start_of,
    unit_scene,
)
from mpmath import cos, mp, mpf, sin
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.mechanics import energy, parameters, potential
from rigid_body_sim.motions.pendulum import pendulum as motion
from rigid_body_sim.motions.solver import Exact, loops
from rigid_body_sim.numerics.rotations import multiply
from rigid_body_sim.scene.bodies import make_body
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.scene.state import STATE_SIZE
from rigid_body_sim.simulation.simulation import Simulation

EPSILON = np.finfo(float).eps


@pytest.mark.without_numba
@pytest.mark.parametrize('name', RECORDS)
def test_reference(name):
    """No error grows with time: the rates of the phases carry more digits than a double."""
    record = RECORDS[name]
    _, start, anchor = recorded(name)
    # what is tiny all the time (1e-300) is held to its own size
    angle = max(np.abs(start[1:4]).max(),
                *(abs(float(value)) for entry in record['states'] for value in entry['state'][:3]))
    for entry in record['states']:
        time = float.fromhex(entry['time'])
        expected = np.array([float(value) for value in entry['state']])
        state = at(anchor, time)[1:]
        fastest = max(np.linalg.norm(start[5:8]), np.linalg.norm(expected[4:7]), angle)
        reach = np.linalg.norm(record.get('through', (0.0, 0.0, 0.0)))
        # worst measured: 3.3e-15 (1e7 rad turned over in 1e6 s, from the 5e-20 of the period);
        # 5e-16 within 100 rad
        assert np.abs(state[:3] - expected[:3]).max() <= 5e-15 * angle, entry['time']
        assert abs(state[3] - expected[3]) <= 5e-15, entry['time']
        # worst measured: 5e-15, as the angle
        assert np.abs(state[4:7] - expected[4:7]).max() <= 1e-14 * fastest, entry['time']
        assert np.abs(state[7:10] - expected[7:10]).max() <= 1e-14 * reach, entry['time']
        assert np.abs(state[10:] - expected[10:]).max() <= 1e-14 * reach * fastest, entry['time']


@pytest.mark.parametrize('name',
                         ['rests an ulp from upright', 'rests 1e-300 from upright',
                          'leaves upright, back', 'tiny swing'])
def test_tiny_distances_grow_to_scale(name):
    """A pendulum 1e-300 from upright keeps its digits while the distance grows."""
    anchor = recorded(name)[2]
    for entry in RECORDS[name]['states']:
        expected = np.array([float(value) for value in entry['state']])
        state = at(anchor, float.fromhex(entry['time']))[1:]
        for k in (0, 1, 3, 4, 5):
            # worst measured 3.4e-14 at 1e-200 (the phase is of 700 rad there), 3e-15 at an ulp
            assert state[k] == near(expected[k], 1e-13), (k, entry['time'])


@pytest.mark.parametrize(
    'name', [name for name, record in RECORDS.items() if record['swings'] and record['period']])
def test_turning_points(name):
    """They are half a period apart, at rest, each found from the one before; some turn over."""
    _, start, anchor = recorded(name)
    period = float(RECORDS[name]['period'])
    fastest = max(np.linalg.norm(at(anchor, time)[5:8]) for time in np.linspace(0.0, period, 50))
    times = list(itertools.accumulate(
        range(6), lambda time, _: motion.next_event(anchor, time)[0], initial=0.0))[1:]
    assert motion.next_event(anchor, 0.0)[1] == 0
    assert np.diff(times) == near(0.5 * period, 1e-14)
    for time in times:
        # a time is rounded by half an ulp, in which the rate grows by at most the square of the
        # fastest rate, and the swing by as much
        assert np.linalg.norm(at(anchor, time)[5:8]) <= 1e-14 * fastest
    far = motion.next_event(anchor, 1e6 * period)[0]
    assert 0.0 < far - 1e6 * period <= 0.5 * period * (1.0 + 1e-9)
    if not start[5:8].any():
        assert times[0] == near(0.5 * period, 1e-15)


@pytest.mark.parametrize(
    'name', [name for name, record in RECORDS.items() if not record['swings']])
def test_no_turning_points(name):
    anchor = recorded(name)[2]
    assert motion.next_event(anchor, 0.0)[0] == math.inf
    assert motion.next_event(anchor, -1e9)[0] == math.inf


def test_no_turning_point_is_lost_in_a_long_jump():
    simulation = Simulation('kater_pendulum')
    simulation.advance(1_000_000)
    period = float(RECORDS['kater']['period'])
    times = np.array([event.time for event in simulation.events])
    assert len(times) == math.floor(1000.0 / (0.5 * period))
    assert times == near(0.5 * period * np.arange(1, len(times) + 1), 2.0 * EPSILON)
    steps = Simulation('kater_pendulum')
    for _ in range(100):
        steps.advance(10_000)
    assert steps.events == simulation.events


@pytest.mark.without_numba
def test_turning_points_agree_with_a_stepped_method():
    exact, stepped = (Simulation('kater_pendulum_from_p', integrator=name)
                      for name in ('exact', 'dop8'))
    for simulation in (exact, stepped):
        for _ in range(80):
            simulation.advance(100)
    assert [(event.tick, event.name) for event in stepped.events] == [(event.tick, event.name)
                                                                      for event in exact.events]
    assert len(exact.events) == 7


def test_the_start_comes_back():
    rng = np.random.default_rng(3)
    for _ in range(300):
        scene, start = random_scene(rng)
        start[0] = rng.normal() * 1e3
        anchor = anchored(scene, start)
        state = at(anchor, start[0])
        assert np.abs(state[1:5] - start[1:5]).max() <= 4.0 * EPSILON
        assert np.abs(state[5:8] - start[5:8]).max() <= 8.0 * EPSILON * np.linalg.norm(start[5:8])
        reach = np.linalg.norm(start[8:11]) + np.linalg.norm(scene.constraint.through)
        assert np.abs(state[8:11] - start[8:11]).max() <= 8.0 * EPSILON * reach


def test_energy_and_hinge_stay():
    """Energy, place of the hinge and direction of the axis stay in random scenes."""
    rng = np.random.default_rng(4)
    diagnosis = np.empty(energy.DIAGNOSIS_SIZE)
    for _ in range(100):
        scene, start = random_scene(rng)
        anchor, numbers = anchored(scene, start), parameters.parameters(scene)
        energies, sizes = [], []
        weight = scene.body.mass * scene.effect('gravity').g
        diagnose = potential.energies(scene).diagnose
        hinge = start[8:11] + Rotation.from_quat(start[1:5]).apply(scene.constraint.through)
        axis = Rotation.from_quat(start[1:5]).apply(scene.constraint.axis)
        for time in (0.0, 0.1, 1.0, 10.0, 1e3, 1e6, -1e5):
            state = at(anchor, time)
            turn = Rotation.from_quat(state[1:5])
            diagnose(numbers, state, diagnosis)
            energies.append(diagnosis[0] + diagnosis[1])
            sizes.append(diagnosis[0] + weight * (np.linalg.norm(state[8:11])
                                                  + np.linalg.norm(scene.body.center_of_mass)))
            arm = turn.apply(scene.constraint.through)
            assert (np.abs(state[8:11] + arm - hinge).max()
                    <= 8.0 * EPSILON * (np.linalg.norm(hinge) + np.linalg.norm(arm)))
            assert np.abs(turn.apply(scene.constraint.axis) - axis).max() <= 8.0 * EPSILON
            assert state[11:14] == pytest.approx(
                -np.cross(turn.apply(state[5:8]), arm), abs=2e-14 * np.linalg.norm(state[5:8]))
        assert np.ptp(energies) <= 8.0 * EPSILON * max(sizes)


def test_one_or_many_the_same_bits():
    rng = np.random.default_rng(5)
    scenes = ([random_scene(rng) for _ in range(8)]
              + [recorded(name)[:2] for name in ('separatrix', 'an ulp above the separatrix')])
    scenes.append((unit_scene(g=0.0), start_of(HANGING, (2.0, 0.0, 0.0))))
    for scene, start in scenes:
        solver = Exact(scene, motion).start(start)
        times = rng.uniform(-1e3, 1e3, 700)
        many, one = np.empty((len(times), STATE_SIZE)), np.empty(STATE_SIZE)
        solver.states(times, many)
        for time, row in zip(times, many, strict=True):
            solver.state(time, one)
            assert np.array_equal(one, row)


@pytest.mark.parametrize('name',
                         ['skew swing', 'skew turning back over', 'an ulp below the separatrix',
                          'an ulp above the separatrix', 'separatrix'])
def test_attitude_is_continuous(name):
    """No jump of the quaternion, its sign included, over many turns and before the start."""
    _, _, anchor = recorded(name)
    times = np.linspace(-30.0, 50.0, 80001)
    states = np.empty((len(times), STATE_SIZE))
    loops(motion).states(anchor, times, states)
    rates, jumps = (np.linalg.norm(states[:, 5:8], axis=1),
                    np.linalg.norm(np.diff(states[:, 1:5], axis=0), axis=1))
    assert (jumps <= 0.5 * np.maximum(rates[1:], rates[:-1]) * np.diff(times) * (
        1.0 + 1e-5) + 1e-15).all()
    assert np.abs(np.linalg.norm(states[:, 1:5], axis=1) - 1.0).max() <= 2.0 * EPSILON


@pytest.mark.parametrize('orientation', [HANGING, UPRIGHT])
def test_equilibrium_is_for_ever(orientation):
    """Hanging and exactly upright at rest nothing moves; no perturbation is put in."""
    anchor = anchored(unit_scene(), start_of(orientation))
    for time in (-1e6, 1.0, 1e6):
        assert np.array_equal(at(anchor, time)[1:], start_of(orientation)[1:])
    assert motion.next_event(anchor, 0.0)[0] == math.inf


@pytest.mark.parametrize(
    'case', ['vertical axis', 'vertical to rounding', 'centre of mass on the axis', 'no gravity'])
def test_nothing_turns_it(case):
    """Uniform rotation, its phase exact after 1e6 s."""
    body, axis, orientation, g = (
        make_body(1.3, (0.5, 0.6, 0.7), (0.1, 0.2, 0.3)), (1.0, 0.0, 0.0), HANGING, 9.81)
    if case == 'vertical axis':
        axis = (0.0, 0.0, 1.0)
    elif case == 'vertical to rounding':
        axis = (-math.sin(0.3), 0.0, math.cos(0.3))
        orientation = (0.0, math.sin(0.15), 0.0, math.cos(0.15))
    elif case == 'centre of mass on the axis':
        body, axis = make_body(1.3, (0.5, 0.6, 0.7), (0.1, 0.2, 0.3)), (0.1, 0.2, 0.3)
    else:
        g = 0.0
    axis = tuple((np.array(axis) / np.linalg.norm(axis)).tolist())
    anchor = anchored(scene_of(body, axis, g=g), start_of(orientation, 0.7 * np.array(axis)))
    for time in (-3.0, 1.0, 1e6):
        state = at(anchor, time)
        # the phase is exact where the axis is a coordinate axis; elsewhere the rate is that of the
        # rounded vector
        with mp.workdps(30):
            half = mpf(0.7) / 2 * mpf(time)
            sine, cosine = float(sin(half)), float(cos(half))
        slack = 1e-15 if max(axis) == 1.0 else 1e-15 + EPSILON * 0.35 * abs(time)
        x, y, z, w = multiply(*orientation, *(sine * component for component in axis), cosine)
        assert state[1:5] == pytest.approx([x, y, z, w], rel=0.0, abs=slack)
        assert np.array_equal(state[5:8], at(anchor, 0.0)[5:8])
    assert motion.next_event(anchor, 0.0)[0] == math.inf


@pytest.mark.parametrize('name', ['kater', 'skew swing', 'skew turning over'])
def test_anchored_anew_at_every_tick(name):
    """Ten thousand anchors end where one does, to the repeated rounding of the rate.

    Measured: 2.5e-12 rad (skew swing).
    """
    scene, state, anchor = recorded(name)
    parameters = motion.parameters(scene)
    for k in range(1, 10_001):
        state = at(anchored_by(parameters, state), 0.001 * k)
    assert state[1:8] == pytest.approx(at(anchor, 10.0)[1:8], rel=0.0, abs=1e-11)


@pytest.mark.parametrize('rate', [5e-324, 1e-200, 1e9, 1e120, 1e300])
def test_extreme_rates_stay_finite(rate):
    scene = unit_scene()
    for orientation in (HANGING, UPRIGHT, (0.6, 0.0, 0.0, 0.8)):
        anchor = anchored(scene, start_of(orientation, (rate, 0.0, 0.0)))
        for time in (-1.0, 1e-3, 1e6):
            state = at(anchor, time)
            assert np.isfinite(state).all()
            assert np.linalg.norm(state[1:5]) == near(1.0, 2.0 * EPSILON)


def test_what_it_absorbs():
    assert motion.absorbs(load_scene('kater_pendulum'))
    assert motion.absorbs(load_scene('baseball_bat'))
    assert not motion.absorbs(load_scene('heavy_top'))
    assert not motion.absorbs(load_scene('free_body'))


PLAIN = """
import json, sys
import numpy as np
from rigid_body_sim.compilation.jit import HAVE_NUMBA
from rigid_body_sim.motions.pendulum import pendulum as motion
from rigid_body_sim.motions.solver import loops
assert not HAVE_NUMBA
answers = []
for parameters, start, times in json.loads(sys.argv[1]):
    anchor, out, force = np.empty(motion.ANCHOR_SIZE), np.empty((len(times), 14)), np.empty(6)
    motion.anchor(np.array(parameters), np.array(start), anchor)
    loops(motion).states(anchor, np.array(times), out)
    motion.reaction(np.array(parameters), out[0], force)
    answers.append((out.tolist(), force.tolist(), motion.next_event(anchor, 1.0)[0]))
print(json.dumps(answers))
"""


def test_the_same_without_numba():
    times = np.linspace(-20.0, 1e3, 12)
    cases = [(*recorded(name)[:2], recorded(name)[2])
             for name in ('skew swing', 'skew turning over', 'an ulp below the separatrix',
                          'separatrix', 'tiny swing')]
    questions = json.dumps([(motion.parameters(scene).tolist(), start.tolist(), times.tolist())
                            for scene, start, _ in cases])
    environment = {**os.environ, 'NUMBA_DISABLE_JIT': '1'}
    answer = subprocess.run([sys.executable, '-c', PLAIN, questions], text=True, check=True,
                            capture_output=True, cwd=ROOT, env=environment, timeout=120)
    for (scene, _, anchor), (states, force, event) in zip(
            cases, json.loads(answer.stdout), strict=True):
        out = np.empty((len(times), STATE_SIZE))
        loops(motion).states(anchor, times, out)
        assert np.array_equal(out, states)
        assert bearing(scene, out[0]) == near(force, 1e-15)
        assert motion.next_event(anchor, 1.0)[0] == event
