# SPDX-License-Identifier: Apache-2.0
"""Hard cases of a convex body on a plane, each against a closed form.

Grazing, one tick that holds several events, no friction, nearly flat, nearly round, long rolling,
and Painleve's paradox in the middle of a run. Chatter to the Zeno point, a spin about the normal
only and strikes at the moment of sticking are in test_convex_body.py, with which the scenes share
one compilation.
"""

import math

import mpmath as mp
import numpy as np
import pytest

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.numerics.rotations import rotate, rotate_back
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
    # N is a sum of parts up to 14 weights, and falls at its rate there
    falls = abs(float(mp.diff(lambda x: normal(x, E), angle) * mp.sqrt(square(angle, E))))
    assert time == pytest.approx(float(true), abs=14.0 * 4.0 * HALF_ULP / falls + 2e-16)
