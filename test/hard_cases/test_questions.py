# SPDX-License-Identifier: Apache-2.0
"""The questions to the peers, put to this package: who is right gets no error but rounding."""

import math
import types

import kept
import numpy as np
import pytest
from near import near
from soak import IN_SOAK

from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.study.hard_cases import beside, contact, questions
from rigid_body_sim.study.hard_cases.sliding_ball import MASS, A, G, Scipy
from rigid_body_sim.study.hard_cases.table import CASES

ASKED = {f'{case.group} {case.name}': case for case in CASES if case.asked}


class Run:
    """A run of this package as that of a peer."""

    def __init__(self, scene):
        self._simulation, self._time = Simulation(scene, accuracy=1e-12), None

    def start(self):
        self._time = 0.0

    def to(self, time):
        assert time >= self._time
        self._time = time

    def state(self):
        state = self._simulation.states([self._time])[0]
        return np.concatenate([state.orientation, state.angular_velocity])


def peer(wrong=None):
    """Return this package as the module of a peer; `wrong` changes its states."""
    def runners(problem, reference):
        def make(setting):
            run = Run(problem.scene)
            if wrong:
                right = run.state
                run.state = lambda: wrong(run._time, right())
            return run
        yield types.SimpleNamespace(control='step', make=make)
    return types.SimpleNamespace(NAME='ours', runners=runners)


def askew(time, state):
    """Return a state that is wrong by about 1e-3, more or less with time."""
    return state + 1e-3 * np.sin(1.0 + np.arange(7) + 0.37 * time)


@pytest.mark.parametrize('name', [
    pytest.param(name, marks=IN_SOAK if name[0] in '68' else ())
    for name in ASKED if name[0] not in '79'])
def test_an_exact_peer_has_no_error(name):
    asked = ASKED[name].asked
    # measured: 2.5e-14 rad beside the separatrix, 0.026 s of the spiral, seen every 0.2 s
    assert asked.ask(peer()) < (0.05 if asked.unit == 's' else 5e-14)


@pytest.mark.without_numba
def test_errors_of_a_peer_that_is_wrong_are_those_of_its_states():
    kept.check('questions', {name: [case.asked.time, case.asked.unit, case.asked.ask(
        peer(wrong=askew))] for name, case in ASKED.items() if name[0] != '7'})


@pytest.mark.without_numba
def test_a_peer_that_finds_nothing_says_so():
    asked = {name: case.asked for name, case in ASKED.items() if name[0] == '8'}
    still = peer(wrong=lambda time, state: np.array([0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0]))
    assert asked['8 1e-300 off the smallest axis'].ask(still) == 'never leaves'
    lost = peer(wrong=lambda time, state: state * (math.nan if time > 0.5 else 1.0))
    assert math.isnan(asked['8 stiff: c dt = 1'].ask(lost))


HALF = math.sin(0.1), math.cos(0.1)


@pytest.mark.parametrize(('found', 'expected', 'angle'), [
    ((0.0, 0.0, *HALF), '0 0 0 1', 0.2), ((0.0, 0.0, *HALF), '0 0 0 -3', 0.2),
    ((2.0 * HALF[0], 0.0, 0.0, 2.0 * HALF[1]), '0 0 0 1', 0.2),
    ((1.0, 0.0, 0.0, 0.0), '0 0 0 1', math.pi), ((0.0, 0.0, 0.0, 1.0), '0 0 0 1', 0.0),
    ((0.0, 0.0, 0.0, 0.0), '0 0 0 1', math.inf), ((math.nan, 0, 0, 1), '0 0 0 1', math.inf)])
def test_the_angle_between_attitudes_is_that_of_the_turn_from_one_to_the_other(
        found, expected, angle):
    assert beside.angle(found, expected.split()) == pytest.approx(angle, rel=1e-14, abs=1e-30)


@pytest.mark.parametrize(('rate', 'time'), [(50.0, 100.0), (101.0, 50.0), (5000.0, 2.0),
                                            (1e9, 2.0)])
def test_peers_are_asked_for_the_last_attitude_that_they_reach(rate, time):
    """Up to 100 s and to 10,000 rad, or for the first one."""
    record = {'angular_velocity': [0.6 * rate, 0.0, 0.8 * rate], 'states': [
        {'time': one, 'orientation': [0, 0, 0, 1]} for one in (2.0, 50.0, 100.0, 101.0)]}
    assert beside.attitude(None, record).time == time


@pytest.mark.parametrize(('time', 'step'), [(2.0, 1e-3), (0.0026, 0.0026 / 3), (1e-4, 1e-4)])
@pytest.mark.parametrize('control', ['step', 'tolerance'])
def test_peers_take_steps_of_a_millisecond_or_a_tolerance(time, step, control):
    """The steps are as long as each other."""
    record = {'angular_velocity': [1, 2, 2],
              'states': [{'time': time, 'orientation': [0, 0, 0, 1]}]}
    made, asked_for = [], []

    def runners(problem, reference):
        assert problem.duration == time and reference.omega == [(1, 2, 2)]
        yield types.SimpleNamespace(control=control, make=lambda setting: made.append(setting)
                                    or types.SimpleNamespace(
            start=lambda: asked_for.append('start'), to=asked_for.append,
            state=lambda: (0.0, 0.0, *HALF, 1.0, 2.0, 2.0)))
    scene = types.SimpleNamespace(
        name='a', about='b', initial=types.SimpleNamespace(angular_velocity=(1, 2, 2)))
    found = beside.attitude(scene, record).ask(types.SimpleNamespace(runners=runners))
    assert found == near(0.2, rel=1e-14)
    assert made == near([step if control == 'step' else 1e-12], rel=1e-14)
    assert asked_for == ['start', time]


def test_what_a_peer_says_is_told_in_a_few_words():
    pytest.importorskip('numba')

    def asked(answer):
        def ask(module):
            if isinstance(answer, Exception):
                raise answer
            return answer
        return beside._asked(None, types.SimpleNamespace(ask=ask))
    assert asked(0.5) == 0.5 and asked('never leaves') == 'never leaves'
    assert asked(math.nan) == asked(math.inf) == 'NaN in silence'
    assert asked(BadInput('scene', 'a', 'b')) == 'refuses: scene: a; b'
    assert asked(NotConverged('no  step\nis small enough', 0.0)).startswith(
        'fails: no step is small')
    assert asked(KeyError(91 * 'x')) == f"fails: KeyError: '{89 * 'x'}"


def spun(*rates):
    """Return a peer whose body has a rate about each axis at a share of the time that it runs.

    `rates` are functions of the time.
    """
    def runners(problem, reference):
        run = types.SimpleNamespace(time=0.0, start=lambda: None)
        run.to = lambda time: setattr(run, 'time', time)
        run.state = lambda: [0.0, 0.0, 0.0, 1.0, *(rate(run.time) for rate in rates)]
        yield types.SimpleNamespace(control='step', make=lambda setting: run)
    return types.SimpleNamespace(runners=runners)


def still(time):
    return 0.0


THREE = """scene: three
body: {mass: 1, inertia: [1, 2, 3]}
constraint: free
effects: []
initial: {angular_velocity: [2, 0, 0]}
"""


@pytest.mark.parametrize(('turning', 'ended', 'expected'), [
    # w^2/3 is in excess about the first axis, and nothing about the third; the start has 2 J
    ((lambda t: 2.0 - 0.1 * t, still, still), False, 0.0),
    ((lambda t: 2.0 - 0.1 * t, still, still), True, 1.9**2 / 6.0),
    ((lambda t: 2.0 + (t > 0.5), still, still), False, 5.0 / 6.0),
    ((lambda t: 2.0 + (t > 0.5) - 2.0 * (t > 0.8), still, still), True, 5.0 / 6.0),
    ((still, still, lambda t: t), True, 0.0)])
def test_the_excess_may_not_rise_nor_stay_where_it_must_have_ended(turning, ended, expected):
    """The largest rise counts, as a share of the energy of the start; the rest at the end, too."""
    scene = parse_scene(THREE)
    found = questions.never_rises(scene, 1.0, ended).ask(spun(*turning))
    # of energies beside 2 J; measured 1e-16
    assert found == pytest.approx(expected, rel=0.0, abs=1e-15)


def test_an_omega_that_must_stay_and_one_that_must_leave_are_told_by_the_axis_and_the_time():
    scene = parse_scene(THREE)
    moved = spun(lambda t: 2.0, lambda t: -0.5 * t, lambda t: 0.25 * t)
    assert questions.stays(scene, 4.0).ask(moved) == near(2.0, rel=1e-15)
    # (2 w2)^2 + (3 w3)^2 = (1 + 0.5625) t^2 is 1 at 0.8 s; looks are 4/399 s apart
    late = questions.leaves(scene, 4.0, 0.75).ask(moved)
    assert 0.05 <= late <= 0.05 + 4.0 / 399
    assert questions.leaves(scene, 0.79, 0.75).ask(moved) == 'never leaves'


SHOTS = [name for name in ASKED if name[0] == '7']


class Ball:
    """The ball of this package as that of a peer."""

    def __init__(self, shot):
        friction = f'sliding_friction: {{mu: {shot.mu}, g: {G}}}'
        self._simulation = Simulation(parse_scene(
            f'scene: ball\nbody: {{mass: {MASS}, shape: {{solid_sphere: {{radius: '
            f'{A}}}}}}}\nconstraint: table\neffects: [{friction}]\ninitial: {{velocity: '
            f'{[*shot.v, 0.0]}, angular_velocity: {list(shot.omega)}}}\n'))

    def to(self, time):
        self._simulation.advance(round(time * 1000) - self._simulation.tick)

    def push(self, change):
        if any(change):
            self._simulation.impulse(force=[MASS * change[0], MASS * change[1], 0])

    def velocities(self):
        state = self._simulation.state
        return state.velocity[:2], rotate(*state.orientation, *state.angular_velocity)[:2]


@pytest.mark.parametrize('name', SHOTS)
def test_a_ball_that_obeys_the_law_ends_as_expected(name, monkeypatch):
    monkeypatch.setitem(contact.PEERS, 'ours', Ball)
    asked = ASKED[name].asked
    assert asked.ask(peer()) < 1e-14    # m/s; measured 2e-15
    assert asked.ask(types.SimpleNamespace(NAME='no engine')) == ''


def test_an_error_counts_in_speed_and_in_slip(monkeypatch):
    class Wrong(Ball):
        def velocities(self):
            (vx, vy), (wx, wy) = super().velocities()
            return (vx + 0.03, vy - 0.04), (wx - 0.04 / A, wy + 0.03 / A)

    monkeypatch.setitem(contact.PEERS, 'ours', Wrong)
    found = [ASKED[name].asked.ask(peer()) for name in SHOTS]
    # without friction no slip counts
    assert found == pytest.approx([0.05 if 'no friction' in name else 0.05 + 0.08 for name in
                                   SHOTS], rel=1e-12, abs=0.0)


@pytest.mark.parametrize('name', SHOTS)
def test_runge_and_kutta_miss_the_onset_of_rolling_by_a_step(name):
    asked = ASKED[name].asked
    kept.check(f'shot_{name[2:].replace(" ", "_").replace("/", "_")}', [
        asked.time, asked.unit, asked.ask(types.SimpleNamespace(NAME='numba RK4'))])


def test_a_ball_without_a_push_is_asked_at_its_start_and_at_its_end(monkeypatch):
    asked = []

    class Noted:
        def __init__(self, shot):
            asked.append(shot)

        def to(self, time):
            asked.append(time)

        push = to

        def velocities(self):
            return (3.0, 4.0), (0.0, 0.0)
    monkeypatch.setitem(contact.PEERS, 'ours', Noted)
    shot = contact.Shot(0.0, (1.0, 0.0), (0.0, 0.0, 0.0), 0.5, (0.0, 0.0))
    assert contact.question(shot).ask(peer()) == 5.0
    assert asked == [shot, 0.0, (0.0, 0.0), 0.5]


def test_scipy_slides_a_ball_as_its_formula_says_and_does_not_go_back(monkeypatch):
    """Before rolling v = v0 - mu g t, a omega_y = 5/2 mu g t."""
    integrate = pytest.importorskip('scipy.integrate')
    ball = Scipy(contact.Shot(0.2, (2.0, 0.0), (0.0, 0.0, 0.0), 1.0, (0.0, 0.0)))
    for time in (0.0, 0.1, 0.05):
        ball.to(time)
        assert ball.time == max(time, ball.time)
    lost = 0.2 * G * 0.1
    (vx, vy), (wx, wy) = ball.velocities()
    assert (vx, A * wy) == pytest.approx((2.0 - lost, 2.5 * lost), rel=1e-12, abs=0.0)
    assert (vy, wx, ball.time) == (0.0, 0.0, 0.1)
    monkeypatch.setattr(integrate, 'solve_ivp', lambda *_, **more: types.SimpleNamespace(
        success=False, message='the step is too small'))
    with pytest.raises(NotConverged, match='the step is too small'):
        ball.to(0.2)


def test_peers_that_are_installed_are_told_from_the_others():
    pytest.importorskip('numba')
    from rigid_body_sim.study.precision import peers
    found, missing = beside.modules()
    assert {'numba RK4', 'SciPy DOP853'} <= set(found)
    assert all(name == module.NAME for name, module in found.items())
    assert not set(found) & set(missing)
    assert len(found) + len(missing) == len(peers.MODULES)
