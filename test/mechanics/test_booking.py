# SPDX-License-Identifier: Apache-2.0
"""The part of a torque that the ledger counts as turning the body."""

import types

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.mechanics.booking import _taken
from rigid_body_sim.mechanics.parameters import FREE, HINGE, PIVOT

pytestmark = pytest.mark.without_numba

AXIS, ACROSS = np.array([0.48, -0.6, 0.64]), np.array([0.8, 0.0, -0.6])


@pytest.mark.parametrize(('along', 'grip', 'rate', 'left'), [
    (2.0, 0.0, 0.0, 2.0), (2.0, 0.5, 0.0, 1.5), (-2.0, 0.5, 0.0, -1.5), (0.4, 0.5, 0.0, 0.0),
    (-0.4, 0.5, 0.0, 0.0), (2.0, 0.5, 1e-9, 2.0), (-0.4, 0.5, -1e-9, -0.4)])
def test_a_hinge_takes_the_part_along_its_axis_less_what_friction_holds_at_rest(
        along, grip, rate, left):
    scene = types.SimpleNamespace(kind=HINGE, hinge_axis=tuple(AXIS), grip=grip)
    found = _taken(scene, tuple(rate * AXIS), tuple(along * AXIS + 3.0 * ACROSS))
    assert found == pytest.approx(left * AXIS, abs=1e-15)    # measured: 2e-16


@pytest.mark.parametrize('kind', [FREE, PIVOT])
@pytest.mark.parametrize('none', [None, 0, 1, 2])
def test_no_torque_turns_a_body_about_an_axis_without_a_moment(kind, none):
    turn, torque = Rotation.random(random_state=3), np.array([1.0, -2.0, 3.0])
    moments = tuple(0.0 if k == none else 0.5 + 0.1 * k for k in range(3))
    scene = types.SimpleNamespace(kind=kind, axes=tuple(turn.as_quat()), moments=moments)
    own = turn.inv().apply(torque)
    if none is not None:
        own[none] = 0.0
    assert _taken(scene, (0.0, 0.0, 0.0), tuple(torque)) == near(turn.apply(own), rel=1e-14)
