# SPDX-License-Identifier: Apache-2.0
"""The way from a state to the unknowns of a method, and back."""

import numpy as np
import pytest

from rigid_body_sim.integrators.equations.equations import Equations
from rigid_body_sim.integrators.equations.euler import lost_norm
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import STATE_SIZE, State

pytestmark = pytest.mark.without_numba


SKEW = [[0.3, 0.01, 0.0], [0.01, 0.4, 0.02], [0.0, 0.02, 0.5]]


@pytest.mark.parametrize(('inertia', 'center'), [
    ([3.0, 4.0, 5.0], (0.0, 0.0, 0.0)), ([3.0, 4.0, 5.0], (1.0, 0.0, 0.0)),
    ([3.0, 4.0, 5.0], (0.0, 1.0, 0.0)), ([3.0, 4.0, 5.0], (0.0, 0.0, 1.0)),
    (SKEW, (0.3, -0.2, 0.1))])
def test_what_is_written_is_what_was_read(inertia, center):
    """Whether the centre of mass, whose place is solved for, is the body's origin or beside it."""
    scene = parse_scene(
        f'scene: s\nbody: {{mass: 2.0, inertia: {inertia}, '
        f'center_of_mass: {list(center)}}}\nconstraint: free\neffects: [drag: {{linear: 1.0}}]\n'
        'initial: {}\n')
    start = State.of(1.5, (0.1, -0.5, 0.5, 0.7), (1.0, -2.0, 3.0), (1.0, 2.0, 3.0),
                     (0.1, -0.2, 0.3)).vector
    equations, out = Equations(scene, None), np.empty(STATE_SIZE)
    p, y = equations.start(start)
    equations.kernels.write(p, 1.5, tuple(y.tolist()), out)
    # measured: 5e-16
    assert out == pytest.approx(start, abs=4e-15)


@pytest.mark.parametrize(('q', 'lost'), [
    # numbers whose squares are doubles
    ((0.5, 0.5, 0.5, 0.5), 0.0), ((0.5, 0.0, 0.0, 0.0), 0.375), ((0.0, 0.25, 0.0, 0.0), 0.46875),
    ((0.0, 0.0, 2.0, 0.0), -1.5), ((0.0, 0.0, 0.0, 1.5), -0.625),
    ((0.5, -0.25, 0.125, 0.75), 0.5 * (1.0 - 0.890625))])
def test_what_a_norm_has_lost_is_half_of_what_its_square_lacks(q, lost):
    assert lost_norm(*q) == lost
