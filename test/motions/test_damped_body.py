# SPDX-License-Identifier: Apache-2.0
"""Which drag leaves a free rotation, only slower: that in proportion to the inertia."""

import types
from fractions import Fraction

import numpy as np
import pytest

from rigid_body_sim.motions import damped_body
from rigid_body_sim.scene.scene import parse_scene

pytestmark = pytest.mark.without_numba


@pytest.mark.parametrize(('inertia', 'drag', 'rate'), [
    ([0.5, 0.75, 1.0], 0.0 * np.eye(3), 0), ([0.5, 0.5, 0.5], 0.25 * np.eye(3), Fraction(1, 2)),
    ([0.5, 0.75, 1.0], [[0.25, 0, 0], [0, 0.375, 0], [0, 0, 0.5]], Fraction(1, 2)),
    # a difference of a few roundings is none
    ([0.5, 0.75, 1.0], [[0.25, 1e-17, 0], [1e-17, 0.375, 0], [0, 0, 0.5]], Fraction(1, 2)),
    ([0.5, 0.75, 1.0], [[0.25, 0, 0], [0, 0.375, 0], [0, 0, 0.5 - 2.0 ** -53]], Fraction(1, 2)),
    ([0.5, 0.5, 0.0], [[0.25, 0, 0], [0, 0.25, 0], [0, 0, 0]], Fraction(1, 2)),
    # nothing turns about an axis without a moment
    ([0.5, 0.5, 0.0], [[0.25, 0, 0], [0, 0.25, 0], [0, 0, 0.7]], Fraction(1, 2)),
    ([0.5, 0.0, 0.5], [[0.25, 0.1, 0], [0.1, 0.7, 0], [0, 0, 0.25]], Fraction(1, 2)),
    ([0.5, 0.5, 0.0], [[0, 0, 0], [0, 0, 0], [0, 0, 0.7]], 0), ([0, 0, 0], np.eye(3), 0),
    ([0.5, 0.75, 1.0], [[0.25, 0, 0], [0, 0.375, 0], [0, 0, 0.51]], None),
    ([0.5, 0.75, 1.0], [[0.24, 0, 0], [0, 0.375, 0], [0, 0, 0.5]], None),
    ([0.5, 0.75, 1.0], [[0.25, 0, 0], [0, 0.375, 0], [0, 0, 0.5 + 1e-15]], None),
    ([0.5, 0.75, 1.0], [[0.25, 0.01, 0], [0.01, 0.375, 0], [0, 0, 0.5]], None),
    ([0.5, 0.75, 1.0], [[0.25, 0, 0], [0, 0.375, 1e-15], [0, 1e-15, 0.5]], None)])
def test_drag_in_proportion_to_the_inertia_has_a_rate(monkeypatch, inertia, drag, rate):
    """It is exact; there is none where the drag has another shape."""
    total = types.SimpleNamespace(drag=tuple(map(tuple, (-np.array(drag)).tolist())))
    monkeypatch.setattr(damped_body, 'total_pull', lambda scene: total)
    assert damped_body.damping(parse_scene(
        f'scene: s\nbody: {{mass: 1.0, inertia: {inertia}, center_of_mass: [0, 0, 1]}}\n'
        'constraint: free\neffects: []\ninitial: {}\n')) == rate
