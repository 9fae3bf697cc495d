# SPDX-License-Identifier: Apache-2.0
"""Runs start as their scenes say, each once; a run that fails fails alone."""

import itertools
import math
import types

import numpy as np
import pytest

from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.sweeps import runs
from rigid_body_sim.sweeps import spec as specs
from rigid_body_sim.sweeps.plan import GAVE_UP, REFUSED, Plan
from rigid_body_sim.sweeps.results import Block

HALF = math.sqrt(0.5)
NEARLY = [[0.0, 0.0, 0.0, 1.0 + k * 2.0 ** -53] for k in (-4, -3, -2, -1, 2, 4)]
"""Beside 1: a norm whose square is within two ulps of 1 stays as it is."""
TURNS = [[0.0, 0.0, 0.0, 1.0], [0.0, 3.0, 0.0, 4.0], [1.0, -2.0, 3.0, 0.5], [HALF, 0.0, HALF, 0.0],
         [1e-90, 2e-90, 0.0, 0.0], [3e-101, 0.0, 9e-101, 0.0], [1e-100, 0.0, 3e-101, 0.0],
         [0.0, 1e70, -1e70, 0.0], *NEARLY]


def plan(vary=None, sample=None, scene='tennis_racket', **more):
    return Plan(specs.read({'scene': scene, 'times': [1.0], 'keep': ['final'],
                            'vary': vary or {}, 'sample': sample or {}, **more}))


def begun(monkeypatch, one, first=0, stop=None):
    """Return (run -> start, how many runs were begun together each time, run -> why refused)."""
    starts, together, seen = {}, [], []

    def many(work, scene, of_scene, where):
        places = work.block.places(where).tolist()
        together.append(len(places))
        seen.extend(work.block.first + place for place in places)
        starts.update(zip(seen[-len(places):], of_scene.copy(), strict=True))
    monkeypatch.setattr(runs._Work, 'many', many)
    block = runs.compute(one, first, one.spec.size if stop is None else stop)
    assert len(set(seen)) == len(seen)
    refused = {first + k for k in np.flatnonzero(block.arrays['status'] == REFUSED).tolist()}
    assert refused >= set(block.texts)
    assert {len(array) for array in block.arrays.values()} == {block.size}
    return starts, together, block.texts


@pytest.mark.parametrize(('given', 'refused', 'together'), [
    ({'vary': {'initial.orientation': TURNS}}, [], [1, 1, 12]),    # tiny ones are scaled
    ({'vary': {'initial.orientation': [TURNS[1], [0.0] * 4, [0, 0, 1e80, 0], TURNS[2]]}},
     [1, 2], [2]),
    ({'vary': {'initial.spin': [3.0, -4.0, 1e76, 0.5]}}, [2], [3]),
    ({'vary': {'initial.angular_velocity.1': [0.0, 1e75, -1e75, 2e75],
               'initial.angular_velocity[2]': [1, 2]}}, [6, 7], [6]),
    ({'vary': {'initial.angular_velocity': [[1, 2, 3], [4, 5, 6]],
               'body.inertia.1': [2.0, 2.5]},
      'sample': {'runs': 3, 'initial.orientation': 'rotation',
                 'initial.velocity': {'direction': 2.0}}}, [], [6, 6]),
    ({'vary': {'initial.angular_velocity.0': [0.1, 0.2]},    # its scenes are its own
      'sample': {'runs': 2, 'body.mass': {'uniform': [1, 2]}}}, [], [1] * 4),
    ({'vary': {'initial.angular_velocity': [[1, 2, 3], [4, 5, 6]],    # replace each other
               'initial.angular_velocity.1': [3, 4]}}, [], [1] * 4)])
def test_runs_start_as_their_scenes_say_those_of_one_scene_together(
        monkeypatch, given, refused, together):
    one = plan(**given)
    starts, found, texts = begun(monkeypatch, one)
    assert sorted(texts) == refused
    assert sorted(found) == together
    for run, start in starts.items():
        assert start.tobytes() == one.scene_of(run).initial.vector.tobytes()
    assert sorted([*starts, *refused]) == list(range(one.spec.size))


@pytest.mark.parametrize(('key', 'is_chosen'), [
    ('initial.angular_velocity.0', True), ('body.mass', False)])
def test_what_was_chosen_for_the_template_is_for_its_scene_alone(monkeypatch, key, is_chosen):
    one, asked = plan({key: [1.0, 2.0]}), []

    def ensemble(scene, starts, times, method, *rest, **more):
        asked.append(method)
        raise NotConverged('body 0: it is not asked here')
    monkeypatch.setattr(runs, 'ensemble', ensemble)
    runs.compute(one, 0, 2)
    assert asked[0] is one.choice if is_chosen else asked == ['auto', 'auto']


def test_a_part_of_the_runs_starts_as_the_whole(monkeypatch):
    one = plan({'body.inertia.1': [2.0, 2.5, 2.2], 'initial.angular_velocity.0': [0.1, 0.2]},
               {'runs': 4, 'initial.orientation': 'rotation'})
    starts, _, _ = begun(monkeypatch, one, 6, 19)
    assert sorted(starts) == list(range(6, 19))
    assert all((start == one.scene_of(run).initial.vector).all() for run, start in starts.items())


def test_a_sample_is_refused_for_one_component_that_is_too_large(monkeypatch):
    one = plan(sample={'runs': 40, 'initial.velocity': {'direction': 1.2e75}})
    large = (np.abs(one.values(0, 40)['initial.velocity']) > 1e75).any(axis=1)
    _, together, texts = begun(monkeypatch, one)
    assert sorted(texts) == np.flatnonzero(large).tolist()
    assert together == [40 - large.sum()] and 0 < large.sum() < 40    # 26


@pytest.mark.parametrize('wrong', [
    [1, 2], [5], 5, 'a', ['1', '2', '3'], [True, 0, 0], [[1, 2, 3]], [math.nan, 0, 0],
    [0, 0, 10 ** 400], None, [1, 2, 3, 4]], ids=str)
def test_a_value_that_is_no_vector_is_refused_alone(monkeypatch, wrong):
    one = plan({'initial.position': [[0, 0, 0], wrong, wrong, np.array([0.0, 1.0, 2.0])]})
    starts, together, texts = begun(monkeypatch, one)
    assert together == [2]
    assert (starts[0][8:11].tolist(), starts[3][8:11].tolist()) == ([0, 0, 0], [0, 1, 2])
    assert sorted(texts) == [1, 2]
    assert all('initial.position' in text for text in texts.values())
    # nor does it matter who stands beside it
    assert sorted(begun(monkeypatch, one, 1, 3)[2]) == [1, 2]


@pytest.mark.parametrize('wrong', ['a', [4], True, None], ids=str)
def test_a_value_that_is_no_number_is_refused_alone(monkeypatch, wrong):
    one = plan({'initial.angular_velocity[1]': [5, wrong, 6.5]})
    starts, together, texts = begun(monkeypatch, one)
    assert together == [2] and sorted(texts) == [1]
    assert [start[6] for start in starts.values()] == [5.0, 6.5]


def test_runs_of_a_group_that_a_method_gives_up_fail_alone(monkeypatch):
    """Halves of the group are tried again; those of four runs or fewer one by one."""
    one, kept, sizes = plan({'initial.angular_velocity.0': [float(k) for k in range(18)]}), [], []

    def ensemble(scene, starts, times, method, accuracy, out, events, horizon):
        sizes.append(len(starts))
        wrong = set(starts[:, 5].tolist()) & {3.0, 4.0, 13.0, 17.0}
        if wrong:
            raise (BadInput('body 0: mass', 'got it', 'less') if 17.0 in wrong else
                   NotConverged('body 0: too fast'))
        return types.SimpleNamespace(choices=[('choice', None)], events=None)

    def keep(results, scene, choice, starts, states, events, where):
        kept.extend(zip(results.block.places(where).tolist(), starts[:, 5].tolist()))
    monkeypatch.setattr(runs, 'ensemble', ensemble)
    monkeypatch.setattr(runs.Results, 'keep', keep)
    monkeypatch.setattr(runs, 'ALONE', 4)
    block = runs.compute(one, 0, 18)
    assert sorted(kept) == [(k, float(k)) for k in range(18) if k not in (3, 4, 13, 17)]
    assert block.arrays['status'][[3, 4, 13, 17]].tolist() == [GAVE_UP] * 3 + [REFUSED]
    assert {run: text[:9] for run, text in block.texts.items()} == {
        3: 'too fast', 4: 'too fast', 13: 'too fast', 17: 'mass: got'}
    assert sizes == [18, 9, 5, 3, 2, 1, 1, 4, 9, 5, 3, 2, 1, 1, 4, 1, 1, 1, 1]


@pytest.mark.parametrize(('wants', 'goes_on'), [
    ({'final'}, False), ({'first'}, True), ({'all', 'final'}, True), ({'residuals'}, True)])
def test_runs_with_strikes_are_simulated_one_by_one(monkeypatch, wants, goes_on):
    """To the last time, the tick 1500 of 1000 a second, where more than states is kept."""
    advanced, kept, failed = [], [], []

    def simulation_of(plan, run):
        if run == 6:
            raise NotConverged('too fast')
        vector = np.full(14, float(run))
        return types.SimpleNamespace(
            states=lambda times: types.SimpleNamespace(vector=np.array([vector, 2.0 * vector])),
            rate=1000.0, advance=lambda ticks: advanced.append((run, ticks)), choice=f'of {run}',
            events=[f'event {run}'],
            scene=types.SimpleNamespace(initial=types.SimpleNamespace(vector=vector)))
    monkeypatch.setattr(runs, 'simulation_of', simulation_of)
    runs._Work.struck(types.SimpleNamespace(
        plan=types.SimpleNamespace(spec=types.SimpleNamespace(times=[0.5, 1.5]), wants=wants),
        block=Block(5, 8, {}, {}, {}), results=types.SimpleNamespace(
            fail=lambda *told: failed.append((*told[:2], str(told[2]))),
            keep=lambda *told: kept.append(told))), slice(0, 3))
    assert failed == [(slice(1, 2), GAVE_UP, 'too fast')]
    assert advanced == ([(5, 1500), (7, 1500)] if goes_on else [])
    for run, (_, choice, starts, states, events, where, simulation) in zip(
            (5, 7), kept, strict=True):
        assert (choice, events, where) == (
            f'of {run}', [[f'event {run}']], slice(run - 5, run - 4))
        assert starts.tolist() == [[float(run)] * 14]
        assert states.tolist() == [[[float(run)] * 14, [2.0 * run] * 14]]
        assert simulation.choice == choice


def test_states_of_many_runs_are_computed_in_pieces(monkeypatch):
    """Of what does not keep all of its states: so many runs as their states have room for."""
    one, seen = plan({'body.mass': [1.0] * 7}, times=[1.0, 2.0]), []
    monkeypatch.setattr(runs._Work, 'run', lambda work: seen.append(
        (work.block.first, work.block.stop, len(work.block.arrays['status']))))
    for room, length in ((0, 1), (one.working_bytes - 1, 1), (3 * one.working_bytes, 3)):
        seen.clear()
        monkeypatch.setattr(runs, 'PIECE_BYTES', room)
        block = runs.compute(one, 1, 6)
        ends = [*range(1, 6, length), 6]
        assert seen == [(a, b, b - a) for a, b in itertools.pairwise(ends)]
        assert (block.first, block.stop, block.values) == (1, 6, {})
    assert runs.compute(one, 1, 3, values=True).values['body.mass'].tolist() == [1.0, 1.0]


@pytest.mark.parametrize(('places', 'expected'), [
    ([3], slice(3, 4)), ([3, 4, 5], slice(3, 6)), ([0, 1], slice(0, 2)), ([3, 5], None),
    ([0, 1, 3], None)])
def test_places_that_follow_each_other_are_a_slice(places, expected):
    places = np.array(places)
    found = runs._slice_of(places)
    assert found is places if expected is None else found == expected
