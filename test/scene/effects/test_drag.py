# SPDX-License-Identifier: Apache-2.0
"""Coefficients of drag: what counts as a number, which matrices take energy, what kernels know."""

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.effects.drag import Drag, ShapedDrag
from rigid_body_sim.scene.scene import parse_scene

TURN = Rotation.random(random_state=6).as_matrix()
SKEW = [[2, 1, 0], [1, 3, 0], [0, 0, 1]]


def read(drag, constraint='free'):
    """Return a drag and the frame of its scene."""
    scene = parse_scene(
        'scene: s\nbody: {mass: 2, inertia: [0.3, 0.4, 0.5], center_of_mass: [0, 0, 0.2]}\n'
        f'constraint: {constraint}\neffects: [drag: {{{drag}}}]\ninitial: {{}}\n')
    return scene.effects[0], scene.frame


def of_eigenvalues(*values):
    matrix = TURN * values @ TURN.T
    return (0.5 * (matrix + matrix.T)).tolist()


def test_matrices_that_are_numbers_are_read_as_these():
    assert read('linear: [[0.7, 0, 0], [0, 0.7, 0], [0, 0, 0.7]], '
                'angular: [[0.3, 0, 0], [0, 0.3, 0], [0, 0, 0.3]]')[0] == Drag(0.7, 0.3)
    assert read('linear: [[0.7, 0, 0], [0, 0.7, 0], [0, 0, 0.7]]')[0] == Drag(0.7, 0.0)
    assert read('linear: 0.7, angular: 0.3, quadratic: 0, angular_quadratic: 0')[0] == Drag(
        0.7, 0.3)


@pytest.mark.parametrize('drag', [
    'linear: [[1, 0, 0], [0, 1, 0], [0, 0, 2]]', 'linear: [[1, 0, 0], [0, 2, 0], [0, 0, 1]]',
    'linear: [[1, 0, 0.1], [0, 1, 0], [0.1, 0, 1]]', f'linear: 1, angular: {SKEW}',
    f'angular: 1, linear: {SKEW}', 'linear: 1, quadratic: 1', 'angular: 1, angular_quadratic: 1'])
def test_other_matrices_and_squares_are_not(drag):
    assert isinstance(read(drag)[0], ShapedDrag)


@pytest.mark.parametrize('size', [1e-8, 1.0, 1e8])
@pytest.mark.parametrize('values', [
    (1, 2, 3), (0, 1, 1), (0, 0, 1), (0, 0, 0), (0, 0.2, 2), (1e-9, 1, 1)])
def test_a_matrix_without_negative_eigenvalues_is_taken(size, values):
    """The rounding of a zero eigenvalue, either sign, is none."""
    matrix = of_eigenvalues(*(size * value for value in values))
    assert read(f'linear: {matrix}')[0].linear == near(np.array(matrix), 1e-15)


@pytest.mark.parametrize('size', [1e-8, 1.0, 1e8])
@pytest.mark.parametrize('values', [
    (-1, 2, 3), (-1e-9, 1, 1), (-1e-9, -1e-9, 1), (-1e-9, 0, 1), (-1, -2, 3), (-1, -2, -3)])
def test_a_matrix_with_a_negative_eigenvalue_is_refused(size, values):
    matrix = of_eigenvalues(*(size * value for value in values))
    with pytest.raises(BadInput, match='drives some motions'):
        read(f'linear: {matrix}')


@pytest.mark.parametrize('matrix', [
    [[1, 2, 0], [2, 1, 0], [0, 0, 1]], [[1, 0, 2], [0, 1, 0], [2, 0, 1]],
    [[1, 0, 0], [0, 1, 2], [0, 2, 1]], np.diag([-1, 0, 0]).tolist(), np.diag([0, -1, 0]).tolist(),
    np.diag([0, 0, -1]).tolist(), [[1, -0.9, -0.9], [-0.9, 1, -0.9], [-0.9, -0.9, 1]]])
def test_each_minor_counts(matrix):
    assert np.linalg.eigvalsh(matrix)[0] < 0.0
    with pytest.raises(BadInput, match='drives some motions'):
        read(f'linear: {matrix}')


@pytest.mark.parametrize('size', [1e-8, 1.0, 1e8])
def test_asymmetry_counts_beyond_rounding(size):
    def askew(share):
        return [[size, 0, 0], [0, size, size * share], [0, 0, size]]
    assert read(f'linear: {askew(1e-13)}')[0].linear[1][2] == near(0.5e-13 * size, 1e-12)
    with pytest.raises(BadInput, match='not symmetric'):
        read(f'linear: {askew(1e-11)}')


@pytest.mark.parametrize(('constraint', 'kernels'), [
    ('free', ['shaped_force']), ('pivot', ['shaped_moment']),
    ("{pivot: {motion: [0, 0, 'sin(t)']}}", ['carried_force', 'carried_moment'])])
def test_squares_have_a_root_and_what_is_in_proportion_is_a_polynomial(constraint, kernels):
    drag, frame = read(f'linear: {SKEW}, quadratic: 1, angular: {SKEW}, angular_quadratic: 2',
                       constraint)
    kernels = *kernels, *kernels, 'shaped_couple', 'shaped_couple'
    squares = [False] * (len(kernels) // 2 - 1) + [True] * (len(kernels) // 2 - 1) + [False, True]
    acting = drag.acting(frame, 0.0)
    assert [one.kernel.rpartition(':')[2] for one in acting] == list(kernels)
    assert [one.rooted for one in acting] == squares
    assert [one.polynomial for one in acting] == [not square for square in squares]
    assert {one.books for one in acting} == {'heat'}


def test_what_is_zero_does_not_act():
    [force] = read('quadratic: 1')[0].acting(read('quadratic: 1')[1], 0.0)
    assert (force.kernel.rpartition(':')[2], force.rooted) == ('shaped_force', True)
    drag, frame = read('angular_quadratic: 1', 'pivot')
    [couple] = drag.acting(frame, 0.0)
    assert (couple.kernel.rpartition(':')[2], couple.rooted) == ('shaped_couple', True)
