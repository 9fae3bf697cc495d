# SPDX-License-Identifier: Apache-2.0
"""Lagrange top against the notes, hand calculations and other motions; what it absorbs."""

import json
import math
import types

import numpy as np
import pytest
from tops import HEAVY, ROUND, UPRIGHT, anchored, at, many, scene_of

from rigid_body_sim.motions.lagrange_top import lagrange_top as motion
from rigid_body_sim.motions.pendulum import pendulum
from rigid_body_sim.motions.solver import Exact
from rigid_body_sim.numerics.rotations import from_euler_zyz, rotate, to_euler_zyz
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import STATE_SIZE


@pytest.mark.without_numba
def test_rod_in_a_plane_moves_as_the_hinged_one():
    rod = {'moments': [1.0, 1.0, 0.0], 'mass': 3.0, 'center': [0.0, 0.0, 0.5], 'g': 9.81}
    hinge = parse_scene(json.dumps({
        'scene': 'rod', 'constraint': {'hinge': {'axis': [0.0, 1.0, 0.0]}},
        'effects': [{'gravity': {'g': 9.81}}],
        'body': {'mass': 3.0, 'inertia': [1.0, 1.0, 0.0], 'inertia_about': 'origin',
                 'center_of_mass': [0.0, 0.0, 0.5]},
        'initial': {'angle': 2.0, 'rate': 1.0}}))
    other = np.empty(pendulum.ANCHOR_SIZE)
    for rate in (0.0, 3.0, 6.0, 12.0):
        start = hinge.initial.vector.copy()
        start[6] = rate
        pendulum.anchor(pendulum.parameters(hinge), start, other)
        _, anchor = anchored(rod, start[1:5], start[5:8])
        for time in (0.3, 5.0, 77.0):
            pendulum.state(other, time, start)
            # 6e-15: I_n and I1 round differently
            np.testing.assert_allclose(at(anchor, time)[1:8], start[1:8], rtol=0.0, atol=3e-14)


def test_sleeping_top_sleeps():
    # far below the threshold, but exactly upright
    _, anchor = anchored(HEAVY, UPRIGHT, (0.0, 0.0, 5.0))
    states = many(anchor, [0.0, 1.0, 1e3, 1e6])
    assert not states[:, 1:3].any()
    assert not states[:, 5:7].any()
    assert motion.next_event(anchor, 0.0) == (math.inf, 0)


def test_falling_top_nods_to_the_angle_of_the_notes():
    # ERRATA, "Sleeping top": cos(beta_max) = P_gamma^2/(2 I1 M g l) - 1, from upright with a seed
    _, anchor = anchored(ROUND, [1e-9, 0.0, 0.0, 1.0], (0.0, 0.0, 1.0))
    index = motion.turning_index(anchor, 0.0)
    lowest = index + 1.0 if (index + 1.0) % 2.0 == 0.0 else index + 2.0
    _, beta, _ = to_euler_zyz(*at(anchor, motion.turning_time(anchor, lowest))[1:5])
    assert math.cos(beta) == pytest.approx(1.0 / 2.0 - 1.0, abs=1e-15)


def test_threshold_decides_by_one_ulp():
    # P_gamma^2 = 4 I1 M g l at omega_3 = 2. One ulp below it a tilt of 1e-20 grows e-fold in
    # 6.7e7 s, and up to the 3e-8 rad of the notes' beta_max; at it in proportion to time; above
    # it, it keeps its size
    for omega_3, least, most in ((2.0 - 2.0 ** -52, 2e-8, 4e-8), (2.0, 1e-10, 1.4e-10),
                                 (2.0 + 2.0 ** -51, 1e-20, 1e-12)):
        _, anchor = anchored(ROUND, [1e-20, 0.0, 0.0, 1.0], (0.0, 0.0, omega_3))
        states = many(anchor, np.linspace(0.0, 6e9, 6001))
        assert least <= 2.0 * np.hypot(states[:, 1], states[:, 2]).max() <= most


def test_steady_precession_keeps_its_angle():
    n, beta, k = 20.0, 0.6, 0.981 / 0.03
    rate = 2.0 * k / (n + math.sqrt(n * n - 4.0 * k * math.cos(beta)))
    _, anchor = anchored(
        HEAVY, from_euler_zyz(0.0, beta, 0.0), (-rate * math.sin(beta), 0.0, 60.0))
    for time in (1.0, 100.0):
        alpha, now, _ = to_euler_zyz(*at(anchor, time)[1:5])
        assert now == pytest.approx(beta, abs=3e-15)
        assert math.remainder(alpha - rate * time, 2.0 * math.pi) == pytest.approx(
            0.0, abs=1e-15 * 60.0 * time)
    # the rounding of its start makes no nutation
    assert motion.next_event(anchor, 0.0)[0] == math.inf


def test_without_weight_the_momentum_stays():
    weightless = {**HEAVY, 'g': 0.0}
    scene = scene_of(weightless, effects=[])
    assert motion.absorbs(scene)
    parameters, anchor = anchored(weightless, from_euler_zyz(0.1, 0.5, 0.0), (1.0, 2.0, 3.0))
    np.testing.assert_array_equal(motion.parameters(scene), parameters)
    states = many(anchor, np.linspace(0.0, 1e5, 1001))
    L = np.array([rotate(*state[1:5], *(np.array(HEAVY['moments']) * state[5:8]))
                  for state in states])
    # 9e-16
    np.testing.assert_allclose(
        L, L[:1].repeat(1001, axis=0), rtol=0.0, atol=2e-15 * np.linalg.norm(L[0]))


def reaction(parameters, state):
    out = np.empty(3)
    motion.reaction(parameters, state, out)
    return out


def test_reactions_by_hand():
    parameters, anchor = anchored(HEAVY, UPRIGHT, (0.0, 0.0, 60.0))
    np.testing.assert_allclose(
        reaction(parameters, at(anchor, 3.0)), [0.0, 0.0, 9.81], rtol=1e-15, atol=0.0)
    # released with a level axis: the end of a rod of I1 = M h^2 + I presses with
    # M g (1 - M h^2/I1)
    parameters, anchor = anchored(HEAVY, from_euler_zyz(0.7, math.pi / 2.0, 0.3), (0.0, 0.0, 0.0))
    np.testing.assert_allclose(reaction(parameters, at(anchor, 0.0)),
                               [0.0, 0.0, 9.81 * (1.0 - 0.01 / 0.03)], rtol=0.0, atol=2e-15)
    # a conical pendulum: the weight, and the centripetal force towards the axis at alpha = 0
    n, beta, k = 20.0, 0.6, 0.981 / 0.03
    rate = 2.0 * k / (n + math.sqrt(n * n - 4.0 * k * math.cos(beta)))
    parameters, anchor = anchored(
        HEAVY, from_euler_zyz(0.0, beta, 0.0), (-rate * math.sin(beta), 0.0, 60.0))
    by_hand = [-0.1 * math.sin(beta) * rate * rate, 0.0, 9.81]
    np.testing.assert_allclose(
        reaction(parameters, at(anchor, 0.0)), by_hand, rtol=0.0, atol=2e-14)


@pytest.mark.parametrize(
    'case', [HEAVY, {**HEAVY, 'moments': [0.01, 0.03, 0.03], 'center': [-0.1, 0.0, 0.0]}])
def test_reaction_is_mass_times_acceleration(case):
    parameters, anchor = anchored(case, [0.1, 0.5, -0.3, 0.8], (3.0, -7.0, 5.0))
    time, h = 0.9, 2.0 ** -9
    r = np.array([rotate(*state[1:5], *case['center'])
                  for state in many(anchor, time + h * np.arange(-4, 5))])
    weights = np.array([
        -1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])
    by_differences = case['mass'] * (weights @ r / h ** 2 + [0.0, 0.0, case['g']])
    # 2e-10
    np.testing.assert_allclose(
        reaction(parameters, at(anchor, time)), by_differences, rtol=0.0, atol=2e-9)


def test_what_is_absorbed():
    assert motion.absorbs(scene_of(HEAVY))
    assert motion.absorbs(scene_of({**HEAVY, 'center': [0.0, 0.0, -0.1]}))
    assert motion.absorbs(scene_of({**HEAVY, 'moments': [0.03, 0.03, 0.0]}))
    assert motion.absorbs(scene_of({
        **HEAVY, 'moments': [0.03, 0.01, 0.03], 'center': [0.0, -0.1, 0.0]}))
    assert motion.absorbs(scene_of({
        **HEAVY, 'moments': [0.4, 0.4, 0.4], 'center': [0.1, -0.2, 0.3]}))
    assert motion.absorbs(scene_of({**HEAVY, 'center': [0.0, 0.0, 0.0]}))
    assert not motion.absorbs(scene_of({
        **HEAVY, 'moments': [0.03, math.nextafter(0.03, 1.0), 0.01]}))
    assert not motion.absorbs(scene_of({**HEAVY, 'center': [1e-18, 0.0, 0.1]}))
    assert not motion.absorbs(scene_of({
        **HEAVY, 'moments': [0.03, 0.01, 0.03], 'center': [0.0, 0.0, 0.05]}))
    assert not motion.absorbs(scene_of(
        HEAVY,
        effects=[
            {'gravity': {'g': 9.81}}, {'torque': {'frame': 'body', 'value': [0.0, 0.0, 1e-9]}}]))


def test_a_composite_with_turned_axes_is_absorbed():
    half = math.sin(0.35)
    scene = parse_scene(json.dumps({
        'scene': 'dumbbell', 'constraint': 'pivot', 'effects': [{'gravity': {'g': 9.81}}],
        'body': {'parts': [{'mass': 2.0, 'shape': {'cylinder': {'radius': 0.1, 'length': 0.4}},
                            'orientation': [half, 0.0, 0.0, math.cos(0.35)],
                            'at': [0.0, -0.3 * math.sin(0.7), 0.3 * math.cos(0.7)]}]},
        'initial': {'angular_velocity': [1.0, 2.0, 3.0]}}))
    assert scene.body.about_origin.axes != (0.0, 0.0, 0.0, 1.0)
    assert motion.absorbs(scene)
    solver = Exact(scene, motion).start(scene.initial.vector)
    states = np.empty((1001, STATE_SIZE))
    solver.states(np.linspace(0.0, 20.0, 1001), states)
    tensor = scene.body.about_origin.matrix
    energy = [0.5 * s[5:8] @ tensor @ s[5:8]
              + 2.0 * 9.81 * rotate(*s[1:5], *scene.body.center_of_mass)[2]
              for s in states]
    assert np.ptp(energy) <= 4e-14      # 1.4e-14 of terms of 6 J


@pytest.mark.parametrize(('overrides', 'tilt'),
                         [({}, 0.0), ({}, math.pi), ({'g': 0.0}, 0.0), ({'g': 0.0}, 0.7),
                          ({'center': [0.0, 0.0, 0.0]}, 2.0)])
def test_top_at_rest_where_nothing_turns_it_stays(overrides, tilt):
    start = (1.0, 0.0, 0.0, 0.0) if tilt == math.pi else from_euler_zyz(0.3, tilt, 0.7)
    _, anchor = anchored(HEAVY | overrides, start, (0.0, 0.0, 0.0))
    for state in many(anchor, [0.0, 1.0, 1e6]):
        np.testing.assert_allclose(state[1:5], start, rtol=0.0, atol=4e-16)
        assert not state[5:8].any()
    assert motion.next_event(anchor, 0.0) == (math.inf, 0)


TURNED = (0.1, -0.5, 0.5, 0.7)


@pytest.mark.parametrize('k', [0, 1, 2])
@pytest.mark.parametrize('way', [1.0, -1.0])
@pytest.mark.parametrize(('axes', 'off', 'found'), [
    ((0.0, 0.0, 0.0, 1.0), 0.0, True), ((0.5, 0.5, 0.5, 0.5), 0.0, True),
    ((0.0, 0.0, 0.0, 1.0), 1e-300, False), (TURNED, 0.0, True), (TURNED, 1e-15, True),
    (TURNED, 2e-15, False)])
def test_the_axis_of_a_top_is_the_one_that_its_centre_of_mass_lies_on(k, way, axes, off, found):
    """It points there; only where axes are turned does rounding count, by 8.9e-16 of 2 m."""
    axis, across = np.zeros(3), np.zeros(3)
    axis[k], across[k - 1] = way, off
    center = rotate(*(np.array(axes) / np.linalg.norm(axes)), *(2.0 * axis + across))
    moments = tuple(0.3 if j != k else 0.2 for j in range(3))

    def axis_of(moments, center):
        about = types.SimpleNamespace(moments=moments, axes=tuple(
            (np.array(axes) / np.linalg.norm(axes)).tolist()))
        return motion.symmetry_axis(types.SimpleNamespace(
            body='a top', constraint=types.SimpleNamespace(
                inertia=lambda body: about, arm=lambda body: center)))
    told = axis_of(moments, center)
    assert (told is not None) is found
    if found:
        assert told[0] == k
        assert rotate(*told[1], 0.0, 0.0, 1.0) == pytest.approx(
            np.array(center) / 2.0, abs=2e-15)
    assert axis_of((0.2, 0.3, 0.4), center) is None
    # all axes of a round body are its own: that of the centre of mass is taken
    assert axis_of((0.3, 0.3, 0.3), center)[0] == 2
    assert rotate(*axis_of((0.3, 0.3, 0.3), center)[1], 0.0, 0.0, 1.0) == pytest.approx(
        np.array(center) / 2.0, abs=2e-15)
    assert axis_of((0.3, 0.3, 0.3), (0.0, 0.0, 0.0)) == (2, (0.0, 0.0, 0.0, 1.0))
