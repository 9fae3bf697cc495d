# SPDX-License-Identifier: Apache-2.0
"""The loop of a page on a source whose snapshots and clock are made by hand."""

import contextlib
import types

import numpy as np
import pytest
from near import near

pytest.importorskip('viser')

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.command_rows import HOLD, IMPULSE, LET_GO
from rigid_body_sim.view import hand, page
from rigid_body_sim.view.mouse import Pull
from rigid_body_sim.view.page import Page
from rigid_body_sim.view.snapshots import Snapshot

BALL = parse_scene('scene: ball\nbody: {mass: 2.0, shape: {solid_sphere: {radius: 0.1}}}\n'
                   'constraint: free\neffects: []\ninitial: {}\n')


class Source:
    """A source that keeps what it is told, and gives the snapshots that a test puts there."""

    pushes, edits, plays, paces = True, True, False, True
    beside, preparing, scene, generation, method, tick = None, '', BALL, 1, 'exact', 1e-3

    def __init__(self):
        self.told, self.commands, self.waits, self.left = [], [], [], []
        self.messages, self.expected, self.speed = [], {}, 1.0

    def poll(self):
        found, self.left = self.left, []
        return found

    def command(self, rows):
        self.commands.append(rows)

    def tell(self, *request):
        self.told.append(request)

    def set_speed(self, speed):
        self.told.append(('speed', speed))

    def seek(self, when):
        self.told.append(('seek', when))

    def begin(self, text):
        self.told.append(('begin', parse_scene(text).name))

    def wait(self, seconds):
        self.waits.append(seconds)

    def close(self):
        self.told.append(('close',))


@pytest.fixture(scope='module')
def opened():
    """Return a page of the ball and its source."""
    source = Source()
    one = Page(source, port=0)
    yield one, source
    one.close()


@pytest.fixture
def ball(opened, monkeypatch):
    """Return (page, source, clock) of the ball at rest, with nothing told so far."""
    one, source = opened
    clock = [50.0]
    monkeypatch.setattr(page, 'time', types.SimpleNamespace(monotonic=lambda: clock[0]))
    one.mouse.pulls, one.mouse.clicks, one._pulled = {}, [], 0.0
    one._pulling, one._lag, one._numbers_due = False, page.PERIOD, 0.0
    one.panel.strength.value, source.speed = 0.0, 1.0
    source.left = [moment(0.0)]
    one.turn()
    source.told, source.commands, source.waits = [], [], []
    return one, source, clock


def moment(time, restarted=True):
    vector = BALL.initial.vector.copy()
    vector[0] = time
    return Snapshot(time, vector, vector[np.newaxis], Wrench(), 0.0, 0.0, 0.0, (), restarted)


def test_a_still_mouse_pulls_again_with_each_snapshot_or_after_a_tenth_of_a_second(ball):
    one, source, clock = ball
    one.mouse.pulls['a'] = Pull(np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.5, 0.0]))
    one.turn()
    assert len(source.commands) == 1
    clock[0] += 0.09
    one.turn()
    assert len(source.commands) == 1
    source.left = [moment(0.1, False)]
    one.turn()
    assert len(source.commands) == 2
    clock[0] += 0.09
    one.turn()
    assert len(source.commands) == 2
    clock[0] += 0.02
    one.turn()
    assert len(source.commands) == 3
    assert all(row[0, 0] == HOLD for row in source.commands)
    one.mouse.pulls.clear()
    one.turn()
    one.turn()
    assert len(source.commands) == 4 and (source.commands[-1] == LET_GO).all()


@pytest.mark.parametrize(('speed', 'between', 'tick', 'lag'), [
    (1.0, 0.01, 1e-3, 1.0 / 60.0), (6.0, 0.01, 1e-3, 0.1), (1.0, 0.3, 1e-3, 0.3),
    (1.0, 0.01, 0.5, 0.5)])
def test_the_spring_is_as_slow_as_the_longest_delay(speed, between, tick, lag, ball, monkeypatch):
    """Delays are those between snapshots, that of a page, and that between ticks."""
    one, source, _ = ball
    monkeypatch.setattr(Source, 'tick', tick)
    source.speed, one.panel.strength.value, paces = speed, 1.0, []
    monkeypatch.setattr(hand, 'pace_of', lambda *of: paces.append(of) or 1.0)
    source.left = [moment(5.0)]
    one.turn()
    source.left = [moment(5.0 + between, False)]
    one.mouse.pulls['a'] = Pull(np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.5, 0.0]))
    one.turn()
    assert paces == [(pytest.approx(10.0), speed, pytest.approx(lag))]
    # snapshots of which one begins anew tell nothing of it
    source.left = [moment(0.0), moment(0.7, False)]
    one.turn()
    assert len(paces) == 2 and paces[-1] == paces[0]


def test_hands_of_two_browsers_pull_together(ball):
    one, source, _ = ball
    pulls = [Pull(np.array([1.0, 0.0, 0.0]), np.array([1.0, y, 0.0])) for y in (0.5, 0.25)]
    for taken in ([0], [1], [0, 1]):
        one.mouse.pulls = {key: pulls[key] for key in taken}
        source.left = [moment(0.0)]
        one.turn()
    first, second, both = source.commands
    assert both[:, 2:] == near(first[:, 2:] + second[:, 2:], rel=1e-12)
    assert first[0, 3] == near(2.0 * second[0, 3], rel=1e-12)
    one.mouse.pulls = {0: Pull(pulls[0].begun, pulls[0].begun)}    # at rest there already
    source.left = [moment(0.0)]
    one.turn()
    assert (source.commands[-1] == LET_GO).all() and not one._pulling


@pytest.mark.parametrize(('strength', 'speed'), [(0.0, 1.0), (1.0, 4.0)])
def test_a_strike_changes_the_speed_of_its_point_by_half_a_page_length_a_second(
        strength, speed, ball):
    """The ball of 2 kg is struck at its middle, and at its edge it would be missed."""
    one, source, _ = ball
    one.panel.strength.value, source.speed = strength, speed
    one.mouse.clicks = [(np.array([-3.0, y, 0.0]), np.array([1.0, 0.0, 0.0])) for y in (0.0, 1.5)]
    one.turn()
    [row] = source.commands
    push = 2.0 * 0.5 * 10.0 ** strength * one._stages[0].unit / speed
    assert row[0, 0] == IMPULSE
    assert row[0, 2:] == pytest.approx([push, 0.0, 0.0, 0.0, 0.0, 0.0], abs=1e-12)
    assert one.mouse.clicks == []


def test_controls_are_requests_to_the_source(ball):
    one, source, _ = ball
    one.panel.say('a problem')
    for request in (('run', 'pause'), ('speed', 3.0), ('seek', 2.0)):
        one.panel.requests.put(request)
    one.turn()
    assert source.told == [('pause', True), ('speed', 3.0), ('seek', 2.0)]
    assert 'a problem' in one.panel._problem.content
    for request in (('run', 'play'), ('run', 'step'), ('choose', 'heavy_top'),
                    ('choose', 'nowhere')):
        one.panel.requests.put(request)
    one.turn()
    assert source.told[3:] == [('pause', False), ('step', None), ('begin', 'heavy_top')]
    assert 'nowhere' in one.panel._problem.content


def test_the_page_turns_dark_and_never_offers_to_be_shared(ball, monkeypatch):
    one, _, _ = ball
    themes = []
    monkeypatch.setattr(one.server.gui, 'configure_theme', lambda **theme: themes.append(theme))
    for dark in (True, False):
        one.panel.requests.put(('dark', dark))
        one.turn()
    assert [theme['dark_mode'] for theme in themes] == [True, False]
    assert not any(theme['show_share_button'] or theme['show_logo'] for theme in themes)


def test_the_motion_waits_for_the_first_client_only(ball, monkeypatch):
    one, source, _ = ball
    aimed = []
    monkeypatch.setattr(page, 'aim', aimed.append)
    one.await_client()
    assert source.told == [('pause', True)]
    for client in 'ab':
        one._welcome(client)
    one.turn()
    assert source.told[1:] == [('pause', False)] and aimed == ['a', 'b']
    monkeypatch.setattr(Source, 'paces', False)    # a node goes on
    one.await_client()
    assert len(source.told) == 2


def test_turns_come_sixty_times_a_second_and_are_not_made_up_for(ball, monkeypatch):
    one, source, clock = ball
    took = iter((0.0, 0.01, 1.0, 0.0))
    monkeypatch.setattr(one, 'turn', lambda: clock.__setitem__(0, clock[0] + next(took)))
    monkeypatch.setattr(source, 'wait', lambda seconds: (
        source.waits.append(seconds), clock.__setitem__(0, clock[0] + seconds)))
    one.run(lambda: len(source.waits) == 4)
    period = 1.0 / 60.0
    assert source.waits == pytest.approx([period, period - 0.01, 0.0, period])


def test_numbers_are_shown_five_times_a_second(ball, monkeypatch):
    one, _, clock = ball
    drawn = []
    monkeypatch.setattr(one.panel, 'draw', lambda *_: drawn.append(clock[0]))
    for _ in range(13):
        clock[0] += 1.0 / 16.0
        one.turn()
    assert drawn == [50.25, 50.5, 50.75]
    one._numbers_due = clock[0]    # at once where it is due
    one.turn()
    assert len(drawn) == 4


@pytest.mark.parametrize('follows', [True, False])
def test_of_two_recordings_the_first_is_followed_and_the_other_one_moves_with_it(
        ball, monkeypatch, follows):
    one, _, _ = ball
    seen = []

    def stage(name):
        return types.SimpleNamespace(
            show=lambda snapshot, *held: seen.append((name, snapshot)),
            move_with=lambda other: seen.append((name, other)))
    first, second = stage('first'), stage('second')
    monkeypatch.setattr(one, '_stages', [first, second])
    monkeypatch.setattr(one, '_beside', lambda: 'beside')
    monkeypatch.setitem(one._shown, 'follow', follows)
    one._show()
    assert seen == [('first', one.snapshot), ('second', 'beside'), ('second', first)]
    assert (first.follows, second.follows) == (follows, False)


@pytest.mark.parametrize('port', [-1, page.LAST_PORT + 1])
def test_a_port_that_is_none_is_refused_before_anything_is_served(port):
    with pytest.raises(BadInput, match='--port'):
        Page(Source(), port=port)


def test_the_largest_port_and_the_first_address_of_a_host_are_served(monkeypatch):
    """A host may have several addresses; one that cannot be listened on is refused."""
    free, taken = ('127.0.0.1', 0), ('203.0.113.7', 0)    # the latter is of no machine

    def addresses(*found):
        monkeypatch.setattr(page.socket, 'getaddrinfo', lambda *_, **asked: [
            (page.socket.AF_INET, asked['type'], 0, '', address) for address in found])
    made = []
    monkeypatch.setattr(page.viser, 'ViserServer', lambda **asked: made.append(
        asked) or types.SimpleNamespace())
    access = types.SimpleNamespace(host='name', guarding=contextlib.nullcontext)
    addresses(free, taken)
    server = page.serve(access, 65000)
    assert [(asked['host'], asked['port']) for asked in made] == [('name', 65000)]
    assert server.request_share_url() is None
    page.serve(access, 0)
    addresses(taken, free)
    with pytest.raises(BadInput, match='cannot be listened on'):
        page.serve(access, 8080)
