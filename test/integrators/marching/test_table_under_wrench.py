# SPDX-License-Identifier: Apache-2.0
"""A ball on the table under a held wrench: hand calculations, an invariant, the energy."""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators.marching import work
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.motions import sliding_sphere
from rigid_body_sim.motions.solver import Exact
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene

a, M, mu, g, k = 0.028575, 0.17, 0.2, 9.81, 0.4
I = k * M * a * a


def ball(initial, effects='[sliding_friction: {mu: 0.2, g: 9.81}]'):
    return parse_scene(f'scene: ball\nbody: {{mass: {M}, shape: {{solid_sphere: {{radius: '
                       f'{a}}}}}}}\nconstraint: table\neffects: {effects}\n'
                       f'initial: {initial}\n')


def held(scene, *wrench, accuracy=1e-14):
    return Stepped(scene, 'dop8', accuracy=accuracy, wrench=Wrench(*wrench)).start(
        scene.initial.vector)


def states(solver, times):
    out = np.empty((len(times), 14))
    solver.states(np.array(times), out)
    return out


def energy(state):
    return 0.5 * M * (state[11:14] @ state[11:14]) + 0.5 * I * (state[5:8] @ state[5:8])


def test_no_wrench_is_the_closed_form():
    scene = ball('{velocity: [1.0, 0.5, 0], angular_velocity: [3, -10, 20]}')
    times = [0.0, 0.05, 0.2, 0.3, 1.0]
    closed = np.empty((5, 14))
    Exact(scene, sliding_sphere).start(scene.initial.vector).states(np.array(times), closed)
    # 4e-14, of omega (40 rad/s)
    assert np.abs(states(held(scene), times) - closed).max() < 1e-13


def test_pushed_from_rest_it_rolls_without_slipping():
    """Rolling under F: v' = F/(M (1 + k)); friction F k/(1 + k) is below mu M g = 0.33 N."""
    state = states(held(ball('{}'), (0.5, 0.0, 0.0)), [2.0])[0]
    acceleration = 0.5 / (M * (1.0 + k))
    assert state[8:14] == near(
        [2.0 * acceleration, 0.0, a, 2.0 * acceleration, 0.0, 0.0], rel=1e-14)
    assert np.linalg.norm(state[5:8]) == near(2.0 * acceleration / a, rel=1e-14)


def test_pushed_hard_from_rest_it_slips():
    """F k/(1 + k) > mu M g: v' = F/M - mu g, a omega' = mu g/k."""
    solver = held(ball('{}'), (2.0, 0.0, 0.0))
    state = states(solver, [0.5])[0]
    assert state[11] == near(0.5 * (2.0 / M - mu * g), rel=1e-14)
    assert state[8] == near(0.125 * (2.0 / M - mu * g), rel=1e-14)
    assert np.linalg.norm(state[5:8]) == near(0.5 * mu * g / (k * a), rel=1e-14)
    assert solver.events(0.0, 0.5) == []


def test_onset_of_rolling_under_a_push_along_the_slide():
    """Sliding at v0 without spin, F along v: u' = F/M - (1 + 1/k) mu g, rolling when u = 0."""
    F, v0 = 0.3, 1.5
    solver = held(ball('{velocity: [1.5, 0, 0]}'), (F, 0.0, 0.0))
    onset = v0 / ((1.0 + 1.0 / k) * mu * g - F / M)
    (time, name, _), = solver.events(0.0, 3.0)
    assert (name, time) == ('rolling began', near(onset, rel=1e-14))
    at_onset = v0 + onset * (F / M - mu * g)
    assert states(solver, [3.0])[0, 11] == near(
        at_onset + (3.0 - onset) * F / (M * (1.0 + k)), rel=1e-14)


def test_strong_push_against_the_slide_turns_it_round():
    """The slip goes through zero and friction reverses at once, since F k/(1 + k) > mu M g."""
    F, v0 = -2.0, 1.0
    solver = held(ball('{velocity: [1.0, 0, 0]}'), (F, 0.0, 0.0))
    turn = v0 / ((1.0 + 1.0 / k) * mu * g - F / M)
    state = states(solver, [1.0])[0]
    assert state[11] == near(
        v0 + turn * (F / M - mu * g) + (1.0 - turn) * (F / M + mu * g), rel=2e-14)


@pytest.mark.parametrize('F', [(0.1, 0.25, 0.0), (0.0, 1.2, 0.0)])
def test_curved_slide_keeps_its_invariant(F):
    """|u| sin(theta) cot(theta/2)^(c/G) is constant, theta between the slip u and G.

    That is because du/dtheta = u (c - G cos theta)/(G sin theta).
    """
    solver = held(ball('{velocity: [1.0, 0.0, 0], angular_velocity: [0, 0, 30]}'), F)
    G, c = math.hypot(*F) / M, (1.0 + 1.0 / k) * mu * g
    found = []
    for state in states(solver, np.linspace(0.0, 0.12, 13)):
        omega = np.array(sliding_sphere.rotate(*state[1:5], *state[5:8]))
        u = state[11:13] - a * np.array([omega[1], -omega[0]])
        theta = math.atan2(abs(u[0] * F[1] - u[1] * F[0]), u @ F[:2])
        found.append(math.hypot(*u) * math.sin(theta) / math.tan(0.5 * theta) ** (c / G))
    assert np.ptp(found) < 2e-13 * max(found)    # 4e-14: theta is small at the end of the first


@pytest.mark.parametrize('wrench',
                         [((0.1, 0.9, 0.2), (0.001, 0.002, 0.003), 'world'),
                          ((0.1, 0.2, 0.2), (0.001, 0.002, 0.003), 'body'),
                          ((0.1, 1.6, 0.2), (0.001, 0.002, 0.003), 'body'),
                          ((0.0, 0.0, 1.2), (0.006, 0.0, 0.0), 'body')])
def test_energy_and_angular_momentum_balance(wrench):
    scene = ball('{velocity: [1.0, 0.5, 0], angular_velocity: [3, -10, 20]}')
    solver = held(scene, *wrench)
    start, state, entries = scene.initial.vector, states(solver, [2.0])[0], solver.entries(2.0)
    scale = max(energy(start), energy(state), entries[0])
    # 4e-15
    assert abs(energy(state) - energy(start) - entries[0] + entries[1]) < 2e-14 * scale
    gained = (I * (np.array(sliding_sphere.rotate(*state[1:5], *state[5:8]))
                   - sliding_sphere.rotate(*start[1:5], *start[5:8])))
    assert np.abs(gained - entries[2:]).max() < 2e-14 * I * np.linalg.norm(state[5:8])


def test_a_push_that_turns_with_the_ball_makes_it_roll_and_slip_by_turns():
    """In the world the press of 1.2 N turns with the ball, so the grip comes and goes."""
    wrench = (0.0, 0.0, 1.2), (0.006, 0.0, 0.0), 'body'
    solver = held(ball('{}'), *wrench)
    names = [name for _, name, _ in solver.events(0.0, 0.65)]
    assert names == [
        'rolling began', 'sliding began', 'rolling began', 'sliding began', 'rolling began']
    found, coarse = (
        states(solver, [0.65])[0], states(held(ball('{}'), *wrench, accuracy=1e-11), [0.65])[0])
    assert np.abs(found - coarse).max() < 2e-11    # 4e-12


def test_without_friction_it_glides():
    state = states(held(ball('{}', '[]'), (0.5, 0.0, 0.0), (0.0, 0.001, 0.0)), [2.0])[0]
    assert state[11] == near(1.0 / M, rel=1e-14)
    assert state[6] == near(0.002 / I, rel=1e-14)


def test_states_do_not_depend_on_what_else_was_asked():
    scene = ball('{velocity: [1.0, 0.5, 0], angular_velocity: [3, -10, 20]}')
    wrench, times = (((0.1, 0.2, 0.0), (0.001, 0.0, 0.002), 'body'),
                     np.random.default_rng(3).uniform(0.0, 1.0, 50))
    together = states(held(scene, *wrench), times)
    for n in (0, 20, 49):
        assert np.array_equal(states(held(scene, *wrench), [times[n]])[0], together[n])


def test_a_fixed_step_is_refused():
    with pytest.raises(BadInput, match='give an accuracy'):
        Stepped(ball('{}'), 'dop8', step=0.01, wrench=Wrench((1.0, 0.0, 0.0)))


@pytest.mark.without_numba
@pytest.mark.timeout(30)
def test_a_ball_that_turns_too_often_gives_up_in_one_line(monkeypatch):
    """Under a couple that turns with it a ball takes a step every few radians."""
    monkeypatch.setattr(work, 'FIRST_LOOK', work.FIRST_LOOK // 8)
    spun = ball('{angular_velocity: [0, 1.0e6, 0], velocity: [1, 0, 0]}')
    solver = held(spun, (0.0, 0.0, 0.0), (0.0, 1.0, 0.3), 'body')
    with pytest.raises(TooMuchWork, match='dop8 on ball: 326 steps'):
        states(solver, [1.0])
