# SPDX-License-Identifier: Apache-2.0
"""A body that springs twist about its hinge, beside its equation in mpmath; what is absorbed."""

import math

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.spatial.transform import Rotation

from rigid_body_sim.motions import torsion_pendulum as motion
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba
MOMENT = 0.375
TURNED = (0.1, -0.5, 0.7, 0.5)
SPRING = 'spring: {stiffness: 6, angle: 0.25, damping: 0}'


def scene_of(effects, angle=0.75, rate=2.0, axis='[0, 0, 1]', through='[0.1, 0.2, 0]'):
    return parse_scene(
        f'scene: a\nbody: {{mass: 2, inertia: [0.4, 0.3, {MOMENT}], '
        'center_of_mass: [0.1, 0.2, -0.3]}\n'
        f'constraint: {{hinge: {{axis: {axis}, through: {through}}}}}\neffects: [{effects}]\n'
        f'initial: {{orientation: {list(TURNED)}, angle: {angle}, rate: {rate}}}\n')


def swung(x0, v0, restoring, slowing, t):
    """Return x and x' of x'' = -restoring x - slowing x', with 60 digits."""
    with mp.workdps(60):
        x, v, w2, r, t = map(mpf, (x0, v0, restoring, slowing, t))
        root = mpmath.sqrt(mpmath.mpc(r * r / 4 - w2))
        if root == 0:
            e = mpmath.exp(-r * t / 2)
            return e * (x + (v + r * x / 2) * t), e * (v - (v + r * x / 2) * r * t / 2)
        first, second = -r / 2 + root, -r / 2 - root
        a = (v - second * x) / (first - second)
        e, f = a * mpmath.exp(first * t), (x - a) * mpmath.exp(second * t)
        return (e + f).real, (first * e + second * f).real


def at(scene, times, start=0.0):
    """Return the states at times of the motion that begins at a time, s."""
    vector, anchor = scene.initial.vector.copy(), np.empty(motion.ANCHOR_SIZE)
    vector[0] = start
    motion.anchor(motion.parameters(scene), vector, anchor)
    out = np.empty((len(times), 14))
    for time, row in zip(times, out, strict=True):
        motion.state(anchor, float(time), row)
    return out


@pytest.mark.parametrize(('damping', 'times'), [
    # 3 is critical: the root of 16 - (c/I)^2/4 is 0 there
    (0.0, (0.0, 1e-3, 0.3, 7.0, 1e6, 1e10)), (0.1, (1e-3, 0.3, 7.0, 100.0)),
    (2.999999, (1e-3, 0.3, 2.0, 7.0)), (3.0, (1e-3, 0.3, 2.0, 7.0)),
    (3.000001, (1e-3, 0.3, 2.0, 7.0)), (30.0, (1e-6, 1e-3, 0.3, 7.0, 40.0)),
    (1e6, (1e-7, 1e-3, 0.3, 1e4, 1e6))])
def test_it_swings_and_creeps_as_its_equation_says(damping, times):
    scene = scene_of(SPRING.replace('damping: 0', f'damping: {damping!r}'))
    start = scene.initial.vector
    turned = Rotation.from_quat(start[1:5])
    for time, state in zip(times, at(scene, 0.25 + np.array(times), 0.25), strict=True):
        # what the sum of 0.25 s and the time loses does not count
        after = (0.25 + time) - 0.25
        x, rate = swung(0.75 - 0.25, 2.0, 16.0, damping / MOMENT, after)
        moved = Rotation.from_rotvec([0.0, 0.0, float(x - mpf('0.5'))])
        assert (Rotation.from_quat(state[1:5]) * (turned * moved).inv()).magnitude() < 1e-15
        assert abs(state[7] - float(rate)) < 4e-15
        assert not state[5:7].any()


@pytest.mark.parametrize('axis', [(0.0, 0.0, 1.0), (0.48, -0.6, 0.64), (-0.64, 0.48, 0.6)])
def test_all_that_acts_along_the_axis_counts(axis):
    """Two springs, a torque in each kind of axes, and drag."""
    effects = ('spring: {stiffness: 6, angle: -0.5, damping: 0.25}, spring: {stiffness: 2}, '
               'torque: {value: [7, 3, 0.5]}, torque: {value: [0.5, 0.25, 1], frame: world}, '
               'drag: {angular: 0.125}')
    scene = scene_of(effects, axis=list(axis), through='[0.1, 0.2, -0.3]')
    q = Rotation.from_quat(scene.initial.vector[1:5])
    moment = math.fsum(one * n * n for one, n in zip((0.4, 0.3, MOMENT), axis, strict=True))
    torque = np.dot(axis, (7.0, 3.0, 0.5)) + np.dot(axis, q.inv().apply([0.5, 0.25, 1.0]))
    rest = (6.0 * -0.5 + torque) / 8.0
    for state in at(scene, [0.5, 3.0]):
        x, rate = swung(0.75 - rest, 2.0, 8.0 / moment, 0.375 / moment, state[0])
        moved = Rotation.from_rotvec(float(x - (mpf('0.75') - mpf(rest))) * np.array(axis))
        # half an ulp of the moment turns it by 1e-15 rad in 3 s; measured: 4e-16, 3e-16
        assert (Rotation.from_quat(state[1:5]) * (q * moved).inv()).magnitude() < 2e-15
        assert np.abs(state[5:8] - float(rate) * np.array(axis)).max() < 2e-15
        # the point on the axis stays
        held = Rotation.from_quat(state[1:5]).apply([0.1, 0.2, -0.3]) + state[8:11]
        assert np.abs(held).max() < 1e-15


@pytest.mark.parametrize(('effects', 'options', 'absorbed'), [
    (SPRING, {}, True), ('spring: {stiffness: 0, damping: 1}', {}, False),
    (f'{SPRING}, torque: {{value: [0, 0, 1]}}', {}, True),
    (f'{SPRING}, torque: {{value: [0, 0, "sin(t)"]}}', {}, False),
    (f'{SPRING}, dry_friction: {{torque: 0.1}}', {}, False),
    # the centre of mass lies on the axis, beside it, or beside one that stands upright
    (f'{SPRING}, gravity: {{g: 9.81}}', {}, True),
    (f'{SPRING}, gravity: {{g: 9.81}}', {'through': '[0, 0, 0]'}, False),
    (SPRING, {'through': '[0, 0, 0]'}, True),
    # x = 0.5 and v/sqrt(16) = 0.5 about 0.25: 0.96 rad; beyond 2 pi it goes on from the other end
    (SPRING, {'rate': 24.0}, True), (SPRING, {'rate': 24.2}, False),
    (SPRING.replace('0.25', '6.5'), {}, False)])
def test_what_is_absorbed(effects, options, absorbed):
    assert motion.absorbs(scene_of(effects, **options)) is absorbed


@pytest.mark.parametrize(('below', 'taken'), [(2.0 ** -19, True), (2.0 ** -21, False)])
def test_a_state_is_taken_that_swings_to_a_millionth_of_the_end_of_its_angle(below, taken):
    """It has x = 0.5 rad about 0.25, and a rate that would take it farther without damping."""
    scene = scene_of(SPRING)
    start, swing = scene.initial.vector.copy(), 2.0 * math.pi * (1.0 - below) - 0.25
    start[7] = -4.0 * math.sqrt(swing * swing - 0.25)
    assert motion.takes(scene, start) is taken


def test_a_scene_is_run_by_it_and_a_strike_that_winds_it_up_is_followed_on():
    """The ledger books its springs, and turning points are where its rate changes its sign."""
    one = Simulation(scene_of(SPRING.replace('damping: 0', 'damping: 0.0625')), horizon=10.0)
    assert (one.choice.method, one.choice.solver(one.vector, None).motion) == ('exact', motion)
    one.advance(1500)
    ledger = one.ledger()
    assert abs(ledger['energy_residual']) < 2e-15                                  # 2e-16
    assert ledger['momentum_residual'] < 1e-13                                     # 3e-15
    gamma = 0.0625 / (2.0 * MOMENT)
    omega = math.sqrt(16.0 - gamma * gamma)
    first = math.atan2(2.0 * omega, 16.0 * 0.5 + gamma * 2.0) / omega
    assert [event.time for event in one.events] == pytest.approx(
        [first, first + math.pi / omega], rel=0.0, abs=1e-14)
    one.impulse(torque=(0.0, 0.0, 40.0), frame='body')
    assert one.choice.solver(one.vector, None).name != 'exact'
    one.advance(20)
    assert abs(one.ledger()['energy_residual']) < 1e-11
