# SPDX-License-Identifier: Apache-2.0
"""Hard cases of a convex body on a plane, each against a closed form.

Grazing, one tick that holds several events, no friction, nearly flat, nearly round, long rolling,
and Painleve's paradox in the middle of a run. Chatter to the Zeno point, a spin about the normal
only and strikes at the moment of sticking are in test_convex_body.py, with which the scenes share
one compilation.
"""

import itertools
import math
import re

import mpmath as mp
import numpy as np
import pytest
from near import near
from numba_only import LONG_IN_PYTHON
from scipy.integrate import solve_ivp
from soak import IN_SOAK, SOAK

from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.integrators.equations.contact_views import FLIGHT
from rigid_body_sim.integrators.marching import contact_march, contact_succession
from rigid_body_sim.numerics.rotations import rotate_back
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

FINEST = 1e-15
G = 9.81
HALF_ULP = 2.0 ** -53
mp.mp.dps = 40


def simulation(body, effects, initial, table='table', accuracy=FINEST, **options):
    """Return a Simulation under gravity by dop8."""
    return Simulation(parse_scene(
        f'scene: hard\nbody: {body}\nconstraint: {table}\n'
        f'effects: [gravity: {{g: {G}}}, {effects}]\ninitial: {initial}\n'), 'dop8', accuracy,
        **options)


def turned(omega, time):
    """Return the orientation of a body that turns at a constant rate from (0, 0, 0, 1)."""
    omega = [mp.mpf(x) for x in omega]
    rate = mp.sqrt(sum(x * x for x in omega))
    half = rate * mp.mpf(time) / 2
    return np.array([float(mp.sin(half) * x / rate) for x in omega] + [float(mp.cos(half))])


# -- grazing ----------------------------------------------------------------------------------


def lowest(function, left, right):
    """Return where a function has its least value in an interval, which holds one minimum."""
    places = [left + (right - left) * k / 200 for k in range(201)]
    least = min(places[1:-1], key=function)
    step = (right - left) / 200
    return mp.findroot(lambda x: mp.diff(function, x), (least - step, least + step),
                       solver='ridder')


def first_zero(function, left, right):
    """Return where a function that is positive at the left of an interval first vanishes."""
    places = [left + (right - left) * k / 400 for k in range(401)]
    end = next(k for k in range(401) if function(places[k]) < 0)
    return mp.findroot(function, (places[end - 1], places[end]), solver='bisect', tol=1e-60)


@pytest.mark.parametrize('clearance', ['1e-3', '1e-9', '1e-12', '-1e-12', '-1e-9', '-1e-3'])
def test_an_ellipsoid_that_turns_in_flight_hits_the_plane_or_just_misses_it(clearance):
    """Its lowest point dips twice a turn; the third dip has the clearance, the fourth one hits."""
    a, c, w, up, g = map(mp.mpf, (0.1, 0.5, 20.0, 2.0, G))

    def sunk(t):
        return up * t - g * t * t / 2 - mp.sqrt((a * mp.sin(w * t)) ** 2
                                                + (c * mp.cos(w * t)) ** 2)

    dip = lowest(sunk, mp.mpf('0.40'), mp.mpf('0.55'))
    height = float(mp.mpf(clearance) - sunk(dip))
    left = height + sunk(dip)    # the clearance, as the double of the height has it
    begin = mp.mpf(0) if left < 0 else dip + mp.mpf('1e-9')
    until = dip if left < 0 else mp.mpf('0.7')
    if left < 0:
        begin = until - 2 * mp.sqrt(-2 * left / mp.diff(sunk, dip, 2))
    true = first_zero(lambda t: height + sunk(t), begin, until)
    sim = simulation('{mass: 1.0, inertia: [0.02, 0.04, 0.03], '
                     'surface: {ellipsoid: {semi_axes: [0.1, 0.2, 0.5]}}}',
                     'sliding_friction: {mu: 0.3}',
                     f'{{position: [0, 0, {height!r}], velocity: [0, 0, 2.0], '
                     'angular_velocity: [0, 20, 0]}')
    # the gap errs by some ulps of the height, and falls at its rate there
    rounding = 16.0 * HALF_ULP * height / abs(float(mp.diff(sunk, true))) + 2e-16
    assert sim.at_event('impact').time == pytest.approx(float(true), abs=rounding)


@pytest.mark.without_numba
@pytest.mark.parametrize('accuracy', [FINEST, 1e-6])
@pytest.mark.parametrize(('short', 'share'), [
    ('1e-2', '0.01'), ('1e-2', '0.7'), ('1e-2', '0.999'), ('1e-3', '0.7'), ('1e-3', '1.01')])
def test_a_flight_that_begins_on_the_plane_dips_below_it_within_a_step_or_just_does_not(
        short, share, accuracy):
    """The lowest point of an ellipsoid that turns leaves the plane slowly, sinks, and goes up.

    From the inclination x on the gap is

        up t - g t^2/2 - h(x + w t) + h(x),    h^2 = (a sin)^2 + (c cos)^2.

    Where x is shortly before that with w^2 h'' = -g, it is off t - A t^2/2 + J t^3/6 with a small
    A, and goes below zero if off < 3 A^2/(8 J).
    """
    a, c, w, g = map(mp.mpf, (0.1, 0.5, 20.0, G))

    def h(x):
        return mp.sqrt((a * mp.sin(x)) ** 2 + (c * mp.cos(x)) ** 2)

    even = mp.findroot(lambda x: w * w * mp.diff(h, x, 2) + g, (1.8, 2.2), solver='ridder')
    x = float(even - mp.mpf(short))
    A, J = g + w * w * mp.diff(h, mp.mpf(x), 2), -w ** 3 * mp.diff(h, mp.mpf(x), 3)
    up = float(w * mp.diff(h, mp.mpf(x)) + mp.mpf(share) * 3 * A * A / (8 * J))

    def gap(t):
        return up * t - g * t * t / 2 - h(x + w * t) + h(mp.mpf(x))

    dip = mp.findroot(lambda t: mp.diff(gap, t), (A / J, 2.2 * A / J), solver='secant')
    sim = simulation('{mass: 1.0, inertia: [0.02, 0.04, 0.03], '
                     'surface: {ellipsoid: {semi_axes: [0.1, 0.2, 0.5]}}}',
                     'sliding_friction: {mu: 0.3}', f'{{tilt: {x!r}, velocity: [0, 0, {up!r}], '
                     'angular_velocity: [0, 20, 0]}', accuracy=accuracy, horizon=1.0)
    if gap(dip) > 0:
        with pytest.raises(BadInput, match='no event comes in that time'):
            sim.at_event('impact', within=0.1)
        return
    true = mp.findroot(gap, (1e-3 * dip, dip), solver='bisect', tol=1e-60)
    # distances of up t cancel in the gap
    rounding = 4.0 * HALF_ULP * up * float(true) / abs(float(mp.diff(gap, true)))
    found = sim.at_event('impact', within=0.1).time
    assert abs(found - float(true)) < 6.0 * rounding    # 1.7


@pytest.mark.parametrize('share', ['1e-3', '1e-9', '1e-12', '-1e-12', '-1e-9', '-1e-3'])
def test_a_ball_that_rolls_is_pulled_off_the_plane_or_just_stays(share):
    """The least normal force of one that rolls in a plane is a share of its weight, or less.

    With theta the angle from the lowest position, the centre of mass l below the middle,

        K theta'^2/2 - m g l cos(theta) = E,    K = I + m (R^2 + l^2 - 2 R l cos(theta)),
        N/m = g + (l sin(theta) theta')'.
    """
    I, R, l, g = map(mp.mpf, (0.02, 0.5, 0.3, G))

    def square(theta, E):
        return 2 * (E + g * l * mp.cos(theta)) / (I + R * R + l * l - 2 * R * l * mp.cos(theta))

    def normal(theta, E):
        inertia = I + R * R + l * l - 2 * R * l * mp.cos(theta)
        grown = -l * mp.sin(theta) * (g + square(theta, E) * R) / inertia
        return 1 + (l * mp.cos(theta) * square(theta, E) + l * mp.sin(theta) * grown) / g

    def least(E):
        return lowest(lambda theta: normal(theta, E), mp.mpf('1.4'), mp.mpf('2.2'))

    E = mp.findroot(lambda E: normal(least(E), E) - mp.mpf(share), (10, 11))
    rate = float(mp.sqrt(square(mp.mpf(0), E)))
    E = (I + (R - l) ** 2) * mp.mpf(rate) ** 2 / 2 - g * l
    at = least(E)
    sim = simulation('{mass: 1.0, inertia: [0.02, 0.02, 0.02], center_of_mass: [0, 0, -0.3], '
                     'surface: {sphere: {radius: 0.5}}}', 'sliding_friction: {mu: .inf}',
                     f'{{angular_velocity: [0, {rate!r}, 0], rolling: true}}')
    turn = float(mp.quad(lambda x: 1 / mp.sqrt(square(x, E)), [0, 1, 2, mp.pi, 4, 5, 2 * mp.pi]))
    if normal(at, E) > 0:
        assert sim.states([0.9 * turn])[0].orientation @ turned((0, rate, 0), 0.0) < 0.0
        return
    angle = first_zero(lambda x: normal(x, E), at - mp.mpf('0.4'), at)
    true = mp.quad(lambda x: 1 / mp.sqrt(square(x, E)), [0, angle / 2, angle])
    with pytest.raises(NotConverged, match='a finite mu lets it slip') as error:
        sim.states([turn])
    time = float(str(error.value).split(' t = ')[1].split()[0])
    # N is a sum of parts up to 14 weights, of a square of omega, whose rounding counts twice, and
    # falls at its rate there: 2.4e-11 s for the share of -1e-9, where 21 starts an ulp or more
    # apart err by up to 1.8e-11
    falls = abs(float(mp.diff(lambda x: normal(x, E), angle) * mp.sqrt(square(angle, E))))
    assert time == pytest.approx(float(true), abs=14.0 * 6.0 * HALF_ULP / falls + 2e-16)


# -- several events within a tick --------------------------------------------------------------


def test_slip_and_lift_off_within_one_tick_are_both_told_and_located():
    parts = ('{mass: 1.0, inertia: [0.01, 0.012, 0.02], center_of_mass: [0, 0, -0.03], '
             'surface: {ellipsoid: {semi_axes: [0.2, 0.1, 0.15]}}}', 'sliding_friction: {mu: 0.5}',
             '{euler_zyz: [0, 0.6, 0.4], angular_velocity: [0, 14, 0], rolling: true}')
    coarse = simulation(*parts, accuracy=1e-12, rate=10.0)
    fine = simulation(*parts, accuracy=1e-12, rate=10000.0)
    coarse.advance()
    assert [event.name for event in coarse.events] == ['sliding began', 'lift-off']
    began, off = (event.time for event in coarse.events)
    assert 0.0 < began < off < 0.1
    coarse.advance(6)
    fine.advance(7000)
    assert [(one.time, one.name) for one in coarse.events] == [
        (one.time, one.name) for one in fine.events]
    assert coarse.vector.tobytes() == fine.vector.tobytes()
    # the force has gone where the lift-off is told, not a tick later
    assert coarse.reactions([off - 1e-9]).force[0, 2] > 0.0
    assert not coarse.reactions([off + 1e-9]).force.any()
    # a start at the onset, or at the lift-off, goes the same way
    for time, names in ((began, ['sliding began', 'lift-off']), (off, ['lift-off'])):
        state = fine.states([time])[0]
        later = simulation(*parts[:2], f'{{orientation: {list(map(float, state.orientation))}, '
                           f'angular_velocity: {list(map(float, state.angular_velocity))}, '
                           f'position: {list(map(float, state.position))}, '
                           f'velocity: {list(map(float, state.velocity))}}}', accuracy=1e-12)
        assert later.at_event('impact').time + time == pytest.approx(
            fine.events[2].time, abs=1e-11)
        assert set(names) >= {event.name for event in later.events}


PULLED = '{mass: 1.0, inertia: [0.4, 0.4, 0.4], surface: {sphere: {radius: 1.0}}}'
PULL = 10240.0    # N/s


def pull(frame):
    """Return an upward force that grows evenly, as an effect."""
    return f"force: {{value: [0, 0, '{PULL}*t'], frame: {frame}}}"


@pytest.mark.without_numba
@pytest.mark.parametrize('initial', ['{angular_velocity: [0, 1, 0], rolling: true}',
                                     '{velocity: [1, 0, 0]}'], ids=['rolling', 'sliding'])
def test_a_ball_that_is_pulled_up_lifts_off_where_n_is_0(initial):
    """A rolling one loses its grip, mu N, at that very time, and only its lift-off is told."""
    sim = simulation(PULLED, f'sliding_friction: {{mu: 0.25}}, {pull("world")}', initial,
                     accuracy=1e-9)
    sim.advance()
    assert [event.name for event in sim.events] == ['lift-off']
    # the clock of a step is a sum of weights up to 5.8: 2e-15 of the time; measured: 1.1e-18
    assert sim.events[0].time == pytest.approx(G / PULL, abs=3e-18)


@pytest.mark.without_numba
def test_a_ball_that_is_pulled_along_an_axis_of_its_own_lets_go_before():
    """The force tilts with the body, by theta, and friction takes 2/7 of its part along the plane.

    Rolling, theta'' = 5/7 F sin(theta), and N = m g - F cos(theta). The axes of a force are those
    of the body by default: the time from letting go to lift-off, 9e-7 s, is no error.
    """
    mu, pulls = 0.25, mp.mpf(PULL)
    sim = simulation(PULLED, f'sliding_friction: {{mu: {mu}}}, {pull("body")}',
                     '{angular_velocity: [0, 1, 0], rolling: true}', accuracy=1e-9)
    sim.advance()
    theta = mp.odefun(lambda t, y: [y[1], mp.mpf(5) / 7 * pulls * t * mp.sin(y[0])], 0,
                      [mp.mpf(0), mp.mpf(1)])

    def normal(t):
        return mp.mpf(G) - pulls * t * mp.cos(theta(t)[0])

    def grip(t):
        return mu * normal(t) - mp.mpf(2) / 7 * pulls * t * mp.sin(theta(t)[0])

    # between the two the ball slips: theta differs from that of rolling by 1e-15
    off = G / PULL
    true = [mp.findroot(grip, (off - 1e-6, off)), mp.findroot(normal, (off, off + 1e-9))]
    assert [event.name for event in sim.events] == ['sliding began', 'lift-off']
    assert true[1] - true[0] > 8e-7
    for event, time in zip(sim.events, true, strict=True):
        assert event.time == pytest.approx(float(time), abs=2e-18)    # measured: 1e-19


@pytest.mark.without_numba
@pytest.mark.parametrize('why', [contact_march.STUCK, contact_march.LOST_CONTACT])
def test_a_slip_that_ends_where_n_is_0_is_told_as_lift_off(why):
    """The march hands over both as 0: in 307 scenes aimed at that, the ball rolled first."""
    sim = simulation(PULLED, f'sliding_friction: {{mu: 0.25}}, {pull("world")}',
                     '{velocity: [1, 0, 0]}', accuracy=1e-9)
    course = sim._spans[-1].solver._course._so_far
    phase, = course.phases
    phase.front[contact_succession.SLIP] = 0.0
    phase.front[contact_succession.TIME] = G / PULL
    phase._meta[contact_march.STATUS] = why
    course.follow(phase)
    assert course.phases[-1].p[contact_march.MODE] == FLIGHT
    assert course.events == [(G / PULL, 'lift-off', {})]


@pytest.mark.without_numba
@pytest.mark.parametrize('accuracy', [1e-6, 1e-9, 1e-12])
def test_a_disk_that_lifts_off_meets_the_plane_when_it_comes_back_only(accuracy):
    """As N ends, gap, velocity and acceleration are 0 but for rounding, which makes no impact."""
    sim = simulation('{mass: 0.1, shape: {disk: {radius: 0.1}}}', 'sliding_friction: {mu: 0.0}',
                     '{euler_zyz: [0.448, 2.695, 5.538], '
                     'angular_velocity: [9.137, -6.983, -0.46], '
                     'velocity: [0, 0, 1.039]}',
                     accuracy=accuracy, rate=20.0, horizon=0.3)
    sim.advance(6)
    assert [one.name for one in sim.events] == ['impact', 'lift-off', 'impact']


# -- no loss ------------------------------------------------------------------------------------


@pytest.mark.without_numba
@pytest.mark.parametrize('accuracy', [1e-6, 1e-9, 1e-12, FINEST])
def test_a_ball_without_loss_bounces_for_ever_and_loses_only_its_first_slip(accuracy):
    """It falls for t1 = (2 H/g)^(1/2), and its impacts are 2 t1 apart.

    The first one takes the slip R (wx^2 + wy^2)^(1/2) of the mass 1/(1/m + R^2/I).
    """
    sim = simulation('{mass: 1.0, inertia: [0.001, 0.001, 0.001], '
                     'surface: {sphere: {radius: 0.05}}}', 'sliding_friction: {mu: 0.25}',
                     '{position: [0, 0, 0.3], angular_velocity: [3, 1, 2]}',
                     table='{table: {restitution: 1.0}}', accuracy=accuracy, rate=10.0)
    sim.advance(30)
    falls, impacts = math.sqrt(2.0 * 0.25 / G), [one.time for one in sim.events]
    assert [one.name for one in sim.events] == ['impact'] * 7
    assert impacts == [near((1 + 2 * n) * falls, rel=2e-14) for n in range(7)]    # 4e-15
    slip = 0.05 * math.sqrt(10.0)
    assert sim.ledger()['dissipated'] == pytest.approx(0.5 * slip ** 2 / 3.5, abs=2e-14)    # 6e-15


# -- no friction ------------------------------------------------------------------------------


def test_a_top_without_friction_nods_as_its_quadrature_says():
    """Its centre of mass moves straight, and what turns it is N alone.

    With theta the angle of the axis from the vertical and h the height of the centre of mass,

        (I1 + m h'(theta)^2) theta'^2 = 2 E - (L - I3 w3 cos(theta))^2/(I1 sin(theta)^2)
            - I3 w3^2 - 2 m g h(theta).
    """
    I1, I3, m, R, l, theta, s, w3, g = map(mp.mpf, ('8e-7', '7e-7', '0.006', '0.015', '0.003',
                                                     '0.9', '20', '150', '9.81'))
    L = I1 * s * mp.sin(theta) + I3 * w3 * mp.cos(theta)

    def level(x):
        return ((L - I3 * w3 * mp.cos(x)) ** 2 / (I1 * mp.sin(x) ** 2)
                + 2 * m * g * (R - l * mp.cos(x)))

    other = mp.findroot(lambda x: (level(x) - level(theta)) / (x - theta), (0.85, 0.8))
    middle, width = (theta + other) / 2, abs(theta - other) / 2

    def share(u):
        x = middle + width * mp.sin(u)
        inertia = I1 + m * (l * mp.sin(x)) ** 2
        return width * mp.cos(u) * mp.sqrt(inertia / (level(theta) - level(x)))

    half = mp.pi / 48 * mp.fsum(share(mp.pi * (k + mp.mpf('0.5')) / 48 - mp.pi / 2)
                                for k in range(48))
    sim = simulation('{mass: 0.006, inertia: [8.0e-7, 8.0e-7, 7.0e-7], '
                     'center_of_mass: [0, 0, -0.003], surface: {sphere: {radius: 0.015}}}',
                     'sliding_friction: {mu: 0}', '{euler_zyz: [0, 0.9, 0], '
                     'angular_velocity: [-20, 0, 150], velocity: [0.3, -0.1, 0]}')
    for turns in (1, 101):
        state = sim.states([float(turns * half)])[0]
        n = rotate_back(*state.orientation, 0.0, 0.0, 1.0)
        assert math.acos(n[2]) == pytest.approx(float(other), abs=1e-14 * turns)
        assert state.angular_velocity[2] == 150.0
    sim.advance(1000)
    assert not sim.events
    assert sim.ledger()['dissipated'] == 0.0


# -- limits ------------------------------------------------------------------------------------


def test_a_disk_inclined_by_1e_8_rad_nods_as_its_quadrature_says():
    """Up to a share a^2, which is below rounding, s a is a constant k of the motion.

    Then the inclination a follows

        (A + m R^2) a'^2 = A (k/a0)^2 + 2 m g R a0 - A (k/a)^2 - 2 m g R a.
    """
    m, R, a0, g = mp.mpf(1), mp.mpf('0.5'), mp.mpf(1e-8), mp.mpf(G)
    A, s0 = m * R * R / 4, mp.sqrt(4 * g * mp.mpf(1e-8) / R) * mp.mpf('1.5')
    energy, k = A * s0 * s0 + 2 * m * g * R * a0, s0 * a0

    def fall(a):
        return energy - A * (k / a) ** 2 - 2 * m * g * R * a

    # energy a^2 - A k^2 - 2 m g R a^3 = -2 m g R (a - a0)(a^2 + b a + b a0)
    b = a0 - energy / (2 * m * g * R)
    other = (-b + mp.sqrt(b * b - 4 * b * a0)) / 2
    middle, width = (a0 + other) / 2, abs(other - a0) / 2

    def share(u):
        a = middle + width * mp.sin(u)
        return width * mp.cos(u) * mp.sqrt((A + m * R * R) / fall(a))

    half = mp.pi / 128 * mp.fsum(share(mp.pi * (j + mp.mpf('0.5')) / 128 - mp.pi / 2)
                                 for j in range(128))
    sim = simulation('{mass: 1.0, shape: {disk: {radius: 0.5}}}', 'sliding_friction: {mu: .inf}',
                     f'{{euler_zyz: [0, 1.0e-8, 0], angular_velocity: [{-float(s0)!r}, 0, 0], '
                     'rolling: true}')
    # measured: 4e-14 of the inclination
    for turns in (1, 2, 21):
        n = rotate_back(*sim.states([float(turns * half)])[0].orientation, 0.0, 0.0, 1.0)
        expected = float(other if turns % 2 else a0)
        assert math.hypot(n[0], n[1]) == near(expected, rel=3e-13)


def test_a_nearly_round_ellipsoid_departs_from_the_sphere_in_proportion():
    body = '{{mass: 1.0, inertia: [0.001, 0.0011, 0.0012], surface: {}}}'
    parts = 'sliding_friction: {mu: 0.2}', '{angular_velocity: [3, -2, 1], velocity: [1, 0.5, 0]}'
    times = np.linspace(0.0, 1.0, 11)
    sphere = simulation(body.format('{sphere: {radius: 0.05}}'), *parts).states(times).vector

    def departure(share):
        axes = [0.05, 0.05 * (1.0 + share), 0.05]
        near = simulation(body.format(f'{{ellipsoid: {{semi_axes: {axes}}}}}'), *parts)
        return (near.states(times).vector - sphere) / share

    first = departure(1e-7)
    size = np.abs(first).max()
    assert 1.0 < size < 100.0
    # measured: 5.1 of the share, and 1e-6 where doubles carry seven digits of the departure
    for share, most in ((1e-4, 1e-3), (1e-5, 1e-4), (1e-9, 1e-5)):
        assert np.abs(departure(share) - first).max() < most * size


# -- a million seconds -------------------------------------------------------------------------


@LONG_IN_PYTHON
def test_a_ball_rolls_for_a_million_seconds():
    """It turns at a constant rate.

    The closed form shows that to the last bit. In steps the plane balances the weight to rounding,
    and what is left of its torque turns the ball ever faster. A tenth of the time without `make
    soak`.
    """
    omega, end = (0.03, 0.07, 0.02), 1e6 if SOAK else 1e5
    ball = 'mass: 1.0, inertia: [0.1, 0.1, 0.1]'
    start = f'{{angular_velocity: {list(omega)}, velocity: [0.035, -0.015, 0]}}'
    exact = Simulation(parse_scene(
        f'scene: ball\nbody: {{{ball}, radius: 0.5}}\nconstraint: table\n'
        f'effects: [sliding_friction: {{mu: 0.3, g: {G}}}]\ninitial: {start}\n'))
    assert exact.choice.method == 'exact'
    state, true = exact.states([1e6])[0], turned(omega, 1e6)
    away = state.orientation - math.copysign(1.0, true @ state.orientation) * true
    assert np.abs(away).max() < HALF_ULP * 0.08 * 1e6
    general = simulation(f'{{{ball}, surface: {{sphere: {{radius: 0.5}}}}}}',
                         'sliding_friction: {mu: 0.3}',
                         f'{{angular_velocity: {list(omega)}, rolling: true}}', accuracy=1e-9,
                         horizon=1e6)
    state, true = general.states([end])[0], turned(omega, end)
    assert not general.events
    away = state.orientation - math.copysign(1.0, true @ state.orientation) * true
    # measured: 1/300 of it at 1e6 s
    assert np.abs(away).max() < 0.5 * end * end * HALF_ULP * G * 0.5 / 0.1
    assert state.position[2] == pytest.approx(0.5, abs=2.0 * HALF_ULP)
    energy, _ = general.diagnose(general.states([0.0, end]))
    assert energy[1] == near(energy[0], rel=1e-12)


# -- Painleve's paradox ------------------------------------------------------------------------

ROD = '{mass: 1.0, inertia: [0.0833333333333, 0.0833333333333, 1.0e-4], ' \
      'surface: {ellipsoid: {semi_axes: [0.005, 0.005, 0.5]}}}'


@pytest.mark.parametrize('accuracy', [1e-5, 1e-8, 1e-9, 1e-12])
def test_a_slip_that_dies_beside_the_paradox_is_no_paradox(accuracy):
    """Its last step may turn what is left of it around, and no force could bear such a slip."""
    sim = simulation(ROD, 'sliding_friction: {mu: 2.5}', '{euler_zyz: [0, 0.5, 0], '
                     'position: [0, 0, 0.6], velocity: [-4.0, 0, 0]}', accuracy=accuracy)
    sim.advance(1400)
    assert [event.name for event in sim.events] == [
        'impact', 'sliding began', 'rolling began', 'sliding began', 'rolling began']
    assert sim.events[-1].time == pytest.approx(0.99311457976744, abs=accuracy + 2e-13)


@pytest.mark.parametrize('accuracy', [1e-9, 1e-12])
def test_the_last_step_of_a_slip_that_dies_beside_the_paradox_is_no_event(accuracy):
    """It turned a slip of 1e-17 of the speeds around, by a step that grew it to 1e-5."""
    sim = simulation(
        '{mass: 50.0, inertia: [1.4588098303773814e-05, 0.0003029009112552686, '
        '0.00031446944916566625], center_of_mass: [0.000152664, 0.000146469, 1.67487e-06], '
        'surface: {ellipsoid: {semi_axes: [0.0005340088516507073, 0.015417054165754625, '
        '0.009375910006723404]}}}', 'sliding_friction: {mu: 1.0}',
        '{euler_zyz: [0.3, 1.5707963257948965, 0.2], '
        'angular_velocity: [6.65719, -3.93922, 14.9624]}',
        '{table: {normal: [-0.304, -0.078, 1]}}', accuracy)
    sim.advance(330)
    # the slip turns round; 14 bodies whose moments and centres differ by an ulp or two begin it at
    # 0.3155871741 s on an average, from 1.9e-9 before to 1.6e-9 after (magnified rounding)
    assert sim.events[-1].name == 'sliding began'
    assert sim.events[-1].time == pytest.approx(0.3155871741, abs=2e-9)    # 1.2e-9, 0.9e-9


def test_a_slip_begins_along_a_direction_beside_the_paradox():
    """Newton's method missed it: slip began along one in which it dies, every 4e-45 s."""
    times = []
    for accuracy in (1e-9, 1e-12):
        sim = simulation(
            '{mass: 0.001, inertia: [2.421734937069718e-07, 5.496113254957697e-10, '
            '2.417560270894058e-07], center_of_mass: [0.00769682, 0.0120721, -0.00599798], '
            'surface: {sphere: {radius: 0.05}}}', 'sliding_friction: {mu: 0.302}',
            '{euler_zyz: [0, 0.1425, 0], '
            'angular_velocity: [-7.58459e-06, 1.3105e-05, -2.23653e-06], rolling: true}',
            '{table: {normal: [0.756, -0.542, 1]}}', accuracy, horizon=1.0)
        sim.states([0.1])
        with pytest.raises(NotConverged, match="Painleve's paradox at t = ") as error:
            sim.states([0.2])
        times.append(float(re.search(r't = (\S+) s', str(error.value)).group(1)))
    assert times == near([0.10990416803934] * 2, rel=1e-9)    # measured: 5e-14


@pytest.mark.without_numba
def test_a_patch_begins_to_slip_along_a_direction_that_newtons_method_missed():
    """The search for it failed from all starts, and the run ended at 0 s as if it had none."""
    coarse, fine = (simulation(
        '{mass: 1.0, inertia: [7.727750842574427e-07, 6.865020137080503e-07, '
        '1.002774851384363e-06], surface: {ellipsoid: {semi_axes: [0.018534855082596516, '
        '0.007641560447726276, 0.010595509000485769]}}}',
        'sliding_friction: {mu: 1.0}, spinning_friction: {radius: 1.34e-07}',
        '{rolling: true}', '{table: {normal: [-0.629, 0.198, 1], restitution: 0.5}}',
        accuracy).states([0.0003]).vector for accuracy in (1e-9, 1e-12))
    assert np.abs(coarse - fine).max() < 1e-12    # measured: 0


@pytest.mark.without_numba
def test_a_contact_that_neither_sticks_nor_lets_a_slip_begin_ends_the_run():
    """No slip grows along any direction, as polynomials with 60 digits say.

    It takes rolling friction whose couple of N lifts the body by less than it presses it down.
    """
    with pytest.raises(NotConverged, match=r"Painleve's paradox at t = 0\.0 s"):
        simulation(
            '{mass: 1.0, inertia: [0.000158, 0.000173, 0.00017], center_of_mass: [0.0106, -0.036, '
            '-0.0717], surface: {sphere: {radius: 0.1}}}',
            'sliding_friction: {mu: 1.61}, rolling_friction: {dry: 0.879}, '
            'spinning_friction: {radius: 0.01}',
            '{angular_velocity: [2.81, -1.79, 0], rolling: true}', accuracy=1e-9)


@pytest.mark.without_numba
def test_a_patch_that_sticks_without_friction_may_begin_to_roll_and_slip():
    """The direction of a friction of 0 was asked for; the run ended at 0 s."""
    sim = simulation(
        '{mass: 1.0, inertia: [0.000183, 0.000174, 0.000177], center_of_mass: [0.0175, 0.0825, '
        '0.03], surface: {sphere: {radius: 0.1}}}',
        'sliding_friction: {mu: 0.256}, rolling_friction: {dry: 0.0905}, '
        'spinning_friction: {radius: 0.01}', '{rolling: true}', accuracy=1e-9)
    assert sim.states([1e-4])[0].time == 1e-4


@pytest.mark.parametrize('accuracy', [1e-9, 1e-12])
def test_a_slip_that_begins_within_rounding_of_the_grip_is_no_paradox(accuracy):
    """The slip grew by -1e-14 m/s^2 where the grip had gone by 2e-12 of it, and the run ended."""
    sim = simulation(
        '{mass: 3.82, inertia: [5.38617e-05, 4.33056e-05, 5.30843e-05], center_of_mass: '
        '[-0.004388, 0.0008451, -7.391e-05], surface: {ellipsoid: {semi_axes: [0.01966, 0.02615, '
        '0.0156]}}}', 'sliding_friction: {mu: 7.26}',
        '{euler_zyz: [-1.47, 1.644, 2.502], rolling: true}',
        '{table: {normal: [-0.7153, 0.199, 1.0]}}', accuracy, horizon=0.2)
    sim.advance(180)
    assert [event.name for event in sim.events] == ['sliding began', 'lift-off', 'impact']
    assert sim.events[-1].time == pytest.approx(0.169780657228, abs=accuracy)


def test_a_slip_that_jams_where_a_falls_evenly_ends_the_run_at_the_paradox():
    """N grows like 1/A and draws the direction so strongly that steps went on without end."""
    times = []
    for accuracy in (1e-9, 1e-12):
        sim = simulation(
            '{mass: 6.82, inertia: [5.36967e-06, 8.72698e-06, 8.3977e-06], surface: '
            '{ellipsoid: {semi_axes: [0.01103, 0.01168, 0.001095]}}}',
            'sliding_friction: {mu: 2.705}', '{euler_zyz: [-2.657, 0.3583, 1.29], '
            'angular_velocity: [-0.62, 5.143, -6.533], rolling: true}',
            '{table: {normal: [0.2942, -1.038, 1.0], restitution: 0.5}}', accuracy, horizon=0.1)
        with pytest.raises(NotConverged, match="Painleve's paradox at t = ") as error:
            sim.states([0.1])
        times.append(float(re.search(r't = (\S+) s', str(error.value)).group(1)))
    # measured: 6e-12
    assert times == pytest.approx([0.0508575925553] * 2, abs=1e-10)


def test_a_disk_whose_film_no_step_follows_ends_the_run_where_it_counts_as_low():
    """Its steps were too short from 1.1e-3 rad on, and it was let slide on its face below 1e-3."""
    sim = simulation(
        '{mass: 0.001, inertia: [1.689713678359953e-05, 1.689713678359953e-05, '
        '3.379427356719906e-07], surface: {disk: {radius: 0.3}}}',
        'sliding_friction: {mu: 0.0238}, air_film: {viscosity: 0.00769974}',
        '{euler_zyz: [0.2442, 2.0181, -1.1886], angular_velocity: [0, 0, -69.2315], '
        'velocity: [0.0219, 0.627, 0]}',
        '{table: {normal: [-0.533, -0.18, 1], restitution: 0.95}}', 1e-9, rate=20.0)
    for _ in range(8):
        sim.advance()    # a million steps in all: each call may take as many
    with pytest.raises(NotConverged, match=r'at t = 0\.446\d* s the body lies flat and goes on'):
        sim.advance()


def test_a_strike_into_the_paradox_ends_the_run_at_an_event():
    """The rod is dragged; the strike pushes it the other way."""
    sim = simulation(ROD, 'sliding_friction: {mu: 2.5}, strike: {impulse: [-8, 0, 0], '
                     'time: 0.01}', '{euler_zyz: [0, 0.5, 0], velocity: [4.0, 0, 0]}',
                     accuracy=1e-9)
    assert any('mu_P = 1.33' in note for note in sim.scene.notes)
    sim.advance(9)
    assert not sim.events
    with pytest.raises(NotConverged) as error:
        sim.advance(5)
    assert "Painleve's paradox at t = 0.01 s" in str(error.value)
    assert '\n' not in str(error.value)
    assert sim.time == 0.009    # what can be said is kept
    assert np.isfinite(sim.vector).all()


INTO_THE_PARADOX = {
    'ellipsoid': (
        '{mass: 1.0, inertia: [2.705318977635444e-07, 6.713395096572897e-07, '
        '6.816440379649026e-07], surface: {ellipsoid: {semi_axes: [0.004169891449125548, '
        '0.0015968861737440567, 0.0026735185721027867]}}}',
        'sliding_friction: {mu: 1.0}, rolling_friction: {dry: 5.26e-06, viscous: 1.32e-08}',
        '{euler_zyz: [2.6441, 0.6523, 0.8371], angular_velocity: [1.61855, 1.25898, 0.584144]}',
        'table', 6.3083817735177e-05),
    'offset sphere': (
        '{mass: 1.0, inertia: [1.456854700328873e-06, 1.0370910978262565e-06, '
        '1.7667106069190764e-06], center_of_mass: [0.00841081, -0.00546418, -0.00076352], '
        'surface: {sphere: {radius: 0.02}}}',
        'sliding_friction: {mu: 0.989}, rolling_friction: {dry: 0.000695, viscous: 6.92e-06}',
        '{angular_velocity: [9.68304e-06, 1.12321e-05, 1.13116e-06], '
        'velocity: [0.118, -0.139, 0]}',
        'table', 0.009524563056909),
    'disk': (
        '{mass: 1.0, inertia: [0.0005496551373514943, 0.0005496551373514943, '
        '0.0010982109644282858], center_of_mass: [-0.023402, 0.0221735, 0], '
        'surface: {disk: {radius: 0.05}}}',
        'sliding_friction: {mu: 0.994}, air_film: {viscosity: 0.000294083}', '{}',
        '{table: {normal: [-0.926, 0.489, 1], restitution: 0.5}}', 0.3039164719267)}


# each is compiled anew in every process that has a case, for longer than plain Python takes
@pytest.mark.without_numba
@pytest.mark.parametrize(('name', 'accuracy'), [
    ('ellipsoid', 1e-7), ('offset sphere', 1e-12), *(
        pytest.param(*one, marks=IN_SOAK) for one in itertools.product(
            INTO_THE_PARADOX, [1e-7, 1e-9, 1e-10, 1e-12])
        if one not in (('ellipsoid', 1e-7), ('offset sphere', 1e-12)))])
def test_a_slip_that_turns_into_the_paradox_ends_the_run_at_every_accuracy(name, accuracy):
    """A falls to 0 like the root of the time that is left, and N rises without bound.

    Behind that N is negative, as A is: rounding said whether it was the paradox, a lift-off, or
    a step that no size made small enough.
    """
    body, effects, initial, table, time = INTO_THE_PARADOX[name]
    sim = simulation(body, effects, initial, table, accuracy, horizon=1.0)
    with pytest.raises(NotConverged, match="Painleve's paradox at t = ") as error:
        sim.states([0.5])
    found = float(re.search(r't = (\S+) s', str(error.value)).group(1))
    assert found == near(time, rel=1e-12 + accuracy)    # measured: 8e-14; 5e-11 at 1e-7


@pytest.mark.without_numba
@pytest.mark.parametrize('accuracy', [1e-9, 1e-3])
def test_a_body_that_viscous_rolling_friction_lifts_ends_the_run_in_one_line(accuracy):
    """N vanishes under a couple that does not: the body left and came back without end.

    At a coarse accuracy one step of the flight led through the plane and out of it.
    """
    scene = parse_scene("""
scene: lifted
body:
  mass: 0.01
  inertia: [2.7e-4, 3.15e-4, 3.6e-4]
  center_of_mass: [-0.0733, 0.0823, -0.0209]
  surface: {sphere: {radius: 0.3}}
constraint: {table: {normal: [0, 0.6, 0.8]}}
effects: [gravity: {g: 9.81}, sliding_friction: {mu: 0.6}, rolling_friction: {viscous: 0.001}]
initial:
  orientation: [-0.618138779940398, -0.531468910521077, -0.274728697712324, -0.509871933466263]
  velocity: [0.792620801608891, 2.71581061988097, -2.03685796491073]
  angular_velocity: [-0.783245452759793, -5.21900664290315, -10.670457455845]
""")
    sim = Simulation(scene, 'dop8', accuracy, horizon=1.0)
    sim.states([0.007])
    with pytest.raises(NotConverged, match=r'at t = 0\.0074728889\d* s viscous rolling friction '
                                           r'or a film of air lifts the body'):
        sim.states([0.01])


@pytest.mark.without_numba
def test_a_slip_that_begins_where_its_direction_turns_fast_errs_as_asked():
    """The direction of a patch lags far behind that of a slow slip, where the spin begins first.

    A creep of 1e-7 of the speeds lagged by more than the first order holds: the answers differed
    by 4e-7.
    """
    scene = parse_scene("""
scene: ellipsoid
body: {mass: 0.3, shape: {ellipsoid: {semi_axes: [0.3, 0.21, 0.15]}}}
constraint: {table: {normal: [0, 0.6, 0.8]}}
effects:
- gravity: {g: 9.81}
- sliding_friction: {mu: 0.6}
- rolling_friction: {dry: 0.05}
- spinning_friction: {radius: 0.003}
initial:
  orientation: [-0.776059443413, -0.004483339555, 0.001865532146, -0.630641070456]
  angular_velocity: [-12.919755304916, -0.055826327595, 0.021049798708]
  rolling: true
""")
    times = [0.0165, 0.03]    # in the slip, and after the lift-off
    coarse, fine = (Simulation(scene, 'dop8', accuracy, horizon=1.0).states(times).vector
                    for accuracy in (1e-9, 1e-12 if SOAK else 1e-10))
    assert np.abs(coarse - fine).max() < 1e-9    # measured: 2e-11


@pytest.mark.without_numba
@pytest.mark.parametrize('accuracy', [1e-6, 1e-9])
def test_a_body_that_sticks_in_an_impact_and_cannot_roll_on_slips(accuracy):
    """Rolling would need a plane that pulls, and without contact the body would fall back.

    A hoop came down so and flew through the plane, 1e-6 m deep: it never slipped, and lifted off
    1.3 ms too early.
    """
    sim = simulation('{mass: 5.0, shape: {hoop: {radius: 0.3}}}', 'sliding_friction: {mu: 0.3}',
                     '{euler_zyz: [0.085, 1.049, 2.433], rolling: true, '
                     'angular_velocity: [-10.798, -17.277, 4.99]}', accuracy=accuracy, horizon=0.7)
    sim.advance(680)
    events = [(event.name, event.time) for event in sim.events]
    assert [name for name, _ in events] == [
        'lift-off', 'impact', 'lift-off', 'impact', 'impact', 'lift-off']
    assert events[-2][1] == pytest.approx(0.6280933616986, abs=10.0 * accuracy)
    assert events[-1][1] == pytest.approx(0.6293950717486, abs=10.0 * accuracy)


@IN_SOAK
@pytest.mark.parametrize('accuracy', [1e-3, 1e-9])
def test_a_creep_of_a_patch_that_dies_leaves_no_spin(accuracy):
    """Its spin erred by 1e-11 of the speeds: a slip of that size took a million steps to die."""
    sim = simulation('{mass: 0.3, shape: {hoop: {radius: 0.05}}}',
                     'sliding_friction: {mu: 0.2}, rolling_friction: {dry: 0.001, '
                     'viscous: 0.001}, spinning_friction: {radius: 0.0005}',
                     '{euler_zyz: [2.212, 1.329, 0.326]}',
                     '{table: {normal: [0.1, -0.05, 1.0]}}', accuracy, horizon=1.0)
    sim.advance(60)
    assert [event.name for event in sim.events] == ['rolling began']
    assert sim.events[0].time == pytest.approx(0.02730808, abs=2e-6)
    assert abs(sim.ledger()['energy_residual']) < max(1e-12, 1e-6 * accuracy)


@pytest.mark.parametrize(('patch', 'spin'), [(0.001, 10.0), (0.002, 30.0), (0.001, 36.0)])
def test_the_spin_of_a_patch_dies_on_a_slope_when_its_quadrature_says(patch, spin):
    """The slip of a sphere dies at the slow pace of the spin, and its direction relaxes fast.

    With W = rho w, x = u/W and dt = W sqrt(1 + x^2) ds: W' = -D W and
    x' = g sin a sqrt(1 + x^2) - (B - D) x, where B = 7/2 mu g cos a and
    D = 5/2 mu g cos a rho^2/R^2. Steps followed the rounding of the spin at last.
    """
    radius, mu, sine, cosine = 0.02, 0.6, 0.6, 0.8
    sim = simulation(
        f'{{mass: 1.0, shape: {{solid_sphere: {{radius: {radius}}}}}, '
        f'surface: {{sphere: {{radius: {radius}}}}}}}',
        f'sliding_friction: {{mu: {mu}}}, spinning_friction: {{radius: {patch}}}',
        f'{{angular_velocity_world: [0, {sine * spin}, {cosine * spin}], rolling: true}}',
        f'{{table: {{normal: [0, {sine}, {cosine}]}}}}', 1e-11, horizon=2.0)
    fast, slow = 3.5 * mu * G * cosine, 2.5 * mu * G * cosine * (patch / radius) ** 2

    def rates(s, y):
        grown = math.sqrt(1.0 + y[0] * y[0])
        return [G * sine * grown - (fast - slow) * y[0],
                patch * spin * math.exp(-slow * s) * grown]

    solved = solve_ivp(rates, (0.0, 60.0 / slow), [0.0, 0.0], 'Radau', rtol=1e-12, atol=1e-14)
    event = sim.at_event('rolling began', within=2.0)
    assert event.time == pytest.approx(solved.y[1, -1], abs=1e-12)    # measured: 4e-15


@pytest.mark.without_numba
@pytest.mark.parametrize('method', ['dop8', 'taylor', 'gauss16'])
@pytest.mark.parametrize(('mu', 'name'), [(0.1, 'sliding began'), (0.4, 'rolling began')])
def test_a_slip_that_turns_round_does_not_roll(method, mu, name):
    """A ball slides up a slope of tan a = 1, and friction can hold it there if mu > 2/7.

    The slip u falls at g (sin a + 7/2 mu cos a) until it is 0. Below 2/7 it grows again, downhill,
    and the event was "rolling began", though nothing rolls.
    """
    sim = Simulation(parse_scene(
        'scene: hard\nbody: {mass: 1.0, shape: {solid_sphere: {radius: 0.1}}, '
        'surface: {sphere: {radius: 0.1}}}\nconstraint: {table: {normal: [-1, 0, 1]}}\n'
        f'effects: [gravity: {{g: {G}}}, sliding_friction: {{mu: {mu}}}]\n'
        'initial: {velocity: [1.0, 0, 1.0]}\n'), method, 1e-9)
    sim.advance(800)
    assert [event.name for event in sim.events] == [name]
    # measured: 2e-16
    assert sim.events[0].time == pytest.approx(2.0 / (G * (1.0 + 3.5 * mu)), abs=1e-14)
    up = sim.events[0].time
    grown = (0.8 - up) * G / math.sqrt(2.0) * (1.0 - 3.5 * mu if mu < 2.0 / 7.0 else 0.0)
    slip = -sim.state.velocity[0] * math.sqrt(2.0) + 0.1 * sim.state.angular_velocity[1]
    assert slip == pytest.approx(grown, abs=1e-12)    # measured: 2e-15


@pytest.mark.parametrize('accuracy', [1e-6, pytest.param(1e-10, marks=IN_SOAK)])
def test_a_spin_that_the_body_turns_round_has_no_event_at_any_accuracy(accuracy):
    """Its patch slips on through 0: "rolling began" was told where steps followed the slip."""
    normal = np.array([0.4, -0.177, 1.0]) / math.sqrt(0.16 + 0.177 ** 2 + 1.0)
    sim = Simulation(parse_scene(
        'scene: hard\nbody: {mass: 13.8, inertia: [[0.018, -0.0025, 0.00034], '
        '[-0.0025, 0.0163, 0.00027], [0.00034, 0.00027, 0.0132]], '
        'center_of_mass: [0.0006, -0.0068, 0.0094], surface: {sphere: {radius: 0.0429}}}\n'
        'constraint: {table: {normal: [0.4, -0.177, 1.0], restitution: 0.5}}\n'
        'effects: [gravity: {g: 25.0}, sliding_friction: {mu: 0.5}, '
        'spinning_friction: {radius: 0.0035}]\n'
        'initial: {angular_velocity: [-10.88, -0.924, 2.4585], position: [0, 0, 0.165], '
        'velocity: [-0.961, -0.957, 0.53]}\n'), 'dop8', accuracy)
    sim.advance(600)
    assert {event.name for event in sim.events} == {'impact'}
    states = sim.states(np.arange(sim.events[-1].time, 0.6, 2e-3))
    spins = [np.dot(rotate_back(*q, *normal), omega)
             for q, omega in zip(states.orientation, states.angular_velocity, strict=True)]
    assert min(spins) < -1.0 and max(spins) > 1.0    # rad/s; in contact all the time
