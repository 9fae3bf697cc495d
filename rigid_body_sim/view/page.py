# SPDX-License-Identifier: Apache-2.0
"""The page: a viser server, and the loop that brings snapshots to it and pushes to the body."""

import contextlib
import io
import socket
import time

import viser

from rigid_body_sim.drawing.setting import follows
from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.view import hand, mouse
from rigid_body_sim.view.access import Access
from rigid_body_sim.view.panel import PRESETS, Panel, aim
from rigid_body_sim.view.stage import Stage

PERIOD = 1.0 / 60.0
FIELD_OF_VIEW = 0.7
LAST_PORT = 65000
"""Largest first port to try: from there on some are left to try if it is taken."""
PULLED_EVERY = 0.1
"""Time after which a pull is sent again where no snapshot comes, s."""
NUMBERS_EVERY = 0.2
"""Time between two updates of numbers, curves and traces, s."""


def serve(access, port):
    """Return a viser server.

    Raises
    ------
    BadInput
        If the address cannot be listened on: viser would try ports for ever.
    """
    if not 0 <= port <= LAST_PORT:
        raise BadInput('--port', f'got {port}', f'0 (any free one) to {LAST_PORT}')
    try:
        family, *_, address = socket.getaddrinfo(access.host, 0, type=socket.SOCK_STREAM)[0]
        with socket.socket(family, socket.SOCK_STREAM) as tried:
            tried.bind(address)
    except (OSError, UnicodeError) as error:
        raise BadInput('--host', f'{access.host!r} cannot be listened on ({error})',
                       'an address of this machine') from None
    # viser prints an address without our token
    with access.guarding(), contextlib.redirect_stdout(io.StringIO()):
        server = viser.ViserServer(host=access.host, port=port, label='rigid_body_sim',
                                   verbose=False)
    # a page can ask for a tunnel to the outside even without the button: it is refused
    server.request_share_url = lambda verbose=True: None
    return server


class Page:
    """A page that shows a source.

    Parameters
    ----------
    source : object
        Live, NodeSource or Player.
    access : Access
        Who may open it.
    port : int
        The first port to try; 0 is any.
    dark : bool
    """

    def __init__(self, source, access=None, port=8080, dark=False):
        self._source = source
        self._access = access or Access()
        self.server = serve(self._access, port)
        self._shown = {'omega': True, 'momentum': True, 'force': False, 'torque': False,
                       'axis': True, 'polhode': False, 'herpolhode': False, 'follow': False,
                       'dark': dark}
        self._theme(dark)
        self.server.initial_camera.position = PRESETS['3/4']
        self.server.initial_camera.look_at = (0.0, 0.0, 0.0)
        self.server.initial_camera.fov = FIELD_OF_VIEW
        self._waits = False
        self.server.on_client_connect(self._welcome)
        self.server.gui.main_panel.dock_right()
        self.panel = Panel(self.server, source, self._shown)
        self.mouse = mouse.Mouse()
        self._generation, self._stages, self._hand = None, [], None
        self._grips, self._held, self._pulling = {}, [], False
        self._pulled, self._lag, self._numbers_due = 0.0, PERIOD, 0.0
        self.snapshot = None

    @property
    def address(self):
        """The address to open, with its token if there is one."""
        return self._access.address(self.server.get_port())

    def _theme(self, dark):
        self.server.gui.configure_theme(dark_mode=dark, show_logo=False, show_share_button=False,
                                        control_width='small', brand_color=(0, 114, 178))

    def _welcome(self, client):
        """Aim the camera of a new client; the first one begins a motion that waits for it."""
        aim(client)
        if self._waits:
            self._waits = False
            self.panel.requests.put(('run', 'play'))

    def await_client(self):
        """Hold the motion until a client sees it; that of a node is not this page's to hold."""
        if self._source.paces and not self.server.get_clients():
            self._waits = True
            self._source.tell('pause', True)

    def run(self, until=lambda: False):
        """Serve until `until` returns true or an interrupt comes."""
        due = time.monotonic()
        while not until():
            self.turn()
            now = time.monotonic()
            due = min(max(due + PERIOD, now), now + PERIOD)
            self._source.wait(due - now)

    def turn(self):
        """Handle requests, snapshots and the mouse."""
        while not self.panel.requests.empty():
            self._do(*self.panel.requests.get())
        text = self.panel.edited() if self._source.edits else None
        if text is not None:
            self._source.begin(text)
        snapshots = self._source.poll()
        if self._source.generation != self._generation:
            self._begin()
        for message in self._source.messages:
            self.panel.say(message)
        self._source.messages.clear()
        if snapshots and self.snapshot is not None and not any(
                one.restarted for one in snapshots):
            self._lag = snapshots[-1].time - self.snapshot.time
        for snapshot in snapshots:
            self.snapshot = snapshot
            self.panel.take(snapshot)
            self._stages[0].trace(snapshot)
        self.panel.wait(self._source.preparing)
        if self.snapshot is not None:
            self._push(bool(snapshots))
            if snapshots:
                self._show()
            self._numbers()
        # else viser gathers messages for a sixtieth of a second of its own
        self.server.flush()

    def _begin(self):
        """Show the scene that the source has begun."""
        self._generation = self._source.generation
        for stage in self._stages:
            stage.remove()
        scene = self._source.scene
        stage = Stage(self.server, scene)
        self._stages = [stage]
        stage.shown = self._shown
        self._shown['follow'] = follows(scene)
        self._hand = hand.Hand(stage.mechanics) if scene else None
        self._grips = {}
        if self._source.pushes:
            self.mouse.listen(stage.bodies)
        beside = self._source.beside
        if beside is not None:
            self._stages.append(Stage(self.server, beside.scene, 'beside', True, stage.unit))
        self.panel.begin(scene, stage.drawing.about, stage.cell, beside)

    def _show(self):
        stage = self._stages[0]
        stage.follows = self._shown['follow']
        stage.show(self.snapshot, self._held)
        for other in self._stages[1:]:
            other.follows = False
            other.show(self._beside())
            other.move_with(stage)

    def _beside(self):
        """Return the Snapshot of the second recording, or None."""
        beside = self._source.beside
        return None if beside is None else beside.beside_of(self.snapshot)

    def _numbers(self):
        now = time.monotonic()
        if now < self._numbers_due:
            return
        self._numbers_due = now + NUMBERS_EVERY
        stage, snapshot = self._stages[0], self.snapshot
        stage.draw_traces()
        arrows = stage.mechanics.of(snapshot) if stage.mechanics else None
        self.panel.draw(snapshot, arrows, self._source.expected, self._beside())

    def _push(self, fresh):
        """Apply the commands of the mouse to the body; `fresh`: whether a snapshot has come."""
        if not self._source.pushes:
            return
        stage, vector = self._stages[0], self.snapshot.vector
        strength = 10.0 ** self.panel.strength.value
        pulls = dict(self.mouse.pulls)
        now = time.monotonic()
        # what has not moved is pulled as before, and what is paused gets no commands for nothing
        if pulls and (fresh or not self._pulling or now - self._pulled > PULLED_EVERY):
            self._pulled = now
            self._pull(pulls, strength)
        elif self._pulling and not pulls:
            self._let_go()
        while self.mouse.clicks:
            origin, direction = self.mouse.clicks.pop(0)
            point = mouse.hit(stage.drawing, vector, stage.to_world(origin), direction)
            if point is not None:
                self._strike(vector, point, direction, strength)

    def _pull(self, pulls, strength):
        """Hold the wrench of the springs of all browsers that drag the body."""
        stage, vector, source = self._stages[0], self.snapshot.vector, self._source
        lag = max(self._lag, PERIOD * source.speed, source.tick)
        pace = hand.pace_of(strength, source.speed, lag)
        known, self._grips, self._held, rows = self._grips, {}, [], []
        for key, (begun, cursor) in pulls.items():
            was, grip = known.get(key, (None, None))
            if was is not begun:
                grip = stage.to_body(vector, stage.to_world(begun))
            self._grips[key] = begun, grip
            point, wanted = self._hand.held_point(vector, grip, lag), stage.to_world(cursor)
            row = self._hand.pull(vector, point, wanted, pace)
            if row is not None:
                rows.append(row)
                self._held.append((point, wanted))
        if rows:
            self._pulling = True
            source.command(hand.together(rows))
        elif self._pulling:
            self._let_go()

    def _let_go(self):
        self._pulling, self._held = False, []
        self._source.command(hand.release())

    def _strike(self, vector, point, direction, strength):
        """Strike a point: at strength 1 its speed changes by half a page length a second."""
        mass = self._hand.felt_mass(vector, point, direction)
        if mass is not None:
            speed = 0.5 * strength * self._stages[0].unit / self._source.speed
            self._source.command(self._hand.strike(vector, point, mass * speed * direction))

    def _do(self, name, value):
        """Execute the request of a control of the panel."""
        source = self._source
        if name == 'choose':
            try:
                source.begin(load_scene(value).text)
            except BadInput as error:
                self.panel.say(str(error))
        elif name == 'run':
            pauses = {'pause': True, 'play': False}
            source.tell('pause' if value in pauses else value, pauses.get(value))
            if value != 'pause':
                self.panel.say('')    # the motion goes on, or says again why it does not
        elif name == 'speed':
            source.set_speed(value)
        elif name == 'seek':
            source.seek(value)
        elif name == 'dark':
            self._theme(value)

    def close(self):
        """Release the body, end the source and the server."""
        if self._pulling:
            self._source.command(hand.release())
        self._source.close()
        with contextlib.redirect_stdout(io.StringIO()):
            self.server.stop()
