"""Rotations: what `normalised` promises about its rounding. The rest is used, and so tested, everywhere."""

from fractions import Fraction

import numpy as np
import pytest
from near import near

from rigid_body_sim.rotations import normalised

ULP = 2.0**-52


def excess(q):
    """Return |q|^2 - 1 in units of 2^-52, exactly summed."""
    return float(sum(Fraction(part) ** 2 for part in q) - 1) / ULP


@pytest.mark.parametrize('scale', [1.0, 1.0 + 3e-9, 1.0 - 1e-6, 0.5, 3e5])
def test_normalised_has_no_side(scale):
    """Unit to an ulp or so, and as often too long as too short: rounding of a sum near 1 alone leaves a mean of 0.6."""
    rng = np.random.default_rng(4)
    starts = rng.normal(size=(4000, 4))
    starts *= scale / np.linalg.norm(starts, axis=1)[:, None]
    found = np.array([excess(normalised(*start.tolist())) for start in starts])
    assert np.abs(found).max() < 2.0                                # measured 1.3
    assert abs(found.mean()) < 5.0 * 0.4 / np.sqrt(4000) + 0.02     # spread 0.37; measured 0.00 to 0.02


def test_normalised_keeps_the_direction():
    q = normalised(0.3, -0.4, 1.2, 2.0)
    assert q == near(tuple(np.array([0.3, -0.4, 1.2, 2.0]) / np.sqrt(5.69)), 1e-15)
    assert normalised(0.0, 0.0, 0.0, -1.0) == (0.0, 0.0, 0.0, -1.0)
