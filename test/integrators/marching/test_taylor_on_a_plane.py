# SPDX-License-Identifier: Apache-2.0
"""taylor on bodies on a plane: beside the equations, dop8, and references of 34 digits."""

import json
import pathlib

import numpy as np
import pytest
from convex_scenes import (
    BODIES,
    FALLING,
    FILM,
    HILL,
    IDEAL,
    LYING,
    ROUGH,
    SLOPE,
    VISCOUS,
    scene_of,
)
from near import near
from soak import IN_SOAK, some_of

from rigid_body_sim.choice import measured
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators import runnable
from rigid_body_sim.integrators.equations.contact_views import (
    FLIGHT,
    GLIDING,
    ROLLING,
    ROW,
    SLIDING,
    UNKNOWNS,
)
from rigid_body_sim.integrators.marching import contact_series_step
from rigid_body_sim.integrators.marching.contact_phase import MODE, SWIFT
from rigid_body_sim.integrators.marching.contact_series import OnPlaneBySeries
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.numerics.rotations import angles_between
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.scene.state import STATE_SIZE
from rigid_body_sim.simulation.simulation import Simulation

IN_PYTHON = pytest.mark.without_numba
REFERENCES = json.loads((pathlib.Path(__file__).parents[2] / 'data/plane_scenes.json').read_text())
ORDER, FRESH, SIZE = contact_series_step.ORDER, contact_series_step.FRESH, UNKNOWNS.size
ROLLED, FILMED = (UNKNOWNS.part('ledger').part(name).first for name in ('rolled', 'filmed'))
GAP, OMEGA, PLACE, U = (UNKNOWNS.part(name).first for name in ('gap', 'omega', 'place', 'u'))
LEDGER, GRIP = UNKNOWNS.part('ledger').first, ROW.part('watched').part('grip').first
@IN_PYTHON
@pytest.mark.parametrize('mode', [FLIGHT, ROLLING, SLIDING, GLIDING])
@pytest.mark.parametrize('body', BODIES)
def test_the_series_of_a_phase_meet_its_equations(body, mode):
    meets_its_equations(scene_of(body, table=HILL), mode)


@IN_PYTHON
@pytest.mark.parametrize('mode', [ROLLING, SLIDING, GLIDING])
@pytest.mark.parametrize(('body', 'friction'), [
    *((body, VISCOUS) for body in BODIES), ('disk', FILM), ('disk', f'{FILM}, {VISCOUS}')])
def test_the_series_of_a_phase_meet_its_equations_under_friction(body, friction, mode):
    rates = meets_its_equations(scene_of(body, f'{ROUGH}, {friction}', table=HILL), mode)
    assert (rates[ROLLED] > 1e-6) == (VISCOUS in friction)
    assert (rates[FILMED] > 1e-6) == (FILM in friction)


def meets_its_equations(scene, mode):
    """Assert that the series of a phase meet its equations; return the rates at its start.

    The derivative of the sum is the rate there, and the watched series are what is watched. That
    tells a wrong coefficient of any order: terms of the last orders are round-off.
    """
    bound = OnPlaneBySeries(scene, None, None)
    step = bound.kernels_of(mode)
    p, w, y = bound.parameters(0.0), np.zeros(bound.work_shape), np.zeros(SIZE)
    p[MODE], p[SWIFT] = mode, 0.3
    y[:4] = np.array([0.1, -0.5, 0.3, 0.8]) / np.sqrt(0.99)
    y[OMEGA:U] = 3.0, -8.0, 5.0
    if mode in (SLIDING, FLIGHT):
        y[U:PLACE], y[GAP] = (0.2, 0.1, -0.3 * (mode == FLIGHT)), 0.02 * (mode == FLIGHT)
    h = 0.02 if mode == SLIDING else 0.005
    assert step.step_from(p, w, y, np.zeros(SIZE), h) == 0.0
    S, row = w[contact_series_step.SERIES:contact_series_step.LEFT, :SIZE], np.empty(ROW.size)
    bound.rates.rate(p, w[FRESH], row)
    slopes = sum(k * h ** (k - 1) * S[k] for k in range(1, ORDER + 1))
    first = S[1].copy()
    rates = np.empty(ROW.size)
    bound.rates.rate(p, y, rates)
    assert first == pytest.approx(rates[:SIZE], rel=1e-13, abs=1e-13)
    assert np.abs(S[ORDER] * h ** ORDER).max() < 1e-14
    assert slopes == pytest.approx(row[:SIZE], rel=1e-12, abs=1e-12)
    # the sample in the middle of the step
    middle = np.empty(ROW.size)
    samples = w[1:contact_series_step.STAGES].copy()
    step.step_from(p, w, y, np.zeros(SIZE), 0.5 * h)
    bound.rates.rate(p, w[FRESH], middle)
    watched = ROW.part('watched')
    normal, grip, motion = (watched.part(one).first for one in ('normal', 'grip', 'motion'))
    half = samples[contact_series_step.STAGES // 2 - 1]
    assert half[normal] == near(middle[normal], rel=1e-11)
    if mode == ROLLING:
        assert half[grip] == near(middle[grip], rel=1e-9)
    if mode != FLIGHT:
        assert half[motion] == near(middle[motion], rel=1e-12)
    return rates


@IN_PYTHON
@pytest.mark.parametrize(('body', 'effects', 'initial', 'table', 'last', 'events'), [
    ('egg', ROUGH, FALLING, 'table', 0.16, 2), ('ball', ROUGH, FALLING, HILL, 0.2, 1),
    pytest.param('egg', ROUGH, FALLING, 'table', 0.2, 3, marks=IN_SOAK),
    ('ring', 'sliding_friction: {mu: 0.0}', FALLING, HILL, 0.2, 3),
    pytest.param('disk', IDEAL, LYING, HILL, 0.12, 55, marks=IN_SOAK),
    ('disk', ROUGH, FALLING, 'table', 0.2, 1),
    ('disk', f'{ROUGH}, {FILM}, {VISCOUS}', LYING, SLOPE, 0.2, 1),
    ('disk', f'{IDEAL}, {FILM}', LYING, SLOPE, 0.2, 1),
    ('egg', f'{ROUGH}, {VISCOUS}', FALLING, 'table', 0.16, 2),
    ('ring', f'{IDEAL}, {VISCOUS}', LYING, SLOPE, 0.2, 1),
    ('ball', f'sliding_friction: {{mu: 0.0}}, {VISCOUS}', LYING, SLOPE, 0.2, 1),
    ('ball', f'{ROUGH}, {VISCOUS}', LYING, SLOPE, 0.2, 2),
    ('ball', ROUGH, LYING, 'table', 0.2, 1)])
def test_phases_events_and_ledger_are_those_of_dop8_to_round_off(body, effects, initial, table,
                                                                 last, events):
    """Impacts, sticking, slips that begin: measured up to 2e-14, events to 1e-15 s.

    The slip of the egg that begins at 0.166 s takes thousands of steps by either method.
    """
    scene, times, found = scene_of(body, effects, initial, table), [0.03, 0.11, last], []
    for method in ('dop8', 'taylor'):
        solver = Stepped(scene, method, 1e-13, horizon=1.0).start(scene.initial.vector)
        states = np.empty((3, STATE_SIZE))
        solver.states(times, states)
        found.append((states, solver.events(0.0, last), solver.entries(last)))
    (states, happened, entries), (ours, seen, booked) = found
    assert len(seen) == events
    assert [name for _, name, _ in seen] == [name for _, name, _ in happened]
    assert [time for time, *_ in seen] == pytest.approx([time for time, *_ in happened],
                                                        rel=0.0, abs=1e-14)
    assert ours == pytest.approx(states, rel=1e-13, abs=1e-13)
    assert booked == pytest.approx(entries, rel=1e-13, abs=1e-14)


@IN_PYTHON
def test_an_ellipsoid_that_turns_in_flight_dips_into_the_plane_by_a_nanometre():
    """Just before its lowest point it touches the plane; what rises again is no impact."""
    scene = scene_of('{mass: 1.0, inertia: [0.02, 0.04, 0.03], '
                     'surface: {ellipsoid: {semi_axes: [0.1, 0.2, 0.5]}}}', ROUGH,
                     '{position: [0, 0, 0.6657953507354194], velocity: [0, 0, 2.0], '
                     'angular_velocity: [0, 20, 0]}')
    times = []
    for method in ('dop8', 'taylor'):
        solver = Stepped(scene, method, 1e-15).start(scene.initial.vector)
        times.append(solver.events(0.0, 0.49)[0][0])
    assert times == pytest.approx([0.4858790044800325] * 2, rel=0.0, abs=2e-12)


def error(scene, accuracy, count):
    """Return (error of the attitude at the first times of a reference (rad), solver)."""
    case = REFERENCES[scene]
    scene = load_scene(scene)
    solver = Stepped(scene, 'taylor', accuracy, horizon=case['times'][-1]).start(
        scene.initial.vector)
    states, angles = np.empty((count, STATE_SIZE)), np.empty(count)
    solver.states(np.array(case['times'][:count]), states)
    angles_between(states[:, 1:5], np.array(case['orientations'][:count], dtype=float), angles)
    return float(angles.max()), solver


@IN_PYTHON
@pytest.mark.parametrize(('name', 'accuracy'), some_of(
    ['rolling_disk', 'routh_sphere', 'chaplygin_sphere', 'euler_disk'],
    [1e-11, 1e-6, 1e-9, 1e-3]))
def test_a_rolling_body_keeps_the_accuracy_that_is_asked(name, accuracy):
    assert error(name, accuracy, 4)[0] < accuracy


@IN_SOAK
@pytest.mark.parametrize('accuracy', [1e-3, 1e-6, 1e-9, 1e-11])
@pytest.mark.parametrize('name', ['rattleback', 'tippe_top', 'rising_egg'])
def test_a_body_that_sticks_keeps_the_accuracy_that_is_asked(name, accuracy):
    case = REFERENCES[name]
    found, solver = error(name, accuracy, len(case['times']))
    assert found < accuracy
    events = solver.events(0.0, case['times'][-1])
    assert [name for _, name, _ in events] == [name for name, _ in case['events']]
    for (time, *_), (_, true) in zip(events, case['events'], strict=True):
        assert time == pytest.approx(float(true), abs=max(accuracy, 1e-12))


@IN_PYTHON
def test_the_ledger_balances_and_ticks_any_way_have_the_same_bits():
    scene = scene_of('egg', ROUGH, FALLING)
    sims = [Simulation(scene, 'taylor', 1e-11, horizon=1.0) for _ in range(3)]
    for _ in range(150):
        sims[0].advance()
    sims[1].advance_through(47)
    sims[1].advance_through(103)
    sims[2].states([0.1, 0.02, 0.15])
    assert sims[0].vector.tobytes() == sims[1].vector.tobytes()
    assert sims[0].vector.tobytes() == sims[2].states([0.15]).vector[0].tobytes()
    ledger = sims[0].ledger()
    assert abs(ledger['energy_residual']) < 1e-13
    assert ledger['momentum_residual'] < 1e-13
    assert ledger['dissipated_sliding'] > 0.0


@IN_PYTHON
@pytest.mark.parametrize(('friction', 'lines'), [
    (VISCOUS, ['rolling']), (FILM, ['air_film']), (f'{FILM}, {VISCOUS}', ['air_film', 'rolling'])])
def test_the_ledger_balances_under_friction(friction, lines):
    sim = Simulation(scene_of('disk', f'{ROUGH}, {friction}', table=SLOPE), 'taylor', 1e-11,
                     horizon=1.0)
    sim.advance(200)
    ledger = sim.ledger()
    assert abs(ledger['energy_residual']) < 1e-13
    assert ledger['momentum_residual'] < 1e-13
    for line in ('rolling', 'air_film'):
        assert (ledger[f'dissipated_{line}'] > 0.0) == (line in lines)


@IN_SOAK
def test_the_ledger_of_a_tossed_coin_balances_through_its_impacts():
    sim = Simulation('tossed_coin', 'taylor', 1e-12, horizon=1.0)
    sim.advance(720)
    ledger = sim.ledger()
    assert abs(ledger['energy_residual']) < 1e-13
    assert ledger['momentum_residual'] < 1e-13
    assert ledger['dissipated_impacts'] > 0.0


@IN_SOAK
@pytest.mark.parametrize('accuracy', [1e-3, 1e-6, 1e-9])
def test_a_tossed_coin_keeps_the_accuracy_that_is_asked(accuracy):
    """Measured by 1.6 s: 6e-4, 1e-7, 8e-10 rad."""
    scene, times, found = load_scene('tossed_coin'), [0.7, 0.8, 1.0, 1.3, 1.6], []
    for method, asked in (('dop8', 1e-14), ('taylor', accuracy)):
        solver = Stepped(scene, method, asked, horizon=10.0).start(scene.initial.vector)
        states = np.empty((len(times), STATE_SIZE))
        solver.states(times, states)
        found.append((states, [name for _, name, _ in solver.events(0.0, times[-1])]))
    (true, happened), (states, seen) = found
    angles = np.empty(len(times))
    angles_between(states[:, 1:5], true[:, 1:5], angles)
    assert angles.max() < accuracy
    assert seen == happened


@IN_PYTHON
def test_under_a_wrench_dop8_goes_on_and_a_strike_is_in_the_ledger():
    scene = scene_of('ball', IDEAL, '{angular_velocity: [3, -5, 7], rolling: true}')
    sim = Simulation(scene, 'taylor', 1e-11, horizon=1.0)
    sim.advance(10)
    sim.hold((0.01, 0.0, 0.0), (1e-4, 0.0, 0.0))
    sim.advance(10)
    sim.release()
    sim.impulse((0.0, 0.001, 0.0))
    sim.advance(20)
    ledger = sim.ledger()
    assert abs(ledger['energy_residual']) < 1e-12
    assert ledger['momentum_residual'] < 1e-12


@IN_PYTHON
@pytest.mark.parametrize(('effects', 'body'), [
    ('rolling_friction: {dry: 0.001}, sliding_friction: {mu: 0.3}', 'ball'),
    ('spinning_friction: {radius: 0.001}, sliding_friction: {mu: 0.3}', 'egg'),
    ("torque: {value: ['sin(t)', 0, 0]}", 'egg'), ('drag: {linear: 0.1}', 'ball')])
def test_what_has_no_series_is_refused_in_one_line(effects, body):
    scene = scene_of(body, effects, '{angular_velocity: [1, 2, 3]}')
    assert runnable(scene) == ['dop8']
    with pytest.raises(BadInput, match=r'taylor.*cannot run') as refused:
        Simulation(scene, 'taylor', 1e-9)
    assert '\n' not in str(refused.value)


@IN_PYTHON
def test_where_the_paradox_may_be_met_and_fixed_steps_are_refused():
    scene = scene_of('disk', 'sliding_friction: {mu: 1.3}')
    with pytest.raises(BadInput, match=r'paradox.*mu below 1\.118, or dop8'):
        Simulation(scene, 'taylor', 1e-9)
    with pytest.raises(BadInput, match='step'):
        Simulation(scene_of('ball'), 'taylor', step=0.001)


@IN_PYTHON
def test_auto_leaves_taylor_to_those_who_name_it():
    scene = scene_of('ball')
    assert runnable(scene) == ['dop8', 'taylor', 'gauss16']
    assert not measured.on_such(scene, 'taylor')
    assert measured.on_such(scene, 'dop8')


@IN_PYTHON
@pytest.mark.parametrize(('body', 'effects', 'initial', 'table'), [
    ('disk', 'sliding_friction: {mu: 0.6}', '{euler_zyz: [0, 0.05, 0]}', 'table'),
    ('{mass: 1.0, shape: {torus: {radius: 0.05, tube: 0.01}}}', IDEAL, '{}',
     SLOPE),
    ('disk', f'{IDEAL}, {VISCOUS}', '{euler_zyz: [0, 0.05, 0]}', 'table'),
    ('disk', f'{IDEAL}, air_film: {{viscosity: 1.0e-4}}',
     '{euler_zyz: [0, 0.05, 0], angular_velocity: [0, 2, 0], rolling: true}', 'table')])
def test_a_ring_that_falls_flat_rests(body, effects, initial, table):
    """A step of its series went through the plane, with energy from nowhere."""
    scene, found = scene_of(body, effects, initial, table), []
    for method in ('dop8', 'taylor'):
        sim = Simulation(scene, method, 1e-9, horizon=1.0)
        found.append(sim.at_event('rest', within=1.0).time)
        sim.advance(200)
        assert abs(sim.ledger()['energy_residual']) < 1e-10
    assert found[1] == pytest.approx(found[0], abs=1e-11)


@IN_PYTHON
def test_a_ring_that_lies_flat_is_struck():
    """Its edge lifts: the series of a ring that is almost flat has a pole close by."""
    body = '{mass: 1.0, shape: {torus: {radius: 0.3, tube: 0.06}}}'
    scene, found = scene_of(body, initial='{}'), []
    for method in ('dop8', 'taylor'):
        sim = Simulation(scene, method, 1e-9, horizon=1.0)
        sim.advance(22)
        sim.impulse(torque=[0.001, 0.002, 0.0])
        sim.advance(5)
        found.append(sim.vector)
    assert found[1] == pytest.approx(found[0], abs=1e-9)
