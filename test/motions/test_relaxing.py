# SPDX-License-Identifier: Apache-2.0
"""Damped, driven and hinged bodies in closed form, against 34 digits and in the simulation."""

import json
import math
import os
import pathlib
import pickle
import subprocess
import sys

import numpy as np
import pytest
import yaml
from near import near

from rigid_body_sim.choice.choice import Choice
from rigid_body_sim.errors import BadInput
from rigid_body_sim.mechanics.events import watches
from rigid_body_sim.motions import absorbing_motion
from rigid_body_sim.motions.solver import Exact
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.ensemble import ensemble
from rigid_body_sim.simulation.simulation import Simulation

ROOT = pathlib.Path(__file__).resolve().parents[2]
RECORDS = json.loads((ROOT / 'test/data/relaxing.json').read_text())
CASES = RECORDS['cases']
HALF_ULP = 2.0 ** -53


def scene_of(constraint, effects, inertia=(0.5, 0.8, 1.1), **initial):
    """Return a scene of a balanced body of 2 kg."""
    return parse_scene(yaml.safe_dump({
        'scene': 'body', 'body': {'mass': RECORDS['mass'], 'inertia': list(inertia)},
        'constraint': constraint, 'effects': effects, 'initial': initial}))


def case(name):
    """Return the scene of a record."""
    record = CASES[name]
    kind, omega, given = record['kind'], record['omega'], record['given']
    if kind == 'hinge':
        effects = [{'torque': {'value': [5.0, -6.0, given[0]]}}, {'drag': {'angular': given[1]}}]
        return scene_of({'hinge': {'axis': [0, 0, 1]}}, effects, record['moments'],
                        orientation=RECORDS['orientation'], rate=omega)
    effects = {'damped': [{'drag': {'angular': given}}, {'gravity': {'g': 9.81}}],
               'driven': [{'torque': {'value': given}}, {'drag': {'angular': 0.0}}],
               'world': [{'torque': {'value': given, 'frame': 'world'}}]}[kind]
    return scene_of('pivot', effects, record['moments'], orientation=RECORDS['orientation'],
                    angular_velocity=omega)


def started(scene, begin=0.0):
    """Return an exact solver from the initial state, at another time of the clock."""
    start = scene.initial.vector.copy()
    start[0] = begin
    return Exact(scene, absorbing_motion(scene)).start(start)


def at(solver, time):
    """Return the state at a time."""
    out = np.empty(14)
    solver.state(time, out)
    return out


@pytest.mark.without_numba
@pytest.mark.parametrize('name', CASES)
def test_reference(name):
    """Times of both signs, drag rates from 1e-300 to 1e3 per second, torque through zero."""
    record, scene = CASES[name], case(name)
    solver = started(scene)
    rate0 = np.linalg.norm(scene.initial.angular_velocity)
    for entry in record['states']:
        time, state = entry['time'], at(solver, entry['time'])
        q, omega = np.array(entry['state'][:4], float), np.array(entry['state'][4:], float)
        size = max(np.abs(omega).max(), 1e-300)
        angle = 0.5 * abs(time) * (rate0 + size) if record['kind'] != 'damped' else 0.0
        if record['kind'] == 'hinge':    # an angle in pairs: only a rate that doubles round grows
            angle = 0.0
        # worst measured: 4 half ulps, or 0.9 of the half ulps of the angle that was turned over;
        # a free body's mean rate carries 2e-19 of the angle; at 1e3/s it was 1e127 rad before
        bound = HALF_ULP * (8.0 + 2.0 * angle) + 1e-18 * rate0 * abs(time)
        if '1e3' in name and time < 0.0:
            bound = math.inf
        sign = math.copysign(1.0, state[1:5] @ q) if record['kind'] == 'damped' else 1.0
        assert np.abs(state[1:5] - sign * q).max() <= bound, (time, 'attitude')
        # the exponent of exp(-x) is x rounded: 300 half ulps at x = -300
        grown = max(0.0, -math.log(size / rate0)) if size < rate0 else math.log(size / rate0)
        assert np.abs(state[5:8] - omega).max() <= HALF_ULP * (12.0 + 4.0 * grown) * size \
            + (bound * size if bound < 1.0 else 0.0), (time, 'omega')


@pytest.mark.parametrize('name', RECORDS['flights'])
def test_flight_reference(name):
    """The drag on the centre of mass leaves the rotation alone, and the flight is exact too."""
    record = RECORDS['flights'][name]
    effects = [{'gravity': {'g': 9.81}}, {'drag': {'linear': record['linear']}}]
    initial = {'position': [1.0, 2.0, 3.0], 'velocity': [3.0, -4.0, 5.0],
               'angular_velocity': [1.0, 2.0, -3.0]}
    scene = scene_of('free', effects, **initial)
    solver, alone = started(scene), started(scene_of('free', [], **initial))
    for entry in record['states']:
        state, expected = at(solver, entry['time']), np.array(entry['state'], float)
        # worst measured: 3 ulp
        share = 4.0 * np.finfo(float).eps * (1.0 + abs(record['linear']) * max(0, -entry['time']))
        assert np.abs(state[8:11] - expected[:3]).max() <= share * np.abs(expected[:3]).max()
        assert np.abs(state[11:] - expected[3:]).max() <= share * np.abs(expected[3:]).max()
        assert (state[1:8] == at(alone, entry['time'])[1:8]).all()


@pytest.mark.parametrize('name', CASES)
def test_bits_are_those_of_one_state_whatever_is_asked(name):
    """One state, many, an ensemble; from another start of the clock to round-off."""
    scene, solver = case(name), started(case(name))
    times = np.linspace(-0.2, 9.0, 150)
    alone = np.array([at(solver, time) for time in times])
    many = np.empty_like(alone)
    solver.states(times, many)
    assert (many == alone).all()
    assert (ensemble(scene, times=times).vector[0] == alone).all()
    simulated = Simulation(scene)
    simulated.advance(1700)
    assert (simulated.vector == at(solver, 1.7)).all()
    assert (pickle.loads(pickle.dumps(simulated)).vector == simulated.vector).all()


def test_plain_python_gives_the_same_bits():
    """Without numba, in a process of its own."""
    code = ('import sys; sys.path.insert(0, "test/motions"); import test_relaxing as t\n'
            'for n in t.CASES:\n'
            '    s = t.started(t.case(n))\n'
            '    for k in (0.001, 0.7, 3.5, -0.2): print([x.hex() for x in t.at(s, k).tolist()])')

    def run(**more):
        out = subprocess.run([sys.executable, '-c', code], cwd=ROOT, text=True, check=True,
                             env={**os.environ, 'PYTHONPATH': f'{ROOT}:{ROOT / "test"}', **more},
                             capture_output=True, timeout=120)
        return out.stdout
    assert run() == run(NUMBA_DISABLE_JIT='1')


NOTHING = [{'torque': {'value': [0, 0, 0]}}, {'drag': {'linear': 0, 'angular': 0}},
           {'torque': {'times': [1, 2], 'values': [[0, 0, 0], [0, 0, 0]], 'frame': 'world'}}]
DRAG, WEIGHT = {'drag': {'angular': 0.1}}, {'gravity': {'g': 9.81}}
HINGE = {'hinge': {'axis': [0, 0, 1]}}


@pytest.mark.parametrize(('motion', 'constraint', 'effects', 'inertia'), [
    ('free_body', 'free', NOTHING, (0.5, 0.8, 1.1)),
    ('free_body', 'free', [*NOTHING, WEIGHT], (0.5, 0.8, 1.1)),
    ('free_body', 'free', [{'internal_dissipation': {'coefficient': 3.0}}], (0.5, 0.5, 0.5)),
    ('damped_body', 'pivot', [*NOTHING, WEIGHT], (0.5, 0.8, 1.1)),
    ('damped_body', 'pivot', [WEIGHT, {'drag': {'linear': 0.3}}], (0.5, 0.8, 1.1)),
    ('damped_body', 'free', [WEIGHT, {'drag': {'linear': 0.3}}], (0.5, 0.8, 1.1)),
    ('damped_body', 'free', [WEIGHT, DRAG], (0.5, 0.5, 0.5)),
    ('lagrange_top', 'pivot', [*NOTHING, WEIGHT], (0.5, 0.5, 0.8)),
    ('driven_body', 'free', [*NOTHING, {'torque': {'value': [0, 0, 1]}}], (0.5, 0.5, 0.8)),
    ('driven_body', 'pivot', [WEIGHT, {'torque': {'value': [0, 0, 1]}}], (0.5, 0.5, 0.8)),
    ('pendulum', HINGE, [*NOTHING, WEIGHT], (0.5, 0.8, 1.1)),
    ('fixed_axis', HINGE, [WEIGHT, DRAG], (0.5, 0.8, 1.1)),
    ('fixed_axis', HINGE, [{'torque': {'value': [1, 0, 2], 'frame': 'world'}}], (0.5, 0.8, 1.1)),
    ('fixed_axis', 'free', [DRAG, WEIGHT], (0.5, 0.8, 1.1))])
def test_scenes_are_matched_by_what_acts(motion, constraint, effects, inertia):
    """A listed effect that does nothing does not hide a closed form; the scene keeps it."""
    start = ({'rate': 2.0} if isinstance(constraint, dict) else
             {'angular_velocity': [0.0, 0.0, 3.0] if motion == 'fixed_axis' else [1.0, 2.0, -3.0]})
    scene = scene_of(constraint, effects, inertia, **start)
    simulation = Simulation(scene)
    assert simulation.choice.method == 'exact'
    assert simulation.choice._prototype.motion.__name__.split('.')[-1] == motion
    assert len(simulation.scene.effects) == len(effects)


@pytest.mark.parametrize(('effects', 'inertia', 'omega'), [
    ([DRAG], (0.5, 0.8, 1.1), (1.0, 2.0, 3.0)),
    ([DRAG], (0.8, 0.8, 1.1), (1.0, 2.0, 3.0)),
    ([DRAG], (0.5, 0.8, 1.1), (0.0, 1e-300, 3.0)),
    ([{'torque': {'value': [0, 1e-9, 1]}}], (0.5, 0.5, 0.8), (1.0, 2.0, 3.0)),
    ([{'torque': {'value': [0, 0, 1], 'frame': 'world'}}], (0.5, 0.5, 0.8), (1.0, 2.0, 3.0)),
    ([{'torque': {'times': [0, 5], 'values': [[0, 0, 1], [0, 0, 2]]}}], (0.5, 0.5, 0.8),
     (1.0, 2.0, 3.0)),
    ([{'torque': {'value': [0, 0, 1]}}, DRAG], (0.5, 0.5, 0.8), (1.0, 2.0, 3.0)),
    ([{'torque': {'value': [0, 0, 1]}}], (0.5, 0.6, 0.8), (1.0, 2.0, 3.0))])
def test_what_has_no_closed_form_is_left_to_methods(effects, inertia, omega):
    assert absorbing_motion(scene_of('free', effects, inertia,
                                     angular_velocity=list(omega))) is None


def test_a_hinge_along_gravity_and_one_that_leans():
    """The weight of an unbalanced body does nothing about a vertical axis."""
    held = {'hinge': {'axis': [0, 0, 1], 'through': [0.1, 0, 0]}}
    vertical = scene_of(held, [WEIGHT, DRAG], rate=2.0)
    assert absorbing_motion(vertical).__name__.endswith('fixed_axis')
    leaning = scene_of(held, [WEIGHT, DRAG], rate=2.0, orientation=[0.6, 0, 0, 0.8])
    assert absorbing_motion(leaning) is None
    # phi' = 2 exp(-k t/I), I = 1.1 + 2 x 0.1^2
    out = at(started(vertical), 3.0)
    assert out[7] == near(2.0 * math.exp(-0.3 / 1.12), 1e-15)
    assert out[8] == near(0.1 * (-math.cos(20.0 * 1.12 * -math.expm1(-0.3 / 1.12))), 1e-14)


def test_turning_point_of_a_hinge():
    """omega0 exp(-r t) + (N/k) (1 - exp(-r t)) = 0 at t = log(1 - omega0 k/N)/r."""
    simulation = Simulation(case('hinge, both, through zero'))
    simulation.advance(20_000)
    [event] = simulation.events
    assert event.name == 'turning point'
    assert event.time == near(math.log1p(2.0 * 0.05 / 0.3) * 1.1 / 0.05, 1e-15)
    undamped = Simulation(case('hinge, drag at 1e-300 /s'))
    undamped.advance(20_000)
    assert [event.time for event in undamped.events] == [near(2.0 / 0.3, 1e-15)]


@pytest.mark.parametrize('effects', [[], [{'torque': {'value': [0, 0, 0.02]}}]],
                         ids=['free', 'driven'])
def test_a_body_with_two_equal_moments_does_not_flip_whatever_solves_it(effects):
    """It has no middle axis: closed forms told flips there, stepped methods did not."""
    scene = scene_of('free', effects, (0.8, 0.8, 1.1), angular_velocity=[1.1, 0.2, -1.3])
    simulation = Simulation(scene)
    assert simulation.choice.method == 'exact'
    simulation.advance(50_000)
    assert np.ptp(simulation.states(np.linspace(0.0, 50.0, 500)).angular_velocity[:, 1]) > 0.1
    assert simulation.events == []
    assert watches(scene) == ()


def test_events_of_a_body_that_turns_over_and_over_within_a_tick_are_passed_over():
    """On a pivot they are looked for on the states: never oftener than the ticks ask for."""
    simulation = Simulation(scene_of('pivot', [DRAG], (0.5, 0.5, 0.5),
                                     angular_velocity=[1.0, 2.0, 1e60]))
    simulation.advance(100)
    assert simulation.events == []


def test_a_hinge_along_a_rod_is_refused():
    with pytest.raises(BadInput, match='about which the body has no moment of inertia'):
        scene_of(HINGE, [DRAG], (0.5, 0.5, 0.0), rate=1.0)


def test_flips_of_a_damped_body():
    """The phase of the free rotation runs slower and slower; an infinite number of flips stops."""
    inertia = (0.5, 0.8, 1.1)
    free = scene_of('free', [{'drag': {'linear': 0.3}}], inertia, angular_velocity=[0.1, 3.0, 0.1])
    simulation = Simulation(free)
    simulation.advance(30_000)
    undragged = Simulation(scene_of('free', [], inertia, angular_velocity=[0.1, 3.0, 0.1]))
    undragged.advance(30_000)
    assert simulation.events == undragged.events
    assert len(simulation.events) > 3


class Stand:
    """A solver that stands in for the general method, and fills in ones."""

    def start(self, vector):
        return self

    def state(self, time, out):
        out[:] = 1.0

    def many(self, starts, times, out):
        out[:] = 1.0


def test_commands_go_on_from_a_closed_form(monkeypatch):
    """An impulse that takes the spin off its axis goes to the general method."""
    scene = scene_of('free', [DRAG, WEIGHT], angular_velocity=[0.0, 0.0, 3.0])
    monkeypatch.setattr(Choice, '_general', lambda self, wrench: Stand())
    simulation = Simulation(scene)
    simulation.advance(100)
    simulation.impulse(torque=(0.0, 0.0, 0.2))
    assert type(simulation._spans[-1].solver) is Exact
    simulation.impulse(torque=(0.1, 0.0, 0.0))
    assert type(simulation._spans[-1].solver) is Stand
    starts = np.array([scene.initial.vector, scene.initial.vector])
    starts[1, 5] = 0.1
    both = ensemble(scene, starts, [0.0, 0.1]).vector
    assert (both[0] == ensemble(scene, times=[0.0, 0.1]).vector[0]).all()
    assert (both[1] == 1.0).all()


@pytest.mark.parametrize('name', ['sphere, angular drag', 'driven through zero',
                                  'sphere, torque in the world', 'hinge, both, through zero'])
def test_ledger(name):
    """Work, heat and angular impulse account for every joule, also after a jump of 30 s."""
    simulation = Simulation(case(name))
    simulation.advance(30_000)
    ledger = simulation.ledger()
    # worst measured: 5e-16
    assert abs(ledger['energy_residual']) <= 5e-15
    assert abs(ledger['momentum_residual']) <= 5e-15
    assert ledger['work'] != 0.0 or ledger['dissipated'] > 0.0


def test_times_that_doubles_cannot_hold_are_refused():
    """Back in time drag makes a motion grow for ever: exp(1e4) is no double."""
    scene = case('sphere, drag at 1e3 /s')
    with pytest.raises(BadInput, match='before the start'):
        ensemble(scene, times=[-10.0])
    assert np.isfinite(ensemble(scene, times=[-0.3, 1e300]).vector).all()
