# SPDX-License-Identifier: Apache-2.0
"""What acts on a body on a plane besides its contact: where and along which axes it is asked."""

import numpy as np
import pytest
from mechanics.contact.test_touch import parameters
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations import contact_acting
from rigid_body_sim.integrators.equations.contact_views import FLIGHT, SLIDING, UNKNOWNS
from rigid_body_sim.mechanics.contact.forces import posture
from rigid_body_sim.mechanics.contact.holding import gripped
from rigid_body_sim.mechanics.contact.parameters import HELD

pytestmark = pytest.mark.without_numba

ROWS = np.random.default_rng(1).normal(size=(11, 14)).round(3)
ACTS = ('def applied(p, *state):\n    return tuple(sum(a * b for a, b in zip(row, state, '
        f'strict=True)) for row in {ROWS.tolist()})\n')
Q = tuple(Rotation.random(random_state=5).as_quat().tolist())
OMEGA, V = (3.0, -8.0, 5.0), (0.4, -0.3, 0.2)


def bound(holds):
    """Return the template under what is another linear function of each argument."""
    return specialise(contact_acting, applied=ACTS, HOLDS=f'HOLDS = {holds}\n')


@pytest.mark.parametrize('normal', ['[0, 0, 1]', '[0.1, -0.2, 1]'])
@pytest.mark.parametrize('mode', [FLIGHT, SLIDING])
def test_what_acts_is_asked_in_the_world_a_moment_after_the_unknowns(mode, normal):
    """The centre of mass goes on with v along the plane, and is as high as its attitude says."""
    c = parameters('ellipsoid', table=f'{{table: {{normal: {normal}}}}}')._replace(
        mode=mode, began=2.0, origin=(0.7, -0.6))
    now = UNKNOWNS.load([0.0] * UNKNOWNS.size)._replace(time=0.3, place=(1.1, 1.2), gap=0.05)
    at = posture(c, Q, OMEGA)
    found = bound(False).applied_at(None, c, now, at, OMEGA, V, 0.01)
    plane = Rotation.from_quat(c.plane) if c.inclined else Rotation.identity()
    assert (normal == '[0, 0, 1]') is (c.inclined == 0.0)
    height = (0.05 if mode == FLIGHT else 0.0) - np.dot(at.axes[2], at.r)
    place = plane.apply([0.7 + 1.1 + 0.01 * V[0], -0.6 + 1.2 + 0.01 * V[1], height])
    q = (plane * Rotation.from_quat(Q)).as_quat()
    expected = ROWS @ [*q, *OMEGA, *plane.apply(V), 2.31, *place]
    other = ROWS @ [*-q, *OMEGA, *plane.apply(V), 2.31, *place]
    numbers = np.array([*plane.apply(found.force), *found.couple, found.work, found.heat,
                        *found.inner])
    # measured: 7e-15; the sign of q is free
    assert min(np.abs(numbers - one).max() for one in (expected, other)) < 1e-13


@pytest.mark.parametrize('holds', [True, False])
@pytest.mark.parametrize('way', [HELD, (0.6, 0.8)])
def test_rolling_friction_holds_a_body_whose_way_says_so(holds, way):
    """A body that is held turns about the normal alone, whatever couple acts."""
    c, kernels = parameters('ellipsoid', ', sliding_friction: {mu: 0.6}')._replace(way=way), bound(
        holds)
    free, held = posture(c, Q, OMEGA), holds and way == HELD
    at = kernels.posture_at(c, Q, OMEGA)
    assert at == (gripped(c, free) if held else free)
    couple = np.array([0.03, 0.05, -0.02])
    grown = np.array(kernels.hastened(c, at, tuple(couple)))
    n = np.array(at.axes[2])
    about = (n @ couple) / (n @ np.array(c.inertia) @ n) * n
    expected = about if held else np.linalg.solve(c.inertia, couple)
    assert grown == near(expected, rel=1e-12)


def test_a_disk_that_is_held_falls_by_what_friction_adds_to_its_rates():
    """Omega' = I^-1 couple less what friction takes, and the shift that keeps s' at 0."""
    c = parameters('disk', ', sliding_friction: {mu: 0.6}')._replace(way=HELD)
    kernels = bound(True)
    at, couple = kernels.posture_at(c, Q, OMEGA), (0.03, 0.05, -0.02)
    assert any(at.shift)
    expected = np.array(at.inverse) @ couple + at.shift
    assert kernels.hastened(c, at, couple) == near(expected, rel=1e-13)
