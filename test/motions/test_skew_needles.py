# SPDX-License-Identifier: Apache-2.0
"""Needles whose inertia is a full tensor: the truth is that of its doubles, in 40 digits.

A rounded moment or a pair of moments made equal spins a needle about its axis: the error was 1e-16
of the large moments over the small one, and nothing told it. The rounding of a vector that lies
along the needle does the same where it makes a torque. Bodies that are less slim suffer less of
it: they had it where their moments were to each other as 1 to 1000, or as 1 to 10.
"""

import itertools
import json
import pathlib
import sys
from typing import NamedTuple

import numpy as np
import pytest
from mpmath import mp, mpf
from soak import IN_SOAK, some_of

from rigid_body_sim.mechanics.parameters import moment_about_hinge
from rigid_body_sim.numerics.rotations import angle_between, matrix
from rigid_body_sim.scene.bodies import Inertia
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / 'data'))
from heavy_body import Flow

TIMES = 1.0, 2.5, 5.0
TILTED = (0.5, -0.1, 0.7, 0.5)    # of norm 1


def tensor(ratio, unequal):
    """Return the tensor of a needle in axes that are none of its own."""
    R = np.array(matrix(*TILTED))
    found = R @ np.diag([0.03, 0.03 * (1.0 + unequal), 0.03 * ratio]) @ R.T
    return (0.5 * (found + found.T)).tolist()


def principal(entries):
    """Return the moments of a tensor, and the turn from its axes to the body's (mpmath)."""
    moments, axes = mp.eigsy(mp.matrix(entries))
    axes = axes if mp.det(axes) > 0 else -axes
    return list(moments), axes


def turned(axes, q):
    """Return q times a rotation matrix, a quaternion."""
    # four times the squares of the quaternion of the matrix; the largest one is safe to divide by
    trace = sum(axes[k, k] for k in range(3))
    squares = [1 + 2 * axes[k, k] - trace for k in range(3)] + [1 + trace]
    largest = max(range(4), key=squares.__getitem__)
    p, size = [mpf(0)] * 4, mp.sqrt(squares[largest]) / 2
    p[largest] = size
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        if largest == 3:
            p[k] = (axes[j, i] - axes[i, j]) / (4 * size)
        elif largest == k:
            p[i], p[j] = ((axes[i, k] + axes[k, i]) / (4 * size),
                          (axes[j, k] + axes[k, j]) / (4 * size))
            p[3] = (axes[j, i] - axes[i, j]) / (4 * size)
    px, py, pz, pw = q
    qx, qy, qz, qw = p
    return [pw * qx + px * qw + py * qz - pz * qy, pw * qy - px * qz + py * qw + pz * qx,
            pw * qz + px * qy - py * qx + pz * qw, pw * qw - px * qx - py * qy - pz * qz]


def error_of(simulation, moments, axes, pull):
    """Return the largest angle (rad) at TIMES to a body of 40 digits under a constant force.

    `pull` is the force times the arm, principal axes, N m.
    """
    initial, flow = simulation.scene.initial, Flow(140, moments, pull)
    flow.start(turned(axes, [mpf(x) for x in initial.orientation.tolist()]), [
        sum(axes[i, k] * mpf(initial.angular_velocity[i]) for i in range(3)) for k in range(3)])
    attitudes = [turned(axes.T, flow.go(time)[0]) for time in TIMES]
    return max(angle_between(*q, *map(float, p)) for q, p in zip(
        simulation.states(TIMES).orientation, attitudes, strict=True))


@pytest.mark.without_numba
@pytest.mark.parametrize(('ratio', 'unequal', 'constraint'), some_of(
    [1e-4, 1e-5, 1e-6, 1e-7], [0.0, 1e-15, 1e-9], ['free', 'pivot']))
def test_the_rotation_is_that_of_the_tensor_given(ratio, unequal, constraint):
    entries = tensor(ratio, unequal)
    scene = parse_scene(json.dumps({
        'scene': 'needle', 'body': {'mass': 2.0, 'inertia': entries}, 'constraint': constraint,
        'effects': [], 'initial': {'orientation': [0.1, 0.5, -0.2, 0.8],
                                   'angular_velocity': [3.0, -7.0, 4.0]}}))
    simulation = Simulation(scene, horizon=5.0)
    assert simulation.choice.method == 'exact'
    with mp.workdps(40):
        error = error_of(simulation, *principal(entries), [mpf(0)] * 3)
    # measured: 1e-15 to 5e-15; 1e-11 to 1e-8 with moments that are rounded
    assert error <= 1.5e-14
    assert simulation.choice.expected_error <= 1.5e-14


def hanging(ratio, unequal, about):
    """Return the settings of a needle on a pivot under gravity, its centre of mass along it."""
    place = (np.array(matrix(*TILTED)) @ np.array([0.0, 0.0, 0.1])).tolist()
    return {
        'scene': 'needle', 'constraint': 'pivot', 'effects': [{'gravity': {'g': 9.81}}],
        'body': {'mass': 2.0, 'inertia': tensor(ratio, unequal), 'inertia_about': about,
                 'center_of_mass': place},
        'initial': {'orientation': [0.1, 0.5, -0.2, 0.8], 'angular_velocity': [3.0, -7.0, 4.0]}}


def held(given, point=(0.0, 0.0, 0.0)):
    """Return moments about a point, the axes, and the centre of mass along them (mpmath).

    `given` are the settings of a body.
    """
    center = mp.matrix(given['center_of_mass']) - mp.matrix(list(point))
    entries = mp.matrix(given['inertia'])
    if given['inertia_about'] == 'center_of_mass':
        square = (center.T * center)[0]
        entries += mpf(given['mass']) * (square * mp.eye(3) - center * center.T)
    moments, axes = principal(entries)
    return moments, axes, list(axes.T * center)


@pytest.mark.without_numba
@pytest.mark.parametrize(('unequal', 'about'), [
    pytest.param(unequal, about, marks=IN_SOAK) for unequal in (0.0, 0.5)
    for about in ('center_of_mass', 'origin')])
def test_a_needle_swings_as_the_tensor_says(unequal, about):
    mapping = hanging(1e-6, unequal * 1e-6, about)
    scene = parse_scene(json.dumps(mapping))
    simulation = Simulation(scene, accuracy=1e-12, horizon=5.0)
    with mp.workdps(40):
        moments, axes, arm = held(mapping['body'])
        weight = mpf(scene.body.mass) * mpf(9.81)
        error = error_of(simulation, moments, axes, [weight * part for part in arm])
    # measured: 3e-14 to 3e-13; 2e-11 to 3e-7 with vectors turned by rounded axes
    assert error <= 1e-12
    assert error <= 3.0 * simulation.choice.expected_error <= 3e-12


@pytest.mark.parametrize('constraint', [
    'pivot', {'pivot': {'at': [0.1, 0.2, 0.3]}},
    {'pivot': {'motion': [0, 0, '0.01*cos(3*t)'], 'at': [0.1, 0.2, 0.3]}}])
@pytest.mark.parametrize('about', ['origin', 'center_of_mass'])
@pytest.mark.parametrize('ratio', [1e-6, 1e-2, 0.3])
def test_vectors_along_a_needle_are_rounded_once(ratio, about, constraint):
    """The arm, and vectors that effects give in body axes, have no more across it than given."""
    mapping, at = hanging(ratio, 0.5 * ratio, about), [0.0, 0.0, 0.0]
    if constraint != 'pivot':
        at, about = [0.1, 0.2, 0.3], 'center_of_mass'
        body = mapping['body']
        body['center_of_mass'] = [a + b for a, b in zip(at, body['center_of_mass'], strict=True)]
        body['inertia_about'] = about
        mapping['constraint'] = constraint
    frame = parse_scene(json.dumps(mapping)).frame
    with mp.workdps(40):
        moments, axes, arm = held(mapping['body'], at)
        center = list(map(mpf, mapping['body']['center_of_mass']))
        along = list(axes.T * mp.matrix(center))
        for found, exact in ((frame.moments, moments), (frame.arm, arm),
                             (frame.from_body(mapping['body']['center_of_mass']), along)):
            for one, other in zip(sorted(map(abs, found)), sorted(map(abs, exact)), strict=True):
                assert abs(one - other) <= 1.2e-16 * other + 1e-30
        I1, I2, I3 = moments
        for found, exact in zip(sorted(map(abs, frame.differences)),
                                sorted([abs(I1 - I2), abs(I2 - I3), abs(I3 - I1)]), strict=True):
            assert abs(found - exact) <= 4e-16 * exact    # 4e-14 to 4e-12 of rounded moments


def rotation(q):
    """Return the matrix of a quaternion of any norm (mpmath)."""
    x, y, z, w = q
    rows = [[w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z]]
    return mp.matrix(rows) / (x * x + y * y + z * z + w * w)


def crossed(a, b):
    """Return a x b (mpmath)."""
    return mp.matrix([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                      a[0] * b[1] - a[1] * b[0]])


class Blow(NamedTuple):
    """An impulse J (N s) at a point from the body's origin (m), and one of torque (N m s)."""

    time: float
    frame: str
    J: list
    point: list
    K: tuple = (0.0, 0.0, 0.0)


def error_after(simulation, given, blows):
    """Return the largest angle (rad) at TIMES to a body of 40 digits that blows strike.

    `given` are the settings of its body. It turns about its origin: it is free and has its centre
    of mass there, or it hangs there under gravity.
    """
    moments, axes, arm = held({
        'center_of_mass': [0, 0, 0], 'inertia_about': 'center_of_mass', **given})
    flow = Flow(140, moments, [mpf(given['mass']) * mpf(9.81) * part for part in arm])
    initial, begun, found = simulation.scene.initial, mpf(0), []
    flow.start(turned(axes, [mpf(x) for x in initial.orientation.tolist()]),
               list(axes.T * mp.matrix(initial.angular_velocity.tolist())))
    for blow in sorted([*blows, *(Blow(time, '', [], []) for time in TIMES)]):
        q, omega = flow.go(mpf(blow.time) - begun)
        if not blow.J:
            found.append(turned(axes.T, q))
            continue
        J, K = mp.matrix(blow.J), mp.matrix(list(blow.K))
        if blow.frame == 'world':
            back = rotation(turned(axes.T, q)).T
            J, K = back * J, back * K
        gained = axes.T * (K + crossed(mp.matrix(blow.point), J))
        begun = mpf(blow.time)
        flow.start(q, [rate + one / moment for rate, one, moment in zip(
            omega, gained, moments, strict=True)])
    return max(angle_between(*q, *map(float, p)) for q, p in zip(
        simulation.states(TIMES).orientation, found, strict=True))


def struck(ratio, constraint, skew):
    """Return the settings of a needle that is to be struck."""
    mapping = hanging(ratio, 0.5 * ratio, 'origin')
    mapping['constraint'], body = constraint, mapping['body']
    if not skew:
        body['inertia'] = np.diag([0.03, 0.03 * (1.0 + 0.5 * ratio), 0.03 * ratio]).tolist()
        body['center_of_mass'] = [0.0, 0.0, 0.1]
    if constraint == 'free':
        mapping['effects'] = []
        del body['center_of_mass'], body['inertia_about']
    return mapping


def on_needle(skew, distance, off=0.0):
    """Return a place on a needle, or near it, m, body axes."""
    place = [off, 0.0, distance]
    return (np.array(matrix(*TILTED)) @ place).tolist() if skew else place


BODY, WORLD = [0.3, -0.2, 0.5], [0.1, 0.2, -0.3]
STRIKES = {
    'body': [(1.3, 'body', BODY, 0.2, 1e-4)],
    'at once': [(0.0, 'body', BODY, 0.2, 0.0)],
    'world': [(1.3, 'world', BODY, 0.2, 0.0)],
    'two': [(1.3, 'body', BODY, 0.2, 0.0), (2.0, 'world', WORLD, -0.1, 0.0)]}


# 40 digits take ten seconds for each needle on a pivot, and for one that is struck beside its axis
ON_PIVOT = 'two', True, 'pivot'
ASIDE = 'body', False, 'free'


@pytest.mark.parametrize(('strikes', 'skew', 'constraint', 'ratio'), [
    *(pytest.param(strikes, skew, 'free', 1e-6,
                   marks=IN_SOAK if (strikes, skew, 'free') == ASIDE else ())
      for strikes in STRIKES for skew in (True, False)),
    ('two', True, 'free', 0.003), (*ON_PIVOT, 1e-6),
    *(pytest.param(*one, 1e-6, marks=IN_SOAK) for one in itertools.product(
        STRIKES, (True, False), ['pivot']) if one != ON_PIVOT)])
def test_a_struck_needle_turns_as_the_impulse_says(strikes, skew, constraint, ratio):
    mapping = struck(ratio, constraint, skew)
    blows = [Blow(time, frame, J, on_needle(skew, at, off))
             for time, frame, J, at, off in STRIKES[strikes]]
    mapping['effects'] += [{'strike': {
        'time': blow.time, 'impulse': blow.J, 'point': blow.point, 'frame': blow.frame}}
        for blow in blows]
    simulation = Simulation(parse_scene(json.dumps(mapping)), horizon=5.0)
    with mp.workdps(40):
        error = error_after(simulation, mapping['body'], blows)
    # measured: 2e-15 to 2e-14 free, 2e-14 to 1.1e-12 on a pivot; 2e-11 to 5e-8 with what acts
    # turned to the world and back in doubles
    assert error <= 2e-12
    assert error <= 3.0 * simulation.choice.expected_error <= 2e-11


@pytest.mark.parametrize(('frame', 'constraint'), [
    ('body', 'free'), ('world', 'free'),
    *(pytest.param(frame, 'pivot', marks=IN_SOAK) for frame in ('body', 'world'))])
def test_a_commanded_impulse_on_a_needle_is_turned_into_its_axes_exactly(frame, constraint):
    mapping = struck(1e-6, constraint, True)
    simulation = Simulation(parse_scene(json.dumps(mapping)), rate=10.0, horizon=5.0)
    K = tuple(on_needle(True, 1e-7, 0.02)) if frame == 'body' else (1e-8, 1e-8, 1e-8)
    blows = [Blow(1.3, frame, BODY, mapping['body'].get('center_of_mass', [0, 0, 0]), K),
             Blow(1.3, 'body', WORLD, mapping['body'].get('center_of_mass', [0, 0, 0]))]
    simulation.advance(13)
    for blow in blows:
        simulation.impulse(blow.J, blow.K, blow.frame)
    with mp.workdps(40):
        error = error_after(simulation, mapping['body'], blows)
    # measured: 1.6e-14 free, 2.6e-13 on a pivot; 5e-11 to 4e-10 turned in doubles
    assert error <= 1e-12


@pytest.mark.parametrize('off', [0.0, 1e-3])
@pytest.mark.parametrize('center', [0.0, 1e-4])
@pytest.mark.parametrize('ratio', [1e-6, 1e-3])
def test_a_needle_on_an_axle_is_struck_with_its_moment(ratio, center, off):
    """The moment in doubles has the rounding of the large moments: the rate was 7e-12 off."""
    mapping, point = struck(ratio, 'pivot', True), on_needle(True, 0.1, 1e-2)
    mapping['body'] |= {'center_of_mass': on_needle(True, 0.05, center),
                        'inertia_about': 'center_of_mass'}
    mapping |= {'constraint': {'hinge': {'axis': on_needle(True, 1.0, off)}},
                'effects': [{'strike': {'impulse': [1e-4, 2e-4, -1e-4], 'point': point,
                                        'frame': 'body'}}],
                'initial': {'rate': 2.0}}
    simulation = Simulation(parse_scene(json.dumps(mapping)), horizon=5.0)
    with mp.workdps(40):
        n, place = mp.matrix(simulation.scene.constraint.axis), mapping['body']['center_of_mass']
        lever = crossed(n, mp.matrix(place))
        moment = (n.T * mp.matrix(mapping['body']['inertia']) * n + 2 * lever.T * lever)[0]
        rounded = moment_about_hinge(simulation.scene.body, simulation.scene.constraint)
        assert abs(rounded - moment) <= 1.2e-16 * moment    # 2e-14 in doubles for 1e-3
        gained = (n.T * crossed(mp.matrix(point), mp.matrix([1e-4, 2e-4, -1e-4])))[0] / moment
        omega = mp.matrix(simulation.scene.initial.angular_velocity.tolist()) + gained * n
        found = mp.matrix(simulation.states([0.0]).angular_velocity[0].tolist())
        # point and impulse are long beside the part of their product that turns the needle
        size = mp.norm(omega) + mp.norm(mp.matrix(point)) * mpf(3e-4) / moment
        # measured: 8.5e-17; 2e-12 to 5e-12 of omega with a moment of doubles
        assert mp.norm(found - omega) <= 2e-16 * size


def test_what_rounding_takes_from_the_moments_of_a_tensor_is_kept():
    """A body that is not slim and symmetric to rounding is symmetric: nothing of that is kept."""
    needle = Inertia.of_matrix(tensor(1e-5, 0.0))
    with mp.workdps(40):
        exact = sorted(principal(tensor(1e-5, 0.0))[0])
        kept = sorted(mpf(moment) + mpf(lost)
                      for moment, lost in zip(needle.moments, needle.lost, strict=True))
        assert max(abs(one - other) for one, other in zip(exact, kept, strict=True)) < 1e-30
    for ratio in (0.5, 1e-17):    # the second is a rod, as skew parts make one
        found = Inertia.of_matrix(tensor(ratio, 0.0))
        assert len(set(found.moments)) == 2
        assert [lost for moment, lost in zip(found.moments, found.lost, strict=True)
                if found.moments.count(moment) == 2] == [0.0, 0.0]
