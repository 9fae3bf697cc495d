# SPDX-License-Identifier: Apache-2.0
"""The warm-up of a node: all that a run may do is done once, on a simulation of its own."""

import itertools
import typing

import pytest

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.messages.state_topics import Frames, chosen, scene_messages
from rigid_body_sim.node import rehearsal
from rigid_body_sim.realtime.session import Session
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.command_rows import AXES, BODY, HOLD, IMPULSE, KIND, RELEASE, WORLD
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba


class Noted(Session):
    """A session that notes what it does, in its order."""

    seen: typing.ClassVar[list] = []

    def __init__(self, *parts):
        self.seen.clear()
        super().__init__(*parts)

    def run_tick(self, publish):
        assert publish
        self.seen.append('prefetched' if self._ahead else 'tick')
        super().run_tick(publish)

    def take_balance(self):
        self.seen.append('balance')
        super().take_balance()

    def _take_effect(self, tick, rows):
        self.seen.append([tuple(row) for row in rows[:, [KIND, AXES]].astype(int).tolist()])
        assert super()._take_effect(tick, rows)
        self.seen.append(bool(self.simulation.wrench))

    def reset(self):
        self.seen.append('reset')
        return super().reset()


def rehearsed(monkeypatch, rate=100.0, scene='tennis_racket'):
    """Rehearse a run; return what was noted, and the simulation of the warm-up."""
    made = []

    class Trial(Simulation):
        def __init__(self, *parts, **more):
            super().__init__(*parts, **more)
            made.append(self)
    monkeypatch.setattr(rehearsal, 'Session', Noted)
    monkeypatch.setattr(rehearsal, 'Simulation', Trial)
    one = Simulation(scene, rate=rate)
    rehearsal.rehearse(one, scene_messages(chosen(('tf',)), one.scene, Frames()))
    assert one.tick == 0 and not one.wrench
    return Noted.seen, *made


def test_ticks_are_sent_one_by_one_and_prefetched_after_everything_that_disturbs(monkeypatch):
    seen, trial = rehearsed(monkeypatch)
    kinds = [(kind, axes) for kind in (IMPULSE, HOLD) for axes in (BODY, WORLD)]
    given = [kinds, kinds[::-1], [(RELEASE, WORLD)]]
    # of impulses and wrenches, in both axes; a body that holds a wrench gets others
    assert [one for one in seen if isinstance(one, list)] == given
    held = [after for one, after in itertools.pairwise(seen) if isinstance(one, list)]
    assert held == [True, True, False]
    # the last one holds: in the world's axes, then in the body's
    assert [next(axes for kind, axes in reversed(one) if kind == HOLD)
            for one in given[:2]] == [WORLD, BODY]
    ends = [k for k, one in enumerate(seen) if isinstance(one, list) or one == 'reset']
    parts = [seen[begin:end] for begin, end in zip([0, *ends], [*ends, len(seen)])]
    assert len(parts) == 5
    for part in parts:
        assert all(one in part for one in ('tick', 'prefetched', 'balance'))
    assert trial.tick < 150


@pytest.mark.parametrize(('rate', 'warm'), [(100.0, 1000.0), (4000.0, 4000.0)])
def test_it_runs_at_the_rate_of_the_node_or_faster(monkeypatch, rate, warm):
    assert rehearsed(monkeypatch, rate)[1].rate == warm


def test_a_scene_that_takes_no_commands_gets_none(monkeypatch):
    seen, _ = rehearsed(monkeypatch, scene=load_scene('tennis_racket', ['commands=refuse']))
    assert 'reset' in seen and not [one for one in seen if isinstance(one, list)]


def test_a_motion_that_ends_on_the_way_ends_the_warm_up(monkeypatch):
    def ends(self, publish):
        raise NotConverged('no motion follows')
    monkeypatch.setattr(Noted, 'run_tick', ends)
    seen, _ = rehearsed(monkeypatch)
    assert 'reset' not in seen
