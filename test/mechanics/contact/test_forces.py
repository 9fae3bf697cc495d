# SPDX-License-Identifier: Apache-2.0
"""The direction along which slip leaves a contact that no longer holds."""

import numpy as np
import pytest

from rigid_body_sim.mechanics.contact.forces import leaving
from rigid_body_sim.mechanics.contact.laws import System, slipping, sticking

pytestmark = pytest.mark.without_numba


@pytest.mark.parametrize('seed', range(6))
def test_slip_leaves_along_the_way_in_which_it_grows(seed):
    """U' under the friction against d is along d, which the force that would hold does not say."""
    draw = np.random.default_rng(seed)
    root = draw.normal(size=(3, 3))
    G = root @ root.T + 0.3 * np.eye(3)
    system = System(tuple(map(tuple, G.tolist())), (*draw.normal(size=2).tolist(), -2.0))
    fx, fy, N = sticking(system)
    mu = 0.3 * np.hypot(fx, fy) / abs(N)
    d = leaving(system, mu)
    u1, u2, _, A = slipping(system, mu, *d)
    assert np.hypot(*d) == pytest.approx(1.0, abs=1e-15)
    assert A > 0.0
    assert u1 * d[0] + u2 * d[1] > 0.0
    # measured: 9e-16
    assert abs(u1 * d[1] - u2 * d[0]) < 1e-14 * np.hypot(u1, u2)


def test_a_contact_that_nothing_draws_has_a_direction_too():
    system = System(((2.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (0.0, 0.0, -3.0))
    assert np.hypot(*leaving(system, 0.4)) == pytest.approx(1.0, abs=1e-15)
