# SPDX-License-Identifier: Apache-2.0
"""taylor's mode for ensembles: eight bodies at once."""

import json
import pathlib

import numpy as np
import pytest
from data import smooth_cases
from near import near
from numba_only import LONG_IN_PYTHON
from scipy.spatial.transform import Rotation
from soak import IN_SOAK

from rigid_body_sim import BadInput, NotConverged, ensemble
from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.lanes import LANES, Plain
from rigid_body_sim.integrators.families import power_series as FAMILY  # noqa: N812
from rigid_body_sim.integrators.marching import (
    batch_directions,
    batch_hinge,
    batch_lane,
    batch_step,
    batch_turning,
)
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.mechanics.parameters import moment_about_hinge
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.scene import parse_scene

REFERENCE = json.loads((pathlib.Path(__file__).resolve().parent.parent.parent / 'data'
                        / 'smooth.json').read_text())
ULP = np.finfo(float).eps
OMEGA = batch_lane.SERIES + batch_lane.OMEGA    # its first row


def starts_of(scene, factors):
    """Return the start of a scene with its angular velocity times each factor."""
    starts = np.tile(scene.initial.vector, (len(factors), 1))
    starts[:, 5:8] *= np.reshape(factors, (-1, 1))
    return starts


@LONG_IN_PYTHON
@pytest.mark.parametrize('name',
                         ['asymmetric_heavy_top', 'skew_heavy_top', 'driven_body',
                          'driven_from_rest', 'driven_in_pieces'])
def test_one_of_many_bodies_is_where_the_reference_says(name):
    """At the round-off floor, an ulp of the angle for an ulp on omega, and 4 ulp for in and out.

    Random ulps on the three components of omega move driven_in_pieces by up to 1.3 of that floor.
    """
    scene, reference = parse_scene(smooth_cases.text(name)), REFERENCE[name]
    times = [float(time) for time in reference]
    bodies = ensemble(
        scene, starts_of(scene, [0.0, 3.0, 0.1, *[2.0] * 7, 1.0]), times[::-1], 'taylor', 1e-14)
    speed = np.linalg.norm(scene.initial.angular_velocity)
    for state, (time, expected) in zip(bodies[10].vector[::-1], reference.items(), strict=True):
        exact = np.array([float(x) for x in expected['state']])
        speed = max(speed, np.linalg.norm(exact[4:7]))
        floor = ULP * (4.0 + speed * float(time))
        assert state[0] == float(time)
        assert state[1:5] @ exact[:4] > 0.0, 'the sign of q is continuous'
        # measured: at most 0.51 (driven_in_pieces)
        assert angle_between(*state[1:5], *exact[:4]) < floor
        # 0.09 (driven_from_rest)
        assert np.linalg.norm(state[5:8] - exact[4:7]) <= 0.2 * floor * speed
        assert np.abs(state[8:] - exact[7:]).max() <= 4 * ULP    # 1.5 (driven_in_pieces)


DAMPED = {
    'top': ('body: {mass: 1.0, inertia: [0.02, 0.03, 0.04], center_of_mass: [0.01, 0, 0.1]}\n'
            'constraint: pivot\neffects: [gravity: {g: 9.81}, drag: {angular: 0.002}]\n'
            'initial: {tilt: 0.5, angular_velocity: [1, 2, 30]}\n'),
    'thrown': ('body: {mass: 1.0, inertia: [1.0, 2.0, 3.0]}\nconstraint: free\n'
               'effects: [gravity: {g: 9.81}, drag: {linear: 0.1, angular: 0.2}, torque: '
               '{times: [0.5, 1.0], values: [[0.3, -0.2, 0.5], [0, 0.4, 0]], frame: world}]\n'
               'initial: {angular_velocity: [1, 2, 3], velocity: [1, 0, 5]}\n'),
    'hinge': ('body: {mass: 1.0, inertia: [0.02, 0.03, 0.01], center_of_mass: [0.1, 0, 0]}\n'
              'constraint: {hinge: {axis: [0, 1, 0.5], through: [0, 0.1, 0]}}\n'
              'effects: [gravity: {g: 9.81}, torque: {value: [0, 0.3, 0]}, '
              'drag: {angular: 0.01}]\n'
              'initial: {angle: 0.5, rate: 2.0}\n')}


@LONG_IN_PYTHON
@pytest.mark.parametrize('name', [
    pytest.param(name, marks=IN_SOAK if name != 'top' else ()) for name in DAMPED])
def test_bodies_with_drag_and_on_a_hinge_go_side_by_side(name):
    """Eleven bodies against one by one, positions and the times between included."""
    scene = parse_scene(f'scene: damped\n{DAMPED[name]}')
    starts, times = starts_of(scene, np.linspace(0.0, 2.0, 11)), np.array([2.0, 0.3, 0.75, 1.0])
    assert FAMILY.batch(Stepped(scene, 'taylor', 1e-12)._bound, Stepped(scene, 'taylor', 1e-12),
                        times) is not None
    alone, one = np.empty((11, 4, 14)), Stepped(scene, 'taylor', accuracy=1e-13)
    for start, states in zip(starts, alone, strict=True):
        one.start(start).states(times, states)
    together = ensemble(scene, starts, times, 'taylor', 1e-12).vector
    assert np.abs(together - alone).max() < 1e-12    # measured: 3e-14


@LONG_IN_PYTHON
def test_slow_and_fast_bodies_share_the_lanes():
    """19 tops, one at rest and one at 240 rad/s, each with its own start, against one by one."""
    scene = parse_scene(smooth_cases.text('asymmetric_heavy_top'))
    starts = starts_of(scene, np.random.default_rng(2).permutation(np.linspace(0.0, 4.0, 19)))
    starts[:, 0] = np.linspace(0.0, 0.5, 19)
    times = np.array([2.0, 0.5, 1.7, 3.0, *np.linspace(0.51, 0.52, 20)])
    alone, one = np.empty((19, 24, 14)), Stepped(scene, 'taylor', accuracy=1e-13)
    for start, states in zip(starts, alone, strict=True):
        one.start(start).states(times, states)
    for accuracy in (1e-12, 1e-6):
        together = ensemble(scene, starts, times, 'taylor', accuracy).vector
        errors = [angle_between(*a[1:5], *b[1:5])
                  for a, b in zip(together.reshape(-1, 14), alone.reshape(-1, 14), strict=True)]
        assert max(errors) < 0.1 * accuracy    # 1.5e-14, 2.5e-9
        assert (np.einsum('kni,kni->kn', together[:, :, 1:5], alone[:, :, 1:5])
                > 0.0).all(), 'the sign of q is continuous'
    # other lanes, other times
    other = ensemble(scene, starts[4:], times[[1, 3, 0]], 'taylor', 1e-6)
    assert (other.vector == together[4:, [1, 3, 0]]).all()


@pytest.mark.without_numba
def test_sign_of_the_quaternion_is_kept_over_steps_longer_than_half_a_turn():
    """Spun about a principal axis the angle is 5 t + 0.005 t^2; a step takes up to 4 rad."""
    spun = parse_scene('scene: spun\nbody: {mass: 1.0, inertia: [1.0, 1.5, 2.0]}\n'
                       'constraint: free\neffects: [torque: {value: [0, 0, 0.02]}]\n'
                       'initial: {angular_velocity: [0, 0, 5]}\n')
    times = np.linspace(0.0, 40.0, 400)
    half = 0.5 * (5.0 * times + 0.005 * times ** 2)
    for body in ensemble(spun, starts_of(spun, [1.0, 1.0]), times, 'taylor', 0.1):
        # 1.9e-4
        exact = np.transpose([np.sin(half), np.cos(half)])
        assert np.abs(body.orientation[:, 2:] - exact).max() < 1e-3


@LONG_IN_PYTHON
def test_force_and_couple_change_the_angular_momentum():
    """L of a top under its weight and an askew couple is the integral of r x F + couple."""
    body, constraint, _, initial, _, _ = smooth_cases.CASES['skew_heavy_top']
    couple = np.array([0.2, -0.3, 0.4])
    scene = parse_scene(f'scene: pulled\nbody: {body}\nconstraint: {constraint}\n'
                        f'effects: [gravity: {{g: 9.81}}, torque: {{value: {couple.tolist()}, '
                        f'frame: world}}]\ninitial: {initial}\n')
    nodes, weights = np.polynomial.legendre.leggauss(16)
    nodes, weights = (np.add.outer(np.arange(20.0), 0.5 + 0.5 * nodes).ravel() / 10.0,
                      np.tile(weights, 20) / 20.0)
    states = ensemble(scene, starts_of(scene, [1.0]), [*nodes, 0.0, 2.0], 'taylor', 1e-12)[0]
    turn = Rotation.from_quat(states.orientation)
    L = turn.apply(states.angular_velocity @ scene.body.about_origin.matrix.T)
    torques = (np.cross(turn.apply(scene.body.center_of_mass), [0.0, 0.0, -9.81 * scene.body.mass])
               + couple)
    assert L[-1] - L[-2] == near(weights @ torques[:-2], 1e-13)    # 1e-14


def test_thrown_bodies_fall():
    """Against the same bodies without weight; the torque changes on the way."""
    def states(effects):
        return ensemble(scene_with(effects), starts, [0.5, 5.0], 'taylor', 1e-9).vector

    def scene_with(effects):
        return parse_scene(
            'scene: thrown\n'
            'body: {mass: 2.0, inertia: [0.8, 0.9, 1.3], center_of_mass: [0.1, -0.2, 0.3]}\n'
            'constraint: free\n'
            f'effects: [{effects}torque: {{times: [0, 2], values: [[0.1, 0, 0.5], [0, 1, 0]], '
            'frame: body}]\n'
            'initial: {angular_velocity: [0.4, -0.2, -1.1], velocity: [3.0, 0.0, 8.0], '
            'position: [1.0, 2.0, 3.0]}\n')
    starts = starts_of(scene_with(''), [1.0, 2.0])
    drop = states('gravity: {g: 10.0}, ') - states('')
    expected = np.zeros((2, 2, 14))
    expected[:, :, 10], expected[:, :, 13] = [-1.25, -125.0], [-5.0, -50.0]
    # 2.4e-13 of the attitude: the directions that are followed are others
    assert np.abs(drop - expected).max() < 1e-11


@pytest.mark.without_numba
def test_hinged_bodies_keep_their_hinge_and_their_energy():
    scene = parse_scene(smooth_cases.text('held_hinge_body'))
    axis, through = np.array(scene.constraint.axis), np.array(scene.constraint.through)
    I, M = moment_about_hinge(scene.body, scene.constraint), scene.body.mass
    for body in ensemble(
            scene, starts_of(scene, [0.0, 0.5, 1.0]), [0.0, 0.4, 3.0], 'taylor', 1e-13):
        turn = Rotation.from_quat(body.orientation)
        height = (body.position + turn.apply(scene.body.center_of_mass))[:, 2]
        E = 0.5 * I * np.sum(body.angular_velocity ** 2, axis=1) + M * 9.81 * height
        for kept, bound in (
                (turn.apply(axis), 8 * ULP), (body.position + turn.apply(through), 8 * ULP),
                (E, 1e-13 * np.abs(E).max())):
            assert np.abs(kept - kept[0]).max() <= bound    # 0.2, 0.03, 0.12 of it


def test_bodies_that_do_not_move_stay():
    still = parse_scene('scene: still\nbody: {mass: 1.0, inertia: [1.0, 2.0, 2.5]}\n'
                        'constraint: free\neffects: [torque: {value: [0, 0, 0]}]\n'
                        'initial: {}\n')
    starts = starts_of(still, [1.0] * 3)
    assert (ensemble(still, starts, [0.0, 1000.0], 'taylor', 1e-9).vector[:, :, 1:]
            == starts[:, np.newaxis, 1:]).all()
    assert ensemble(still, starts, [], 'taylor', 1e-9).vector.shape == (3, 0, 14)


def test_who_fails_is_named():
    scene = parse_scene(smooth_cases.text('driven_body'))
    # powers of omega leave the range of doubles
    starts = starts_of(scene, [*[1.0] * 70, 1e18, 2.0])
    with pytest.raises(NotConverged, match=r'body 70: taylor on driven_body: at t = 0\.0 s'):
        ensemble(scene, starts, [1e-10], 'taylor', 1e-9)
    with pytest.raises(NotConverged, match=r'body 70: .*more radians than'):
        ensemble(scene, starts, [1.0], 'taylor', 1e-9)
    starts[1, 0] = 3.0
    with pytest.raises(BadInput, match=r'from the start, 3\.0 s'):
        ensemble(scene, starts[:2], [1.0], 'taylor', 1e-9)


@LONG_IN_PYTHON
@pytest.mark.parametrize(('series', 'order'), [
    ('coarse_', batch_lane.COARSE), ('', batch_lane.ORDER)])
@pytest.mark.parametrize('form', [
    batch_directions, pytest.param(batch_turning, marks=IN_SOAK),
    pytest.param(batch_hinge, marks=IN_SOAK)])
def test_a_step_is_the_same_in_plain_python(form, series, order):
    """The recurrence on arrays agrees to the rounding of sums of 18 terms, and so does the end."""
    draw = np.random.default_rng(1)
    table = np.zeros((batch_lane.ROWS, LANES))
    table[batch_lane.EULER:batch_lane.EULER + 3] = [[-0.3], [0.6], [-0.4]]
    table[batch_lane.CONSTANT:batch_lane.DRAG] = draw.uniform(-1.0, 1.0, (15, 1))
    table[batch_lane.INVERSES:] = 1.0 / np.arange(1.0, batch_lane.ORDER + 1.0).reshape(-1, 1)
    attitude = slice(batch_lane.QUATERNION, batch_lane.SERIES)
    unknowns = slice(batch_lane.SERIES, batch_lane.SERIES + batch_lane.UNKNOWNS)
    for lane in range(LANES):
        q, omega = draw.normal(size=4), draw.uniform(-1.0, 1.0, 3)
        if form is batch_hinge:
            q[:2] = omega[:2] = 0.0
        q /= np.linalg.norm(q)
        table[attitude, lane] = q
        table[unknowns, lane] = np.concatenate(form.unknowns(tuple(q), tuple(omega)))
    table[batch_lane.END] = 1e3
    step = getattr(form, f'{series}advance')

    @compiled
    def advance(W):
        step(W, (1e-20,))
    plain, written = table.ravel().copy(), table.ravel().copy()
    batch_step.advance(Plain(), plain, 1e-20, form.FORM._replace(order=order))
    advance(written)
    plain, written = plain.reshape(table.shape), written.reshape(table.shape)
    # what is left of the point before: its time, quaternion and unknowns
    before = slice(batch_lane.BEFORE_TIME, batch_lane.END)
    assert (written[before] == plain[before]).all()
    assert (written[before] == np.concatenate(
        [table[:1], table[attitude], table[unknowns]])).all()
    orders = slice(unknowns.stop, batch_lane.BEFORE_TIME)
    highest = batch_lane.UNKNOWNS * order
    assert np.abs(plain[orders][:highest]).min(axis=1).nonzero()[0][-1] >= highest - 3
    assert not plain[orders][highest:].any(), 'higher orders are not filled'
    # 1
    assert np.abs(plain[orders] - written[orders]).max() < 20 * ULP * np.abs(plain[orders]).max()
    assert written[batch_lane.STEP] == near(plain[batch_lane.STEP], 1e-14)    # the same
    for rows in (attitude, unknowns):
        assert np.abs(plain[rows] - written[rows]).max() < 5 * ULP    # 1
    # the quaternion turns with the attitude of the unknowns
    for q, y in zip(written[attitude].T, written[unknowns].T, strict=True):
        # 3.5
        turned, _ = form.unknowns(tuple(q), (0.0, 0.0, 0.0))
        assert np.abs(y[:batch_lane.DIRECTIONS] - turned).max() < 8 * ULP
