# SPDX-License-Identifier: Apache-2.0
"""The flows of a body on a hinge beside the formulas, with what their sums lose."""

from fractions import Fraction

import pytest

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations import flows_hinged

pytestmark = pytest.mark.without_numba

ACTS = 'def rate(p, y):\n    return None, p[0] * y[0] + p[1] * y[1] * y[1]\n'
P, Y, LOST, H = (-3.0, 0.5), (0.7, -1.9), (3e-17, -7e-18), 0.013


def growth(phi, speed):
    """Return what the kernel above does, rounded as it rounds."""
    return P[0] * phi + P[1] * speed * speed


def after(flow):
    """Return angle and rate after a flow, exactly."""
    y, c = getattr(specialise(flows_hinged, rate=ACTS), flow)(P, Y, LOST, H)
    return [Fraction(one) + Fraction(lost) for one, lost in zip(y, c, strict=True)]


@pytest.mark.parametrize(('flow', 'turned', 'hastened'), [
    ('drift', H * Y[1], 0.0), ('kick', 0.0, H * growth(*Y)),
    ('kick_with_heat', 0.0, H * growth(Y[0], Y[1] + 0.5 * H * growth(*Y)))])
def test_a_flow_changes_one_unknown_by_its_rate_and_loses_nothing(flow, turned, hastened):
    """A drift goes on with the rate, a kick changes it; with drag by that of the midpoint."""
    expected = [Fraction(one) + Fraction(lost) + Fraction(more)
                for one, lost, more in zip(Y, LOST, (turned, hastened), strict=True)]
    # measured: 3e-33
    assert all(abs(one - other) < 1e-31 for one, other in zip(after(flow), expected, strict=True))
