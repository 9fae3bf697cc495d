# SPDX-License-Identifier: Apache-2.0
"""Lateness in bins of a microsecond: percentiles are never too small, the greatest is exact."""

import numpy as np
import pytest

from rigid_body_sim.realtime.lateness import BINS, Lateness


def of(*nanoseconds):
    found = Lateness()
    for one in nanoseconds:
        found.add(one)
    return found


def seconds(count, p50, p99, most):
    return pytest.approx({'count': count, 'p50': p50, 'p99': p99, 'max': most})


def test_of_nothing_all_is_zero():
    assert Lateness().summary() == {'count': 0, 'p50': 0.0, 'p99': 0.0, 'max': 0.0}


def test_a_percentile_is_the_upper_edge_of_its_bin_and_at_most_the_greatest():
    assert of(1500).summary() == seconds(1, 1.5e-6, 1.5e-6, 1.5e-6)
    assert of(1000, 1999, 5000).summary() == seconds(3, 2e-6, 5e-6, 5e-6)
    assert of(*[500] * 98, 7500, 9900).summary() == seconds(100, 1e-6, 8e-6, 9.9e-6)
    assert of(*[500] * 50, *[3500] * 50).summary() == seconds(100, 1e-6, 3.5e-6, 3.5e-6)


def test_what_is_early_counts_as_punctual_and_what_is_very_late_in_the_last_bin():
    found = of(-5000, 3_000_000_000, 4_000_000_000).summary()
    assert found['count'] == 3
    assert found['max'] == 4.0
    assert found['p50'] == pytest.approx(BINS * 1e-6) == 0.02
    assert of(-5000, -1, 2500).summary() == seconds(3, 1e-6, 2.5e-6, 2.5e-6)


def test_ticks_that_are_never_late_have_no_greatest_lateness():
    found = of(-5000)
    assert found.worst == found.summary()['max'] == found.since_last()['max'] == 0
    found.add(-1)
    assert found.worst == found.summary()['max'] == found.since_last()['max'] == 0


def test_what_is_new_since_the_last_look_is_told_once_and_the_whole_run_stays():
    found = of(1000, 9000)
    assert found.since_last() == seconds(2, 2e-6, 9e-6, 9e-6)
    found.add(3000)
    assert found.summary() == seconds(3, 4e-6, 9e-6, 9e-6)
    assert found.since_last() == seconds(1, 3e-6, 3e-6, 3e-6)
    assert found.since_last() == {'count': 0, 'p50': 0.0, 'p99': 0.0, 'max': 0.0}
    found.add(2000)
    assert found.summary()['max'] == 9e-6
    assert found.worst == 9000


def test_percentiles_are_those_of_numpy_to_a_bin():
    draw = np.random.default_rng(1).exponential(2e5, 3000).astype(int)
    found = of(*draw.tolist()).summary()
    for name, share in (('p50', 50), ('p99', 99)):
        exact = np.percentile(draw, share) * 1e-9
        assert exact - 1e-6 < found[name] < exact * 1.01 + 2e-6
