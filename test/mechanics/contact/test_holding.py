# SPDX-License-Identifier: Apache-2.0
"""Dry rolling friction where a rolling ends."""

import types

import numpy as np
import pytest
from mechanics.contact.test_touch import axes, parameters
from near import near

from rigid_body_sim.mechanics.contact.holding import rolling_couples
from rigid_body_sim.mechanics.contact.parameters import SLOW

ROLLS = ', sliding_friction: {mu: 0.3}, rolling_friction: {dry: 0.01}'


def wrung(share):
    """Return the couple for each newton of N at a share of the least speed that counts, m."""
    c, rows = parameters('sphere', ROLLS)._replace(swift=2.0, way=(0.0, 1.0)), axes(3)
    moved = tuple((share * SLOW * c.swift * np.array(rows[0])).tolist())
    return np.array(rolling_couples(c, types.SimpleNamespace(axes=rows, moved=moved), c.way)[1])


@pytest.mark.parametrize('share', [1e-3, 0.25, 0.5])
def test_friction_goes_to_zero_with_the_rolling_against_which_it_acts(share):
    """It is against s', whichever way the phase began, and continuous where s' counts again."""
    full = wrung(1.0)
    assert np.linalg.norm(full) > 0.0
    assert wrung(share) == near(share * full, rel=1e-12)
    assert wrung(-share) == near(-share * full, rel=1e-12)
    assert wrung(3.0) == near(full, rel=1e-12)
    assert (wrung(0.0) == 0.0).all()
