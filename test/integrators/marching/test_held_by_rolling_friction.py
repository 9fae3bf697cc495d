# SPDX-License-Identifier: Apache-2.0
"""A body that dry rolling friction holds: its lowest point stays where it is on the body."""

import math

import mpmath
import numpy as np
import pytest
from near import near
from soak import IN_SOAK, SOAK

from rigid_body_sim.integrators.equations.contact_views import ROLLING, ROW, SLIDING, UNKNOWNS
from rigid_body_sim.integrators.marching import contact_march
from rigid_body_sim.integrators.marching.contact import OnPlane
from rigid_body_sim.integrators.marching.contact_rolling import MODE, SWIFT, WAY
from rigid_body_sim.mechanics.balance import Dynamics
from rigid_body_sim.mechanics.contact.forces import posture
from rigid_body_sim.mechanics.contact.parameters import CONTACT, HELD
from rigid_body_sim.mechanics.contact.touch import tangent
from rigid_body_sim.numerics.rotations import rotate_back
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

G, M, R = 9.81, 1.0, 0.5
OMEGA, U = UNKNOWNS.part('omega').places, UNKNOWNS.part('u').first


def scene(dry, spin, effects='', mu='.inf'):
    """Return a hoop 1.1 rad from lying flat that turns about the vertical."""
    return parse_scene(
        f'scene: hoop\nbody: {{mass: {M}, shape: {{hoop: {{radius: {R}}}}}}}\nconstraint: table\n'
        f'effects: [gravity: {{g: {G}}}, sliding_friction: {{mu: {mu}}}{effects}, '
        f'rolling_friction: {{dry: {dry}}}]\n'
        f'initial: {{euler_zyz: [0.3, 1.1, 0.2], angular_velocity_world: [0, 0, {spin}], '
        'rolling: true}\n')


def along_rim(orientation, omega):
    """Return the velocity of the lowest point along the rim, over the radius and up to its sign.

    It is b . omega with the tangent e and b = e x gamma.
    """
    gamma = np.array(rotate_back(*orientation, 0.0, 0.0, 1.0))
    return np.cross(tangent(gamma), gamma) @ omega


def inclination(sim, time):
    """Return the angle between the axis of a hoop and the vertical, rad."""
    return math.asin(math.hypot(*rotate_back(*sim.states([time])[0].orientation, 0, 0, 1)[:2]))


def fall(end):
    """Return the time (s) in which the hoop falls straight from 1.1 rad, to 30 digits."""
    with mpmath.workdps(30):
        start, share = mpmath.mpf(1.1), mpmath.mpf(1.5) * R / mpmath.mpf(G)

        def slowness(root):    # dt/d root with a = start - root^2
            half = root * root / 2    # sin(start) - sin(a) = 2 cos(start - half) sin(half)
            return root / mpmath.sqrt(mpmath.cos(start - half) * mpmath.sin(half) / share)

        return float(mpmath.quad(slowness, [0, mpmath.sqrt(start - mpmath.mpf(end))]))


@pytest.mark.without_numba
@pytest.mark.parametrize('dry', [1e-5, 0.002, 0.3])
def test_a_hoop_falls_straight_when_its_quadrature_says(dry):
    """It turns about the tangent at its lowest point: no friction acts, and no energy is lost.

    (A + m R^2) a'^2/2 = m g R (sin 1.1 - sin a). The sign of the friction changed in each step,
    and steps were taken without end.
    """
    sim = Simulation(scene(dry, 0.0), 'dop8', 1e-12)
    share = 1.5 * R / G    # (A + m R^2)/(m g R)
    # measured: 2.3e-16 s and 3.9e-16 rad
    assert sim.at_event('rest', within=1.0).time == pytest.approx(fall(1e-6), abs=1e-14)
    assert inclination(sim, fall(0.4)) == pytest.approx(0.4, abs=1e-14)
    sim.advance(200)
    ledger = sim.ledger()
    assert ledger['dissipated_rolling'] == 0.0
    assert abs(ledger['energy_residual']) < 1e-14    # measured: 2.8e-16
    N = sim.reactions([0.2]).force[0][2]
    tilt = inclination(sim, 0.2)
    falls, square = math.cos(tilt) / share, 2.0 * (math.sin(1.1) - math.sin(tilt)) / share
    assert pytest.approx(M * (G - R * (falls * math.cos(tilt) + square * math.sin(tilt)))) == N


@pytest.mark.without_numba
def test_friction_lets_go_where_it_could_hold_no_more_and_every_event_is_in_the_ledger():
    sim = Simulation(scene(0.05, 2.0), 'dop8', 1e-13)
    held, rolls = sim.states([0.04, 0.2])
    assert along_rim(held.orientation, held.angular_velocity) == pytest.approx(0.0, abs=1e-13)
    assert abs(along_rim(rolls.orientation, rolls.angular_velocity)) > 0.1
    sim.advance(20)
    assert sim.ledger()['dissipated_rolling'] == pytest.approx(0.0, abs=1e-14)
    sim.advance(400)
    ledger = sim.ledger()
    assert ledger['dissipated_rolling'] > 1e-3
    assert abs(ledger['energy_residual']) < 2e-13
    assert ledger['momentum_residual'] < 2e-13


@pytest.mark.without_numba
@pytest.mark.parametrize('time', [0.02, 0.2])
@pytest.mark.parametrize('mu', ['.inf', '0.05'])
def test_reactions_are_those_under_which_it_moves(time, mu):
    """Held and rolling, with slip and without: omega' is the slope of omega."""
    sim = Simulation(scene(0.05, 2.0, mu=mu), 'dop8', 1e-13)
    before, now, after = sim.states([time - 1e-4, time, time + 1e-4])
    slope = (after.angular_velocity - before.angular_velocity) / 2e-4
    balance = Dynamics(sim.scene).balance(now.vector)
    assert balance.angular_acceleration == pytest.approx(slope, abs=1e-6)


@pytest.mark.without_numba
@pytest.mark.parametrize('effects', ['', ', spinning_friction: {radius: 0.01}'])
@pytest.mark.parametrize('mode', [ROLLING, SLIDING])
def test_what_holds_the_lowest_point_takes_no_power_and_leaves_it_where_it_is(mode, effects):
    bound = OnPlane(scene(0.1, 0.0, effects, '0.4'), None, None, None)
    p, y = bound.parameters(0.0), np.zeros(UNKNOWNS.size)
    p[MODE], p[SWIFT], p[WAY] = mode, 1.0, HELD
    y[:4] = np.array([0.1, -0.5, 0.3, 0.8]) / np.sqrt(0.99)
    y[U:U + 2] = (0.3, -0.2) if mode == SLIDING else (0.0, 0.0)
    c = CONTACT.load(p.tolist())
    gamma = posture(c, tuple(y[:4].tolist()), (0.0, 0.0, 0.0)).axes[2]
    along = np.array(tangent(gamma))
    y[OMEGA] = 1.7 * along - 2.3 * np.array(gamma)
    row = np.empty(ROW.size)
    bound.rates.rate(p, y, row)
    h = 1e-5 / row[ROW.part('pace').first]
    moved = []
    for step in (-h, h):
        later = y + step * row[:UNKNOWNS.size]
        at = posture(c, tuple(later[:4].tolist()), tuple(later[OMEGA].tolist()))
        moved.append(np.dot(tangent(at.axes[2]), at.moved))
    assert abs(moved[1] - moved[0]) / (2.0 * h * row[ROW.part('pace').first]) < 1e-8
    assert max(map(abs, moved)) < 1e-9
    heat = row[UNKNOWNS.part('ledger').part('rolled').first]
    assert heat == pytest.approx(0.0, abs=1e-15)


# -- a ball, whose lowest point may move in two directions -------------------------------------

BALL = '{mass: 1.0, inertia: [0.001, 0.001, 0.001], surface: {sphere: {radius: 0.05}}}'
INERTIA, RADIUS = 1e-3, 0.05


def ball(mu, dry, initial, table='table', effects=''):
    """Return a Simulation of a ball."""
    return Simulation(parse_scene(
        f'scene: ball\nbody: {BALL}\nconstraint: {table}\neffects: [gravity: {{g: {G}}}, '
        f'sliding_friction: {{mu: {mu}}}, rolling_friction: {{dry: {dry}}}{effects}]\n'
        f'initial: {initial}\n'), 'dop8', 1e-13)


@pytest.mark.without_numba
@pytest.mark.parametrize('mu', ['.inf', '0.3'])
def test_a_held_ball_spins_on_about_the_normal(mu):
    """Rounding turned the friction of a rolling that was none, in steps without end."""
    sim = ball(mu, 0.01, '{euler_zyz: [0.3, 0.6, 0.2], angular_velocity_world: [0, 0, 2.0], '
               'rolling: true}')
    first, last = sim.states([0.0, 2.0])
    assert last.angular_velocity == pytest.approx(first.angular_velocity, abs=1e-12)
    assert last.position == pytest.approx(first.position, abs=1e-12)


@pytest.mark.without_numba
def test_a_held_ball_slides_without_rolling_and_rests_when_it_says():
    sim = ball(0.1, 0.2, '{velocity: [0.5, 0, 0]}')
    assert not sim.states([0.3])[0].angular_velocity.any()
    rest = sim.at_event('rest', within=1.0)
    assert rest.time == pytest.approx(0.5 / (0.1 * G), abs=1e-12)
    assert rest.position[0] == pytest.approx(0.125 / (0.1 * G), abs=1e-12)
    sim.advance(700)
    ledger = sim.ledger()
    assert ledger['dissipated_sliding'] == pytest.approx(0.125, abs=1e-12)
    assert ledger['dissipated_rolling'] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.without_numba
def test_a_ball_that_slides_back_spins_through_zero_under_the_friction_of_its_rolling():
    """I w' = m g R (mu + C) against the backspin, then m g R (mu - C) until it rolls."""
    mu, C, v, back = 0.3, 0.1, 2.0, 10.0
    sim = ball(mu, C, f'{{velocity: [{v}, 0, 0], angular_velocity: [0, {-back}, 0]}}')
    slow, fast = (M * G * RADIUS * (mu + sign * C) / INERTIA for sign in (-1.0, 1.0))
    stops = back / fast
    rolls = (v + RADIUS * slow * stops) / (mu * G + RADIUS * slow)
    assert sim.states([stops / 2.0])[0].angular_velocity[1] == pytest.approx(-back / 2.0)
    rolling = sim.at_event('rolling began', within=1.0)
    assert rolling.time == pytest.approx(rolls, abs=1e-12)
    assert rolling.velocity[0] == pytest.approx(v - mu * G * rolls, abs=5e-12)
    sim.advance(800)
    assert abs(sim.ledger()['energy_residual']) < 1e-13


@pytest.mark.without_numba
@pytest.mark.parametrize('dry', [0.1, 0.3])
def test_a_ball_at_rest_on_a_slope_begins_to_slide_and_rolls_if_friction_lets_it(dry):
    """The slope is 3/4, mu 1/5: it slides held where C > mu, and else rolls against C N."""
    sim = ball(0.2, dry, '{}', '{table: {normal: [0, 0.6, 0.8]}}')
    state = sim.states([0.1])[0]
    down = 0.1 * G * (0.6 - 0.2 * 0.8)
    turned = 0.1 * G * 0.8 * RADIUS * (0.2 - dry) / INERTIA
    assert np.linalg.norm(state.velocity) == near(down, rel=1e-9)
    assert np.linalg.norm(state.angular_velocity) == near(max(turned, 0.0), rel=1e-9)


@pytest.mark.without_numba
def test_the_reactions_of_a_ball_that_begins_to_roll_have_its_friction():
    """A couple of 9e-3 N m against C m g R = 4.9e-3 N m turns m R^2 + I."""
    sim = ball(0.9, 0.01, '{}', effects=', torque: {value: [0, 9.0e-3, 0]}')
    gained = (9.0e-3 - 0.01 * G * RADIUS) / (INERTIA + RADIUS**2)
    turns = Dynamics(sim.scene).balance(sim.states([0.0])[0].vector).angular_acceleration
    assert turns == pytest.approx([0.0, gained, 0.0], abs=1e-12)
    assert sim.states([0.5])[0].angular_velocity[1] == near(0.5 * gained, rel=1e-12)


@pytest.mark.without_numba
def test_an_ellipsoid_that_begins_to_roll_grows_along_the_friction_that_is_against_it():
    """From rest omega' is constant at first, and the balance of forces has the same."""
    sim = Simulation(parse_scene(
        'scene: ellipsoid\nbody: {mass: 1.0, shape: {ellipsoid: {semi_axes: [0.1, 0.07, 0.05]}}}'
        f'\nconstraint: table\neffects: [gravity: {{g: {G}}}, sliding_friction: {{mu: .inf}}, '
        'rolling_friction: {dry: 0.1}]\ninitial: {euler_zyz: [0.3, 0.5, 0.2]}\n'), 'dop8', 1e-12)
    first, later = sim.states([0.0, 1e-4])
    turns = Dynamics(sim.scene).balance(first.vector).angular_acceleration
    # measured: 8.5e-8, by the turn of the body in 0.1 ms
    assert later.angular_velocity / 1e-4 == near(turns, rel=1e-6)


@pytest.mark.without_numba
def test_a_ball_that_is_lifted_off_is_not_held():
    sim = ball(0.3, 0.1, '{}', effects=', force: {value: [0, 0, 20.0], frame: world}')
    assert sim.states([0.1])[0].position[2] == pytest.approx(RADIUS + 0.005 * (20.0 - G))


@pytest.mark.without_numba
def test_the_ledger_of_a_ball_that_friction_turned_and_stopped_leaves_round_off():
    sim = ball(0.3, 0.1, '{velocity: [0.2, 0, 0]}')
    sim.advance(400)
    assert sim.events[-1].name == 'rest'
    ledger = sim.ledger()
    assert abs(ledger['energy_residual']) < 1e-13
    assert ledger['momentum_residual'] < 1e-13


# -- natural scenes ----------------------------------------------------------------------------

DISK = '{mass: 0.4387, shape: {disk: {radius: 0.0375}}}'
HOOP = f'{{mass: {M}, shape: {{hoop: {{radius: {R}}}}}}}'
TORUS = '{mass: 1.0, shape: {torus: {radius: 0.1, tube: 0.02}}}'
ROCKER = ('{mass: 1.0, inertia: [0.003, 0.004, 0.003], center_of_mass: [0, 0, -0.02], '
          'surface: {ellipsoid: {semi_axes: [0.1, 0.08, 0.05]}}}')
LET_GO, SPINS = '{euler_zyz: [0.3, 1.1, 0.2]}', \
    '{euler_zyz: [0.3, 1.1, 0.2], angular_velocity_world: [0, 0, 3], rolling: true}'
TILTED, PATCH = '{euler_zyz: [0, 1.1, 0]}', ', spinning_friction: {radius: 0.003}'


@IN_SOAK
@pytest.mark.parametrize(('body', 'mu', 'dry', 'effects', 'initial', 'time', 'last'), [
    (HOOP, '.inf', 0.05, '', SPINS, 2.0, 'rest'), (DISK, '0.3', 0.002, '', SPINS, 1.0, 'rest'),
    (TORUS, '.inf', 0.05, '', TILTED, 1.0, 'rest'), (ROCKER, '0.0', 0.05, '', TILTED, 2.5, None),
    (ROCKER, '0.3', 0.05, '', TILTED, 2.5, 'rest'), (ROCKER, '0.3', 0.05, '', LET_GO, 2.5, None),
    (ROCKER, '0.3', 0.05, PATCH, SPINS, 2.5, 'rest'),
    (BALL, '0.3', 0.002, PATCH, SPINS, 1.0, 'rest')])
def test_what_is_let_go_or_spins_is_in_the_ledger_to_its_end(body, mu, dry, effects, initial,
                                                            time, last):
    """Hoop, disk, torus, a body that rocks, a ball; where nothing dies, it spins on."""
    sim = Simulation(parse_scene(
        f'scene: let_go\nbody: {body}\nconstraint: table\neffects: [gravity: {{g: {G}}}, '
        f'sliding_friction: {{mu: {mu}}}, rolling_friction: {{dry: {dry}}}{effects}]\n'
        f'initial: {initial}\n'), 'dop8', 1e-9)
    sim.advance(round(1000 * time))
    ledger = sim.ledger()
    # measured: at most 9.7e-14 and 6.4e-15
    assert abs(ledger['energy_residual']) < 2e-13
    assert ledger['momentum_residual'] < 2e-13
    names = [event.name for event in sim.events]
    assert 'rest' not in names if last is None else names[-1] == last


@pytest.mark.without_numba
def test_a_hoop_that_rolls_straight_stops_where_it_says_and_stands():
    """It rolls upright: v' = -C g/2, for friction takes C N v of the energy m v^2."""
    v, C = 0.5, 0.05
    sim = Simulation(parse_scene(
        f'scene: wheel\nbody: {HOOP}\nconstraint: table\neffects: [gravity: {{g: {G}}}, '
        f'sliding_friction: {{mu: 0.3}}, rolling_friction: {{dry: {C}}}]\n'
        f'initial: {{euler_zyz: [0, {0.5 * math.pi}, 0], angular_velocity: [0, 0, {v / R}], '
        'rolling: true}\n'), 'dop8', 1e-12)
    start, end = sim.states([0.0, 4.0])
    gone = end.position - start.position
    assert np.hypot(*gone[:2]) == pytest.approx(v * v / (C * G), abs=1e-12)
    # upright it is unstable: half an ulp of its tilt falls at 3.9e-10 rad/s by then; measured of 8
    # starts nearby: 0.1 to 2.9 times that, and 3e-23 rad/s along the axis
    rate = math.sqrt(G / (1.5 * R))
    fallen = 2.0 ** -53 * rate * math.cosh(4.0 * rate)
    assert np.abs(end.angular_velocity).max() < 6.0 * fallen
    assert end.angular_velocity[2] == pytest.approx(0.0, abs=1e-15)


@IN_SOAK
@pytest.mark.parametrize('later', [1e-6, 1e-4, 3e-4])
def test_the_reactions_of_a_body_that_friction_lets_go_are_those_of_its_motion(later):
    """Friction was along so slow a rolling, whose direction is another: 2.4e-3 rad/s^2."""
    sim = Simulation(parse_scene(
        'scene: begins\nbody: {mass: 0.3, inertia: [3.6e-5, 4.2e-5, 4.8e-5], center_of_mass: '
        '[0.003, 0.0051, -0.0057], surface: {sphere: {radius: 0.02}}}\nconstraint: {table: '
        f'{{normal: [0.1, -0.05, 1.0]}}}}\neffects: [gravity: {{g: {G}}}, sliding_friction: '
        '{mu: 0.05}, rolling_friction: {dry: 0.01, viscous: 0.001}]\n'
        'initial: {euler_zyz: [0, 0.001, 0]}\n'), 'dop8', 1e-12, horizon=2.0)
    time, step = 1.720821703158 + later, 0.05 * later
    before, now, after = sim.states([time - step, time, time + step])
    slope = (after.angular_velocity - before.angular_velocity) / (2.0 * step)
    # measured: 5e-7, by the turn of the friction
    assert Dynamics(sim.scene).balance(now.vector).angular_acceleration == pytest.approx(
        slope, abs=2e-6)


@pytest.mark.parametrize(('body', 'table', 'laws', 'initial', 'let_go'), [
    pytest.param('{mass: 0.01, shape: {ellipsoid: {semi_axes: [0.02, 0.014, 0.01]}}}',
                 '{table: {normal: [0, 0.6, 0.8]}}', '0.6}, rolling_friction: {dry: 0.5}',
                 '{euler_zyz: [1.818, 1.178, 2.147]}', 0.269919979704, marks=IN_SOAK),
    pytest.param('{mass: 0.3, inertia: [3.6e-5, 4.2e-5, 4.8e-5], '
                 'center_of_mass: [0.003, 0.0051, -0.0057], surface: {sphere: {radius: 0.02}}}',
                 '{table: {normal: [0.1, -0.05, 1.0]}}',
                 '0.05}, rolling_friction: {dry: 0.01, viscous: 0.001}',
                 '{euler_zyz: [0, 0.001, 0]}', 1.720821703158,
                 marks=pytest.mark.without_numba)])
def test_a_body_that_slides_held_begins_to_roll(body, table, laws, initial, let_go):
    """The force that holds it reaches C N while it slides: s' grows from 0 with no rate.

    The direction of so slow a rolling relaxes at once, in steps without end.
    """
    scene = parse_scene(f'scene: begins\nbody: {body}\nconstraint: {table}\neffects: [gravity: '
                        f'{{g: {G}}}, sliding_friction: {{mu: {laws}]\ninitial: {initial}\n')
    times, found = [let_go - 1e-6, let_go + 0.02], []
    for accuracy in (1e-6, 1e-12 if SOAK else 1e-9):
        sim = Simulation(scene, 'dop8', accuracy, horizon=let_go + 0.02)
        found.append(sim.states(times).vector)
        sim.advance(math.floor(1000.0 * times[1]))
        assert abs(sim.ledger()['energy_residual']) < accuracy
    assert found[0] == pytest.approx(found[1], abs=1e-6)


@pytest.mark.without_numba
def test_a_rolling_that_no_step_follows_to_its_end_is_over():
    """Its direction relaxes ever faster, at last within the rounding of time: the run ended."""
    sim = Simulation(parse_scene(
        'scene: ends\nbody: {mass: 1.0, shape: {ellipsoid: {semi_axes: [0.03, 0.02, 0.01]}}}\n'
        f'constraint: table\neffects: [gravity: {{g: {G}}}, sliding_friction: {{mu: .inf}}, '
        'rolling_friction: {dry: 0.5}]\n'
        'initial: {angular_velocity: [1.0, 2.0, 0.0], rolling: true}\n'), 'dop8', 1e-9)
    sim.states([1e-4])
    course = sim._spans[-1].solver._course
    phase = course._so_far.phases[-1]
    phase.front[UNKNOWNS.part('omega').places] *= 1e-12
    # the steps that come so far take minutes in plain Python
    phase._meta[contact_march.STATUS] = contact_march.FAILED
    course._so_far.follow(phase)
    assert [name for _, name, _ in course.events(0.0, 0.01)] == ['rest']


@pytest.mark.without_numba
def test_a_ball_that_turns_as_it_slides_without_friction_is_held_where_its_turning_ends():
    """Friction along another direction drove so slow a rolling on, and no step passed its end."""
    sim = Simulation(parse_scene(
        'scene: turns\nbody: {mass: 1.0, inertia: [0.00012, 0.00014, 0.00016], center_of_mass: '
        '[0.0029, -0.005, -0.0016], surface: {sphere: {radius: 0.02}}}\nconstraint: {table: '
        f'{{normal: [0.1, -0.05, 1.0]}}}}\neffects: [gravity: {{g: {G}}}, sliding_friction: '
        '{mu: 0.0}, rolling_friction: {dry: 0.05, viscous: 0.02}]\ninitial: {}\n'),
        'dop8', 1e-9, horizon=1.0)
    sim.advance(700)
    before = sim.state.velocity
    sim.advance(300)
    # measured: 3e-12, a spin about the normal that nothing holds
    assert sim.state.angular_velocity == pytest.approx(np.zeros(3), abs=1e-10)
    slope = G * math.hypot(0.1, 0.05) / math.hypot(0.1, 0.05, 1.0)
    grown = math.hypot(*(sim.state.velocity - before))
    assert grown == pytest.approx(0.3 * slope, abs=1e-9)
    ledger = sim.ledger()
    assert abs(ledger['energy_residual']) < 1e-9
    assert ledger['momentum_residual'] < 1e-9


@pytest.mark.without_numba
@pytest.mark.parametrize('attitude', [[0.0, 0.0, 0.0], [1.3, 0.7, 2.5]])
@pytest.mark.parametrize('velocity', [[0.6, 0.8, 0.0], [0.3, 1.1, 0.0]])
def test_a_sphere_that_friction_just_holds_slides_without_turning(attitude, velocity):
    """With C = mu the couple of the slip is the one that rolling friction can hold.

    By rounding it was more, and the rolling that then began never grew.
    """
    sim = Simulation(parse_scene(
        'scene: tie\nbody: {mass: 1.0, shape: {solid_sphere: {radius: 0.02}}, '
        'surface: {sphere: {radius: 0.02}}}\nconstraint: table\n'
        f'effects: [gravity: {{g: {G}}}, sliding_friction: {{mu: 0.2}}, '
        'rolling_friction: {dry: 0.2}]\n'
        f'initial: {{euler_zyz: {attitude}, velocity: {velocity}}}\n'), 'dop8', 1e-11, horizon=1.0)
    time, speed = 0.2, math.hypot(*velocity)
    way = (speed * time - 0.1 * G * time ** 2) / speed * np.array(velocity)
    state = sim.states([time])[0]
    assert state.vector[8:10] == pytest.approx(way[:2], abs=1e-14)
    assert np.abs(state.angular_velocity).max() < 1e-13
    sim.advance(100)
    sim.impulse(force=[0.3, 0.1, 0.0])
    sim.advance(100)
    assert abs(sim.ledger()['energy_residual']) < 1e-14
