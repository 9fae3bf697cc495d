# SPDX-License-Identifier: Apache-2.0
"""Turning about a fixed axis beside its formulas in mpmath, and what is absorbed."""

import math

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.motions import fixed_axis as motion
from rigid_body_sim.scene.scene import parse_scene

pytestmark = pytest.mark.without_numba
MOMENTS, CENTER = (2.0, 3.0, 4.0), (0.1, 0.2, -0.3)
AXIS = (0.48, -0.6, 0.64)
TURNED = (0.1, -0.5, 0.7, 0.5)
START = 0.25    # s


def scene_of(constraint, effects, spin, center=CENTER, orientation=TURNED, about='center'):
    return parse_scene(
        f'scene: a\nbody: {{mass: 2, inertia: {list(MOMENTS)}, center_of_mass: {list(center)}}}\n'
        f'constraint: {constraint}\neffects: [{effects}]\ninitial: {{orientation: '
        f'{list(orientation)}, {spin}}}\n')


def anchored(scene):
    """Return the anchor of a motion that begins at START, and the state there."""
    start, anchor = scene.initial.vector.copy(), np.empty(motion.ANCHOR_SIZE)
    start[0] = START
    motion.anchor(motion.parameters(scene), start, anchor)
    return anchor, start


def at(anchor, time):
    out = np.empty(14)
    motion.state(anchor, time, out)
    return out


def relaxed(first, growth, slowing, t):
    """Return y and its integral from 0 of y' = growth - slowing y, with 40 digits."""
    with mp.workdps(40):
        y, g, r, t = mpf(first), mpf(growth), mpf(slowing), mpf(t)
        if r == 0:
            return y + g * t, y * t + g * t * t / 2
        gone = (1 - mpmath.exp(-r * t)) / r
        return y * mpmath.exp(-r * t) + g * gone, y * gone + g * (t - gone) / r


def angle_error(state, start, axis, angle):
    """Return the angle (rad) from a state's attitude to the start's turned by `angle`."""
    with mp.workdps(40):
        half = float(mpmath.fmod(angle, 4 * mp.pi) / 2)
    x, y, z = math.sin(half) * np.array(axis)
    expected = Rotation.from_quat(start[1:5]) * Rotation.from_quat([x, y, z, math.cos(half)])
    return (Rotation.from_quat(state[1:5]) * expected.inv()).magnitude()


@pytest.mark.parametrize('slowing', ['drag: {linear: 0.5, angular: 0.9}', ''])
@pytest.mark.parametrize('frame', ['body', 'world'])
@pytest.mark.parametrize('time', [-1.5, 0.25, 9.0, 2e5])
def test_a_free_body_turns_and_flies_by_the_formulas(slowing, frame, time):
    """Its moment is 3 about the second axis, its mass 2; the torque 0.75 is along that axis."""
    q = Rotation.from_quat(TURNED)
    torque = [0, 0.75, 0] if frame == 'body' else q.apply([0.0, 0.75, 0.0]).tolist()
    scene = scene_of('free', f'gravity: {{g: 9.75}}, torque: {{value: {torque}, frame: {frame}}}'
                     f'{", " * bool(slowing)}{slowing}',
                     'angular_velocity: [0, 1.5, 0], velocity: [3, -2, 5], position: [1, 2, 3]')
    assert motion.absorbs(scene)
    anchor, start = anchored(scene)
    state, t = at(anchor, time), time - START
    with mp.workdps(40):
        r, s = (mpf(0.9) / 3, mpf(0.25)) if slowing else (mpf(0), mpf(0))
        rate, angle = relaxed(1.5, 0.25, r, t)
    # of a torque in world axes the part along the axis is rounded
    allowed = 1e-15 if frame == 'body' else 1e-15 * (4.0 + abs(float(angle)))
    assert angle_error(state, start, (0.0, 1.0, 0.0), angle) < allowed
    assert state[0] == time
    assert state[5:8] == pytest.approx([0.0, float(rate), 0.0], abs=4e-15 * abs(float(rate)))
    begun, arm = Rotation.from_quat(start[1:5]), np.array(CENTER)
    center = start[8:11] + begun.apply(arm)
    moving = start[11:14] + begun.apply(np.cross([0.0, 1.5, 0.0], arm))
    turned = Rotation.from_quat(state[1:5])
    for k, pull in enumerate((0.0, 0.0, -9.75)):
        v, way = map(float, relaxed(moving[k], pull, s, t))
        assert state[8 + k] == pytest.approx(
            center[k] + way - turned.apply(arm)[k], abs=1e-14 * (9.0 + abs(way)))
        assert state[11 + k] == pytest.approx(
            v - turned.apply(np.cross(state[5:8], arm))[k],
            abs=1e-14 * (9.0 + abs(v) + abs(float(rate))))


@pytest.mark.parametrize('damping', [0.4, 0.0])
@pytest.mark.parametrize('rate', [2.0, -7.0])
def test_a_hinged_body_turns_by_its_moment_about_the_axis_and_back_at_its_time(damping, rate):
    """I = n . (2, 3, 4) n; torques in the body and in the world add up along the axis."""
    scene = scene_of(f'{{hinge: {{axis: {list(AXIS)}}}}}',
                     'torque: {value: [0.5, -1, 0.25]}, torque: {value: [0.3, -0.2, 0.5], '
                     f'frame: world}}, drag: {{angular: {damping}}}', f'rate: {rate}', (0, 0, 0))
    assert motion.absorbs(scene)
    anchor, start = anchored(scene)
    n = np.array(AXIS)
    inertia = n @ (np.array(MOMENTS) * n)
    torque = n @ (np.array([0.5, -1.0, 0.25])
                  + Rotation.from_quat(start[1:5]).inv().apply([0.3, -0.2, 0.5]))
    growth, slowing = torque / inertia, damping / inertia
    for time in (-0.5, 0.25, 1.0, 6.0):
        speed, angle = relaxed(rate, growth, slowing, time - START)
        state = at(anchor, time)
        assert angle_error(state, start, n, angle) < 3e-14
        assert state[5:8] == pytest.approx(float(speed) * n, abs=3e-14)
    expected = math.inf
    if rate * growth < 0.0:
        expected = START + (math.log1p(-slowing * rate / growth) / slowing if damping
                            else -rate / growth)
        assert motion.next_event(anchor, START) == (near(expected, rel=1e-14), 0)
    assert motion.next_event(anchor, max(expected + 1e-9, START)) == (math.inf, 0)


@pytest.mark.parametrize(('effects', 'omega'), [
    ('torque: {value: [0, 0, 0]}', 2.0), ('torque: {value: [0, 1, 0]}', 0.0)])
def test_what_never_turns_back_has_no_event(effects, omega):
    anchor, _ = anchored(scene_of('free', effects, f'angular_velocity: [0, {omega}, 0]'))
    assert motion.next_event(anchor, -1e9) == (math.inf, 0)


HINGE, UP = '{hinge: {axis: [0, 0, 1]}}', (0.0, 0.0, 0.0, 1.0)


@pytest.mark.parametrize(('constraint', 'effects', 'spin', 'absorbed'), [
    ('free', 'torque: {value: [0, 0, 1]}', 'angular_velocity: [0, 0, 2]', True),
    ('free', 'torque: {value: [0, 0, 1]}', 'angular_velocity: [1e-9, 0, 2]', False),
    ('free', 'torque: {value: [0, 0, 1]}', 'angular_velocity: [0, 2, 0]', False),
    ('free', 'torque: {value: [0, 1e-9, 1]}', 'angular_velocity: [0, 0, 2]', False),
    ('free', 'torque: {value: [0, 0, 1], frame: world}', 'angular_velocity: [0, 0, 2]', True),
    ('free', 'torque: {value: [0, 1e-9, 1], frame: world}', 'angular_velocity: [0, 0, 2]', False),
    ('free', 'drag: {angular: 0.5}', 'angular_velocity: [3, 0, 0]', True),
    (HINGE, 'gravity: {g: 9.8}', 'rate: 1', True),
    ('{hinge: {axis: [0, 1, 0]}}', 'gravity: {g: 9.8}', 'rate: 1', False),
    ('{hinge: {axis: [0, 1, 0]}}', 'torque: {value: [1, 2, 3]}', 'rate: 1', True),
    ('pivot', 'torque: {value: [0, 0, 1]}', 'angular_velocity: [0, 0, 2]', False)])
def test_what_stays_about_its_axis_is_absorbed(constraint, effects, spin, absorbed):
    """The centre of mass lies beside the hinge, whose weight is idle where the axis stands up."""
    scene = scene_of(constraint, effects, spin, orientation=UP)
    assert motion.absorbs(scene) is absorbed
    if absorbed:
        assert motion.takes(scene, scene.initial.vector)
        tilted = scene.initial.vector.copy()
        tilted[1:5] = 0.0, math.sin(0.1), 0.0, math.cos(0.1)
        tilted[5:8] += (1e-3, 1e-3, 1e-3)
        assert motion.takes(scene, tilted) == (constraint != 'free' and 'gravity' not in effects)


@pytest.mark.parametrize(('along', 'beside', 'absorbed'), [
    (0.0, 0.0, True), (0.3, 0.0, True), (-2.0, 0.0, True), (0.3, 1e-9, False)])
def test_a_weight_at_any_point_of_the_axis_is_idle(along, beside, absorbed):
    """The hinge is level, and may be held anywhere on the line through the centre of mass."""
    x, y, z = CENTER
    hinge = f'{{hinge: {{axis: [0, 1, 0], through: [{x + beside}, {y + along}, {z}]}}}}'
    scene = scene_of(hinge, 'gravity: {g: 9.8}, drag: {angular: 0.5}', 'rate: 1', orientation=UP)
    assert motion.absorbs(scene) is absorbed
