# SPDX-License-Identifier: Apache-2.0
"""Simulation: ticks, commands and the ledger, on the racket and on scenes made here."""

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.simulation.ensemble import ensemble
from rigid_body_sim.simulation.simulation import Simulation

EPS = np.finfo(float).eps
SPHERE = """
scene: ball
body: {mass: 2.0, shape: {solid_sphere: {radius: 0.1}}}
constraint: free
effects: []
initial: {angular_velocity: [0, 0, 1]}
"""


def momentum_in_body(simulation):
    return simulation.scene.body.about_center.matrix @ simulation.state.angular_velocity


def test_five_lines_from_python():
    simulation = Simulation('tennis_racket')
    simulation.advance(1000)
    assert simulation.time == 1.0
    assert simulation.choice.method == 'exact'
    assert np.linalg.norm(simulation.state.orientation) == pytest.approx(1.0, abs=2 * EPS)
    assert simulation.states([10.0, 20.0, 5.0]).orientation.shape == (3, 4)


def test_single_jump_equals_a_million_ticks_to_the_last_bit():
    ticking, jumping = Simulation('tennis_racket', rate=1.0), Simulation('tennis_racket', rate=1.0)
    last = ticking.advance_through(1_000_000)[-1]
    jumping.advance(1_000_000)
    assert last.vector.tobytes() == ticking.vector.tobytes() == jumping.vector.tobytes()


def test_times_out_of_order_give_the_same_bits():
    simulation = Simulation('tennis_racket')
    times = np.random.default_rng(1).uniform(0.0, 1e5, 1000)
    shuffled = simulation.states(times).vector
    assert shuffled[np.argsort(times)].tobytes() == simulation.states(np.sort(
        times)).vector.tobytes()


@pytest.mark.parametrize('frame', ['body', 'world'])
def test_impulse_changes_the_momentum_by_exactly_its_value(frame):
    simulation = Simulation('tennis_racket')
    simulation.advance(777)
    turn = Rotation.from_quat(simulation.state.orientation)
    before, impulse = momentum_in_body(simulation), np.array([0.1, -0.2, 0.3])
    simulation.impulse(torque=impulse, frame=frame)
    expected = before + (impulse if frame == 'body' else turn.inv().apply(impulse))
    # one rounding each for the product, the sum and the quotient: measured 8.9e-16 of 10
    assert momentum_in_body(simulation) == pytest.approx(
        expected, abs=4 * EPS * np.abs(expected).max())


def test_impulse_of_force_moves_the_centre_of_mass():
    simulation = Simulation(parse_scene(SPHERE))
    simulation.impulse(force=(1.0, 2.0, 3.0))
    simulation.advance(2000)
    assert simulation.state.velocity.tolist() == [0.5, 1.0, 1.5]
    assert simulation.state.position.tolist() == [1.0, 2.0, 3.0]


def test_opposite_impulses_of_one_tick_cancel_to_the_last_bit():
    simulation, quiet = Simulation('tennis_racket'), Simulation('tennis_racket')
    for each in (simulation, quiet):
        each.advance(100)
    impulse = np.array([0.1, 1e-3, -7.7])
    simulation.impulse(torque=impulse, frame='body')
    assert simulation.vector.tobytes() != quiet.vector.tobytes()
    simulation.impulse(torque=-impulse, frame='body')
    for each in (simulation, quiet):
        each.advance(100)
    assert simulation.vector.tobytes() == quiet.vector.tobytes()


@pytest.mark.parametrize('frame', ['body', 'world'])
def test_held_wrench_does_not_depend_on_the_rate_or_on_how_often_it_is_sent(frame):
    final = []
    for rate in (100, 10_000):
        simulation = Simulation('tennis_racket', rate=rate)
        simulation.advance(rate // 2)
        for _ in range(rate // 2):
            simulation.hold(force=(1.0, 0.0, 0.5), torque=(0.3, 0.1, -0.2), frame=frame)
            simulation.advance()
        simulation.release()
        simulation.advance(rate)
        final.append(simulation.vector.copy())
    assert final[0].tobytes() == final[1].tobytes()


def test_body_at_rest_held_at_every_tick_by_another_wrench_by_hand():
    body = 'body: {mass: 1.0, inertia: [1.0, 2.0, 3.0]}'
    simulation = Simulation(parse_scene(
        f'scene: still\n{body}\nconstraint: free\neffects: []\ninitial: {{}}'))
    for k in range(50):
        simulation.hold(force=(0.0, 0.0, float(k)), torque=(0.0, 0.0, 3e-3 * k))
        simulation.advance()
    h = 1e-3
    speed = h * sum(range(50))                                                  # v = sum of F h/M
    # each F/M h acts for the ticks left
    place = h * h * sum(k * (49 - k) + 0.5 * k for k in range(50))
    assert simulation.state.velocity == pytest.approx([0.0, 0.0, speed], abs=1e-15)
    assert simulation.state.position == pytest.approx([0.0, 0.0, place], abs=1e-17)
    assert simulation.state.angular_velocity == pytest.approx([0.0, 0.0, 1e-3 * speed], abs=1e-18)
    assert angle_between(*simulation.state.orientation,
                         *Rotation.from_rotvec([0.0, 0.0, 1e-3 * place]).as_quat()) < 1e-16


def test_torque_on_a_ball_held_and_released_by_hand():
    simulation = Simulation(parse_scene(SPHERE))
    I = 0.4 * 2.0 * 0.01
    simulation.hold(torque=(0.0, 0.0, 0.016))
    simulation.advance(1000)
    simulation.release()
    simulation.advance(500)
    # alpha = tau/I = 2 rad/s^2 for 1 s from 1 rad/s, then 3 rad/s for 0.5 s: 1 + 1 + 1.5 rad about
    # z
    assert simulation.state.angular_velocity == pytest.approx([0.0, 0.0, 3.0], abs=1e-13)
    assert angle_between(
        *simulation.state.orientation, *Rotation.from_rotvec([0.0, 0.0, 3.5]).as_quat()) < 1e-12
    ledger = simulation.ledger()
    assert ledger['work'] == near(0.5 * I * (9.0 - 1.0), 1e-12)
    assert abs(ledger['energy_residual']) < 1e-13
    assert ledger['momentum_residual'] < 1e-13


def test_ledger_balances_under_impulses_and_holds():
    simulation = Simulation('tennis_racket')
    for k in range(20):
        simulation.impulse(force=(0.1, 0.0, k), torque=(0.0, 0.1 * k, -0.2), frame='body')
        simulation.advance(37)
        simulation.hold(force=(0.0, 1.0, 0.0), torque=(0.3, 0.0, 0.01 * k))
        simulation.advance(20)
        simulation.release()
        simulation.advance(5)
    ledger = simulation.ledger()
    assert abs(ledger['work']) > 1.0
    assert abs(ledger['energy_residual']) < 1e-12
    assert ledger['momentum_residual'] < 1e-12


def test_reset_puts_the_state_back_and_the_tick_goes_on():
    simulation = Simulation('tennis_racket')
    start = simulation.vector.copy()
    simulation.advance(10)
    simulation.impulse(torque=(1.0, 0.0, 0.0))
    simulation.reset()
    assert simulation.tick == 10
    assert simulation.vector.tobytes() == start.tobytes()
    simulation.advance(5)
    assert (simulation.tick, simulation.time) == (15, 0.005)


def test_past_is_kept_until_it_is_forgotten():
    simulation = Simulation('tennis_racket')
    simulation.advance(1000)
    before = simulation.states([0.5]).vector
    simulation.impulse(torque=(1.0, 0.0, 0.0))
    simulation.advance(1000)
    assert simulation.states([0.5]).vector.tobytes() == before.tobytes()
    simulation.forget_past()
    with pytest.raises(BadInput, match='finite times from'):
        simulation.states([0.5])


@pytest.mark.parametrize(('act', 'words'), [
    (lambda s: s.impulse(torque=(np.nan, 0, 0)), 'three finite numbers'),
    (lambda s: s.impulse(force=(np.inf, 0, 0)), 'three finite numbers'),
    (lambda s: s.hold(torque=(1, 2)), 'three finite numbers'),
    (lambda s: s.hold(torque=(1, 2, 3), frame='moon'), "'world' or 'body'"),
    (lambda s: s.hold(torque={1, 2, 3}), 'three finite numbers'),
    (lambda s: s.states([np.nan]), 'finite times'),
    (lambda s: s.states([1.0, -0.5]), r'from -0\.5 to 1\.0 s'),
    (lambda s: s.states([1.0, np.inf]), r'from 1\.0 to inf s'),
    (lambda s: s.states('12'), '^states: got .*a sequence of numbers'),
    (lambda s: s.states(None), '^states: got .*a sequence of numbers'),
    (lambda s: s.states([1j]), '^states: got .*a sequence of numbers'),
    (lambda s: s.states({1.0}), '^states: got .*a sequence of numbers'),
    (lambda s: s.states([[1.0, 2.0], [3.0]]), '^states: got .*a sequence of numbers'),
    (lambda s: s.restart('x'), '^restart: got .*14 numbers'),
    (lambda s: s.restart([10**400] * 14), '^restart: got .*14 numbers'),
    (lambda s: ensemble(s.scene, times='x'), '^times: got .*a sequence of numbers'),
    (lambda s: ensemble(s.scene, times=[1.0], starts=['x']), '^starts: got .*list of State'),
    (lambda s: parse_scene(None), '^scene: got None; the text of a scene'),
    (lambda s: parse_scene(b'scene: x'), '^scene: got .*; the text of a scene'),
    (lambda s: parse_scene('\ud800'), '^scene: got .*; the text of a scene'),
    (lambda s: Simulation(s.scene, ['rk4']), '^integrator: got .*; one of auto')])
def test_bad_command_gets_one_line_and_changes_nothing(act, words):
    simulation = Simulation('tennis_racket')
    before = simulation.vector.copy()
    with pytest.raises(BadInput, match=words):
        act(simulation)
    assert simulation.vector.tobytes() == before.tobytes()


def test_scene_may_refuse_commands():
    simulation = Simulation(load_scene('tennis_racket', ['commands=refuse']))
    with pytest.raises(BadInput, match='refuses commands'):
        simulation.impulse(torque=(1.0, 0.0, 0.0))


def test_torque_about_a_rod_is_refused():
    rod = load_scene(
        'tennis_racket',
        ['body={mass: 1.0, shape: {rod: {length: 1.0}}}', 'initial.angular_velocity=[1, 0, 0]'])
    simulation = Simulation(rod)
    for act in (simulation.impulse, simulation.hold):
        with pytest.raises(BadInput, match='axis of zero moment'):
            act(torque=(0.0, 0.0, 1.0), frame='body')


def test_a_rod_is_pushed_at_its_centre_without_a_torque():
    """A torque of zero has no part along the rod either."""
    simulation = Simulation(load_scene(
        'tennis_racket',
        ['body={mass: 2.0, shape: {rod: {length: 1.0}}}', 'initial.angular_velocity=[1, 0, 0]']))
    simulation.impulse(force=(0.0, 1.0, 4.0))
    assert tuple(simulation.state.velocity) == (0.0, 0.5, 2.0)
    assert tuple(simulation.state.angular_velocity) == (1.0, 0.0, 0.0)


@pytest.mark.without_numba    # where numbers come from arrays, and are told all the same
@pytest.mark.parametrize(('overrides', 'work'), [
    ([], '1.62[0-9]*e[+]300'),
    (['body.mass=1e-70', 'body.inertia=[1e-140, 1e-140, 1e-140]'], 'inf')])
def test_strike_beyond_what_a_double_holds_is_refused(overrides, work):
    blow = ['strike.impulse=[0, -1e75, 0]', 'strike.distance=1e75']
    with pytest.raises(
            BadInput, match=rf'baseball_bat: strike: at 0 s it would do a work of {work} J'):
        Simulation(load_scene('baseball_bat', [*blow, *overrides]))


@pytest.mark.parametrize(
    ('arguments', 'line'),
    [({'rate': 0.0}, 'rate: got 0.0'), ({'rate': np.nan}, 'rate: got nan'),
     ({'accuracy': 1e-17}, 'accuracy: got 1e-17'), ({'integrator': 'dop9'}, "did you mean 'dop8'"),
     ({'step': -1.0, 'integrator': 'dop8'}, 'step: got -1.0')])
def test_impossible_request_is_refused_by_name_and_value(arguments, line):
    with pytest.raises(BadInput, match=line):
        Simulation('tennis_racket', **arguments)


def test_exact_and_stepped_agree():
    exact, stepped = (Simulation('tennis_racket'),
                      Simulation('tennis_racket', integrator='dop8', accuracy=1e-13))
    for each in (exact, stepped):
        each.advance(10_000)
    # the racket magnifies an error e^(lambda t) between flips: measured 3e-13 rad at 10 s
    assert angle_between(*exact.state.orientation, *stepped.state.orientation) < 1e-11


@pytest.mark.parametrize('scene', ['tennis_racket', 'billiard_low'])
def test_foreseen_states_are_those_met_up_to_the_next_event(scene):
    simulation, plain = Simulation(scene, rate=100.0), Simulation(scene, rate=100.0)
    foreseen = 0
    while simulation.tick < 1500:
        states = simulation.foresee(16)
        for k in range(len(states) + 1):
            simulation.advance()
            plain.advance()
            if k < len(states):
                foreseen += 1
                assert states.vector[k].tobytes() == plain.vector.tobytes()
                assert len(plain.events) == len(simulation.events)
            assert simulation.vector.tobytes() == plain.vector.tobytes()
            assert simulation.ledger() == plain.ledger()
        if len(states) < 16:
            assert plain.events[-1].tick == plain.tick
    assert simulation.events == plain.events
    assert plain.events
    assert foreseen > 1300


def test_what_was_foreseen_before_a_command_is_not_met():
    simulation, plain = Simulation('tennis_racket'), Simulation('tennis_racket')
    for each in (simulation, plain):
        each.advance(5)
        if each is simulation:
            each.foresee(16)
        each.impulse(torque=(0.0, 1e-3, 0.0))
        each.advance(5)
    assert simulation.vector.tobytes() == plain.vector.tobytes()
