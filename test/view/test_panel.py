# SPDX-License-Identifier: Apache-2.0
"""The panel beside the picture, on a server that only keeps what it is asked for."""

import contextlib
import math
import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.view import panel, parameters
from rigid_body_sim.view.panel import EVENTS, Panel
from rigid_body_sim.view.snapshots import Snapshot

SHOWN = dict.fromkeys(('omega', 'momentum', 'force', 'torque', 'axis', 'polhode', 'herpolhode',
                       'follow', 'dark'), False)


class Control:
    """A control of the page: its settings, and what hears of its changes."""

    def __init__(self, name, **settings):
        self.name, self.settings, self.content = name, settings, settings.get('content', '')
        self.value, self.heard = settings.get('initial_value'), []

    on_update = on_click = property(lambda self: self.heard.append)

    def set(self, value, client='a page'):
        """Change the value as a page does; one that no page changed has the client None."""
        self.value = value
        for hear in self.heard:
            hear(types.SimpleNamespace(target=self, client=client, client_id=client))


class Gui:
    """Keeps the controls that it is asked for, by their names."""

    def __init__(self):
        self.controls, self.folders = {}, {}

    def _add(self, name, options=(), **settings):
        self.controls[name] = Control(name, options=options, **settings)
        return self.controls[name]

    add_slider = add_button_group = add_checkbox = add_number = add_dropdown = _add

    def add_html(self, content):
        return Control('', content=content)

    def add_folder(self, name, expand_by_default=True):
        self.folders[name] = expand_by_default
        return contextlib.nullcontext()


@pytest.fixture
def made():
    """Return a function that makes a Panel of a source with some abilities, and its controls."""
    def make(clients=None, **source):
        gui, kind = Gui(), {'pushes': False, 'edits': False, 'plays': False, 'paces': False}
        source = types.SimpleNamespace(**kind | {'method': 'exact', 'speed': 1.0} | source)
        server = types.SimpleNamespace(gui=gui, get_clients=lambda: clients)
        gui.add_uplot = lambda *args, **settings: Control('chart', **settings)
        return Panel(server, source, dict(SHOWN)), gui.controls
    return make


@pytest.mark.parametrize(('speed', 'shown', 'most'), [(0.1, -1.0, 3.0), (1e4, 4.0, 4.0)])
def test_the_slider_of_the_speed_is_its_common_logarithm(speed, shown, most, made):
    one, controls = made(paces=True, speed=speed)
    slider = controls['speed (log10)']
    assert slider.value == pytest.approx(shown)
    assert (slider.settings['min'], slider.settings['max']) == (-3.0, pytest.approx(most))
    assert all(mark == pytest.approx(math.log10(eval(text)))
               for mark, text in slider.settings['marks'])
    slider.set(2.0)
    assert one.requests.get_nowait() == ('speed', pytest.approx(100.0))


def test_a_person_who_moves_the_time_seeks_and_the_panel_itself_does_not(made):
    marks = [(0.001 * k, 'a command') for k in range(300)]
    one, controls = made(plays=True, end=4.0, marks=marks)
    slider = controls['time (s)']
    assert (slider.value, slider.settings['min'], slider.settings['max']) == (0.0, 0.0, 4.0)
    assert [at for at, _ in slider.settings['marks']] == [at for at, _ in marks[:200]]
    slider.set(1.0, client=None)
    assert one.requests.empty()
    slider.set(2.0)
    assert one.requests.get_nowait() == ('seek', 2.0)
    assert one.curves is None    # a recording has no ledger


@pytest.mark.parametrize(('end', 'step'), [(4.0, 0.002), (0.0, 1e-9), (1e-7, 1e-9)])
def test_the_time_has_two_thousand_steps_or_those_of_a_nanosecond(made, end, step):
    _, controls = made(plays=True, end=end, marks=[])
    assert controls['time (s)'].settings['step'] == near(step, rel=1e-12)


def test_the_strength_of_the_mouse_goes_from_a_hundredth_to_a_hundred(made):
    one, controls = made(pushes=True)
    settings = controls['strength (log10)'].settings
    assert one.strength is controls['strength (log10)'] and one.strength.value == 0.0
    assert (settings['min'], settings['max'], settings['step']) == (-2.0, 2.0, 0.1)


def test_what_is_not_needed_at_first_is_folded(made):
    one, _ = made(pushes=True, edits=True, scene=load_scene('heavy_top'))
    assert one._server.gui.folders == {'Push with the mouse': True, 'Conservation': True,
                                       'Show': False, 'Scene': False, 'Events': False}


def test_numbers_of_a_changed_scene_are_put_into_the_controls_that_there_are(made):
    scene = load_scene('heavy_top')
    one, controls = made(edits=True, scene=scene)
    one._scene_folder = contextlib.nullcontext()
    one.begin(scene, 'a top', 0.5)
    before = dict(controls)
    assert before['spin (rad/s)'].value == near(60.0, rel=1e-12)    # that of the scene
    one.begin(parse_scene(parameters.changed(scene.text, ('body', 'mass'), 0.75)), 'a top', 0.5)
    assert controls['body.mass'] is before['body.mass']
    assert controls['body.mass'].value == 0.75
    for name, control in before.items():
        assert controls[name] is control


def test_a_preset_moves_the_camera_of_the_page_that_asks(made):
    clients = {name: types.SimpleNamespace(
        atomic=contextlib.nullcontext, camera=types.SimpleNamespace(aspect=2.0, position=None))
        for name in 'ab'}
    _, controls = made(clients)
    controls['camera'].set('front', client='a')
    assert np.array_equal(clients['a'].camera.position, panel.PRESETS['front'])
    # it looks at the middle of the picture, and up is up
    assert clients['a'].camera.look_at == (0.0, 0.0, 0.0)
    assert clients['a'].camera.up_direction == (0.0, 0.0, 1.0)
    assert clients['b'].camera.position is None
    controls['camera'].set('side', client=None)
    assert all(np.array_equal(one.camera.position, panel.PRESETS['side'])
               for one in clients.values())


def test_what_is_typed_is_taken_when_nobody_has_typed_for_a_while(made, monkeypatch):
    now = [0.0]
    monkeypatch.setattr(panel.time, 'monotonic', lambda: now[0])
    scene = load_scene('heavy_top')
    one, controls = made(edits=True, scene=scene)
    one._scene_folder = contextlib.nullcontext()
    one.begin(scene, 'a top', 0.5)
    controls['body.mass'].set(7.0, client=None)    # the panel itself
    now[0] = 100.0
    assert one.edited() is None
    controls['body.mass'].set(2.0)
    now[0] += 0.3
    controls['body.mass'].set(3.0)
    now[0] += 0.39
    assert one.edited() is None
    now[0] += 0.02
    assert 'mass: 3.0' in one.edited()
    assert one.edited() is None    # once


@pytest.mark.parametrize(('method', 'shown'), [('dop8', ', dop8<'), ('', ', not yet moving<')])
def test_the_title_tells_scene_method_and_ground(method, shown, made):
    one, controls = made(method=method)
    one.take(moment(1.0, ((1.0, 'flip'),)))
    one._shown['follow'] = True
    one.begin(load_scene('heavy_top'), 'a <top>', 0.25)
    text = one._title.content
    assert f'<b>heavy top</b>{shown}' in text
    assert 'Drawn: a &lt;top&gt;; the ground has a line every 0.25 m.' in text
    assert controls['follow the body'].value
    assert one._events == []    # those of the scene before


def test_presets_look_from_where_they_say():
    """A scene has x to the right of its front, and z upwards."""
    (x, y, z), (fx, fy, fz), (sx, sy, sz), (tx, ty, tz) = (
        panel.PRESETS[name] for name in ('3/4', 'front', 'side', 'top'))
    assert x > 0.0 > y and z > 0.0
    assert fx == 0.0 and fy < 0.0 < fz < -0.1 * fy
    assert sy == 0.0 and 0.0 < sz < 0.1 * sx
    # straight from above a camera has no upward direction: it is a little in front
    assert tx == 0.0 and 0.0 < -ty < 0.01 * tz
    sizes = [np.linalg.norm(place) for place in panel.PRESETS.values()]
    assert max(sizes) < 1.2 * min(sizes)    # and from about as far


def moment(time, events=()):
    return Snapshot(time, np.zeros(14), np.zeros((1, 14)), Wrench(), 2.5, 0.0, 0.0, events)


def test_the_last_events_are_listed_the_newest_first(made):
    one, _ = made()
    for k in range(6):
        one.take(moment(float(k), ((k, f'first <{k}>'), (k + 0.5, f'then <{k}>'))))
    one.draw(moment(6.0), None, {})
    text = one._event_list.content
    lines = text[text.index('>') + 1:].removesuffix('</div>').split('<br>')
    whole = [line for k in range(6) for line in (
        f'{k} s: first &lt;{k}&gt;', f'{k + 0.5} s: then &lt;{k}&gt;')]
    assert lines == whole[::-1][:EVENTS]


def test_the_page_says_what_it_waits_for_and_nothing_when_it_does_not(made):
    one, _ = made()
    shown = []
    for text in ('compiling <a>', ''):
        one.wait(text)
        shown.append(one._waiting.content)
    assert '>compiling &lt;a&gt; ...<' in shown[0]
    assert shown[1] == ''


def test_numbers_are_lengths_and_what_is_unknown_is_said_so(made):
    one, controls = made(plays=True, end=4.0, marks=[])
    arrows = types.SimpleNamespace(omega=(2.0, 3.0, 6.0), momentum=(0.0, 3.0, 4.0),
                                   force=(np.nan,) * 3, torque=(0.0, 0.0, 0.0))
    moved = moment(5.0)
    moved.vector[1:5] = 1.0, 0.0, 0.0, 0.0
    beside = moment(5.0)
    beside.vector[1:5] = math.cos(0.5), math.sin(0.5), 0.0, 0.0    # by 1 rad about z
    moved.vector[8:11], beside.vector[8:11] = (1.0, 1.0, 1.0), (2.0, 3.0, 3.0)
    one.draw(moved, arrows, {'event': 'flip', 'predicted_period': 2.0, 'measured_period': 2.5,
                             'predicted_rate': 3.0}, beside)
    for value in ('5.000 s', '2.5 J', '7 rad/s', '5 N m s', 'unknown', '0 N m', '1 rad', '3 m'):
        assert one._values.content.count(f'>{value}<') == 1
    for value in ('flip', 'period', '2, 2.5', 'rate', '3, ...'):
        assert one._expected.content.count(f'>{value}<') == 1
    assert controls['time (s)'].value == 4.0    # not beyond the end
