# SPDX-License-Identifier: Apache-2.0
"""Group 13, slim and stiffly damped bodies: nothing hangs, and what is followed is right."""

import json
import math
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from hard_cases.stiff_scenes import ACCURACIES, DEPARTURES, scene
from soak import IN_SOAK, SOAK, some_of

from rigid_body_sim.compilation import threads
from rigid_body_sim.compilation.jit import HAVE_NUMBA
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.integrators.marching import work
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.motions import solver as closed_forms
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.simulation.ensemble import ensemble
from rigid_body_sim.simulation.simulation import Simulation

NAMES = 'slim', 'hinge', 'spinning', 'skew', 'driven', 'needle'
LIKE_OTHERS = 'spinning', 'skew', 'driven', 'needle'


@pytest.fixture(scope='module')
def stiff(plain):
    # only one test, of the soak, looks at the skew body
    return plain('hard_cases/stiff_scenes.py', 'departures',
                 *(name for name in NAMES if SOAK or name != 'skew'))


@pytest.mark.parametrize('name', [
    pytest.param(name, marks=IN_SOAK if name in LIKE_OTHERS else ()) for name in NAMES])
def test_auto_takes_a_method_that_keeps_the_pace_of_the_motion(stiff, name):
    assert stiff[name]['method'] in ('gauss16', 'exact')
    assert stiff[name]['expected'] < 1e-11


def test_a_pendulum_in_tar_creeps_at_the_rate_of_torque_over_drag(stiff):
    pendulum = load_scene('kater_pendulum_from_p')
    arm = pendulum.constraint.arm(pendulum.body)
    end = stiff['hinge']['end']
    angle, rate = 2.0 * math.atan2(end[2], end[4]), end[6]
    down = math.hypot(arm[0], arm[2])
    torque = -pendulum.body.mass * 9.81 * down * math.sin(angle - math.pi)
    # the hinge's drag is 1e8 N m s, the rest of it a part in 1e9; the scene decides which way the
    # angle counts
    assert abs(abs(rate) - abs(torque) / 1e8) < 1e-8 * abs(rate)


def test_an_overdamped_top_keeps_its_spin_and_its_axis_falls_as_the_sum_says(stiff):
    _, x, y, z, w, _, _, spin, *_ = stiff['spinning']['end']
    assert abs(spin - 30.0) < 1e-12
    tilt = 2.0 * math.atan2(math.hypot(x, y), math.hypot(z, w))
    # c r^2 theta' = M g r sin(theta), gyroscopic corrections are (I3 w3/(c r^2))^2 = 6e-11 of it
    expected = 2.0 * math.atan(math.tan(0.25) * math.exp(9.81 * 1.0 / (1e6 * 0.2)))
    assert abs(tilt - expected) < 1e-9


def test_a_driven_body_in_tar_turns_with_torque_over_drag(stiff):
    omega = np.array(stiff['driven']['end'][5:8])
    assert np.abs(omega - np.array([0.1, 0.2, 0.3]) / 1e5).max() < 1e-15


def test_drag_slows_a_needle_as_it_slows_a_disk(stiff):
    # I1 = I2 and I3 = 0: omega1 and omega2 fall by e^(-k t/I1), the axis turns in a plane
    omega = np.array(stiff['needle']['end'][5:8])
    assert np.abs(omega - np.array([1.0, 2.0, 0.0]) * math.exp(-0.005)).max() < 1e-13


def departing(moments, coefficient, omega):
    return scene('free', body={'mass': 1.0, 'inertia': list(moments)},
                 effects=[{'internal_dissipation': {'coefficient': coefficient}}],
                 initial={'angular_velocity': list(omega)})


@pytest.mark.parametrize(('name', 'accuracy'), some_of([*DEPARTURES], ACCURACIES))
def test_internal_dissipation_leaves_an_axis_at_the_right_time(stiff, name, accuracy):
    # measured at 1e-12: errors of at most 1e-14, and they are the expected ones
    found = stiff['departures'][f'{name} {accuracy}']
    assert found['error'] < accuracy
    assert found['rate'] < 10.0 * accuracy
    assert found['error'] < 2.0 * found['expected'] + 1e-14
    assert found['expected'] < accuracy


@pytest.mark.without_numba
@pytest.mark.parametrize('coefficient', [100.0, 1000.0, 1e9])
def test_a_body_1e_300_off_its_smallest_axis_leaves_when_it_has_grown_by_that(coefficient):
    # omega3 grows at c I1 w1^2 (I3 - I1)/I3, from 1e-300 to about 1 in log(1e300) of its times
    expected = 300.0 * math.log(10.0) / (coefficient * 4.0 * 2.0 / 3.0)
    body = departing((1, 2, 3), coefficient, (2, 1e-300, 1e-300))
    solver = Stepped(body, 'dop8', 1e-12).start(body.initial.vector)
    before, after = np.empty(14), np.empty(14)
    solver.state(0.98 * expected, before)
    solver.state(1.02 * expected, after)
    assert abs(before[5] - 2.0) < 1e-9
    assert abs(after[5]) < 1e-3


@pytest.mark.without_numba
def test_a_body_far_from_the_origin_departs_about_its_centre():
    parts = {'effects': [{'internal_dissipation': {'coefficient': 5.0}}],
             'initial': {'angular_velocity': [1e-12, 2.0, 1e-12], 'velocity': [0.1, 0.2, 0.3]}}
    skew = scene('free', body={'mass': 2.0, 'center_of_mass': [0.1, -0.2, 0.3],
                               'inertia': [1.0, 2.0, 3.0]}, **parts)
    solver = Stepped(skew, 'dop8', 1e-12).start(skew.initial.vector)
    times, states = np.linspace(0.0, 3.0, 7), np.empty((7, 14))
    solver.states(times, states)
    simulation = Simulation(skew, 'dop8')
    for state in states:    # the centre of mass moves in a straight line all the way
        x, y, z, w = state[1:5]
        u, c = np.array([x, y, z]), np.array([0.1, -0.2, 0.3])
        center = state[8:11] + c + 2.0 * np.cross(u, np.cross(u, c) + w * c)
        start = simulation.states([0.0]).vector[0]
        drift = start[11:14] + np.cross(start[5:8], c)
        assert np.abs(center - (c + state[0] * drift)).max() < 1e-12


def refused_in_one_line(text):
    with pytest.raises((BadInput, NotConverged)) as found:
        parse_scene(json.dumps({'scene': 'extreme'} | text))
    assert str(found.value).isprintable()


@pytest.mark.parametrize('scene_of', [
    lambda: {'body': {'mass': 1.0, 'inertia': [1, 2, 3], 'center_of_mass': [0, 0, 1]},
             'constraint': 'pivot', 'effects': [{'gravity': {'g': 1e308}}], 'initial': {}},
    lambda: {'body': {'mass': 1.0, 'inertia': [1, 2, 3]}, 'constraint': 'free',
             'effects': [{'gravity': {'g': 1e160}}], 'initial': {}},
    lambda: {'body': {'mass': 1.0, 'shape': {'solid_sphere': {'radius': 0.03}}},
             'constraint': 'table', 'effects': [{'sliding_friction': {'mu': 0.2, 'g': 9.81}}],
             'initial': {'velocity': [1e308, 0.0, 0.0]}},
    lambda: {'body': {'mass': 1.0, 'inertia': [1, 1, 1e-310]}, 'constraint': 'free',
             'effects': [], 'initial': {'angular_velocity': [1, 2, 3]}},
    lambda: {'body': {'mass': 1e-310, 'inertia': [1, 1, 1]}, 'constraint': 'free',
             'effects': [], 'initial': {'angular_velocity': [1, 2, 3]}}],
    ids=['weight', 'fall', 'ball', 'needle', 'mass'])
def test_numbers_whose_products_are_no_doubles_are_refused(scene_of):
    refused_in_one_line(scene_of())


@pytest.mark.without_numba
def test_a_march_gives_up_where_the_way_ahead_asks_for_too_many_steps():
    top = scene(body={'mass': 1.0, 'inertia': [1, 2, 3], 'center_of_mass': [0, 0, 1]},
                effects=[{'gravity': {'g': 1e60}}], initial={'tilt': 1.0})
    solver = Stepped(top, 'dop8', 1e-9).start(top.initial.vector)
    with pytest.raises(TooMuchWork, match='too many'):
        solver.state(10.0, np.empty(14))
    bounded = Stepped(top, 'dop8', 1e-9, most=100).start(top.initial.vector)
    with pytest.raises(TooMuchWork, match=r'^dop8 on stiff: \d+ steps'):
        bounded.state(1e-20, np.empty(14))


BODY = {'mass': 1.0, 'inertia': [1.0, 2.0, 2.5]}
ENDLESS = {
    'impacts': ('dop8', {
        'constraint': {'table': {'restitution': 1.0}}, 'effects': [{'gravity': {'g': 9.81}}],
        'body': {'mass': 1.0, 'shape': {'ellipsoid': {'semi_axes': [0.1, 0.1, 0.1]}}},
        'initial': {'position': [0, 0, 1]}}),
    'kinks': ('dop8', {
        'body': BODY, 'effects': [{'torque': {'value': ['sign(sin(9*t))', 0, 0]}}],
        'initial': {}}),
    'steps of SciPy': ('radau', {
        'body': BODY, 'effects': [], 'initial': {'angular_velocity': [9.0, 1.0, 2.0]}})}


@pytest.mark.without_numba
@pytest.mark.parametrize(('method', 'parts'), ENDLESS.values(), ids=ENDLESS)
def test_what_python_does_between_marches_counts_as_work(method, parts, monkeypatch):
    monkeypatch.setattr(work, 'MOST', 1e6)
    monkeypatch.setattr(work, 'PATIENCE', 1e8)
    monkeypatch.setattr(work, 'FIRST_LOOK', 1000)
    simulation = Simulation(scene(**parts), method, accuracy=1e-6)
    with pytest.raises(TooMuchWork, match='too many'):
        simulation.states([1e7])


def steps_of(march, most=None, doublings=None):
    """Return the steps after which a march to 1 s gives up; march(n) is the time after n, s."""
    done, limited = 0, work.Work('a march', most, doublings=doublings)

    def follow(limit):
        nonlocal done
        done += limit
        return march(done) >= 1.0

    try:
        limited.go(follow, lambda: march(done), 1.0)
    except TooMuchWork:
        return done
    return math.inf


def test_what_explodes_ends_soon_in_a_trial_and_without_numba(monkeypatch):
    """Each turn takes half the time of the last. The march once took 80,000 and 262,144 steps."""
    def exploding(n):
        return math.log1p(n) / 4000.0

    assert steps_of(exploding, 80_000) <= 1 << 15
    monkeypatch.setattr(work, 'SLOWER', 1)
    assert steps_of(exploding) >= 1 << 17
    monkeypatch.setattr(work, 'SLOWER', 100)
    assert steps_of(exploding) <= 1 << 14
    # what begins with short steps, or goes on as it began, arrives
    assert steps_of(lambda n: 1e-90 * 4.0 ** (n / 30), 5000) == math.inf
    assert steps_of(lambda n: 1e-7 * n + (n / 4000.0) ** 3, 5000) == math.inf
    assert steps_of(lambda n: n / 4900.0, 5000) == steps_of(lambda n: n / 2e6) == math.inf


@pytest.mark.parametrize(('march', 'hopeless'), [
    (lambda n: math.log1p(n) / 70.0, True),
    (lambda n: (n / 1e4 if n < 100 else 0.01 + math.log(n / 100.0) / 70.0), True),
    (lambda n: 0.9 - 0.9 / (1.0 + n / 10.0), True),
    # 1e10 steps would do, and 3e10 are allowed
    (lambda n: math.log1p(n) / 23.0, False),
    (lambda n: n / 1e7, False),
    (lambda n: (n / 1e7) ** 0.12, False),
    (lambda n: (n / 1e5) ** 2.0, False),
    (lambda n: 1e-90 * 4.0 ** (n / 30), False)],
    ids=['geometric', 'geometric later', 'pole', 'not far', 'even', 'power', 'growing', 'stiff'])
def test_steps_that_shrink_geometrically_are_seen_to_lead_nowhere(march, hopeless, monkeypatch):
    monkeypatch.setattr(work, 'MOST', 3e8)
    monkeypatch.setattr(work, 'SLOWER', 1)
    made = steps_of(march, doublings=work.Doublings(1.0, 1))
    assert made <= 1 << 12 if hopeless else made > 1 << 14


def counted(monkeypatch):
    """Return a list whose sum is the number of steps that marches are about to count."""
    made, count = [], work.Work.count

    def noting(self, steps, *rest):
        made.append(steps)
        count(self, steps, *rest)
    monkeypatch.setattr(work.Work, 'count', noting)
    return made


@pytest.mark.without_numba
@pytest.mark.parametrize(('held', 'formula'), [
    ('free', 'exp(500*t)'), ('pivot', 'exp(20*t)'),
    pytest.param('free', 'exp(t^3)', marks=IN_SOAK),
    pytest.param('pivot', 'abs(exp(50*t) - 2)', marks=IN_SOAK)])
def test_a_torque_that_explodes_is_given_up_after_a_thousand_steps(held, formula, monkeypatch):
    """The march may take 100,000 steps to each of the times."""
    body = scene(held, body=BODY, effects=[{'torque': {'value': [formula, 0, 0]}}],
                 initial={'angular_velocity': [1, 2, 3]})
    solver = Stepped(body, 'dop8', 1e-9, horizon=10.0, most=100_000).start(body.initial.vector)
    made = counted(monkeypatch)
    with pytest.raises(TooMuchWork, match='too many'):
        solver.states(np.linspace(0.0, 10.0, 65)[1:], np.empty((64, 14)))
    assert 32 < sum(made) < 5000


@pytest.mark.without_numba
@pytest.mark.parametrize('method', ['gauss16', 'taylor', 'dop8'])
def test_a_pivot_that_leaves_what_doubles_hold_is_told(method):
    body = scene({'pivot': {'motion': [0, 'exp(77*t)', 0]}}, body=BODY, effects=[],
                 initial={'angular_velocity': [0.1, 0.2, 0.3]})
    simulation = Simulation(body, method, rate=1.0)
    assert simulation.states([9.0]).position[0, 1] == pytest.approx(math.exp(693.0))
    with pytest.raises(NotConverged, match=r'at t = 10.0 s the state is no longer finite'):
        simulation.advance(10)
    with pytest.raises(NotConverged, match=r'at t = 9.5 s the state is no longer finite'):
        ensemble(body, [body.initial.vector] * 2, [1.0, 9.5, 10.0], method)


@pytest.mark.without_numba
def test_a_torque_that_grows_no_further_than_it_can_be_followed_is_followed(monkeypatch):
    body = scene('free', body=BODY, effects=[{'torque': {'value': ['exp(3*t)', 0, 0]}}],
                 initial={'angular_velocity': [1, 2, 3]})
    states = np.empty((2, 14))
    solver = Stepped(body, 'dop8', 1e-6, horizon=3.0, most=5000).start(body.initial.vector)
    made = counted(monkeypatch)
    solver.states(np.array([1.5, 3.0]), states)    # the first 64 steps to each are not counted
    assert np.isfinite(states).all()
    assert sum(made) > 500


def test_a_march_that_gives_up_says_times_as_a_person_writes_them():
    with pytest.raises(TooMuchWork) as given_up:
        work.Work('a march', None).go(lambda limit: False, lambda: np.float64(0.5), 1.0)
    assert 'steps from t = 0.5 s led to t = 0.5 s; to reach 1.0 s' in str(given_up.value)


STRUCK = {'strike': {'impulse': [0, 1e-9, 0], 'point': [0.1, 0, 0.2], 'time': 0.002}}
TOP = {'mass': 1.0, 'inertia': [0.02, 0.02, 0.01], 'center_of_mass': [0, 0, 0.1]}
SWIFT = {
    'free body': {
        'constraint': 'free', 'body': BODY, 'effects': [STRUCK],
        'initial': {'angular_velocity': [0.0, 1e40, 200.0]}},
    'damped body': {
        'constraint': 'free', 'body': BODY, 'effects': [STRUCK, {'drag': {'linear': 1e-9}}],
        'initial': {'angular_velocity': [0.0, 1e40, 200.0]}},
    'pendulum': {
        'constraint': {'hinge': {'axis': [1, 0, 0], 'through': [0, 0, 0]}}, 'body': TOP,
        'effects': [STRUCK, {'gravity': {'g': 1e74}}], 'initial': {'angle': 1.0, 'rate': 0.0}},
    'Lagrange top': {
        'constraint': 'pivot', 'body': TOP, 'effects': [STRUCK, {'gravity': {'g': 9.81}}],
        'initial': {'tilt': 1.0, 'spin': 1e40}}}


@pytest.mark.without_numba
@pytest.mark.timeout(60)
@pytest.mark.parametrize('parts', [
    pytest.param(parts, id=name, marks=[IN_SOAK] * (name != 'free body'))
    for name, parts in SWIFT.items()])
def test_events_that_doubles_do_not_tell_apart_are_not_looked_for(parts):
    simulation = Simulation(scene(**parts))
    assert simulation.method == 'exact'
    simulation.advance(3)    # past the strike
    assert np.isfinite(simulation.vector).all()


@pytest.mark.without_numba
def test_a_march_in_slices_has_the_bits_of_one_that_is_asked_for_each_state():
    top = load_scene('driven_body')
    once, often = (Stepped(top, 'dop8', 1e-9).start(top.initial.vector) for _ in range(2))
    end, other = np.empty(14), np.empty(14)
    once.state(40.0, end)
    for at in np.linspace(0.0, 40.0, 4001):
        often.state(at, other)
    assert np.array_equal(end, other)


@pytest.mark.skipif(not HAVE_NUMBA, reason='about compiled loops')
def test_an_interrupt_from_the_keyboard_is_heard_in_a_compiled_loop():
    code = """
from rigid_body_sim import load_scene
from rigid_body_sim.integrators.solver import Stepped
import numpy as np
body = load_scene('driven_body', ['effects=[{torque: {value: [1.0e-9, 0, 0]}}]',
                                  'initial.angular_velocity=[1, 2, 3]'])
solver = Stepped(body, 'dop8', 1e-6).start(body.initial.vector)
for time in (1.0, 2.0, 50.0):    # an interrupt that comes while a kernel compiles may be lost
    solver.state(time, np.empty(14))
print('on the way', flush=True)
solver.state(3e7, np.empty(14))
"""
    process = subprocess.Popen(
        [sys.executable, '-c', code], cwd=pathlib.Path(__file__).parents[2], text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        assert process.stdout.readline() == 'on the way\n'
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        # it takes a tenth of a second; the march itself would take minutes
        _, error = process.communicate(timeout=20)
    finally:
        process.kill()
    assert 'KeyboardInterrupt' in error


def test_an_interrupt_ends_the_work_of_all_threads(monkeypatch):
    monkeypatch.setattr(os, 'cpu_count', lambda: 2)
    main, ended = threading.get_ident(), []

    def work(part):
        if threading.get_ident() == main:
            raise KeyboardInterrupt
        try:
            while True:
                threads.look()
                time.sleep(0.001)
        except threads.Abandoned:
            ended.append(part)
            raise

    with pytest.raises(KeyboardInterrupt):
        threads.on_all_cores(work, 100)
    assert len(ended) <= 1
    threads.look()    # the work is over: nothing is abandoned


def test_closed_forms_give_their_states_in_slices(monkeypatch):
    times = np.linspace(0.0, 10.0, 1000)
    whole = Simulation('tennis_racket').states(times).vector
    monkeypatch.setattr(closed_forms, 'AT_ONCE', 100)
    simulation, asked = Simulation('tennis_racket'), []
    loops = simulation._spans[0].solver._loops

    def states(anchor, times, out):
        asked.append(len(times))
        return slow(anchor, times, out)
    slow = loops.states
    monkeypatch.setattr(loops, 'states', states)
    assert np.array_equal(simulation.states(times).vector, whole)
    assert asked == 10 * [100]
