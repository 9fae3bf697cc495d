# SPDX-License-Identifier: Apache-2.0
"""The restitution that an impact can have."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.integrators.equations.contact_impacts import bearable, loss_of

pytestmark = pytest.mark.without_numba

G = ((2.0, 0.0, 1.2), (0.0, 1.0, 0.0), (1.2, 0.0, 1.0))


@pytest.mark.parametrize('along', [-2.0, -1.0, -0.5])
def test_an_impact_that_sticks_rebounds_with_all_the_energy_that_there_is(along):
    """With J = -G^-1 (u_t, (1 + e) u_n) the loss is (u . G^-1 u - e^2 u_n^2 (G^-1)_nn)/2."""
    before, inverse = (along, 0.0, -1.0), np.linalg.inv(G)
    most = np.sqrt(before @ inverse @ before / inverse[2, 2])
    assert most < 1.0
    assert loss_of(G, before, 1.0, np.inf) < 0.0
    assert bearable(G, before, 1.0, np.inf) == near(most, rel=1e-15)    # 2.2e-16
    assert bearable(G, before, 0.5 * most, np.inf) == 0.5 * most
    assert abs(loss_of(G, before, bearable(G, before, 1.0, np.inf), np.inf)) < 1e-15    # 1.1e-16


@pytest.mark.parametrize('mu', [0.0, 0.1, 0.3, 0.8])
@pytest.mark.parametrize('restitution', [0.0, 0.5, 1.0])
def test_no_impact_creates_energy_and_none_loses_restitution_without_need(mu, restitution):
    for along in np.linspace(-3.0, 3.0, 25):
        before = float(along), 0.2, -1.0
        e = bearable(G, before, restitution, mu)
        assert loss_of(G, before, e, mu) >= 0.0
        if e < restitution:    # more would create energy
            assert loss_of(G, before, e + 1e-12, mu) < 0.0
