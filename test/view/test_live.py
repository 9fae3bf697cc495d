# SPDX-License-Identifier: Apache-2.0
"""A live source without its process: what it takes from the pipe, and its first pace."""

import contextlib
import time
import types

import pytest

from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.view import live as module
from rigid_body_sim.view import runner
from rigid_body_sim.view.live import Live, pace_for
from rigid_body_sim.view.runner import About

SCENE, OTHER = load_scene('tennis_racket'), load_scene('heavy_top')


class Pipe:
    """Stands for the pipe to the process: what it has to tell, and what it was told."""

    def __init__(self):
        self.tells, self.told, self.waited = [], [], []

    def poll(self, seconds=0.0):
        self.waited.append(seconds)
        return bool(self.tells)

    def recv(self):
        return self.tells.pop(0)

    def send(self, message):
        self.told.append(message)


@pytest.fixture
def live():
    """Return a Live whose process only keeps what it is told."""
    one = object.__new__(Live)
    one.scene, one.generation, one.method, one.speed = SCENE, 0, '', 1.0
    one.messages, one.expected = [], {}
    one._asked, one._next, one._doing, one._pipe = None, None, '', Pipe()
    return one


def test_a_scene_begins_in_a_process_at_its_pace(monkeypatch):
    """Commands act at ticks; the body can be pushed, edited and paced, and is not a recording."""
    pipe, made, done = Pipe(), [], []
    process = types.SimpleNamespace(start=lambda: done.append('started'))
    context = types.SimpleNamespace(
        Pipe=lambda: (pipe, types.SimpleNamespace(close=lambda: done.append('closed'))),
        Process=lambda **settings: made.append(settings) or process)
    monkeypatch.setattr(module.multiprocessing, 'get_context', lambda kind: context)
    monkeypatch.setattr(module, 'deaf_children', contextlib.nullcontext)
    scene = load_scene('tennis_racket', ['initial.angular_velocity=[0, 2e-4, 0]'])
    one = Live(scene.text, {'rate': 500.0}, 'runs')
    assert (one.tick, one.speed, one.generation) == (0.002, 1e4, 0)
    assert (one.pushes, one.edits, one.paces, one.plays) == (True, True, True, False)
    assert pipe.told == [('scene', scene.text), ('speed', 1e4)]
    assert done == ['started', 'closed']
    [settings] = made
    assert settings['target'] is runner.serve and settings['args'][1:] == ({'rate': 500.0}, 'runs')


def test_of_scenes_asked_for_meanwhile_the_last_one_follows(live):
    live.set_speed(10.0)
    for scene in (SCENE, load_scene('billiard_follow'), OTHER):
        live.begin(scene.text)
    assert live._pipe.told == [('speed', 10.0), ('scene', SCENE.text), ('speed', 10.0)]
    live.command('not while a scene is prepared')
    live._pipe.tells = [('preparing', 'compiling'), ('prepared', None)]
    assert live.poll() == []
    assert live._pipe.told[3:] == [('scene', OTHER.text), ('speed', 10.0)]
    live._pipe.tells = [('prepared', None)]
    live.poll()
    live.command('rows')
    assert live._pipe.told[5:] == [('command', 'rows')]


def test_what_is_prepared_is_said_with_the_seconds_that_it_takes(live, monkeypatch):
    clock = [50.0]
    monkeypatch.setattr(time, 'monotonic', lambda: clock[0])
    assert live.preparing == ''
    live.begin(OTHER.text)
    clock[0] = 62.0
    assert live.preparing == 'Preparing heavy top: starting, 12 s'
    live._pipe.tells = [('preparing', 'choosing a method')]
    live.poll()
    assert 'choosing a method, 12 s' in live.preparing


def test_snapshots_of_the_scene_before_are_left_out(live):
    live._pipe.tells = [
        ('snapshot', 'old'), ('expected', {'event': 'flip'}),
        ('scene', About(OTHER.text, 'taylor', [])), ('snapshot', 'new'), ('refused', 'too much')]
    assert live.poll() == ['new']
    assert (live.scene.name, live.method, live.generation) == ('heavy_top', 'taylor', 1)
    assert (live.expected, live.messages) == ({}, ['too much'])
    assert not live.wait(0.25) and live._pipe.waited[-1] == 0.25


@pytest.mark.parametrize(('rate', 'pace'), [
    (0.0, 1.0), (1e-4, 1e4), (2e-4, 1e4), (5e-4, 1e3), (0.02, 1.0), (100.0, 1.0)])
def test_a_body_slower_than_a_thousandth_is_shown_faster_by_a_power_of_ten(rate, pace):
    scene = parse_scene('scene: a\nbody: {mass: 1, inertia: [1, 2, 2.5]}\nconstraint: free\n'
                        f'effects: []\ninitial: {{angular_velocity: [0, {0.6 * rate!r}, '
                        f'{0.8 * rate!r}]}}\n')
    assert pace_for(scene) == pytest.approx(pace)
