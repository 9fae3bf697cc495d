# SPDX-License-Identifier: Apache-2.0
"""The panel beside the picture: controls of display, speed and mouse, and measured values.

Controls never act by themselves: they put requests into a queue that the page's loop empties, so
that everything happens in one thread.
"""

import html
import math
import queue
import time

import numpy as np
from scipy.spatial.transform import Rotation

from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.scene import scene_names
from rigid_body_sim.scene.state import ORIENTATION, POSITION
from rigid_body_sim.view import parameters
from rigid_body_sim.view.curves import Curves

SPEEDS = 3.0
"""Common logarithm of the largest speed; the smallest is its inverse."""
PRESETS = {'3/4': (2.2, -3.2, 1.7), 'front': (0.0, -4.2, 0.3), 'side': (4.2, 0.0, 0.3),
           'top': (0.0, -0.01, 4.6)}
EVENTS = 8
EDIT_AFTER = 0.4
"""Time without a change after which a changed number is taken, s."""


def look(client, preset):
    """Put the camera of a client to a preset, farther off where its window is narrow."""
    with client.atomic():
        client.camera.position = place_of(client, preset)
        client.camera.look_at = (0.0, 0.0, 0.0)
        client.camera.up_direction = (0.0, 0.0, 1.0)


def place_of(client, preset):
    """Return the place of a client's camera for a preset."""
    return np.array(PRESETS[preset]) / min(1.0, client.camera.aspect)


def aim(client, preset='3/4'):
    """Put the camera of a new client to a preset, and keep all in sight as its window is resized.

    The panel narrows the picture only after a client has connected. Once the person has moved the
    camera, it stays where it is.
    """
    look(client, preset)
    aimed = [place_of(client, preset)]

    def resized(_):
        place = place_of(client, preset)
        if np.allclose(place, aimed[0], rtol=1e-3):
            return
        # the page itself begins at the preset, which may arrive after the first messages
        if any(np.allclose(client.camera.position, one, atol=1e-3)
               for one in (aimed[0], PRESETS[preset])):
            aimed[0] = place
            look(client, preset)
    client.camera.on_update(resized)


class Panel:
    """The controls of a page.

    Parameters
    ----------
    server : viser.ViserServer
    source : object
        Where the snapshots come from (snapshots.py).
    shown : dict
        Name of an arrow or trace -> whether it is drawn; the check boxes change it.

    Attributes
    ----------
    requests : queue.Queue
        ``(name, value)`` pairs for the page's loop.
    """

    def __init__(self, server, source, shown):
        self.requests = queue.Queue()
        self._server, self._source, self._shown = server, source, shown
        self._events, self._edit = [], None
        self._scene_controls = {}
        gui = server.gui
        self._title = gui.add_html('')
        self._add_run(gui)
        self._waiting = gui.add_html('')
        self._values = gui.add_html('')
        self._problem = gui.add_html('')
        if source.pushes:
            with gui.add_folder('Push with the mouse'):
                gui.add_html('<div style="padding:0 1em;font-size:0.85em">Drag the body: a spring '
                             'pulls the grabbed point to the cursor. Click it: a strike along the '
                             'line of sight. Drag beside it: turn the picture.</div>')
                self.strength = gui.add_slider(
                    'strength (log10)', min=-2.0, max=2.0, step=0.1, initial_value=0.0,
                    hint='of the spring and of the strike')
        self.curves = None
        if not source.plays:
            with gui.add_folder('Conservation'):
                self.curves = Curves(gui)
        self._expected = gui.add_html('')
        with gui.add_folder('Show', expand_by_default=False):
            self._add_shown(gui)
        self._scene_folder = None
        if source.edits:
            self._scene_folder = gui.add_folder('Scene', expand_by_default=False)
        with gui.add_folder('Events', expand_by_default=False):
            self._event_list = gui.add_html('')

    def _ask(self, name, value=None):
        self.requests.put((name, value))

    def _add_run(self, gui):
        source = self._source
        if source.edits:
            names = sorted({*scene_names(), source.scene.name})
            choice = gui.add_dropdown('scene', names, initial_value=source.scene.name)
            choice.on_update(lambda event: self._ask('choose', event.target.value))
        buttons = gui.add_button_group('run', ('pause', 'play', 'step', 'reset'))
        buttons.on_click(lambda event: self._ask('run', event.target.value))
        if source.paces:
            self._speed = gui.add_slider(
                'speed (log10)', min=-SPEEDS, max=max(SPEEDS, math.log10(source.speed)), step=0.1,
                initial_value=math.log10(source.speed),
                marks=((-3.0, '1/1000'), (0.0, '1'), (3.0, '1000')))
            self._speed.on_update(lambda event: self._ask('speed', 10.0 ** event.target.value))
        if source.plays:
            self._timeline = gui.add_slider(
                'time (s)', min=0.0, max=source.end, step=max(source.end / 2000.0, 1e-9),
                initial_value=0.0,
                marks=tuple((at, '') for at, _ in source.marks[:200]))
            self._timeline.on_update(lambda event: event.client is not None
                                     and self._ask('seek', event.target.value))
        cameras = gui.add_button_group('camera', tuple(PRESETS))
        cameras.on_click(self._look)

    def _look(self, event):
        """Put the camera of the page that asks to a preset."""
        clients = self._server.get_clients()
        client = clients.get(event.client_id) if event.client_id is not None else None
        for one in [client] if client else clients.values():
            look(one, event.target.value)

    def _add_shown(self, gui):
        labels = {'omega': 'angular velocity ω', 'momentum': 'angular momentum L',
                  'force': 'net force', 'torque': 'net torque dL/dt', 'axis': 'trace of the axis',
                  'polhode': 'polhode (ω in the body)', 'herpolhode': 'herpolhode (ω in space)',
                  'follow': 'follow the body'}
        self._boxes = {}
        for key, text in labels.items():
            box = self._boxes[key] = gui.add_checkbox(text, initial_value=self._shown[key])
            box.on_update(lambda event, key=key: self._shown.update({key: event.target.value}))
        dark = gui.add_checkbox('dark page', initial_value=self._shown['dark'])
        dark.on_update(lambda event: self._ask('dark', event.target.value))

    def begin(self, scene, about, cell, beside=None):
        """Show the controls of a scene that begins.

        `about` says in words what is drawn, `cell` how far the lines of the ground are apart (m),
        and `beside` is the Player of a second recording or None.
        """
        name = html.escape(scene.name.replace('_', ' '))
        method = html.escape(self._source.method or 'not yet moving')
        grey = '' if beside is None else (
            f'<div>In grey: <b>{html.escape(beside.name)}</b>, {html.escape(beside.method)}; '
            f'in colours: {html.escape(self._source.name)}</div>')
        self._title.content = (
            f'<div style="padding:0.4em 1em 0"><b>{name}</b>, {method}{grey}'
            f'<div style="font-size:0.85em">{html.escape(scene.about)}</div>'
            f'<div style="font-size:0.85em;opacity:0.75">Drawn: {html.escape(about)}; the ground '
            f'has a line every {cell:g} m.</div></div>')
        self._boxes['follow'].value = self._shown['follow']
        self._events.clear()
        self._event_list.content = ''
        self._expected.content = ''
        self.say('')
        if self._scene_folder:
            self._fill_scene(scene)

    def _fill_scene(self, scene):
        """Make a control for each number of a scene, or put the numbers into those there are."""
        wanted = list(self._numbers(scene))
        if [name for name, _, _ in wanted] != list(self._scene_controls):
            for control in self._scene_controls.values():
                control.remove()
            with self._scene_folder:
                self._scene_controls = {name: self._number(name, value, text_for)
                                        for name, value, text_for in wanted}
        for name, value, _ in wanted:
            if self._scene_controls[name].value != value:
                self._scene_controls[name].value = value

    def _numbers(self, scene):
        """Yield (label, number, function) of a scene; the function of a value returns YAML."""
        source = self._source
        yield ('spin (rad/s)', parameters.spin_of(scene)[0],
               lambda value: parameters.with_spin(source.scene, value))
        if scene.constraint.mechanism is not Mechanism.TABLE:
            yield ('tilt (rad)', parameters.tilt_of(scene),
                   lambda value: parameters.with_tilt(source.scene, value))
        for path, value in parameters.numbers(parameters.mapping_of(scene)):
            yield (parameters.label(path), value,
                   lambda value, path=path: parameters.changed(source.scene.text, path, value))

    def _number(self, name, value, text_for):
        control = self._server.gui.add_number(name, initial_value=value)

        def edit(event):
            if event.client is not None:
                self._edit = (time.monotonic(), lambda: text_for(event.target.value))
        control.on_update(edit)
        return control

    def edited(self):
        """Return the YAML text of an edited scene when the person has stopped typing, or None."""
        if self._edit is None or time.monotonic() - self._edit[0] < EDIT_AFTER:
            return None
        (_, text), self._edit = self._edit, None
        return text()

    def wait(self, text):
        """Show what the page waits for, or nothing."""
        content = text and (f'<div style="margin:0.3em 1em;font-size:0.9em">'
                            f'{html.escape(text)} ...</div>')
        if self._waiting.content != content:
            self._waiting.content = content

    def say(self, problem):
        """Show an error line."""
        # the text keeps the colour of the page, which is legible on light and on dark ground
        style = ('margin:0.3em 1em;padding:0.2em 0.6em;font-size:0.9em;'
                 'border-left:4px solid #e03131;background:rgba(224,49,49,0.15)')
        self._problem.content = (f'<div style="{style}">{html.escape(problem)}</div>'
                                 if problem else '')

    def take(self, snapshot):
        """Take the events of a Snapshot."""
        if self.curves:
            self.curves.take(snapshot)
        self._events = [*self._events, *snapshot.events][-EVENTS:]

    def draw(self, snapshot, arrows, expected, beside=None):
        """Show the numbers of a Snapshot; a few times a second is enough.

        `beside` is the Snapshot of a second recording at the same time, or None.
        """
        rows = [('t', f'{snapshot.time:.3f} s'), ('E', f'{snapshot.energy:.9g} J')]
        if arrows:
            for name, value, unit in (('ω', arrows.omega, 'rad/s'),
                                      ('L', arrows.momentum, 'N m s'),
                                      ('net force', arrows.force, 'N'),
                                      ('net torque', arrows.torque, 'N m')):
                size = math.hypot(*value)
                rows.append((name, f'{size:.5g} {unit}' if math.isfinite(size) else 'unknown'))
        if beside is not None:
            angle, distance = _apart(snapshot.vector, beside.vector)
            rows += [('to the grey one', f'{angle:.3g} rad'), ('', f'{distance:.3g} m')]
        self._values.content = _table(rows)
        if self.curves:
            self.curves.draw(self._source.speed)
        if self._source.plays:
            self._timeline.value = min(snapshot.time, self._source.end)
        lines = [f'{at:.6g} s: {html.escape(text)}' for at, text in reversed(self._events)]
        self._event_list.content = (f'<div style="padding:0 1em;font-size:0.85em">'
                                    f'{"<br>".join(lines) or "none yet"}</div>')
        if expected:
            what = expected.get('event') or expected.get('quantity') or 'theory'
            self._expected.content = _table([(what, 'predicted, measured'),
                                             *_compared(expected)])


def _apart(one, other):
    """Return the angle (rad) between the attitudes of two states, and their distance (m)."""
    turn = Rotation.from_quat(one[ORIENTATION]).inv() * Rotation.from_quat(other[ORIENTATION])
    return float(turn.magnitude()), float(np.linalg.norm(other[POSITION] - one[POSITION]))


def _compared(expected):
    """Yield the rows of what theory predicts and what was measured."""
    for key, predicted in expected.items():
        name = key.removeprefix('predicted_')
        if name != key:
            measured = expected.get(f'measured_{name}')
            seen = '...' if measured is None else f'{measured:.12g}'
            yield name.replace('_', ' '), f'{predicted:.12g}, {seen}'


def _table(rows):
    cells = ''.join(f'<tr><td style="opacity:0.7;padding-right:1em">{html.escape(name)}</td>'
                    f'<td>{html.escape(value)}</td></tr>' for name, value in rows)
    return (f'<table style="margin:0.2em 1em;font-size:0.9em;font-variant-numeric:tabular-nums">'
            f'{cells}</table>')
