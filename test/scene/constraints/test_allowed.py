# SPDX-License-Identifier: Apache-2.0
"""Which starts of a constraint are ones that it allows, by hand; rounding counts as allowed."""

import types

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.constraints.allowed import refuse_forbidden
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.expressions.path import path
from rigid_body_sim.scene.expressions.reader import read
from rigid_body_sim.scene.state import State

TURN = Rotation.from_rotvec([0.4, -0.7, 0.2])
UNIT = TURN.as_quat()
AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
OMEGA, AT, POSITION = np.array([0.3, -0.8, 1.2]), np.array([0.3, -0.2, 0.5]), [1.0, 2.0, -1.5]
PATH = path(tuple(read(text, {'t'}, 'here') for text in ('0.1 + 0.5*t', '2*t', '0.3')), ())
SPEED = np.array([0.5, 2.0, 0.0])    # of the path, which begins at (0.1, 0, 0.3)


def refused(mechanism, turn=UNIT, omega=OMEGA, place=POSITION, velocity=(0.0, 0.0, 0.0), axis=None,
            path=None, keys=('position',), position=POSITION):
    """Return what is said of a state, or '' if it is allowed."""
    constraint = types.SimpleNamespace(
        kind='own', mechanism=mechanism, axis=axis, path=path, point=lambda body: AT.tolist(),
        holds_a_point=mechanism in (Mechanism.POINT, Mechanism.AXIS), INITIAL=dict.fromkeys(keys))
    state = State.of(0.0, turn, omega, place, velocity)
    try:
        refuse_forbidden(state, constraint, types.SimpleNamespace(position=position), None, 'here')
    except BadInput as refusal:
        return str(refusal)
    return ''


@pytest.mark.parametrize(('size', 'said'), [
    (1.0, ''), (1.0 + 1e-13, ''), (1.0 - 1e-11, 'the orientation'),
    (1.0 + 1e-11, 'the orientation')])
def test_an_orientation_has_the_norm_1(size, said):
    found = refused(Mechanism.FREE, turn=size * UNIT)
    assert said in found and bool(said) == bool(found)


@pytest.mark.parametrize(('velocity', 'said'), [
    ([3.0, 1.0, 0.0], ''), ([3.0, 1.0, 5e-324], 'the vertical velocity 5e-324 m/s'),
    ([3.0, 1.0, -0.1], 'the vertical velocity -0.1 m/s')])
def test_on_a_table_nothing_moves_up_or_down(velocity, said):
    found = refused(Mechanism.TABLE, velocity=velocity)
    assert said in found and bool(said) == bool(found)
    assert refused(Mechanism.FREE, velocity=velocity) == ''


def held(omega, point=POSITION, moves=(0.0, 0.0, 0.0)):
    """Return place and velocity of the origin of a body whose point AT is there and moves so."""
    arm = TURN.apply(AT)
    return {'omega': omega, 'place': point - arm,
            'velocity': moves - np.cross(TURN.apply(omega), arm)}


@pytest.mark.parametrize(('axis', 'beside', 'said'), [
    (AXIS, 0.0, ''), (AXIS, 1e-14, ''), (AXIS, 1e-11, 'the angular velocity'),
    (AXIS * (1.0 + 1e-13), 0.0, ''), (AXIS * (1.0 + 1e-11), 0.0, 'has the axis'),
    (AXIS * (1.0 - 1e-11), 0.0, 'has the axis'), (None, 0.0, 'has the axis None')])
def test_about_an_axis_a_body_turns_along_it(axis, beside, said):
    omega = 20.0 * (AXIS + beside * np.array([1.0, 2.0, 0.0]))    # across the axis
    found = refused(Mechanism.AXIS, axis=None if axis is None else axis.tolist(), **held(omega))
    assert said in found and bool(said) == bool(found)


@pytest.mark.parametrize(('path', 'start', 'moves'), [
    (None, POSITION, np.zeros(3)), (PATH, POSITION + np.array([0.1, 0.0, 0.3]), SPEED)])
def test_a_point_that_is_held_is_where_it_is_held_and_moves_with_it(path, start, moves):
    def found(place=0.0, velocity=0.0, **more):
        given = held(OMEGA, start, moves)
        given['place'] = given['place'] + np.array([0.0, place, 0.0])
        given['velocity'] = given['velocity'] + np.array([0.0, 0.0, velocity])
        return refused(Mechanism.POINT, path=path, **given, **more)
    assert found() == found(place=1e-13, velocity=-1e-13) == ''
    for wrong in (-1e-10, 1e-10):
        assert 'its held point at' in found(velocity=wrong) and 'm/s' in found(velocity=wrong)
        assert 'the place that position says' in found(place=wrong)
        assert found(place=wrong, keys=()) == ''    # of a place of its own nothing is known


@pytest.mark.parametrize('size', [1e6, 1e-6])
def test_rounding_is_a_share_of_what_is_rounded(size):
    """The rounding of the arm, 1e-16 m, is that share where nothing is far away."""
    place = [size * x for x in POSITION] if size > 1.0 else POSITION
    given = held(size * OMEGA, np.array(place))
    off = given | {'velocity': given['velocity'] + 1e-14 * size}
    assert refused(Mechanism.POINT, position=place, **off) == ''
    off = given | {'velocity': given['velocity'] + 1e-10 * size}
    assert 'm/s' in refused(Mechanism.POINT, position=place, **off)
    off = given | {'place': given['place'] + 1e-14 * max(size, 1.0)}
    assert refused(Mechanism.POINT, position=place, **off) == ''
    off = given | {'place': given['place'] + 1e-10 * max(size, 1.0)}
    assert 'position says' in refused(Mechanism.POINT, position=place, **off)
