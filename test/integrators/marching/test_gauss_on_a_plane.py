# SPDX-License-Identifier: Apache-2.0
"""gauss16 on bodies on a plane: beside the equations, dop8, and references of 34 digits."""

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
from soak import IN_SOAK, some_of

from rigid_body_sim.choice import measured
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators.equations.contact_views import (
    FLIGHT,
    GLIDING,
    ROLLING,
    ROW,
    SLIDING,
    UNKNOWNS,
)
from rigid_body_sim.integrators.marching import contact_gauss_step
from rigid_body_sim.integrators.marching.contact_gauss import OnPlaneByGauss
from rigid_body_sim.integrators.marching.contact_phase import MODE, SWIFT
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.numerics.rotations import angles_between
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.scene.state import STATE_SIZE
from rigid_body_sim.simulation.simulation import Simulation

IN_PYTHON = pytest.mark.without_numba
REFERENCES = json.loads((pathlib.Path(__file__).parents[2] / 'data/plane_scenes.json').read_text())
SIZE, NODES = UNKNOWNS.size, contact_gauss_step.NODES
OMEGA, U = (UNKNOWNS.part(name).first for name in ('omega', 'u'))
WATCHED, JUMP = ROW.part('watched'), ROW.part('watched').part('jump').first


@IN_PYTHON
@pytest.mark.parametrize('mode', [ROLLING, SLIDING, GLIDING])
@pytest.mark.parametrize(('body', 'friction'), [
    *((body, '') for body in BODIES), *((body, VISCOUS) for body in BODIES), ('disk', FILM),
    ('disk', f'{FILM}, {VISCOUS}')])
def test_the_rates_at_the_stages_are_those_of_the_equations(body, friction, mode):
    """Measured: up to 8e-15 of the largest rate."""
    bound = OnPlaneByGauss(scene_of(body, f'{ROUGH}, {friction}', table=HILL), None, None)
    step, p = bound.kernels_of(mode), bound.parameters(0.0)
    w, y = np.zeros(bound.work_shape), np.zeros(SIZE)
    p[MODE], p[SWIFT] = mode, 0.3
    y[:4] = np.array([0.1, -0.5, 0.3, 0.8]) / np.sqrt(0.99)
    y[OMEGA:U] = 3.0, -8.0, 5.0
    y[U:U + 2] = (0.2, 0.1) if mode == SLIDING else (0.0, 0.0)
    bound.rates.rate(p, y, w[0])
    assert step.step_from(p, w, y, np.zeros(SIZE), 0.005) == 0.0
    S, row = w[contact_gauss_step.LANES], np.empty(ROW.size)
    for i in range(NODES):
        now = y.copy()
        now[:U + 2] = S[i:contact_gauss_step.RATES:NODES]
        bound.rates.rate(p, now, row)
        rates = S[contact_gauss_step.RATES + i:contact_gauss_step.SWEEPS:NODES]
        row[JUMP] = w[i + 1, JUMP]
        assert rates[:SIZE] == pytest.approx(row[:SIZE], rel=1e-12, abs=1e-13)
        assert w[i + 1, WATCHED.places] == pytest.approx(row[WATCHED.places], rel=1e-12, abs=1e-13)


@IN_PYTHON
@pytest.mark.parametrize('mode', [ROLLING, SLIDING])
def test_a_step_is_of_order_16_and_its_error_is_told(mode):
    """Halving the step leaves at most 2^-15 of the error; the estimate is not below it."""
    bound = OnPlaneByGauss(scene_of('egg', table=HILL), None, None)
    step, p = bound.kernels_of(mode), bound.parameters(0.0)
    w, y, lost = np.zeros(bound.work_shape), np.zeros(SIZE), np.zeros(SIZE)
    p[MODE], p[SWIFT] = mode, 0.3
    y[:4] = np.array([0.1, -0.5, 0.3, 0.8]) / np.sqrt(0.99)
    y[OMEGA:U] = 3.0, -8.0, 25.0
    y[U:U + 2] = (0.2, 0.1) if mode == SLIDING else (0.0, 0.0)

    def after(h, parts):
        now, kept = y.copy(), lost.copy()
        for _ in range(parts):
            bound.rates.rate(p, now, w[0])
            assert step.step_from(p, w, now, kept, h / parts) == 0.0
            now[:], kept[:] = w[step.FRESH, :SIZE], w[step.TRIED, :SIZE]
        return now
    h = 0.25 if mode == SLIDING else 0.06
    true, whole = after(h, 16), after(h, 1)
    told = step.error_of(w, h, (25.0, 0.3, 0.02))
    halves = after(h, 2)
    errors = [np.abs(one[:4] - true[:4]).max() for one in (whole, halves)]
    assert errors[0] > 1e-12 and errors[1] < 2.0 ** -15 * errors[0] + 1e-15
    assert errors[0] < told < 1e6 * errors[0]


@IN_PYTHON
@pytest.mark.parametrize(('body', 'effects', 'initial', 'table', 'last', 'events'), [
    ('egg', ROUGH, FALLING, 'table', 0.16, 2), ('ball', ROUGH, FALLING, HILL, 0.2, 1),
    ('ring', 'sliding_friction: {mu: 0.0}', FALLING, HILL, 0.2, 3),
    pytest.param('disk', IDEAL, LYING, HILL, 0.12, 55, marks=IN_SOAK),
    ('disk', f'{ROUGH}, {FILM}, {VISCOUS}', LYING, SLOPE, 0.2, 1),
    ('ring', f'{IDEAL}, {VISCOUS}', LYING, SLOPE, 0.2, 1),
    ('ball', f'sliding_friction: {{mu: 0.0}}, {VISCOUS}', LYING, SLOPE, 0.2, 1),
    ('ball', f'{ROUGH}, {VISCOUS}', LYING, SLOPE, 0.2, 2)])
def test_phases_events_and_ledger_are_those_of_dop8_to_round_off(body, effects, initial, table,
                                                                 last, events):
    """Impacts, sticking, slips that begin."""
    scene, times, found = scene_of(body, effects, initial, table), [0.03, 0.11, last], []
    for method in ('dop8', 'gauss16'):
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


def error(scene, accuracy, count):
    """Return (error of the attitude at the first times of a reference (rad), solver)."""
    case = REFERENCES[scene]
    scene = load_scene(scene)
    solver = Stepped(scene, 'gauss16', accuracy, horizon=case['times'][-1]).start(
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
@pytest.mark.parametrize('friction', [
    pytest.param('', marks=IN_SOAK), VISCOUS, pytest.param(f'{FILM}, {VISCOUS}', marks=IN_SOAK)])
def test_the_ledger_balances_and_ticks_any_way_have_the_same_bits(friction):
    scene = scene_of('disk', f'{ROUGH}, {friction}', table=SLOPE)
    sims = [Simulation(scene, 'gauss16', 1e-11, horizon=1.0) for _ in range(3)]
    for _ in range(60):
        sims[0].advance()
    sims[1].advance_through(19)
    sims[1].advance_through(41)
    sims[2].states([0.04, 0.01, 0.06])
    assert sims[0].vector.tobytes() == sims[1].vector.tobytes()
    assert sims[0].vector.tobytes() == sims[2].states([0.06]).vector[0].tobytes()
    ledger = sims[0].ledger()
    assert abs(ledger['energy_residual']) < 1e-13
    assert ledger['momentum_residual'] < 1e-13
    assert ledger['dissipated_sliding'] > 0.0
    assert (ledger['dissipated_rolling'] > 0.0) == (VISCOUS in friction)
    assert (ledger['dissipated_air_film'] > 0.0) == (FILM in friction)


@IN_PYTHON
def test_under_a_wrench_the_steps_are_those_of_dop8_and_a_strike_is_in_the_ledger():
    scene = scene_of('ball', IDEAL, '{angular_velocity: [3, -5, 7], rolling: true}')
    sim = Simulation(scene, 'gauss16', 1e-11, horizon=1.0)
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
def test_phases_that_are_short_or_may_meet_the_paradox_are_those_of_dop8():
    bound = OnPlaneByGauss(scene_of('disk', 'sliding_friction: {mu: 1.3}'), None, None)
    assert [bound.kernels_of(mode) is bound.kernels for mode in (FLIGHT, SLIDING, ROLLING)] == [
        True, True, False]
    bound = OnPlaneByGauss(scene_of('disk'), None, None)
    assert bound.kernels_of(SLIDING) is not bound.kernels
    assert bound.kernels_of(ROLLING, low=True) is bound.kernels


@IN_PYTHON
def test_fixed_steps_are_refused_and_auto_leaves_it_to_those_who_name_it():
    scene = scene_of('ball')
    with pytest.raises(BadInput, match='step'):
        Simulation(scene, 'gauss16', step=0.001)
    with pytest.raises(BadInput, match=r'gauss16.*cannot run'):
        Simulation(scene_of('ball', f'drag: {{linear: 0.1}}, {ROUGH}'), 'gauss16', 1e-9)
    assert not measured.on_such(scene, 'gauss16')
