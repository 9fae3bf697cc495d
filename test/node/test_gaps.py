# SPDX-License-Identifier: Apache-2.0
"""Lost messages, told by the numbers of those that came."""

import pytest

from rigid_body_sim.node.gaps import Gaps


def lost(*numbers, publishers=('a',)):
    gaps = Gaps(lambda: set(publishers))
    gaps.look(numbers)
    return gaps.lost


@pytest.mark.parametrize(('numbers', 'missing'), [
    ((1, 2, 3), 0), ((37, 38), 0), ((1, 2, 5), 2), ((1, 5, 6, 9), 5), ((), 0), ((None, None), 0)])
def test_of_one_publisher(numbers, missing):
    assert lost(*numbers) == missing


@pytest.mark.parametrize(('numbers', 'missing'), [
    ((1, 1, 2, 2, 3), 0), ((1, 500, 2, 501), 0), ((1, 500, 2, 503, 3, 504), 2),
    # 2 to 599 and 501 to 698 are missing; the first gap is put down to the one that was at 500
    ((1, 500, 600, 699, 601, 700), 598 + 198)])
def test_of_two_publishers(numbers, missing):
    assert lost(*numbers, publishers=('a', 'b')) == missing


def test_who_comes_later_has_lost_nothing_and_who_goes_neither():
    publishers = {'a'}
    gaps = Gaps(publishers.copy)
    gaps.look([1, 2, 3])
    publishers.add('b')
    gaps.look([700, 4, 701, 5])
    assert gaps.lost == 0
    publishers.remove('a')
    # at 710 it is found that one is gone: the gap may be no gap
    gaps.look([702, 703, 710, 711, 720])
    assert gaps.lost == 8
    publishers.clear()
    gaps.look([721, 730, 731])
    assert gaps.lost == 8


def test_publishers_are_looked_up_only_for_numbers_that_nobody_expects():
    looked = []
    gaps = Gaps(lambda: looked.append(1) or {'a', 'silent'})
    gaps.look(range(1, 1000))
    assert len(looked) == 1
    # the silent one begins: it takes the place of what was expected of the other one
    gaps.look([2000, 1, 2001, 2, 3, 2002])
    assert len(looked) == 3
