# SPDX-License-Identifier: Apache-2.0
"""Effects in the scene's own words: closed forms, ledgers at round-off, refusals in one line."""

import json
import math
import pathlib
import re

import mpmath
import numpy as np
import pytest
from near import near
from scene import language_cases
from soak import IN_SOAK

from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators import runnable
from rigid_body_sim.mechanics.balance import Dynamics
from rigid_body_sim.numerics.rotations import (
    angle_between,
    from_euler_zyz,
    multiply,
    rotate,
    rotate_back,
)
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.ensemble import ensemble
from rigid_body_sim.simulation.simulation import Simulation

HERE = pathlib.Path(language_cases.__file__)


@pytest.fixture(scope='module')
def found(plain):
    """Return what the cases give without numba."""
    return plain('scene/language_cases.py')


def damped(t, M, k, c, v):
    rate, decay = math.sqrt(k / M - (c / M / 2) ** 2), c / M / 2
    return v / rate * math.exp(-decay * t) * math.sin(rate * t)


def approach(t, M, k, c, x):
    rate, decay = math.sqrt(k / M - (c / M / 2) ** 2), c / M / 2
    return x * math.exp(-decay * t) * (math.cos(rate * t) + decay / rate * math.sin(rate * t))


CLOSED = {
    # case: (place in the state, value by hand)
    'torque of time': (7, 3.0 + 0.1 * (1 - math.cos(24.0)) / (12.0 * 0.5)),
    'torque of the world': (7, 3.0 + 0.1 * -math.expm1(-2.0) / 0.5),
    'drag of a disk by the square': (7, 3.0 / (1 + 0.7 * 3.0 * 2.0 / 0.5)),
    'fall with drag by the square': (13, -math.sqrt(2 * 9.81 / 0.7)
                                     * math.tanh(3.0 * math.sqrt(9.81 * 0.7 / 2))),
    'on a spring': (8, 0.1 * math.sin(10.0)),
    'on a damped spring': (8, damped(2.0, 2.0, 50.0, 3.0, 0.5)),
    'spring of a length': (10, 0.4 + approach(2.0, 2.0, 50.0, 3.0, 0.1)),
    'in a well': (8, 0.1 * math.sin(10.0)),
    'force at a point': (7, 3.0 + 0.5 * 0.3 / 0.5 * 2.0),
    'fall by the key quadratic': (13, -math.sqrt(2 * 9.81 / 0.7)
                                  * math.tanh(3.0 * math.sqrt(9.81 * 0.7 / 2))),
    'disk by the key angular_quadratic': (7, 3.0 / (1 + 0.7 * 3.0 * 2.0 / 0.5)),
    'drag by a matrix': (7, 3.0 * math.exp(-0.3 / 0.5 * 2.0)),
    'thrown aslant': (8, 4.0 * 2.0 + 1.0 * 2.0 ** 2 / 2),
    'torsion spring': (3, math.sin(0.25 * math.pi + 0.5 * (
        0.4 + approach(0.2, 0.5, 50.0, 3.0, 0.1)))),
    'torque of time on a hinge': (7, 3.0 + 0.1 * (1 - math.cos(24.0)) / (12.0 * 0.5)),
    # omega1 + i omega2 turns with ((C - A) omega3 + h)/A
    'gyrostat': (5, 0.3 * math.cos(2 * (0.2 * 1.5 + 0.4) / 0.3)
                 - 0.1 * math.sin(2 * (0.2 * 1.5 + 0.4) / 0.3)),
    'synchronous needle': (3, math.sin(0.65)),
    'reaction wheel': (7, 1.5 - 0.1 * 2.0 / 0.5),
}


@pytest.mark.parametrize('case', CLOSED)
def test_it_meets_the_closed_form(found, case):
    place, exact = CLOSED[case]
    # measured: 3.3e-14 at most of the value
    assert found[case]['state'][place] == near(exact, rel=2e-13)


@pytest.mark.parametrize(('case', 'rate'), [
    # small swings: sqrt(m B/I) and sqrt(3 mu/r^3 (I2 - I1)/I3), 1e-4 rad: to 1e-9 of the angle
    ('compass needle', math.sqrt(2 * 0.5 / 0.5)),
    ('satellite', math.sqrt(3 * 90 / 27 * 0.1 / 0.4))])
def test_small_swings_have_the_frequency_of_the_formula(found, case, rate):
    *_, z, w = found[case]['state'][1:5]
    rest = math.pi / 2 if case == 'satellite' else 0.0
    angle = 2 * math.atan2(z, w) - rest
    assert angle == pytest.approx(1e-4 * math.cos(2 * rate), abs=1e-12)


@pytest.mark.parametrize('case', [
    pytest.param(case, marks=IN_SOAK if case in language_cases.LIKE_OTHERS else ())
    for case in language_cases.CASES])
def test_the_ledger_balances(found, case):
    """Measured: 1.3e-15 of energy and 8e-16 of momentum at most, but for small swings.

    Their momentum is 1e-5 of the terms of the torque, which cancel but for their rounding: there
    1.3e-9.
    """
    # of the state of the first of them dop8 is 8e-15 from 34 digits, gauss16 1e-15; of eight that
    # differ a little dop8's residuals are 4e-15 to 1e-14, gauss16's 5e-16 to 8e-16 (rms)
    run = f'{case} by gauss16' if case in language_cases.DRIVEN else case
    ledger = found[run]['ledger']
    assert abs(ledger['energy_residual']) < 5e-15
    assert ledger['momentum_residual'] < (1e-8 if case in ('compass needle', 'satellite')
                                          else 5e-15)


@pytest.mark.parametrize('case', ['mixed, free', 'mixed, on a moving pivot'])
def test_four_effects_at_once_meet_34_digits(found, case):
    exact = [mpmath.mpf(text) for text in json.loads(
        (HERE.parents[1] / 'data' / 'language.json').read_text())[case]]
    others = ('gauss16', 'taylor') if case in language_cases.BY_SERIES else ('gauss16',)
    for name in (case, *(f'{case} by {method}' for method in others)):
        error = max(abs(mpmath.mpf(one) - other)
                    for one, other in zip(found[name]['state'][1:8], exact, strict=True))
        assert error < 1e-13, name    # measured: 8e-15


def test_a_controlled_attitude_decays_at_the_rates_of_the_formula(found):
    """I a'' = -p a - d a' about each axis: it swings at sqrt(p/I - (d/2I)^2), decays at d/2I."""
    x, y, z, _ = found['attitude under control']['state'][1:5]
    for angle, start, moment in zip((2 * x, 2 * y, 2 * z), (1e-6, -2e-6, 1.5e-6), (0.2, 0.3, 0.4),
                                    strict=True):
        # the axes are coupled by products of two deviations
        assert angle == pytest.approx(approach(0.7, moment, 5.0, 0.4, start), abs=1e-11)


LIBRATING = {'pitch': '[0, 0, 1.0e-5]', 'roll': '[0, 1.0e-5, 0]', 'yaw': '[1.0e-5, 0, 0]'}


@pytest.mark.without_numba
@pytest.mark.parametrize('start', LIBRATING)
def test_a_satellite_librates_as_the_stability_triangle_says(start):
    """Axes 1 outwards (yaw), 2 along the track (roll), 3 along the normal (pitch).

    Pitch: n sqrt(3 (I2 - I1)/I3). Roll and yaw: s^4 + (1 + 3 k1 + k1 k3) n^2 s^2 + 4 k1 k3 n^4 = 0
    with k1 = (I3 - I1)/I2, k3 = (I3 - I2)/I1 (Hughes, Spacecraft Attitude Dynamics, section 9.1).
    The angle x at equal times of such a motion is annihilated by the polynomial of its
    frequencies.
    """
    I1, I2, I3 = 0.2, 0.3, 0.4
    scene = parse_scene(
        f'scene: a\nbody: {language_cases.SATELLITE}\nconstraint: free\neffects: '
        '[gravity_gradient: {orbit: {rate: 1.0, normal: [0, 0, 1], toward: [1, 0, 0]}}]\n'
        f'initial: {{rotation_vector: {LIBRATING[start]}, angular_velocity: [0, 0, 1]}}\n')
    step = 0.7
    times = step * np.arange(9)
    states = Simulation(scene, 'dop8', accuracy=1e-13, rate=1.0, horizon=6.0).states(times)
    # the attitude as the orbit's axes see it
    angles = np.array([2 * np.array(multiply(0, 0, -math.sin(t / 2), math.cos(t / 2), *q)[:3])
                       for t, q in zip(times, states.orientation, strict=True)])
    if start == 'pitch':
        exact = 1e-5 * np.cos(math.sqrt(3 * (I2 - I1) / I3) * times)
        assert np.abs(angles[:, 2] - exact).max() < 1e-13
        return
    k1, k3 = (I3 - I1) / I2, (I3 - I2) / I1
    half, rest = (1 + 3 * k1 + k1 * k3) / 2, 4 * k1 * k3
    first, second = (2 * math.cos(step * math.sqrt(half + sign * math.sqrt(half ** 2 - rest)))
                     for sign in (1, -1))
    # (z + 1/z - first)(z + 1/z - second)
    weights = np.array([1, -(first + second), 2 + first * second, -(first + second), 1])
    for x in angles[:, 0], angles[:, 1]:
        assert np.abs(x).max() > 1e-6
        assert np.abs(np.convolve(x, weights, 'valid')).max() < 1e-12


def test_on_a_circular_orbit_the_energy_of_the_rotating_frame_stays(found):
    """H = T - n L_3 + (3 n^2/2) u . I u, u the direction from the attracting point."""
    def energy(state):
        t, *q = state[:5]
        I, omega = np.array([0.2, 0.3, 0.4]), np.array(state[5:8])
        u = np.array(rotate_back(*q, math.cos(t), math.sin(t), 0.0))
        return (omega @ (I * omega) / 2 - rotate(*q, *(I * omega))[2] + 1.5 * u @ (I * u))

    scene = parse_scene(language_cases.text('on a circular orbit'))
    start, end = scene.initial.vector.tolist(), found['on a circular orbit']['state']
    assert np.abs(np.subtract(start[1:5], end[1:5])).max() > 0.1
    assert energy(end) == pytest.approx(energy(start), abs=1e-15)


@pytest.mark.without_numba
def test_a_spinning_magnet_precesses_about_the_field():
    """Steady precession Omega at the tilt beta: I1 Omega^2 cos(beta) - I3 w3 Omega - m B = 0."""
    moment, axial, energy, beta, Omega = 0.3, 0.5, 0.6, 0.7, -0.9
    w3 = (moment * Omega ** 2 * math.cos(beta) - energy) / (axial * Omega)
    # the body turns about its axis with w3 - Omega cos(beta), and that about z with Omega
    scene = parse_scene(
        'scene: a\nbody: {mass: 1, inertia: [0.3, 0.3, 0.5]}\nconstraint: pivot\n'
        'effects: [magnetic: {moment: [0, 0, 1.2], field: [0, 0, 0.5]}]\n'
        f'initial: {{tilt: {beta}, angular_velocity: [{-Omega * math.sin(beta)}, 0, {w3}]}}\n')
    end = Simulation(scene, 'dop8', accuracy=1e-13, rate=1.0, horizon=5.0).states([5.0])
    exact = from_euler_zyz(5 * Omega, beta, 5 * (w3 - Omega * math.cos(beta)))
    assert angle_between(*end.orientation[0], *exact) < 1e-13


@pytest.mark.parametrize(('case', 'method'), [
    *((case, 'gauss16') for case in language_cases.BY_TWO),
    *((case, 'taylor') for case in language_cases.BY_SERIES)])
def test_two_methods_agree(found, case, method):
    one, other = (np.array(found[name]['state']) for name in (case, f'{case} by {method}'))
    assert np.abs(one - other).max() < 2e-13


def test_gravity_in_another_direction_is_the_world_turned(found):
    turned, upright = (np.array(found[case]['state'][5:8])
                       for case in ('top in a world that is turned', 'the same upright'))
    assert np.abs(turned - upright).max() < 2e-13


def test_a_pivot_off_the_origin_is_one_at_the_origin_of_other_axes(found):
    one, other = (np.array(found[case]['state'])
                  for case in ('held off its origin', 'the same with its origin there'))
    assert np.abs(one[1:8] - other[1:8]).max() < 2e-13
    point = one[8:11] + rotate(*one[1:5], -0.1, -0.2, 0.1)
    assert np.abs(point).max() < 1e-15


SHAKEN = {
    'force': ('{hinge: {axis: [0, 1, 0]}}',
              ", {force: {value: [0, 0, 'A*w^2*cos(w*t)'], frame: world}}", '{angle: 0.1}'),
    'pivot': ("{pivot: {motion: [0, 0, 'A*cos(w*t)']}}", '', '{tilt: 0.1}')}


@pytest.mark.without_numba
@pytest.mark.parametrize('by', SHAKEN)
@pytest.mark.parametrize(('amplitude', 'stands'), [(0.05, True), (0.02, False)])
def test_kapitzas_pendulum_stands_where_the_averaged_formula_says(amplitude, stands, by):
    """The pivot shakes with A cos(w t), or in its axes the force m A w^2 cos(w t) acts.

    Averaged over the shaking, upright is stable if (A w)^2 > 2 g l; then it swings slowly with
    (A w)^2/(2 l^2) - g/l, else it falls so (Landau, Lifshitz, Mechanics, section 30). 2 g l is
    19.6 here, beside 100 and 16.
    """
    constraint, effect, initial = SHAKEN[by]
    scene = parse_scene(
        f"""scene: kapitza
parameters: {{A: {amplitude}, w: 200.0}}
body: {{mass: 1.0, inertia: [1.0e-9, 1.0e-9, 1.0e-9], center_of_mass: [0, 0, 1]}}
constraint: {constraint}
effects: [{{gravity: {{g: 9.8}}}}{effect}]
initial: {initial}
""")
    square = (amplitude * 200.0) ** 2 / 2 - 9.8
    slow = math.sqrt(abs(square))
    times = np.linspace(0.0, math.pi / slow if stands else 1.5, 17)[1:]
    states = Simulation(scene, 'dop8', accuracy=1e-8, rate=10.0).states(times)
    angle = 2 * np.arctan2(states.orientation[:, 1], states.orientation[:, 3])
    assert (square > 0.0) == stands
    averaged = 0.1 * (np.cos if stands else np.cosh)(slow * times)
    # the shaking itself is A/l of the angle
    assert np.abs(angle - averaged).max() < 0.02


@pytest.mark.parametrize(('moving', 'at_rest'), [
    ('on a moving pivot', 'the same in its own axes'), ('in a lift', 'under more weight')])
def test_seen_from_a_moving_pivot_its_acceleration_is_a_force(found, moving, at_rest):
    one, other = (np.array(found[case]['state'][1:8]) for case in (moving, at_rest))
    assert np.abs(one - other).max() < 2e-13


def test_a_moving_pivot_is_where_the_scene_says(found):
    now = np.array(found['on a moving pivot']['state'])
    arm = rotate(*now[1:5], 0.1, 0.02, -0.05)
    place = 0.3 * math.sin(1.0), 0.0, 0.05 * math.cos(10.0)
    assert np.abs(now[8:11] + arm - place).max() < 1e-15


@pytest.mark.without_numba
def test_the_drive_of_a_pivot_does_the_work_of_its_force():
    """The ledger's work is the integral of the reaction (Newton's law) times the velocity."""
    scene = parse_scene(language_cases.text('all on a moving pivot'), [
        'force.books=work', 'force.value=[0, 0, 0]'])
    simulation, dynamics = Simulation(scene, 'dop8', accuracy=1e-12, rate=2.0), Dynamics(scene)
    nodes, weights = np.polynomial.legendre.leggauss(16)
    times = (np.arange(10)[:, np.newaxis] + 0.5 + 0.5 * nodes).ravel() / 20
    powers = [dynamics.balance(vector).force
              @ (0.6 * math.cos(2 * t), 0.2 * t, -math.sin(20 * t))
              for t, vector in zip(times, simulation.states(times).vector, strict=True)]
    work = np.tile(weights, 10) @ powers / 40
    simulation.advance(1)
    assert simulation.ledger()['work'] == pytest.approx(work, abs=1e-13)


@pytest.mark.without_numba
def test_commands_on_a_moving_pivot_are_booked():
    scene = parse_scene(language_cases.text('on a moving pivot'))
    simulation = Simulation(scene, 'dop8', accuracy=1e-12, rate=10.0)
    simulation.advance(3)
    simulation.impulse(force=(0.1, 0.3, 0.0), torque=(0.0, 0.01, 0.0))
    simulation.hold(force=(0.1, 0.0, 0.4), torque=(0.0, 0.01, 0.0))
    simulation.advance(3)
    ledger = simulation.ledger()
    assert abs(ledger['energy_residual']) < 5e-15
    assert ledger['momentum_residual'] < 5e-15


@pytest.mark.parametrize('case', [
    pytest.param('heat at a pivot', marks=IN_SOAK), 'heat in a field'])
def test_heat_at_constant_momentum_is_taken_from_the_whole_energy(found, case):
    """T + U falls along the extra rate c (m x omega + Gamma): the heat is a square."""
    assert found[case]['ledger']['dissipated'] > 0.1


def test_the_momentum_of_a_gyrostat_counts_its_rotor(found):
    # |I omega + h|^2 of the start, where the body turns about skew axes
    start = np.array([0.3 * 0.3, 0.3 * 0.1, 0.5 * 1.5 + 0.4])
    found = found['gyrostat']['ledger']['angular_momentum_squared']
    assert found == near(start @ start, rel=2e-15)


def test_a_rotor_beside_what_only_an_even_kick_solves_runs_by_few_methods():
    """A torque that depends on omega is solved to order 2 by split2, and not by the others."""
    assert [name for name in runnable(scene_of('rotor: {axis: [0, 0, 1], momentum: 1}'))
            if 'split' in name] == ['split2']
    assert [name for name in runnable(scene_of("torque: {value: ['wy', 0, 0]}"))
            if 'split' in name] == ['split2']


@IN_SOAK
def test_compiled_it_has_the_same_bits(found):
    assert language_cases.run('four at once')['state'] == found['four at once']['state']


def scene_of(effect, constraint='free', parameters=''):
    return parse_scene(f'scene: a\nparameters: {{{parameters}}}\n'
                       'body: {mass: 1, inertia: [1, 2, 3]}\n'
                       f'constraint: {constraint}\neffects: [{{{effect}}}]\ninitial: {{}}\n')


@pytest.mark.parametrize(('effect', 'parameters', 'words'), [
    ("torque: {value: ['-c*wx', 0, 0]}", 'k: 1', "effects.torque.value.0: got '-c*wx': c is not"),
    ("torque: {value: ['os.system(1)', 0, 0]}", '', 'is not part of the language'),
    ('torque: {value: [0, 0, 0]}', 'wx: 1', 'parameters.wx: wx means something else'),
    ('torque: {value: [0, 0, 0]}', '3x: 1', "parameters.3x: got the name '3x'"),
    ('torque: {value: [0, 0]}', '', 'needs at least 3 entries'),
    ("torque: {values: [['x', 0, 0]], times: [0]}", '', 'the type is number'),
    ("potential: {energy: 't*x'}", '', 'potential.energy: depends on t; a potential is'),
    ("magnetic: {moment: [0, 0, 1], field: ['wx', 0, 0]}", '', 'depends on wx; a field of'),
    ('gravity_gradient: {mu: 1, position: [0, 0, 0]}', '', 'not the attracting point'),
    ('gravity_gradient: {mu: 1}', '', "the key 'position' is missing; needed: mu and"),
    ('gravity_gradient: {mu: 1, orbit: {rate: 1, normal: [0, 0, 1], toward: [1, 0, 0]}}', '',
     'gravity_gradient.orbit: is given together with mu or position'),
    ('gravity_gradient: {orbit: {rate: 1, normal: [0, 0, 1], toward: [1, 0, 1]}}', '',
     'orbit.toward: got [1, 0, 1]; a direction perpendicular to normal'),
    ('gravity: {g: [1, 2]}', '', 'gravity.g: got [1, 2]; needs at least 3 entries'),
    ('drag: {linear: [[1, 1, 0], [0, 1, 0], [0, 0, 1]]}', '', 'linear: got [[1, 1, 0], [0, 1, 0]'),
    ('drag: {quadratic: [[1, 2, 0], [2, 1, 0], [0, 0, 1]]}', '', 'which drives some motions'),
    ('drag: {quadratic: -1}', '', 'needs a number of at least 0'),
    ('rotor: {axis: [0, 0, 1], momentum: 1, rate: 2}', '', 'give momentum alone, or inertia and'),
    ('rotor: {axis: [0, 0, 1], momentum: 1}}, {internal_dissipation: {coefficient: 1}', '',
     'internal_dissipation: is given together with rotor'),
    ('rotor: {axis: [0, 0, 0], momentum: 1}', '', 'a direction: three numbers, not all zero'),
    ('spring: {at: [0, 0, 0], anchor: [0, 0, 1]}', '', "the key 'stiffness' is missing"),
    ('spring: {anchor: [0, 0, 1], stiffness: 1}', '', "the key 'at' is missing")])
def test_what_does_not_fit_gets_one_line(effect, parameters, words):
    with pytest.raises(BadInput, match=re.escape(words)) as refusal:
        scene_of(effect, parameters=parameters)
    assert str(refusal.value).isprintable()


@pytest.mark.parametrize(('motion', 'effect', 'words'), [
    ("[0, 0, 'abs(t)']", 'drag: {linear: 1}', 'pivot.motion: has abs; a path without kinks'),
    ("[0, 0, 'x']", 'drag: {linear: 1}', "pivot.motion.2: got 'x': x is not known here"),
    ("[0, 0, '1/t']", 'drag: {linear: 1}', 'the place at time 0 is [0.0, 0.0, inf]'),
    ("[0, 0, 'sqrt(t)']", 'drag: {linear: 1}', 'the velocity at time 0 is'),
    ("[0, 0, 't']", 'internal_dissipation: {coefficient: 1}',
     'is given together with a pivot that moves'),
    ('[0, 0]', 'drag: {linear: 1}', 'needs at least 3 entries')])
def test_a_path_that_no_pivot_can_take_gets_one_line(motion, effect, words):
    with pytest.raises(BadInput, match=re.escape(words)) as refusal:
        scene_of(effect, f'{{pivot: {{motion: {motion}}}}}')
    assert str(refusal.value).isprintable()


def test_the_angle_of_a_hinge_is_known_on_hinges_only():
    with pytest.raises(BadInput, match="depends on angle; on constraint 'free' there is no hinge"):
        scene_of("torque: {value: ['angle', 0, 0]}")
    with pytest.raises(BadInput, match="angle: has no meaning on constraint 'pivot'"):
        scene_of('spring: {stiffness: 1, angle: 0.2}', 'pivot')


def test_only_methods_with_a_clock_run_what_depends_on_time():
    assert runnable(scene_of("torque: {value: ['t', 0, 0]}")) == \
        ['dop8', 'gauss16', 'taylor', 'rk4', 'lsoda', 'radau']
    assert 'split4' in runnable(scene_of("torque: {value: ['sin(qx)', 0, 0]}"))


SPHERE = '{mass: 1, shape: {solid_sphere: {radius: 0.1}}, surface: {sphere: {radius: 0.1}}}'
DISK = '{mass: 1, shape: {disk: {radius: 0.1}}}'
BODY = '{mass: 1.0, inertia: [0.03, 0.04, 0.05]}'
HEAVY = '{gravity: {g: 9.81}}, {sliding_friction: {mu: 0.3}}'


@pytest.mark.parametrize(('body', 'constraint', 'effects', 'initial'), [
    *((BODY, 'free', effect, '{}') for effect in (
        '{gravity: {g: 9.81}}', '{gravity: {g: [0, 1, -9]}}',
        "{torque: {value: ['-k*wx', 0, '0.1*sin(w0*t)'], frame: body}}",
        "{force: {value: [0, 0, '3*exp(-t)'], at: [0.1, 0, 0], frame: body}}",
        "{potential: {energy: '0.5*k*(z - 1)^2'}}", '{rotor: {axis: [0, 0, 1], momentum: 0.4}}',
        '{rotor: {axis: [0, 0, 1], inertia: 0.01, rate: 30, torque: 0.1}}',
        '{gravity_gradient: {mu: 3.986004418e14, position: [7.0e6, 0, 0]}}',
        '{gravity_gradient: {orbit: {rate: 0.001, normal: [0, 0, 1], toward: [1, 0, 0]}}}',
        '{magnetic: {moment: [0, 0, 1.2], field: [0, 2e-5, 4e-5]}}',
        "{magnetic: {moment: [0, 0, 1.2], field: ['2e-5*cos(w0*t)', 0, 'k*x']}}",
        '{spring: {at: [0.1, 0, 0], anchor: [0, 0, 1], stiffness: 4.0, damping: 0.1, '
        'length: 0.2}}',
        '{drag: {linear: 0.1, angular: 0.2, quadratic: 0.3}}',
        '{drag: {linear: [[1, 0, 0], [0, 2, 0], [0, 0, 3]]}}')),
    *((BODY, constraint, '{gravity: {g: 9.81}}', '{}') for constraint in (
        'pivot', '{pivot: {at: [0.1, 0, 0]}}',
        "{pivot: {at: [0.1, 0, 0], motion: [0, 0, '0.01*cos(300*t)']}}",
        "{pivot: {motion: ['k*t', 0, 0]}}", '{hinge: {axis: [0, 0, 1], through: [0.1, 0, 0]}}')),
    (BODY, '{hinge: {axis: [0, 0, 1]}}', '{spring: {stiffness: 4, angle: 0.1}}', '{angle: 1}'),
    (BODY, '{hinge: {axis: [0, 0, 1]}}', '{dry_friction: {torque: 0.02}}', '{rate: 1}'),
    (BODY, 'pivot', '{internal_dissipation: {coefficient: 1}}', '{}'),
    (SPHERE, 'table', HEAVY, '{}'), (SPHERE, '{table: {normal: [0, 0.1, 1]}}', HEAVY, '{}'),
    (SPHERE, 'table', f'{HEAVY}, {{rolling_friction: {{dry: 0.01}}}}', '{}'),
    (SPHERE, 'table', f'{HEAVY}, {{spinning_friction: {{radius: 0.001}}}}', '{}'),
    (DISK, 'table', f'{HEAVY}, {{air_film: {{viscosity: 1.8e-5}}}}', '{tilt: 1}'),
    *((BODY, 'free', '', f'{{{start}}}') for start in (
        'orientation: [0, 0, 0, 1]', 'euler_zyz: [0, 0.5, 0]', 'euler: [0.1, 0.2, 0.3]',
        'rotation_vector: [0.1, 0, 0]', 'tilt: 0.2', 'angular_velocity: [1, 2, 3]',
        'angular_velocity_world: [1, 2, 3]', 'angular_momentum: [1, 2, 3]', 'spin: 2',
        'position: [1, 2, 3], velocity: [4, 5, 6]')),
    *((f'{{parts: [{{mass: 2, shape: {{box: {{size: [0.1, 0.2, 0.3]}}}}}}, {{{part}}}]}}',
       'free', '', '{}') for part in (
        'mass: 1, inertia: [[0.02, 0.001, 0], [0.001, 0.02, 0], [0, 0, 0.02]], at: [0.1, 0, 0], '
        'orientation: [0, 0, 1, 1]', 'mass: 1, point: [0.1, 0, 0]',
        'mass: -0.1, shape: {solid_sphere: {radius: 0.02}}',
        'density: 1000, shape: {solid_sphere: {radius: 0.02}}'))])
def test_a_scene_may_say_it(body, constraint, effects, initial):
    """Every kind of line of the scene language."""
    parse_scene(f'scene: a\nparameters: {{k: 0.02, w0: 12.0}}\nbody: {body}\n'
                f'constraint: {constraint}\neffects: [{effects}]\ninitial: {initial}\n')


def test_a_constant_torque_is_the_effect_it_always_was():
    one, other = scene_of('torque: {value: [1, 2, 3]}'), scene_of('torque: {value: [1, 2.0, 3]}')
    assert one.effects == other.effects
    assert one.effects[0].values == ((1.0, 2.0, 3.0),)


def test_a_parameter_is_one_override_and_needs_no_other_kernel():
    text = language_cases.text('torque of time')
    scenes = [parse_scene(text, [f'parameters.Gamma={size}']) for size in (0.1, 0.2)]
    frame = scenes[0].constraint.frame(scenes[0].body)
    (one,), (other,) = (scene.effects[0].acting(frame, 0.0) for scene in scenes)
    assert one.kernel == other.kernel
    assert (one.values[0], other.values[0]) == (0.1, 0.2)


@pytest.mark.without_numba
def test_commands_the_past_and_an_ensemble():
    scene = parse_scene(language_cases.text('four at once'))
    simulation = Simulation(scene, 'dop8', accuracy=1e-12, rate=10.0)
    simulation.advance(3)
    simulation.impulse(force=(0.1, 0.0, 0.0), torque=(0.0, 0.01, 0.0))
    simulation.advance(3)
    ledger = simulation.ledger()
    assert abs(ledger['energy_residual']) < 5e-15
    assert ledger['momentum_residual'] < 5e-15
    end = simulation.vector.copy()
    assert simulation.states([0.6]).vector[0].tobytes() == end.tobytes()
    many = ensemble(scene, np.array([scene.initial.vector] * 3), [0.0, 0.3], 'dop8', 1e-12)
    assert many.vector[0].tobytes() == many.vector[2].tobytes()
