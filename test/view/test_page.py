# SPDX-License-Identifier: Apache-2.0
"""The page of a scene: in a browser, and its loop without one."""

import http.client
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import ros
from soak import IN_SOAK

pytest.importorskip('viser')

from rigid_body_sim.analysis.resimulate import resimulate
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.simulation.command_rows import HOLD, WORLD, ZERO
from rigid_body_sim.view import access, hand, mouse
from rigid_body_sim.view.live import Live
from rigid_body_sim.view.page import Page

BALL = """
scene: still_ball
body: {mass: 1.0, shape: {solid_sphere: {radius: 0.1}}}
constraint: free
effects: []
initial: {}
"""
PATIENCE = 200.0
"""Time for a process that imports numba and compiles, on a loaded machine, s."""


def until(page, condition):
    """Turn a page's loop until a condition holds; return what it returned."""
    deadline = time.monotonic() + PATIENCE
    while not (found := condition()):
        assert time.monotonic() < deadline
        page.turn()
        time.sleep(0.01)
    return found


@pytest.fixture
def page():
    """Return the page of a ball at rest."""
    opened = Page(Live(parse_scene(BALL).text, {'rate': 1000.0}), port=0)
    until(opened, lambda: opened.snapshot)
    yield opened
    opened.close()


def test_a_drag_in_a_browser_moves_the_body_and_nothing_outside_is_asked(
        tmp_path, open_tab, address_of):
    (tmp_path / 'ball.yaml').write_text(BALL)
    command = [sys.executable, '-m', 'rigid_body_sim', 'view', tmp_path / 'ball.yaml',
               '--port', '0',
               '--output', tmp_path / 'pushed']
    with subprocess.Popen(command, cwd=ros.ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True) as process:
        try:
            tab = open_tab(address_of(process))
            tab.see('still ball')
            tab.see('rad/s')
            assert tab.cell('0 rad/s').count() == 1
            tab.drag((270, 250), (340, 215))
            tab.cell('0 rad/s').wait_for(state='detached', timeout=1000 * PATIENCE)
            tab.cell('0 N').wait_for(timeout=1000 * PATIENCE)
            assert tab.page.get_by_label('Share').count() == 0
            assert tab.outside == []
            process.send_signal(signal.SIGINT)
            assert process.wait(90) == 0, process.stderr.read()
        finally:
            process.kill()
    commands = commands_in(tmp_path / 'pushed')
    assert sum(any(command['force']) for command in commands) > 5
    assert commands[-1]['topic'] == 'release'
    assert parting_of(tmp_path / 'pushed') is None


def commands_in(path):
    """Return the commands of a recording."""
    with Recording(path) as recording:
        return [command for entry in recording.journal() if entry['kind'] == 'commands'
                for command in entry['commands']]


def parting_of(path):
    """Return where a recording and its rerun first differ, or None."""
    [(_, _, comparison)] = resimulate(path)
    assert comparison.ticks > 100
    return comparison.parting


def test_a_pull_and_a_strike_are_commands_to_the_simulation(page):
    page.mouse.pulls[0] = mouse.Pull(np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.5, 0.0]))
    until(page, lambda: page.snapshot.energy > 0.0)
    assert page.snapshot.wrench.force[1] > 0.0 and page.snapshot.wrench.torque[2] > 0.0
    page.mouse.pulls.clear()
    until(page, lambda: not page.snapshot.wrench)
    before = page.snapshot.vector[11:14].copy()
    page.mouse.clicks.append((np.array([-3.0, 0.0, 0.0]) + page._stages[0]._offset,
                              np.array([1.0, 0.0, 0.0])))
    until(page, lambda: page.snapshot.vector[11] > before[0] + 0.01)
    assert abs(page.snapshot.energy_residual) < 1e-12


def test_whatever_the_page_does_is_recorded_and_runs_again_to_the_same_bits(tmp_path):
    page = Page(Live(parse_scene(BALL).text, {'rate': 1000.0}, str(tmp_path / 'run')), port=0)
    try:
        until(page, lambda: page.snapshot)
        page.mouse.pulls[0] = mouse.Pull(np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.5, 0.0]))
        until(page, lambda: page.snapshot.energy > 0.0)
        page.mouse.pulls.clear()
        until(page, lambda: not page.snapshot.wrench)
        page.panel.requests.put(('run', 'pause'))
        page.mouse.clicks.append((np.array([-3.0, 0.0, 0.0]) + page._stages[0]._offset,
                                  np.array([1.0, 0.0, 0.0])))
        page.turn()
        assert not page.mouse.clicks
        page.panel.requests.put(('run', 'play'))
        page.panel.requests.put(('run', 'reset'))
        until(page, lambda: page.snapshot.energy == 0.0)
        page.panel.requests.put(('choose', 'tennis_racket'))
        until(page, lambda: page._source.scene.name == 'tennis_racket')
        page.panel.requests.put(('speed', 10.0))
        until(page, lambda: any(name == 'flip' for _, name in page.panel._events))
        page.mouse.pulls[0] = mouse.Pull(np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.5, 0.0]))
        until(page, lambda: page.snapshot.wrench)
    finally:
        page.close()
    assert commands_in(tmp_path / 'run')[-1]['topic'] == 'release'
    with Recording(tmp_path / 'run') as recording:
        kinds = [entry['kind'] for entry in recording.journal()]
        names = [event['name'] for _, event in recording.decoded('/events')]
    assert {'commands', 'reset', 'parameters'} <= set(kinds)
    assert {'reset', 'flip'} <= set(names)
    assert parting_of(tmp_path / 'run') is None


def grab(page):
    """Drag the body of a page, off its middle."""
    until(page, lambda: not page.snapshot.wrench)    # the snapshot is one of this scene
    stage = page._stages[0]
    begun = stage._about + stage._offset + np.array([0.4, 0.0, 0.3])
    page.mouse.pulls[0] = mouse.Pull(begun, begun + np.array([0.3, 0.4, 0.1]))
    until(page, lambda: page.snapshot.wrench)


@IN_SOAK
def test_a_drag_ends_with_its_scene_and_lasts_through_all_else(tmp_path):
    """The wrench of a body that was dragged once went to the next body."""
    source = Live(load_scene('tippe_top').text, {'rate': 1000.0}, str(tmp_path / 'run'))
    told, tell = [], source.tell
    source.tell = lambda *request: (told.append(request), tell(*request))
    page = Page(source, port=0)
    try:
        until(page, lambda: page.snapshot)
        grab(page)
        for request in (('run', 'reset'), ('speed', 100.0), ('speed', 1e-3), ('run', 'pause'),
                        ('run', 'play'), ('speed', 1.0)):
            page.panel.requests.put(request)
            later = time.monotonic() + 0.3
            until(page, lambda later=later: time.monotonic() > later)
            assert page._pulling and page.mouse.pulls
            assert np.isfinite(page.snapshot.vector).all()
        for name in ('rolling_disk', 'rattleback', None):
            begun = page._generation
            if name:
                page.panel.requests.put(('choose', name))
            else:    # a number is changed
                text = load_scene('rattleback', ['initial.angular_velocity.2=-3']).text
                page.panel._edit = (0.0, lambda text=text: text)
            until(page, lambda begun=begun: page._generation > begun and not page._pulling)
            assert page.mouse.pulls == {}
            told.append(('grabbed', None))
            grab(page)
    finally:
        page.close()
    begun = [k for k, (name, _) in enumerate(told) if name == 'scene']
    assert len(begun) == 3
    for k in begun:
        grabbed = told.index(('grabbed', None), k)
        # a release, or nothing if the body was let go before the page could tell it
        assert all(np.array_equal(value, hand.release()) for name, value in told[k:grabbed]
                   if name == 'command')
    assert parting_of(tmp_path / 'run') is None


def test_a_page_says_what_it_waits_for_and_what_is_chosen_meanwhile_is_next(page):
    assert page.panel._waiting.content == ''
    begun = page._source.generation
    for name in ('heavy_top', 'sphere', 'tennis_racket'):
        page.panel.requests.put(('choose', name))
    page.turn()
    assert 'Preparing heavy top: ' in page.panel._waiting.content
    page._source.command(np.zeros((1, 8)))    # it is for the ball, and would be refused
    until(page, lambda: page._source.scene.name == 'tennis_racket' and not page._source.preparing)
    assert page._source.generation == begun + 2
    page.turn()
    assert page.panel._waiting.content == ''


def test_a_page_says_why_a_motion_halts_and_a_reset_leads_on(page):
    """A disk that must roll was pulled sideways; after a reset it stood still."""
    page.panel.requests.put(('choose', 'rolling_disk'))
    until(page, lambda: page._source.scene.name == 'rolling_disk' and page.snapshot.energy > 1.0)
    page._source.command(np.array([(HOLD, WORLD, *ZERO, 0.0, 20.0, 0.0)]))
    until(page, lambda: 'plane that pulls' in page.panel._problem.content)
    assert 'press reset' in page.panel._problem.content
    page.panel.requests.put(('run', 'reset'))
    until(page, lambda: not page.snapshot.wrench)
    again = page.snapshot.time
    until(page, lambda: page.snapshot.time > again)
    assert page.panel._problem.content == ''


def test_a_picture_goes_out_when_it_is_drawn_and_the_page_wakes_when_one_comes(
        page, monkeypatch):
    drawn, sent = [], []
    monkeypatch.setattr(page, '_show', lambda: drawn.append(page.snapshot.time))
    monkeypatch.setattr(page.server, 'flush', lambda: sent.append(page.snapshot.time))
    until(page, lambda: len(drawn) > 2)
    assert set(drawn) <= set(sent)
    page._source.tell('pause', True)
    while page._source.wait(1.0):
        page._source.poll()
    page._source.tell('step')
    assert page._source.wait(PATIENCE)
    assert page._source.poll()


def test_another_scene_and_a_changed_number_begin_anew(page):
    # a free body is followed, and the box says so
    assert page.panel._boxes['follow'].value
    page.panel.requests.put(('choose', 'heavy_top'))
    until(page, lambda: page._source.scene.name == 'heavy_top' and page.snapshot.energy > 1.0)
    assert not page.panel._boxes['follow'].value
    assert not page._shown['follow']
    text = load_scene('heavy_top', ['initial.angular_velocity.2=50']).text
    page.panel._edit = (0.0, lambda: text)
    until(page, lambda: page.snapshot.vector[7] == 50.0)
    page.panel._edit = (0.0, lambda: text.replace('mass: 1.0', 'mass: -1.0'))
    until(page, lambda: 'mass' in page.panel._problem.content)
    assert page._source.scene.body.mass == 1.0


def test_pause_step_speed_and_reset(page):
    page.panel.requests.put(('choose', 'tennis_racket'))
    until(page, lambda: page._source.scene.name == 'tennis_racket')
    page.panel.requests.put(('speed', 10.0))
    until(page, lambda: page.snapshot.time > 3.0)
    # what theory predicts is named: the flips
    until(page, lambda: 'predicted, measured' in page.panel._expected.content)
    assert '>flip<' in page.panel._expected.content
    # the snapshot of the reset is the first one after the pause, however late it comes
    page.panel.requests.put(('run', 'pause'))
    page.panel.requests.put(('run', 'reset'))
    until(page, lambda: page.snapshot.time == 0.0)
    for steps in (1, 2):
        deadline = time.monotonic() + 0.3
        until(page, lambda deadline=deadline: time.monotonic() > deadline)
        stopped = page.snapshot.time
        page.panel.requests.put(('run', 'step'))
        until(page, lambda stopped=stopped: page.snapshot.time != stopped)
        assert page.snapshot.time == pytest.approx(steps * 10.0 / 60.0)


def test_the_motion_waits_for_the_first_page_and_a_second_one_lets_a_pause_be(open_tab):
    """A tossed coin once lay still before a browser was there to show it.

    The second page is closed while it drags the body, which is released then.
    """
    page = Page(Live(load_scene('tennis_racket').text, {'rate': 1000.0}), port=0)

    def after(seconds):
        deadline = time.monotonic() + seconds
        page.run(lambda: time.monotonic() > deadline)
        return page.snapshot.time
    try:
        page.await_client()
        until(page, lambda: page.snapshot)
        assert after(0.3) == after(0.3) == 0.0
        open_tab(page.address)
        until(page, lambda: page.snapshot.time > 0.5)
        page.panel.requests.put(('run', 'pause'))
        page.panel.requests.put(('run', 'reset'))    # its snapshot is the first after the pause
        until(page, lambda: page.snapshot.time == 0.0)
        second = open_tab(page.address)
        until(page, lambda: len(page.server.get_clients()) == 2)
        assert after(0.3) == after(0.3) == 0.0
        until(page, lambda: second.cell('5 rad/s').count())
        second.grab((270, 200), (340, 165))
        until(page, lambda: page._pulling)
        second.page.close()
        until(page, lambda: not page._pulling)
        assert page.mouse.pulls == {}
    finally:
        page.close()


def answer(page, path='/', **headers):
    """Return the status of a request and the cookie that it gave."""
    connection = http.client.HTTPConnection('127.0.0.1', page.server.get_port())
    connection.request('GET', path, headers=headers)
    got = connection.getresponse()
    return got.status, (got.getheader('Set-Cookie') or '').partition(';')[0]


def test_only_its_own_pages_reach_the_server(page):
    assert answer(page)[0] == 200
    assert answer(page, Host='evil.example')[0] == 403
    assert answer(page, Origin='https://evil.example')[0] == 403


def test_on_another_host_a_token_opens_the_page(monkeypatch):
    monkeypatch.setattr(access, '_is_local', lambda name: False)
    page = Page(Live(parse_scene(BALL).text, {'rate': 1000.0}), port=0)
    try:
        assert answer(page)[0] == 403
        status, cookie = answer(page, page.address[page.address.index('/?'):])
        assert status == 200 and cookie
        assert answer(page, Cookie=cookie)[0] == 200
        assert answer(page, Cookie=f'{cookie}x')[0] == 403
    finally:
        page.close()


def test_no_tunnel_is_opened_whoever_asks(page):
    assert page.server.request_share_url() is None
    assert page.server._share_tunnel is None
