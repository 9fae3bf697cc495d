# SPDX-License-Identifier: Apache-2.0
"""The motion that a report plays: which frames, and lengths relative to the body's reach."""

import math
import types

import numpy as np
import pytest

from rigid_body_sim.analysis import moving
from rigid_body_sim.scene.scene import parse_scene

STILL = [0.0, 0.0, 0.0, 1.0]


def columns(times, fastest):
    """Return the columns of a motion about x that is fastest in the middle."""
    times = np.asarray(times, dtype=float)
    omega = np.zeros((len(times), 3))
    omega[len(times) // 2] = (0.6 * fastest, 0.0, 0.8 * fastest)
    return times, np.tile(STILL, (len(times), 1)), omega, np.zeros((len(times), 3))


def frames_of(samples, head=None):
    """Return the times of the frames of a recording."""
    held = [types.SimpleNamespace(columns=lambda one=one: one) for one in (samples, head)]
    measured = types.SimpleNamespace(
        motion=types.SimpleNamespace(samples=held[0], head=held[1]),
        source=types.SimpleNamespace(scene=None))
    return moving.moving(measured).times


def test_without_states_nothing_is_played():
    empty = types.SimpleNamespace(samples=types.SimpleNamespace(columns=tuple))
    for motion in (None, empty):
        assert moving.moving(types.SimpleNamespace(motion=motion)) is None


@pytest.mark.parametrize(('fastest', 'whole', 'which'), [
    (1.6, [0.0, 0.5, 0.75], 'whole'), (1.61, [0.0, 0.5, 0.75], 'head'),
    (1.61, [0.0, 0.5], 'head')])
def test_the_beginning_is_played_where_the_whole_is_too_coarse(fastest, whole, which):
    """From one frame to the next the body turns by 0.8 rad at most: 1.6 rad/s for 0.5 s."""
    head = [0.0, 0.25, 0.5]
    played = frames_of(columns(whole, fastest), columns(head, fastest))
    assert list(played) == (whole if which == 'whole' else head)


@pytest.mark.parametrize(('ticks', 'turn', 'step', 'frames'), [
    (2400, 1.0 / 64.0, 9, 267),         # 0.15 rad a frame
    (2400, 0.25, 1, 2400),              # it turns by more
    (1990, 1.0 / 128.0, 9, 222),        # 200 frames at least
    (24_000, 0.1, 8, 3000),             # 3000 at most: with 0.8 rad a frame it is whole
    (24_001, 0.1, 1, 3000),             # with more it is the beginning
    (9001, 0.125, 4, 2251), (9000, 0.125, 3, 3000),
    (2, 1.0, 1, 2), (3, 0.0, 1, 3), (1, 1.0, 1, 1)])
def test_the_frames_suffice_to_see_the_turn_and_are_few(ticks, turn, step, frames):
    times = 5.0 + np.arange(ticks) / 64.0
    samples = columns(times, 64.0 * turn)
    played = frames_of(samples, samples)
    assert np.array_equal(played, times[::step][:frames]) and len(played) == frames


def motion(scene, omega, orientation=STILL, position=(0.0, 0.0, 0.0)):
    """Return the Moving of one tick, or of several values of omega."""
    omega = np.atleast_2d(omega).astype(float)
    several = (len(omega), 1)
    return moving.Moving(np.full(len(omega), 0.123456789), np.tile(orientation, several), omega,
                         np.tile(position, several), scene)


def test_the_arrow_of_omega_is_in_world_axes_and_relative_to_its_longest():
    turned = [0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5)]    # x to y
    [arrow] = motion(None, [[4.0, 0.0, 0.0], [0.0, 0.0, -1.0 / 3.0]], turned).data()['arrows']
    assert arrow['values'] == [[0.0, 1.35, 0.0], [0.0, 0.0, -0.1125]]
    [arrow] = motion(None, [[3.0, 0.0, 0.0], [0.0, 0.0, -1.0]], turned).data()['arrows']
    assert arrow['values'][1] == [0.0, 0.0, -0.45]
    [arrow] = motion(None, [[7.0, 0.0, 0.0], [0.0, 0.0, -1.0]], turned).data()['arrows']
    assert arrow['values'][1] == [0.0, 0.0, -0.1929]    # 1.35/7 = 0.192857, in 4 digits
    assert np.max(arrow['mesh']['points'], axis=0)[2] == 1.0
    [still] = motion(None, [[0.0, 0.0, 0.0]]).data()['arrows']
    assert still['values'] == [[0.0, 0.0, 0.0]]


BOX = """
scene: one
body: {parts: [{mass: 3.0, shape: {box: {size: [0.6, 0.4, 0.2]}}, at: [0, 0, 0.5]}]}
constraint: CONSTRAINT
effects: [gravity: {g: 9.81}, spring: {at: [0.3, 0, 0.5], anchor: [0, 0.7, 2], stiffness: 4.0}]
initial: {angular_velocity: [3.0, 0.0, 3.0]}
"""
"""Moments about the centre of mass: M (b^2 + c^2)/12 = 0.05, 0.10, 0.13."""


@pytest.mark.parametrize(('constraint', 'moments'), [
    ('free', (0.05, 0.10, 0.13)),
    ('pivot', (0.80, 0.85, 0.13))])     # about the pivot, M 0.5^2 more across
def test_the_arrow_of_momentum_is_about_the_centre_of_mass_or_the_point_held(constraint, moments):
    text = BOX.replace('CONSTRAINT', constraint)
    _, arrow = motion(parse_scene(text), [3.0, 0.0, 3.0]).data()['arrows']
    size = math.hypot(moments[0], moments[2])
    # 0.8 times the length of the longest arrow; 4 digits
    assert arrow['values'] == [pytest.approx(
        [1.08 * moments[0] / size, 0.0, 1.08 * moments[2] / size], abs=5.1e-5)]


def test_lengths_are_relative_to_the_reach_and_rounded():
    reach = math.hypot(0.3, 0.2, 0.1)
    scene = parse_scene(BOX.replace('CONSTRAINT', 'free'))
    data = motion(scene, [3.0, 0.0, 3.0], [0.1234567, 0.0, 0.0, 0.9923497],
                  (0.1, 0.2, 0.3)).data()
    assert data['times'] == [0.1234568] and data['orientation'] == [[0.12346, 0.0, 0.0, 0.99235]]
    assert data['position'] == [[round(one / reach, 5) for one in (0.1, 0.2, 0.3)]]
    assert data['middle'] == [0.0, 0.0, round(0.5 / reach, 6)]
    assert data['start'] == [0.0, 0.0, round(0.5 / reach, 6)]
    assert data['springs'] == [{'at': [round(0.3 / reach, 5), 0.0, round(0.5 / reach, 5)],
                                'anchor': [0.0, round(0.7 / reach, 5), round(2.0 / reach, 5)]}]
    assert data['floor'] == pytest.approx(0.5 / reach - 1.1, abs=1e-12)
    assert data['cell'] == pytest.approx(0.2 / reach, abs=1e-12) and data['follow'] is True
    # the middle axis is y, on which the box ends at 0.2; its trace is 0.7 away at least
    assert data['traced'] == 'middle axis'
    assert data['axis'] == [0.0, 0.7, 0.0]
    [box] = data['surfaces']
    assert np.max(np.abs(box['points']), axis=0) == pytest.approx(
        [0.3 / reach, 0.2 / reach, 0.6 / reach], abs=5.1e-6)


def test_the_trace_of_a_long_axis_is_just_outside_the_body():
    scene = parse_scene(BOX.replace('CONSTRAINT', 'free').replace('[0.6, 0.4, 0.2]',
                                                                  '[0.4, 0.6, 0.2]'))
    scene_of_long = parse_scene(BOX.replace('CONSTRAINT', 'free').replace(
        'shape: {box: {size: [0.6, 0.4, 0.2]}}', 'shape: {cylinder: {radius: 0.3, length: 0.8}}'))
    assert motion(scene, [1.0, 0.0, 0.0]).data()['traced'] == 'middle axis'
    data = motion(scene_of_long, [1.0, 0.0, 0.0]).data()
    assert data['traced'] == 'symmetry axis'
    assert data['axis'] == [0.0, 0.0, round(1.15 * 0.4 / 0.5, 5)]


def test_the_arrows_are_told_apart_by_the_colour_blind():
    """They have Okabe and Ito's vermillion and bluish green; L is thicker and shorter."""
    assert list(moving.ARROWS.values()) == [
        pytest.approx(np.array(color) / 255.0, abs=0.006)
        for color in ((0xd5, 0x5e, 0x00), (0x00, 0x9e, 0x73))]
    scene = parse_scene(BOX.replace('CONSTRAINT', 'free'))
    thin, thick = (np.array(one['mesh']['points'])
                   for one in motion(scene, [3.0, 0.0, 3.0]).data()['arrows'])
    # the head is the widest: 2.5 times the shaft's 0.018 and 0.028
    assert (thin[:, 0].max(), thick[:, 0].max()) == (0.045, 0.07)


def test_an_arrow_has_length_one_and_a_head_of_two_and_a_half_shafts():
    points = moving._arrow(0.02).vertices
    across = np.hypot(points[:, 0], points[:, 1])
    assert points[:, 2].min() == pytest.approx(0.0, abs=1e-12)
    assert points[:, 2].max() == pytest.approx(1.0, abs=1e-12)
    assert sorted(set(np.round(across, 9))) == [0.0, 0.02, 0.05]
    assert set(np.round(points[across > 0.03, 2], 9)) == {0.86}
    assert set(np.round(points[np.abs(across - 0.02) < 1e-9, 2], 9)) == {0.0, 0.86}
    shaft = np.array(motion(None, [0.0, 0.0, 1.0]).data()['shaft']['points'])
    assert [*shaft.min(axis=0), *shaft.max(axis=0)] == pytest.approx(
        [-0.012, -0.012, 0.0, 0.012, 0.012, 1.0], abs=1e-9)
