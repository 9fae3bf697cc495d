# SPDX-License-Identifier: Apache-2.0
"""The restitution that an impact can have."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.integrators.equations.contact_impacts import bearable, rebound

pytestmark = pytest.mark.without_numba

G = ((2.0, 0.0, 1.2), (0.0, 1.0, 0.0), (1.2, 0.0, 1.0))


@pytest.mark.parametrize('along', [-2.0, -1.0, -0.5])
def test_an_impact_that_sticks_rebounds_with_all_the_energy_that_there_is(along):
    """With J = -G^-1 (u_t, (1 + e) u_n) the loss is (u . G^-1 u - e^2 u_n^2 (G^-1)_nn)/2."""
    before, inverse = (along, 0.0, -1.0), np.linalg.inv(G)
    most = np.sqrt(before @ inverse @ before / inverse[2, 2])
    assert most < 1.0
    assert rebound(G, before, 1.0, np.inf).loss < 0.0
    found = bearable(G, before, 1.0, np.inf)
    assert found.restitution == near(most, rel=1e-15)    # 2.2e-16
    assert abs(found.loss) < 1e-15    # 1.1e-16
    assert found.after == pytest.approx((0.0, 0.0, most), abs=1e-15)    # 4e-16
    assert bearable(G, before, 0.5 * most, np.inf).restitution == 0.5 * most


@pytest.mark.parametrize('mu', [0.0, 0.1, 0.3, 0.8])
@pytest.mark.parametrize('restitution', [0.0, 0.5, 1.0])
def test_no_impact_creates_energy_and_none_loses_restitution_without_need(mu, restitution):
    for along in np.linspace(-3.0, 3.0, 25):
        before = float(along), 0.2, -1.0
        found = bearable(G, before, restitution, mu)
        assert found.loss >= 0.0
        if found.restitution < restitution:    # more would create energy
            assert rebound(G, before, found.restitution + 1e-12, mu).loss < 0.0
