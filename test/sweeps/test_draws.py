# SPDX-License-Identifier: Apache-2.0
"""Random samples by their formulas, from words that are chosen; and how they are distributed."""

import math

import numpy as np
import pytest
from near import near
from scipy import stats
from scipy.spatial.transform import Rotation

from rigid_body_sim.sweeps.draws import DIRECTION, KINDS, NORMAL, ROTATION, UNIFORM, Sampled, fill

QUARTERS = [(u1, u2, u3) for u1 in (0.0, 0.25, 0.75) for u2 in (0.125, 0.5, 0.8)
            for u3 in (0.0, 0.3)]
WIDTHS = {UNIFORM: 1, NORMAL: 1, DIRECTION: 3, ROTATION: 4}


def made(kind, a, b, u):
    """Return the sample of three numbers in [0, 1)."""
    words = np.array([[*(int(part * 2.0 ** 53) << 11 | 2047 for part in u), 77]], np.uint64)
    out = np.full((1, WIDTHS[kind]), math.nan)
    fill(kind, words, a, b, out)
    return out[0]


@pytest.mark.parametrize('u', QUARTERS)
def test_a_sample_is_what_its_formula_says(u):
    u1, u2, u3 = u
    assert made(UNIFORM, 2.0, 6.0, u) == near([2.0 + 4.0 * u1], rel=1e-15)
    normal = math.sqrt(-2.0 * math.log(1.0 - u1)) * math.cos(2.0 * math.pi * u2)
    assert made(NORMAL, 2.0, 3.0, u) == pytest.approx([2.0 + 3.0 * normal], abs=1e-14)
    z = 2.0 * u1 - 1.0
    around, longitude = math.sqrt(1.0 - z * z), 2.0 * math.pi * u2
    assert made(DIRECTION, 5.0, 0.0, u) == pytest.approx(
        [5.0 * around * math.cos(longitude), 5.0 * around * math.sin(longitude), 5.0 * z],
        abs=1e-14)
    lesser, far, third = math.sqrt(1.0 - u1), math.sqrt(u1), 2.0 * math.pi * u3
    assert made(ROTATION, 0.0, 0.0, u) == pytest.approx(
        [lesser * math.sin(longitude), lesser * math.cos(longitude), far * math.sin(third),
         far * math.cos(third)], abs=1e-15)


def test_samples_are_distributed_as_they_should():
    """By the test of Kolmogorov and Smirnov on 4000 runs of one seed."""
    def fits(values, distribution):
        return stats.kstest(values, distribution).pvalue > 0.01
    assert fits(Sampled('uniform', 3.0, 5.0, 1, 'a').of_runs(0, 4000), stats.uniform(3, 2).cdf)
    assert fits(Sampled('normal', 3.0, 0.5, 1, 'a').of_runs(0, 4000), stats.norm(3, 0.5).cdf)
    points = Sampled('direction', 2.0, 0.0, 1, 'a').of_runs(0, 4000)
    assert np.linalg.norm(points, axis=1) == pytest.approx(np.full(4000, 2.0))
    for k in range(3):
        assert fits(points[:, k], stats.uniform(-2, 4).cdf)
    turned = Rotation.from_quat(Sampled('rotation', 0.0, 0.0, 1, 'a').of_runs(0, 4000))
    for axis in np.eye(3):
        for k in range(3):
            assert fits(turned.apply(axis)[:, k], stats.uniform(-1, 2).cdf)


@pytest.mark.parametrize('kind', KINDS)
def test_a_run_has_its_sample_whoever_asks_for_which_others(kind):
    sampled = Sampled(kind, 1.0, 2.0, 7, 'body.mass')
    all_at_once = sampled.of_runs(0, 20)
    width = WIDTHS[KINDS[kind]]
    assert all_at_once.shape == ((20,) if width == 1 else (20, width))
    pieces = [sampled.of_runs(first, first + 5) for first in range(0, 20, 5)]
    assert np.concatenate(pieces).tobytes() == all_at_once.tobytes()
    assert (sampled.of_runs(13, 14) == all_at_once[13]).all()
    for other in (Sampled(kind, 1.0, 2.0, 8, 'body.mass'), Sampled(kind, 1.0, 2.0, 7, 'b')):
        assert not (other.of_runs(0, 20) == all_at_once).any()
    assert len(np.unique(all_at_once, axis=0)) == 20
