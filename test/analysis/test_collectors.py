# SPDX-License-Identifier: Apache-2.0
"""Thinning: what is kept was there, and no extreme is lost, however the blocks fall."""

import numpy as np
import pytest

from rigid_body_sim.analysis.collectors import Curve, Head, Samples

RANDOM = np.random.default_rng(7)


def blocks(count):
    """Yield slices that cut `count` samples into blocks of any size."""
    begin = 0
    while begin < count:
        end = begin + int(RANDOM.integers(1, 700))
        yield slice(begin, end)
        begin = end


@pytest.mark.parametrize('count', [1, 99, 1000, 1001, 12345])
def test_a_thinned_curve_has_the_least_and_the_greatest_of_every_group(count):
    times, values = np.arange(count) * 0.5, RANDOM.normal(size=(count, 3))
    values[count // 3, 1] = 1e6    # one spike
    curve = Curve(count, points=1000)
    for block in blocks(count):
        curve.add(times[block], values[block])
    for k in range(3):
        kept_times, kept = curve.curve(k)
        assert len(kept) <= 1002 and np.all(np.diff(kept_times) >= 0.0)
        assert values[(kept_times / 0.5).astype(int), k].tolist() == kept.tolist()
        if count <= 1000:
            assert kept.tolist() == values[:, k].tolist()
        group = -(-2 * count // 1000) if count > 1000 else 1
        for begin in range(0, count, group):
            last = times[min(begin + group, count) - 1]
            inside = kept[(kept_times >= times[begin]) & (kept_times <= last)]
            part = values[begin:begin + group, k]
            assert (inside.min(), inside.max()) == (part.min(), part.max())


def test_a_curve_of_one_column_and_of_nothing():
    curve = Curve(4)
    assert [part.tolist() for part in curve.curve()] == [[], []]
    curve.add(np.arange(4.0), np.arange(4.0))
    assert curve.curve()[1].tolist() == [0.0, 1.0, 2.0, 3.0]


def test_a_curve_as_long_as_wanted_is_kept_whole_though_it_never_changes():
    curve = Curve(32768)
    curve.add(np.arange(32768.0), np.zeros(32768))
    assert curve.curve()[0].tolist() == list(range(32768))
    longer = Curve(32769)    # of each three two are kept, here the first, twice
    longer.add(np.arange(32769.0), np.zeros(32769))
    assert longer.curve()[0].tolist() == np.repeat(np.arange(0, 32769, 3), 2).tolist()


def test_the_first_of_some_curves_is_returned_unless_another_is_wanted():
    curve = Curve(2)
    curve.add(np.arange(2.0), np.array([[1.0, 2.0], [3.0, 4.0]]))
    assert curve.curve()[1].tolist() == [1.0, 3.0]
    assert curve.curve(1)[1].tolist() == [2.0, 4.0]


def test_few_samples_are_all_kept_and_of_none_there_are_none():
    few = Samples(5, 100)
    few.add(np.arange(5))
    assert few.columns()[0].tolist() == [0, 1, 2, 3, 4]
    assert Samples(0, 100).columns() == []
    none = Samples(0, 100)
    none.add(np.arange(0))
    assert none.columns()[0].tolist() == []


def test_the_head_is_the_first_samples_whatever_the_blocks():
    head = Head(7)
    assert head.columns() == []
    for begin, end in ((0, 3), (3, 5), (5, 9), (9, 10)):
        numbers = np.arange(begin, end)
        head.add(numbers, np.stack([numbers, -numbers], axis=1))
    first, second = head.columns()
    assert first.tolist() == [0, 1, 2, 3, 4, 5, 6]
    assert second.tolist() == [[k, -k] for k in range(7)]


def test_samples_are_evenly_spaced_across_blocks():
    count = 9999
    numbers = np.arange(count)
    samples = Samples(count, 100)
    for block in blocks(count):
        samples.add(numbers[block], np.stack([numbers[block], -numbers[block]], axis=1))
    first, second = samples.columns()
    assert first.tolist() == list(range(0, count, 100))
    assert second.tolist() == [[k, -k] for k in range(0, count, 100)]
