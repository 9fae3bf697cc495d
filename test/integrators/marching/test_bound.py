# SPDX-License-Identifier: Apache-2.0
"""The places in a piece of a march, and the numbers with which one begins."""

import math
import types

import numpy as np
import pytest

from rigid_body_sim.integrators.marching import bound, track
from rigid_body_sim.integrators.marching.bound import Bound
from rigid_body_sim.integrators.marching.points import SCALES, TIME, VALUES

PLACES = 3, 5, 5 + VALUES + 2, 5 + 2 * (VALUES + 2)    # of 3 parameters, 2 controls, 2 values
LENGTH = VALUES + 2
SIZE = PLACES[-1] + track.STORE + track.CHECKPOINTS * LENGTH


def made(monkeypatch, breakpoints=(), modes=()):
    """Return a Bound of made-up equations, (the times asked for, what its track was made of)."""
    asked, tracks = [], []

    def held(time):
        asked.append(time)
        return np.array([time, 1.0, 2.0])
    equations = types.SimpleNamespace(
        parameter_count=3, breakpoints=breakpoints, modes=list(modes), held=held, write='write',
        kernels=types.SimpleNamespace(__name__='kernels'))
    family = types.SimpleNamespace(
        equations_of=lambda scene, wrench: equations,
        march=lambda method, of, adapts: types.SimpleNamespace(
            __name__=f'march, {adapts}', arrive=None),
        begin=lambda stepped, march: (np.array([stepped.accuracy, 7.0]), np.arange(LENGTH)))
    monkeypatch.setattr(bound, '_track', lambda *names: tracks.append(names) or 'track')
    stepped = types.SimpleNamespace(scene=None, wrench=None, step=None, accuracy=0.5)
    return Bound(types.SimpleNamespace(FAMILY=family), stepped), stepped, asked, tracks


def test_a_piece_holds_parameters_control_two_points_counts_and_those_that_are_kept(monkeypatch):
    of, _, _, tracks = made(monkeypatch)
    assert (of.point, of.piece_size, of.track) == (5, SIZE, 'track')
    assert tracks == [('march, True', 'kernels', 'write', PLACES, False)]
    piece = np.arange(float(SIZE))
    parts = of.parts_of(piece)
    assert [part.tolist() for part in parts] == [
        [*range(3, 5)], [*range(5, 5 + LENGTH)], [*range(5 + LENGTH, 5 + 2 * LENGTH)]]
    assert all(np.shares_memory(part, piece) for part in parts)
    piece[PLACES[-1] + 2] = 12.0
    assert of.steps_of(piece) == 12


def test_the_head_of_another_march_is_that_of_the_first_point_wherever_it_stands(monkeypatch):
    """The time stays, and so do the values; the points that are kept later are others."""
    of, *_ = made(monkeypatch)
    piece, head = np.zeros(SIZE), np.arange(1.0, VALUES)
    of.set_head(piece, head)
    first = 5, 5 + LENGTH, PLACES[-1] + track.STORE
    places = [begin + k for begin in first for k in range(1, VALUES)]
    assert piece.nonzero()[0].tolist() == places
    assert piece[places].tolist() == [*head] * 3


def test_a_march_that_none_went_before_has_the_least_scales(monkeypatch):
    of, *_ = made(monkeypatch)
    assert of.first_head(0.5).tolist() == [0.5, *range(SCALES, VALUES)]


def test_the_parameters_of_a_piece_are_those_that_hold_until_the_next_breakpoint(monkeypatch):
    of, _, asked, _ = made(monkeypatch, (1.0, 3.0))
    found = [of.prototype(time) for time in (0.0, 0.9, 1.0, 2.0, 3.0, 9.0)]
    assert asked == [0.0, 1.0, 3.0]
    assert [one[0] for one in found] == [0.0, 0.0, 1.0, 1.0, 3.0, 3.0]
    for one in found:
        assert one[1:].tolist() == [1.0, 2.0, 0.5, 7.0, *range(LENGTH)]


def test_a_solver_of_another_accuracy_shares_all_but_where_its_marches_begin(monkeypatch):
    of, stepped, _, _ = made(monkeypatch)
    of.prototype(0.0)
    stepped.accuracy = 0.25
    other = of.at(stepped)
    assert (other.track, other.point, other.equations) == (of.track, of.point, of.equations)
    assert other.prototype(0.0)[3:5].tolist() == [0.25, 7.0]
    assert of.prototype(0.0)[3:5].tolist() == [0.5, 7.0]


@pytest.mark.parametrize(('breakpoints', 'last'), [((), -math.inf), ((1.0, 3.0), 3.0)])
def test_a_run_in_one_call_begins_after_the_last_breakpoint(breakpoints, last, monkeypatch):
    of, stepped, asked, _ = made(monkeypatch, breakpoints)
    of.track = types.SimpleNamespace(final='kernel')
    kernel, room = of.runner(stepped, 0.0)
    assert (kernel, asked) == ('kernel', [last])
    assert len(room) == 5 + LENGTH + SIZE
    assert room[:5].tolist() == [last, 1.0, 2.0, 0.5, 7.0]
    assert room[5 + TIME] == last
    assert room[5 + TIME + 1:5 + LENGTH].tolist() == [*range(1, LENGTH)]
    _, room = of.runner(stepped, 3.0)    # a slower body is left to a course
    assert room[5 + TIME:5 + LENGTH].tolist() == [last, 9.0, *range(2, LENGTH)]
    assert made(monkeypatch, (), [0])[0].runner(stepped, 0.0) is None
    assert not of.KEEPS_ENTRIES


def test_what_has_kinks_is_followed_from_one_to_the_next(monkeypatch):
    monkeypatch.setattr(bound, 'Switched', lambda *of: ('switched', *of))
    monkeypatch.setattr(bound, 'Course', lambda *of: ('course', *of))
    for modes, name in (([], 'course'), ([3], 'switched')):
        of, stepped, _, _ = made(monkeypatch, (), modes)
        assert of.course(stepped) == (name, stepped, of)
