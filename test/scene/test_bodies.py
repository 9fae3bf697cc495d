# SPDX-License-Identifier: Apache-2.0
"""Inertia of shapes against integrals by hand, composites against parts, impossible tensors."""

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene import bodies, composites, principal_axes, shapes

EPS = np.finfo(float).eps

# name, dimensions, moments for M = 1 (by hand from the integrals)
SHAPES = [
    ('rod', {'length': 2.0}, (1 / 3, 1 / 3, 0.0)),
    ('lamina', {'width': 3.0, 'height': 2.0}, (1 / 3, 3 / 4, 13 / 12)),
    ('hoop', {'radius': 2.0}, (2.0, 2.0, 4.0)),
    ('disk', {'radius': 2.0}, (1.0, 1.0, 2.0)),
    ('spherical_shell', {'radius': 3.0}, (6.0, 6.0, 6.0)),
    ('solid_sphere', {'radius': 5.0}, (10.0, 10.0, 10.0)),
    ('box', {'size': (1.0, 2.0, 3.0)}, (13 / 12, 10 / 12, 5 / 12)),
    ('cylinder', {'radius': 2.0, 'length': 6.0}, (4.0, 4.0, 2.0)),
    ('cone', {'radius': 2.0, 'height': 4.0}, (1.2, 1.2, 1.2)),
    ('ellipsoid', {'semi_axes': (1.0, 2.0, 3.0)}, (13 / 5, 2.0, 1.0)),
    ('torus', {'radius': 2.0, 'tube': 1.0}, (2.625, 2.625, 4.75)),
]


@pytest.mark.parametrize(
    ('name', 'dimensions', 'moments'), SHAPES, ids=[shape[0] for shape in SHAPES])
def test_shape_has_the_moments_of_its_integral(name, dimensions, moments):
    body = bodies.of_shape(name, 1.0, dimensions)
    # a few roundings: measured 2.2e-16 relative at most
    assert body.about_center.moments == near(moments, rel=4 * EPS)


def test_every_shape_is_checked():
    assert set(shapes.SHAPES) == {shape[0] for shape in SHAPES}


def test_rod_about_its_end_by_the_parallel_axis():
    rod = bodies.of_shape('rod', 2.0, {'length': 3.0}, center_of_mass=(0.0, 0.0, 1.5))
    assert rod.about_origin.moments == near((6.0, 6.0, 0.0), EPS)    # M L^2 / 3


@pytest.mark.parametrize('shift', [(-933.4, -1e6, 13.5), (-1e74, 0.005, 814.0), (3e7, 3e7, -1.0)])
def test_about_a_far_point_no_moment_is_below_the_least_about_the_centre(shift):
    body = bodies.make_body(1.3, (0.7, 0.0013, 0.7))
    about = bodies.moved(body.about_center, body.mass, shift, 1.0)
    assert min(about.moments) >= 0.0013
    assert bodies.make_body(1.3, (0.7, 0.0013, 0.7), shift).about_origin.moments == about.moments


@pytest.mark.parametrize('about', ['center_of_mass', 'origin'])
def test_differences_of_moments_that_were_moved_are_those_before_rounding(about):
    """A needle's two large moments agree in nine digits, and its small one divides the rest."""
    M, center = 0.5, (0.0, 0.0, 0.25)
    given = 0.037, 0.037 * (1.0 + 1e-9), 0.037 * 3e-6
    body = bodies.make_body(M, given, center, about)
    sign, inertia = ((1, body.about_origin) if about == 'center_of_mass'
                     else (-1, body.about_center))
    more = sign * Fraction(M) * Fraction(center[2]) ** 2
    I1, I2, I3 = Fraction(given[0]) + more, Fraction(given[1]) + more, Fraction(given[2])
    assert inertia.differences == near((I2 - I3, I3 - I1, I1 - I2), 4e-16)
    if about == 'center_of_mass':
        I1, I2, I3 = inertia.moments
        assert abs(inertia.differences[2] - (I1 - I2)) > 1e-8 * abs(I1 - I2)    # doubles lose that


def test_differences_of_moments_have_what_rounding_took_from_each_of_them():
    inertia = bodies.Inertia((5.0, 3.0, 2.0), lost=(0.5, 0.125, 0.0625))
    assert inertia.differences == (1.0625, -3.4375, 2.375)


def test_flat_shapes_have_perpendicular_axes():
    for name, dimensions in (('lamina', {'width': 0.3, 'height': 0.7}), ('hoop', {'radius': 0.3}),
                             ('disk', {'radius': 0.7})):
        I1, I2, I3 = bodies.of_shape(name, 1.3, dimensions).about_center.moments
        assert abs(I1 + I2 - I3) <= 2 * EPS * I3


def test_given_tensor_is_kept_to_the_last_bit():
    body = bodies.make_body(1.0, (0.03, 0.03, 0.01), (0.0, 0.0, 0.1), about='origin')
    assert body.about_origin.moments == (0.03, 0.03, 0.01)
    assert body.about_center.moments == near((0.02, 0.02, 0.01), 4 * EPS)
    assert body.about_center.moments[0] == body.about_center.moments[1]


@pytest.mark.parametrize(
    'moments', [(1.0, 2.0, 2.5), (1.0, 1.0 + 1e-9, 1.9), (1e-9, 1.0, 1.0 + 1e-9)])
def test_turned_tensor_gives_back_its_moments_and_axes(moments):
    turn = Rotation.from_rotvec([0.2, -0.1, 0.3])
    matrix = turn.as_matrix() @ np.diag(moments) @ turn.as_matrix().T
    inertia = bodies.Inertia.of_matrix((matrix + matrix.T) / 2)
    # conditioning: an eigenvalue moves by the rounding of the matrix, eps times its norm
    assert inertia.moments == pytest.approx(moments, abs=4 * EPS * max(moments))
    assert np.abs(inertia.matrix - matrix).max() <= 8 * EPS * max(moments)    # measured 4.4e-16


def test_axes_are_the_nearest_to_the_input_axes():
    turn = Rotation.from_rotvec([0.02, -0.01, 0.03])
    matrix = turn.as_matrix() @ np.diag([2.0, 1.0, 2.5]) @ turn.as_matrix().T
    inertia = bodies.Inertia.of_matrix((matrix + matrix.T) / 2)
    assert Rotation.from_quat(inertia.axes).magnitude() == near(turn.magnitude(), 1e-13)


def test_a_ball_whose_tensor_was_rounded_is_a_ball():
    turn = Rotation.from_rotvec([0.2, -0.1, 0.3]).as_matrix()
    matrix = turn @ np.diag([0.4] * 3) @ turn.T
    assert np.count_nonzero(matrix - np.diag(np.diagonal(matrix)))
    inertia = bodies.Inertia.of_matrix((matrix + matrix.T) / 2)
    assert inertia.moments == near([0.4] * 3, 4 * EPS)
    assert len(set(inertia.moments)) == 1
    assert inertia.axes == (0.0, 0.0, 0.0, 1.0)
    assert inertia.rows == inertia.entries == ()    # its axes are those of the body


def test_equal_moments_keep_the_input_axes():
    turn = Rotation.from_rotvec([0.0, 0.0, 0.7])
    # a disk turned about its own axis is the same disk; rounding of the turn must not turn its
    # axes
    matrix = turn.as_matrix() @ np.diag([1.0, 1.0, 2.0]) @ turn.as_matrix().T
    inertia = bodies.Inertia.of_matrix((matrix + matrix.T) / 2)
    assert inertia.moments[0] == inertia.moments[1]
    assert Rotation.from_quat(inertia.axes).magnitude() <= 1e-15


def test_dumbbell_of_two_balls_and_a_rod():
    ball = bodies.of_shape('solid_sphere', 2.0, {'radius': 0.1})
    rod = bodies.of_shape('rod', 1.0, {'length': 1.0})
    body = composites.composite([
        (rod, (0, 0, 0), bodies.IDENTITY), (ball, (0, 0, 0.5), bodies.IDENTITY),
        (ball, (0, 0, -0.5), bodies.IDENTITY)])
    across = 1 / 12 + 2 * (0.4 * 2.0 * 0.01 + 2.0 * 0.25)
    assert body.mass == 5.0
    assert body.about_center.moments == near((across, across, 2 * 0.4 * 2.0 * 0.01), 1e-15)
    assert body.about_center.axes == bodies.IDENTITY


def test_composite_keeps_its_own_axes_and_origin():
    parts = [(bodies.of_shape('box', 1.0, {'size': (0.1, 0.2, 0.3)}), (0.3, 0.1, 0.0),
              (0.0, 0.0, math.sin(0.2), math.cos(0.2))),
             (bodies.of_shape('disk', 2.0, {'radius': 0.1}), (-0.2, 0.0, 0.1), bodies.IDENTITY)]
    body = composites.composite(parts)
    assert body.center_of_mass == pytest.approx((-0.1 / 3, 0.1 / 3, 0.2 / 3), abs=1e-16)
    # the tensor about the origin is the sum of the parts' tensors about the origin
    tensor = np.zeros((3, 3))
    for part, at, orientation in parts:
        turn = Rotation.from_quat(orientation).as_matrix()
        tensor += (turn @ part.about_center.matrix @ turn.T
                   + part.mass * (np.dot(at, at) * np.eye(3) - np.outer(at, at)))
    # a dozen roundings of numbers up to 0.2: measured 1.1e-16
    assert np.abs(body.about_origin.matrix - tensor).max() <= 4 * EPS * 0.22


@pytest.mark.parametrize('order', list(itertools.permutations((1.0, 2.0, 3.0 + 1e-15))))
def test_lamina_is_legal_in_any_order(order):
    assert bodies.make_body(1.0, order).about_center.moments == order


def test_a_rod_is_legal_where_rounding_makes_its_moments_differ():
    moments = (0.0, 1.0, 1.0 + EPS)
    assert bodies.make_body(1.0, moments).about_center.moments == moments


def test_a_tensor_that_is_given_is_kept_as_it_was_given():
    """Not as its moments and axes give it back, which are rounded."""
    for seed in range(3):
        turn = Rotation.random(random_state=seed).as_matrix()
        tensor = turn @ np.diag([1.0, 2.0, 2.5]) @ turn.T
        tensor = 0.5 * (tensor + tensor.T)
        assert [list(row) for row in bodies.Inertia.of_matrix(tensor).exact] == tensor.tolist()


@pytest.mark.parametrize(('moments', 'center'), [
    ((1e151, 1e151, 1.0), (0.0, 0.0, 0.0)), ((1.0, 1.0, 1.0), (0.0, 1e76, 0.0)),
    ((0.0, 1e151, 1e151), (1e76, 0.0, 0.0))])
def test_one_moment_whose_square_is_no_double_is_refused(moments, center):
    with pytest.raises(BadInput, match=r'a moment of inertia of .*, about the middle or'):
        bodies.make_body(1.0, moments, center)


@pytest.mark.parametrize(('moments', 'words'), [
    ((1.0, 2.0, 3.00001), 'triangle inequality'), ((-1.0, 2.0, 2.0), 'negative'),
    ((0.0, 0.0, 0.0), 'at least two'),
    ([[1, 2, 0], [0, 1, 0], [0, 0, 1]], 'not symmetric')])
def test_impossible_tensor_is_refused_by_name(moments, words):
    with pytest.raises(BadInput, match=words) as caught:
        bodies.make_body(1.0, moments)
    assert '\n' not in str(caught.value)


def test_tensor_about_the_origin_is_checked_at_the_centre_of_mass():
    # 0.01 about the pivot with the centre of mass 0.2 m away would leave -0.03 about the centre
    with pytest.raises(BadInput, match='parallel-axis'):
        bodies.make_body(1.0, (0.01, 0.01, 0.01), (0.0, 0.0, 0.2), about='origin')


def test_needle_keeps_its_small_moment_when_turned():
    turn = Rotation.from_euler('z', 90, degrees=True)
    matrix = np.round(turn.as_matrix()) @ np.diag([1.0, 1e-12, 1.0]) @ np.round(turn.as_matrix()).T
    assert sorted(bodies.Inertia.of_matrix(matrix).moments) == [1e-12, 1.0, 1.0]


@pytest.mark.filterwarnings('error')
def test_graded_tensors_are_solved_to_round_off():
    """Moments span up to sixteen decades; the smallest one is as accurate as the given tensor."""
    rng = np.random.default_rng(0)
    for _ in range(100):
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        tensor = turn @ np.diag([1.0, 2.0, 2.5] * 10.0 ** rng.integers(-8, 8, 3)) @ turn.T
        moments, vectors, _ = principal_axes.eigenvectors(((tensor + tensor.T) / 2.0).tolist())
        assert np.abs(np.matmul(vectors, np.transpose(vectors)) - np.eye(3)).max() < 1e-15
        assert np.trace(tensor) == near(sum(moments), 1e-14)


def test_a_moment_that_rounding_makes_negative_is_zero():
    """Points 1e74 m apart leave less than an ulp for the moment about the line through them."""
    heavy = bodies.make_body(154.28331065338853, [0.27, 0.27, 6.8e-9])
    light = bodies.make_body(0.016218724248853164, [1e-30, 1e-30, 1e-30])
    for far in (1e74, 1e30, 3e15):
        for across in np.random.default_rng(8).normal(size=20) * 200.0:
            body = composites.composite([(light, (across, 0.0, far), bodies.IDENTITY),
                                     (heavy, (-0.025, 0.0, -1e-3 * far), bodies.IDENTITY)])
            assert min(body.about_center.moments) >= 0.0
            assert min(body.about_origin.moments) >= 0.0
