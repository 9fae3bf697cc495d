# SPDX-License-Identifier: Apache-2.0
"""How a sweep is cut into pieces: by what is known of its speed, for workers to share evenly."""

import types

import pytest

from rigid_body_sim.sweeps import engine


def plan(size, quick=True, block=1000):
    """Return what is asked of a Plan; `block` is the number of runs that fill a block."""
    return types.SimpleNamespace(spec=types.SimpleNamespace(size=size), is_quick=quick,
                                 bytes=engine.BLOCK_BYTES // block)


def pieces(one, rates, workers=1):
    rates = iter(rates)
    return list(engine.pieces_in_memory(
        one, types.SimpleNamespace(count=workers), lambda: next(rates, None)))


@pytest.mark.parametrize('size', [1, 2, 7, 1000])
@pytest.mark.parametrize('rate', [None, 0.01, 3.0, 1e9])
@pytest.mark.parametrize('workers', [1, 3])
def test_pieces_follow_one_another_to_the_end(size, rate, workers):
    found = pieces(plan(size), [rate] * (size + 1), workers)
    assert [number for _, _, number in found] == list(range(len(found)))
    assert [first for first, _, _ in found] == [0, *(stop for _, stop, _ in found[:-1])]
    assert found[-1][1] == size
    assert all(stop > first for first, stop, _ in found)


def test_a_piece_takes_a_second_a_fair_share_or_a_block_whatever_is_least():
    sizes = [stop - first for first, stop, _ in pieces(plan(100_000), [None, 50.0, 200.0, 1e6])]
    first = min(engine.FIRST_QUICK, 1000)
    assert sizes[:4] == [first, 50 * engine.SECONDS, 200 * engine.SECONDS, 1000]
    slow = [stop - first for first, stop, _ in pieces(plan(100_000, quick=False), [None])]
    assert slow[0] == min(engine.FIRST_PIECE, 1000)
    shared = pieces(plan(160, block=10 ** 6, quick=False), [1e6] * 20, workers=4)
    assert {stop - first for first, stop, _ in shared} == {160 // (engine.PIECES * 4)}
    least = engine.ENOUGH_QUICK
    for workers, size, count in ((1, 3 * least, 3), (2, 4 * least, 4), (2, least, 2)):
        found = pieces(plan(size, block=10 ** 6), [1e9] * 20, workers)
        assert len(found) == count
        assert {stop - first for first, stop, _ in found} == {size // count}
    rare = pieces(plan(5, block=10 ** 6), [0.2] * 20)
    assert {stop - first for first, stop, _ in rare} == {1}


@pytest.mark.parametrize(('seconds', 'workers', 'runs'), [
    (1e-3, 1, 1000), (1e-2, 1, 100), (1e-4, 2, 10_000),    # a second
    (3.0, 1, 1), (1e-9, 1, 2**15),    # at least a run, at most a block
    (1e-3, 1000, 125), (1e-4, 400, 500),    # an eighth of what each of the workers does; 0.05 s
    (1e-2, 400, 200)])    # 400 workers ask once in 2 s each, the leader serves 200 a second
def test_blocks_of_a_store(seconds, workers, runs):
    assert engine.block_runs(plan(1_000_000, block=2**15), seconds, workers) == runs


def test_a_run_that_fills_more_than_a_block_is_a_piece(monkeypatch):
    one = plan(3, quick=False)
    one.bytes = 2 * engine.BLOCK_BYTES
    assert pieces(one, [1e9] * 4) == [(0, 1, 0), (1, 2, 1), (2, 3, 2)]
    monkeypatch.setattr(engine, 'SECONDS', 0.5)
    assert pieces(plan(1000), [100.0])[0] == (0, 50, 0)


def measured(monkeypatch, one, patience, seconds):
    """Return the time of a run, and (first, stop) of what ran; runs take `seconds(count)`."""
    calls, clock = [], [0.0]

    def compute(_, first, stop):
        calls.append((first, stop))
        clock[0] += seconds(stop - first)
    monkeypatch.setattr(engine, 'compute', compute)
    monkeypatch.setattr(engine, 'time', types.SimpleNamespace(perf_counter=lambda: clock[0]))
    one.template_run = 3
    return engine.seconds_a_run(one, patience), calls


@pytest.mark.parametrize(('size', 'block', 'counts'), [
    (1000, 10 ** 6, [1, 4, 16, 64, 256, 1000]),    # at most all runs
    (1000, 20, [1, 4, 16, 20]), (1, 20, [1]), (7, 20, [1, 4, 7]), (2, 20, [1, 2])])    # or a block
def test_the_time_of_a_run_is_measured_on_more_and_more_runs_of_the_middle(
        monkeypatch, size, block, counts):
    took, calls = measured(
        monkeypatch, plan(size, block=block), 1e9, lambda count: 0.25 + 0.5 * count)
    assert took == 0.25 / counts[-1] + 0.5
    compiling = {min(3, size - 1), (size - 1) // 2}
    begun, runs = calls[:len(compiling)], calls[len(compiling):]
    assert {(first, first + 1) for first in compiling} == set(begun)
    assert runs == [((size - count) // 2, (size - count) // 2 + count) for count in counts]


@pytest.mark.parametrize(('patience', 'counts'), [
    (0.0, [1]), (4.9, [1]), (5.0, [1, 4]), (20.9, [1, 4]), (21.0, [1, 4, 16])])
def test_runs_are_measured_while_there_is_patience_for_four_times_as_many(
        monkeypatch, patience, counts):
    _, calls = measured(monkeypatch, plan(1000), patience, float)    # a run takes 1 s
    assert [stop - first for first, stop in calls[2:]] == counts
