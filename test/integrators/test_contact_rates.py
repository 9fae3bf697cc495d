# SPDX-License-Identifier: Apache-2.0
"""What is watched of a body on a plane: its gap in flight, as it falls and just after lift-off."""

import numpy as np
import pytest

from rigid_body_sim.integrators.equations.contact_rates import (
    FLIGHT,
    GAP,
    OMEGA,
    ROW,
    SIZE,
    WATCHED,
    U,
)
from rigid_body_sim.integrators.marching.contact import MODE, SWIFT, OnPlane
from rigid_body_sim.scene.scene import parse_scene

pytestmark = pytest.mark.without_numba

SCENE = parse_scene("""
scene: egg
body: {mass: 0.06, inertia: [3.0e-5, 3.4e-5, 2.0e-5],
       surface: {ellipsoid: {semi_axes: [0.022, 0.021, 0.03]}}}
constraint: table
effects: [gravity: {g: 9.81}]
initial: {angular_velocity: [0, 0, 0]}
""")


@pytest.mark.parametrize(('gap', 'speed', 'watched'), [
    (0.01, -1.0, 0.01), (0.01, 1.0, 0.01), (0.01, 0.0, 0.01), (-1e-18, -1.0, -1e-18),
    (-1e-18, 1e-6, 0.0), (-1e-18, 0.0, 0.0), (-1e-18, -1e-17, 0.0), (0.0, 1.0, 0.0)])
@pytest.mark.parametrize('turning', [(0.0, 0.0, 0.0), (0.0, 0.0, 3.0)])
def test_a_gap_ends_a_flight_when_it_shrinks_by_more_than_rounding(gap, speed, watched, turning):
    """A body that has just lifted off is not below the plane by the rounding of its gap."""
    bound = OnPlane(SCENE, None, None, None)
    p, y, row = bound.parameters(0.0), np.zeros(SIZE), np.empty(ROW)
    p[MODE], p[SWIFT] = FLIGHT, 1.0
    y[3], y[GAP], y[U + 2], y[OMEGA:U] = 1.0, gap, speed, turning
    bound.rates.rate(p, y, row)
    assert row[WATCHED] == watched
    assert row[GAP] == pytest.approx(speed, abs=1e-15)
    assert row[U + 2] == pytest.approx(-9.81)
