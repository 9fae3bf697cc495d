# SPDX-License-Identifier: Apache-2.0
"""The harness: errors that it must find, refusals that it must keep, table, figure and command."""

import dataclasses
import json
import sys
import types

import numpy as np
import pytest
from near import near
from soak import IN_SOAK

from rigid_body_sim import integrators
from rigid_body_sim.compilation.jit import HAVE_NUMBA
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.study.precision import (
    figure,
    measure,
    peers,
    reference,
    runner,
    suite,
    table,
    work_precision,
)
from rigid_body_sim.study.precision.peers import plane

OFF = 1e-5


@pytest.fixture(scope='module')
def racket():
    problem = suite.problem('racket')
    return problem, reference.load(problem)


def beginning(problem, count):
    """Return a problem and its Reference, both up to the first times of the latter."""
    truth = reference.load(problem)
    return dataclasses.replace(problem, duration=float(truth.times[count - 1])), (
        reference.Reference(
            truth.times[:count], truth.orientation[:count], truth.omega[:count],
            truth.floor[:count], truth.floor_omega[:count], truth.digits))


def turned(q, angle):
    """Return q turned by an angle about the body's z axis."""
    x, y, z, w = q
    s, c = np.sin(angle / 2), np.cos(angle / 2)
    return np.array([x * c + y * s, y * c - x * s, z * c + w * s, w * c - z * s])


def made_up(problem, truth, name, angle):
    """Return the Runner of a method with a known error.

    Its attitude is off by an angle at the end, by twice that half-way, and right at the first
    time, as that of any method is that has not gone far yet.
    """
    shares = {truth.times[0]: 0.0, problem.duration / 2: 2.0}
    rows = {time: (np.array([float(x) for x in q]), np.array([float(x) for x in omega]))
            for time, q, omega in zip(truth.times.tolist(), truth.orientation, truth.omega)}
    place = [None]

    def to(time):
        place[0] = time

    def state():
        q, omega = rows[place[0]]
        return *turned(q, angle * shares.get(place[0], 1.0)), *omega
    return runner.Runner(name, 'step', (0.1,), lambda _: runner.Run(lambda: None, to, state))


def test_errors_are_rotation_angles_at_the_end_and_along_the_way(racket):
    found = measure.measure(*racket, [made_up(*racket, 'made up', OFF)], 1.0, 5)
    point, = found['lines'][0]['points']
    assert abs(point['error'] / OFF - 1.0) < 1e-9
    assert abs(point['largest_error'] / (2.0 * OFF) - 1.0) < 1e-9
    assert point['omega_error'] < 1e-15
    assert point['energy_residual'] < 1e-15
    assert OFF / 10.0 < point['momentum_residual'] < 2.0 * OFF
    assert point['cpu']['least'] <= point['cpu']['median'] <= point['cpu']['most']


@pytest.mark.without_numba
@pytest.mark.parametrize(('constraint', 'place', 'weight'), [
    ('free', (0.0, 0.0, 0.0), 0.0), ('pivot', (0.1, -0.2, 0.4), 9.81),
    ('{hinge: {axis: [0, 0.6, 0.8], through: [0.1, 0.2, 0]}}', (0.0, -0.4, 0.4), 9.81)])
def test_energy_and_angular_momentum_are_about_the_point_of_reference(constraint, place, weight):
    """T = omega.I omega/2 of the tensor about that point, by the parallel-axis theorem."""
    scene = parse_scene(
        'scene: a\nbody: {mass: 2, inertia: [[1, 0.1, 0], [0.1, 2, -0.2], [0, -0.2, 2.5]], '
        f'center_of_mass: [0.1, -0.2, 0.4]}}\nconstraint: {constraint}\n'
        'effects: [gravity: {g: 9.81}]\ninitial: {}\n')
    arm, balance = np.array(place), measure.Balance(scene)
    tensor = np.array([[1, 0.1, 0], [0.1, 2, -0.2], [0, -0.2, 2.5]]) + 2.0 * (
        arm @ arm * np.eye(3) - np.outer(arm, arm))
    q, omega = np.array([0.5, -0.1, 0.7, 0.5]), np.array([1.0, -2.0, 3.0])
    momentum = rotate(*q, *(tensor @ omega))
    energy = 0.5 * omega @ tensor @ omega + 2.0 * weight * rotate(*q, *arm)[2]
    found, moment = balance.of(q, omega)
    assert found == near(energy, rel=1e-14)
    assert moment == near(momentum, rel=1e-13)
    # relative to the energy, or to its largest potential part; a quaternion of another length
    true = reference.Reference(np.zeros(1), [tuple(q)], [tuple(omega)], *np.zeros((2, 1)), 34.0)
    residuals = balance.residuals(np.concatenate((3.0 * q, 1.01 * omega)), true)
    kinetic = 0.5 * omega @ tensor @ omega
    size = max(abs(energy), 2.0 * weight * np.linalg.norm(arm))
    assert residuals['energy_residual'] == near((1.01**2 - 1.0) * kinetic / size, rel=1e-11)
    assert residuals['momentum_residual'] == near(0.01, rel=1e-11)
    rest = reference.Reference(
        np.zeros(1), [tuple(q)], [(0.0, 0.0, 0.0)], *np.zeros((2, 1)), 34.0)
    assert balance.residuals(np.concatenate((q, np.zeros(3))), rest) == {
        'energy_residual': 0.0, 'momentum_residual': 0.0}


def test_a_lucky_coarse_setting_does_not_end_a_sweep_but_round_off_does(racket):
    problem, truth = racket

    def swept(*errors):
        one = runner.Runner(
            'swept', 'step', errors, lambda error: made_up(problem, truth, '', error).make(None))
        return [point['setting']
                for point in measure.measure(problem, truth, [one], 1.0, 1)['lines'][0]['points']]
    assert swept(1e-2, 1.0, 1.0, 1e-3) == [1e-2, 1.0, 1.0, 1e-3]
    assert swept(1e-3, 1e-12, 1e-10, 1e-10, 1e-10) == [1e-3, 1e-12, 1e-10, 1e-10]


def test_refusals_are_recorded_and_nan_is_one(racket):
    def refuses(_):
        raise runner.RefusedError('a rod has no inverse')

    def gives_up(_):
        raise NotConverged('too far')
    silent = runner.Run(lambda: None, lambda time: None, lambda: [np.nan] * 7)
    partly = runner.Run(lambda: None, lambda time: None, lambda: [0, 0, 0, 1, np.nan, 1, 1])
    found = measure.measure(*racket,
                            [runner.Runner('no', 'none', (None,), refuses),
                             runner.Runner('silent', 'none', (None,), lambda _: silent),
                             runner.Runner('partly', 'none', (None,), lambda _: partly),
                             runner.Runner('weak', 'none', (None,), gives_up)],
                            1.0, 5)
    assert found['lines'] == []
    assert found['refused']['no'] == 'a rod has no inverse'
    assert all('NaN' in found['refused'][name] for name in ('silent', 'partly'))
    assert found['refused']['weak'] == 'too far'


def test_what_fails_in_a_later_run_is_recorded_and_ends_nothing(racket):
    sound = made_up(*racket, 'sound', OFF)
    run, runs = sound.make(None), []

    def start():
        runs.append(None)
        if len(runs) > 5:
            raise NotConverged('a singularity')
    weak = runner.Runner('weak', 'step', (0.25,), lambda _: runner.Run(start, run.to, run.state))
    found = measure.measure(*racket, [weak, sound], 1.0, 5)
    assert [line['name'] for line in found['lines']] == ['sound']
    assert found['refused'] == {'weak': 'at 0.25, in a later run: a singularity'}


@pytest.mark.without_numba
def test_exact_is_at_the_floor_of_the_racket(racket):
    lines = [one for one in runner.ours(*racket) if one.control == 'none']
    found = measure.measure(*racket, lines, 1.0, 5)
    for line in found['lines']:
        assert line['points'][0]['error'] < racket[1].floor[-1]
    result = {'problem': 'racket', 'about': '', 'duration': 100.0, 'floor': 5e-14, **found}
    assert table.cost_at(found['lines'][0], 1e-12) is not None
    assert 'exact' in '\n'.join(table.lines(result))
    assert len(figure.draw([result, result, result]).axes) == 3


def test_methods_come_from_the_table(racket, monkeypatch):
    names = {one.name for one in runner.ours(*racket)}
    assert {'exact', 'dop8', 'rk4'} <= names
    # settings go from coarse to fine; tolerances are from a tenth to what doubles carry
    swept = {one.control: one.settings for one in runner.ours(*racket) if one.control != 'none'}
    assert all(list(one) == sorted(one, reverse=True) for one in swept.values())
    assert swept['accuracy'] == near([float(f'1e-{k}') for k in range(1, 16)], rel=1e-14)
    assert all(one.settings == (None,) for one in runner.ours(*racket) if one.control == 'none')
    # the table of all tests keeps its order
    monkeypatch.setattr(integrators, 'METHODS', integrators.Methods({
        name: method for name, method in integrators.METHODS.items() if name != 'rk4'}))
    assert 'rk4' not in {one.name for one in runner.ours(*racket)}


# measured: at most 8e-12 rad, 4e-11 rad/s
@pytest.mark.skipif(not HAVE_NUMBA, reason='peers are given compiled equations')
@pytest.mark.parametrize('name', ['damped_body', 'driven_pendulum', 'ball_slip_to_roll',
                                  'top_in_air', 'tied_top'])
def test_peers_solve_the_same_equations(name):
    """SciPy, which is always here, tells whether signs are right.

    They are those of weight, damping, heat, hinge, friction, drag by squares and a spring; the
    ball begins to roll.
    """
    problem, truth = beginning(suite.problem(name), 8)
    fine = next(one for one in peers.runners(problem, truth) if one.name == 'SciPy DOP853')
    run = fine.make(1e-13)
    run.start()
    states = []
    for time in truth.times:
        run.to(time)
        states.append(run.state())
    angles, omegas = truth.errors(np.array(states))
    assert angles.max() < 1e-10
    assert omegas.max() < 1e-10


# measured: at most 1.1e-13 rad, 3.2e-12 rad/s
@pytest.mark.parametrize(('name', 'count'), [
    pytest.param('tippe_top', 2, marks=pytest.mark.without_numba),
    *(pytest.param(name, 32, marks=IN_SOAK) for name in suite.ON_A_PLANE)])
def test_our_methods_meet_the_references_on_a_plane(name, count):
    problem, truth = beginning(suite.problem(name), count)
    method, = (dataclasses.replace(one, settings=(1e-12,)) for one in runner.ours(problem, truth)
               if one.name == 'taylor')
    line, = measure.measure(problem, truth, [method], 1.0, 1)['lines']
    point, = line['points']
    assert point['largest_error'] < 1e-12
    assert point['largest_omega_error'] < 3e-11


@pytest.mark.without_numba
@pytest.mark.parametrize('name', suite.ON_A_PLANE)
def test_engines_are_given_a_body_that_touches_the_plane(name):
    scene = suite.problem(name).scene
    numbers = plane.of(scene)
    q, spin = numbers.start[:4], numbers.start[4:]
    arm = np.array(rotate(*q, *np.subtract(
        scene.body.surface.lowest(rotate_back(*q, 0.0, 0.0, 1.0)), scene.body.center_of_mass)))
    assert abs(numbers.place[2] + arm[2]) < 1e-15
    slip = numbers.velocity + np.cross(spin, arm)
    assert abs(slip[2]) < 1e-14
    assert numbers.rolls == (name != 'tippe_top')
    if numbers.rolls:
        assert np.abs(slip).max() < 1e-14
        assert numbers.mu == plane.STICKY
    start = [*scene.initial.orientation, *scene.initial.angular_velocity]
    assert np.abs(np.subtract(numbers.state(numbers.start), start)).max() < 1e-13


@pytest.mark.without_numba
@pytest.mark.parametrize(('surface', 'table', 'more', 'why'), [
    ('torus: {radius: 0.5, tube: 0.1}', 'table', '', 'torus'),
    ('sphere: {radius: 0.5}', '{table: {normal: [0.1, 0, 1]}}', '', 'slope'),
    ('sphere: {radius: 0.5}', '{table: {restitution: 0.5}}', '', 'impacts'),
    ('sphere: {radius: 0.5}', 'table', ', rolling_friction: {viscous: 0.1}', 'more than weight')])
def test_engines_are_not_asked_what_they_do_otherwise(surface, table, more, why):
    scene = parse_scene(
        f'scene: a\nbody: {{mass: 1, inertia: [0.1, 0.1, 0.12], surface: {{{surface}}}}}\n'
        f'constraint: {table}\neffects: [gravity: {{g: 9.81}}, sliding_friction: {{mu: 0.3}}'
        f'{more}]\ninitial: {{angular_velocity: [1, 0, 3]}}\n')
    with pytest.raises(runner.RefusedError, match=why):
        plane.of(scene)


@pytest.mark.without_numba
def test_peers_without_contact_refuse_a_body_with_a_surface():
    pytest.importorskip('numba', reason='peers are given compiled equations')
    from rigid_body_sim.study.precision.peers import given
    with pytest.raises(runner.RefusedError, match='contact'):
        given.of(suite.problem('tippe_top'))


@pytest.mark.parametrize(('name', 'package'), [
    ('heyoka', 'heyoka'), ('MuJoCo', 'mujoco'), ('Drake', 'pydrake'), ('Exudyn', 'exudyn'),
    ('PyBullet', 'pybullet'), ('Pinocchio', 'pinocchio'), ('Basilisk', 'Basilisk')])
def test_a_peer_that_is_not_installed_is_named(name, package, monkeypatch):
    for module in [one for one in sys.modules if one.partition('.')[0] == package]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, package, None)
    assert name in peers.missing()
    assert name not in {module.NAME for module in peers.installed()}


@pytest.mark.without_numba
def test_the_command_answers_in_json_and_refuses_in_one_line(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(runner, 'methods_for', lambda scene: ['exact'])
    monkeypatch.chdir(tmp_path)
    assert work_precision.main(['--scene', 'billiard_follow', '--duration', '1', '--quick',
                                '--json', '--output', 'made']) == 0
    found = json.loads(capsys.readouterr().out)
    result, = found['results']
    assert result['reference_digits'] > 25.0
    assert result['lines'][0]['points'][0]['largest_error'] < 4.0 * result['largest_floor']
    assert (tmp_path / 'made' / 'work_precision.png').stat().st_size > 10000
    assert json.loads((tmp_path / 'made' / 'work_precision.json').read_text()) == found
    for arguments in (['--duration', '-1', '--scene', 'heavy_top'], ['--duration', '3'],
                      ['--scene', 'nowhere'], ['--scene', 'euler_disk'],
                      ['--scene', 'racket', '--duration', '3']):
        assert work_precision.main(arguments) == 2
        assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.mark.without_numba
@pytest.mark.parametrize('time', [0.0, 0.25])
def test_strikes_act_at_the_start_and_on_the_way(time):
    """The run is begun again, and goes on from one time to the next."""
    problem = suite.of_scene('tennis_racket', [
        'effects=[strike: {impulse: [0, 0, 0.5], point: [0.2, 0, 0], '
        f'time: {time}}}]'], 2.0)
    truth = reference.Reference(np.array([2.0]), [(0.0, 0.0, 0.0, 1.0)], [(0.0, 5.0, 0.0)],
                                np.zeros(1), np.zeros(1), 34.0)
    exact, more = (one for one in runner.ours(problem, truth) if one.control == 'none')
    assert (exact.name, more.name) == ('exact', runner.ONE_MORE)
    expected = Simulation(problem.scene).states([0.125, 1.0, 2.0]).vector[:, 1:8]
    run = exact.make(None)
    for _ in range(2):
        run.start()
        for at, state in zip([0.125, 1.0, 2.0], expected, strict=True):
            run.to(at)
            assert np.array(run.state()) == pytest.approx(state, abs=1e-12)
    assert np.abs(expected[1] - Simulation('tennis_racket').states([1.0]).vector[0, 1:8]).max() > (
        1e-3)
    begun = runner.begun(problem.scene)
    struck = Simulation(problem.scene).states([0.0]).vector[0]
    assert np.array_equal(begun, struck)
    assert np.array_equal(begun, problem.scene.initial.vector) == (time > 0.0)


def test_steps_are_shares_of_a_radian_at_the_fastest_rate(racket):
    problem, truth = racket
    omega = np.array([[3.0, 0.0, 4.0], [0.0, 1.0, 0.0]]) * 1e3
    quick = dataclasses.replace(truth, omega=omega)
    counts = [problem.duration / step for step in runner.steps_for(problem, quick)]
    assert counts == near([32 * round(problem.duration * 5e3 * share / 32)
                           for share in runner.STEPS_OF_A_RADIAN], rel=1e-12)
    # one that swings: about as fast as a pendulum of its length does, sqrt(M g r/I) = 2 rad/s
    held = parse_scene('scene: a\nbody: {mass: 1, inertia: [3, 3, 4], center_of_mass: '
                       '[0, 0, -1]}\nconstraint: pivot\neffects: [gravity: {g: 16}]\n'
                       'initial: {angular_velocity: [0, 0, 5]}\n')
    slow = dataclasses.replace(truth, omega=omega / 1e4)
    swinging = dataclasses.replace(problem, scene=held, duration=64.0)
    counts = [64.0 / step for step in runner.steps_for(swinging, slow)]
    assert counts == near([32 * 14 * 2 ** k for k in range(-1, 16)], rel=1e-12)


@pytest.fixture
def clock(monkeypatch):
    """Return the CPU time (s, a list of one number), which only tests put forward."""
    now = [50.0]
    monkeypatch.setattr(
        measure, 'time', types.SimpleNamespace(process_time=lambda: now[0]))
    return now


def costing(clock, *costs):
    """Return a Run whose runs cost so many CPU seconds in turn, the last cost again and again."""
    left, ran = list(costs), []

    def to(time):
        ran.append(time)
        clock[0] += left.pop(0) if len(left) > 1 else left[0]
    return runner.Run(lambda: None, to, lambda: None), ran


@pytest.mark.without_numba
def test_a_sample_is_the_mean_of_as_many_runs_as_take_a_millisecond(clock):
    """Of 0.1 ms each: 1, 2, 4, 8 runs are too few, and 16 are enough."""
    run, ran = costing(clock, *[1e-4] * 47, *[3e-4] * 16, 2e-4)
    point, notes = {}, []
    timed = measure._Timed(run, point, notes, 4.0)
    timed.sample()
    assert len(ran) == 1 + 2 + 4 + 8 + 16 + 16
    for _ in range(2):
        timed.sample()
    assert len(ran) == 47 + 2 * 16 and set(ran) == {4.0}
    timed.tell()
    assert point['cpu'] == near({'median': 2e-4 / 4.0, 'least': 1e-4 / 4.0, 'most': 3e-4 / 4.0},
                                rel=1e-9)
    run, ran = costing(clock, 1.1e-3)    # once is enough
    measure._Timed(run, {'setting': 1}, notes, 4.0).sample()
    assert len(ran) == 2


@pytest.mark.without_numba
@pytest.mark.parametrize(('limit', 'swept'), [(0.26, 3), (0.24, 1)])
def test_a_sweep_ends_after_the_first_setting_beyond_its_limit(limit, swept, clock):
    """Making it and its first run are the set-up; the second run counts."""
    problem = types.SimpleNamespace(duration=4.0)
    truth = types.SimpleNamespace(
        times=np.array([4.0]), floor=np.array([1e-15]),
        errors=lambda states: (np.array([1e-3]), np.array([2e-3])))

    def make(setting):
        run, _ = costing(clock, 0.5, 0.25, 0.0)
        clock[0] += 2.0
        return runner.Run(run.start, run.to, lambda: [0.0] * 7)
    balance = types.SimpleNamespace(residuals=lambda *_: {})
    found = [point for point, _ in measure._sweep(
        problem, truth, runner.Runner('a', 'step', (1, 2, 3), make), limit, balance, [])]
    assert len(found) == swept
    assert [(point['set_up'], point['first_run']) for point in found] == [(2.5, 0.25)] * swept


@pytest.mark.without_numba
def test_what_acts_without_striking_is_run_by_its_solver_alone(monkeypatch):
    monkeypatch.setattr(runner, 'Simulation', None)    # it has ticks, a ledger and events
    problem = suite.problem('heavy_symmetric_top')
    exact = next(iter(runner.ours(problem, reference.load(problem))))
    run = exact.make(None)
    expected = Simulation(problem.scene).states([0.5, 2.0]).vector[:, 1:8]
    run.start()
    for time, state in zip([0.5, 2.0], expected, strict=True):
        run.to(time)
        assert (exact.name, run.state().tolist()) == ('exact', state.tolist())


@pytest.mark.parametrize(('time', 'struck'), [(0.5, True), (0.0, False)])
def test_strikes_on_the_way_are_applied_by_simulations(time, struck, monkeypatch):
    """So it is though something else acts, too; one at the start leaves a motion to follow."""
    scene = parse_scene('scene: s\nbody: {mass: 1, inertia: [1, 2, 2.5]}\nconstraint: free\n'
                        'effects: [drag: {linear: 0, angular: 0.1}, strike: {impulse: [1, 0, 0], '
                        f'point: [0, 1, 0], time: {time}}}]\n'
                        'initial: {angular_velocity: [1, 2, 3]}\n')
    problem = types.SimpleNamespace(scene=scene, duration=1.0)
    monkeypatch.setattr(runner, '_struck_run', lambda *given: given)
    found = runner._our_run(problem, 'dop8', {'accuracy': 1e-6})
    assert (found == (scene, 'dop8', {'accuracy': 1e-6})) == struck
