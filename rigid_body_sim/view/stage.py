# SPDX-License-Identifier: Apache-2.0
"""The stage: the body, what holds it, its arrows and traces as objects of a viser server.

Lengths on the page are relative to `unit` metres, the reach of the body, so that a needle and
a planet fill the same picture. The frame /world holds everything; when the page follows the body,
it moves against it.
"""

import collections

import numpy as np
from scipy.spatial.transform import Rotation

from rigid_body_sim.analysis.space import traced_axis
from rigid_body_sim.drawing.body import drawing_of
from rigid_body_sim.drawing.setting import (
    cell_of,
    ground_of,
    holder_of,
    middle_of,
    reach_of,
    springs_of,
    start_of,
)
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, POSITION
from rigid_body_sim.view.snapshots import Mechanics

BODY, ACCENT, GHOST = (70, 140, 210), (240, 165, 60), (150, 150, 160)
HOLDER = (110, 110, 118)
CLEAR = 0.35
"""Opacity of a translucent surface."""
COLORS = {'omega': (214, 94, 0), 'momentum': (0, 158, 115), 'force': (204, 60, 60),
          'torque': (160, 90, 200), 'spring': (230, 200, 40)}
AXES = ((214, 60, 60), (60, 170, 60), (60, 90, 214))
TRACES = {'axis': (0, 140, 217), 'polhode': (214, 94, 0), 'herpolhode': (230, 159, 0)}
TRACE_POINTS = 1500
ARROW, LEAST_ARROW, GROWTH = 1.3, 0.45, 1.5
"""How far the first arrow of a kind reaches, in units; its least length beyond the ball that hides
it; and how much an arrow may grow before its kind is rescaled."""
THICK = {'momentum': (0.026, 0.06)}
SLIM = 0.014, 0.045
"""Radii of an arrow's shaft and head, in units. L is thicker and shorter than omega, so that
both are seen where they are parallel."""
SHORTER = {'momentum': 0.75}
HEAD = 0.11
SMALLEST_MOVE = 1e-6
"""A holder that has moved by less than this, in units, stays where it is drawn."""
FADING = 0.93
"""Share of the lead of a pulled body that is left after each snapshot."""


def wxyz(quaternion):
    """Return a quaternion (x, y, z, w) in viser's order."""
    x, y, z, w = quaternion
    return np.array((w, x, y, z))


class Stage:
    """The picture of one scene.

    Parameters
    ----------
    server : viser.ViserServer
    scene : Scene or None
    name : str
        Folder of its objects in the tree; a second recording gets one of its own.
    ghost : bool
        Whether the body is drawn in grey and translucent, beside another one.

    Attributes
    ----------
    unit : float
        Metres per length 1 on the page: the reach of the body.
    cell : float
        Metres from line to line of the ground.
    bodies : list
        Handles of the body's surfaces, for the mouse.
    shown : dict
        Name of an arrow or a trace -> whether it is drawn.
    """

    def __init__(self, server, scene, name='world', ghost=False, unit=None):
        self._server, self._name, self.scene = server, name, scene
        self.mechanics = Mechanics(scene) if scene else None
        self.drawing = drawing_of(scene)
        self._middle = middle_of(scene)
        self.unit = unit or reach_of(scene, self.drawing)
        self.cell = cell_of(self.unit)
        self.follows = False
        self._offset = self._about = np.zeros(3)
        self._lead = np.zeros(3)
        self._holder = None
        self._references = collections.defaultdict(float)
        self.what_axis, self._axis = traced_axis(scene)
        center = np.array(scene.body.center_of_mass) if scene else self._middle
        starts = dict.fromkeys(COLORS, self._middle) | {'force': center}
        self._hidden = {key: self.drawing.depth(at) / self.unit for key, at in starts.items()}
        along = (self.drawing.vertices - self._middle) @ self._axis
        self._radius = max(1.2 * float(along.max()) / self.unit, 0.7)
        self._traces = {key: collections.deque(maxlen=TRACE_POINTS) for key in TRACES}
        self.shown = {}
        with server.atomic():
            self._root = server.scene.add_frame(f'/{name}', show_axes=False)
            self._body = server.scene.add_frame(f'/{name}/body', show_axes=False)
            self._reference = server.scene.add_frame(f'/{name}/reference', show_axes=False)
            self.bodies = list(self._add_body(ghost))
            self._add_axes()
            if not ghost:
                self._add_ground()
                self._add_holder()
            self._springs = springs_of(scene)
            self._coils = self._server.scene.add_line_segments(
                f'/{name}/springs', np.zeros((max(len(self._springs), 1), 2, 3)), HOLDER,
                thickness=3.0, thickness_units='screen', visible=bool(self._springs))
            self._arrows = {key: self._add_arrow(key) for key in COLORS}
            self._lines = {key: self._add_trace(key) for key in TRACES}

    def _mesh(self, path, vertices, faces, color, smooth, **more):
        return self._server.scene.add_mesh_simple(
            path, vertices=np.asarray(vertices) / self.unit, faces=faces, color=color,
            flat_shading=not smooth, side='double', **more)

    def _add_body(self, ghost):
        for k, surface in enumerate(self.drawing.surfaces):
            for accent, color in ((False, BODY), (True, ACCENT)):
                chosen = surface.accent == accent
                if chosen.any():
                    used, faces = np.unique(surface.faces[chosen], return_inverse=True)
                    yield self._mesh(f'/{self._name}/body/surface_{k}_{int(accent)}',
                                     surface.vertices[used], faces.reshape(-1, 3),
                                     GHOST if ghost else color, surface.smooth,
                                     opacity=CLEAR if ghost or surface.clear else None)

    def _add_axes(self):
        """Add the body's axes, from the centre of mass just beyond its surface."""
        center = np.array(self.scene.body.center_of_mass if self.scene else (0.0, 0.0, 0.0))
        reach = 1.25 * np.abs(self.drawing.vertices - center).max(axis=0)
        ends = center + np.diag(np.maximum(reach, 0.35 * reach.max()))
        points = np.stack([np.broadcast_to(center, (3, 3)), ends], axis=1) / self.unit
        self._body_axes = self._server.scene.add_arrows(
            f'/{self._name}/body/axes', points, np.array(AXES, np.uint8),
            shaft_radius=0.008, head_radius=0.022, head_length=0.06)

    def _add_ground(self):
        ground = ground_of(self.scene, self.unit)
        self._server.scene.add_grid(
            f'/{self._name}/ground', infinite_grid=True, plane='xy',
            cell_size=self.cell / self.unit, section_size=5.0 * self.cell / self.unit,
            cell_color=(165, 165, 170), section_color=(120, 120, 130), section_thickness=1.2,
            fade_distance=22.0, fade_strength=1.5, shadow_opacity=0.25,
            position=(0.0, 0.0, ground.height / self.unit), wxyz=wxyz(ground.axes))

    def _add_holder(self):
        """Add what holds the body."""
        held = holder_of(self.scene, self.unit)
        if held:
            self._holder = self._server.scene.add_frame(f'/{self._name}/holder', show_axes=False)
            self._held_at = start_of(self.scene) / self.unit
        for k, surface in enumerate(held):
            self._mesh(f'/{self._name}/holder/{k}', surface.vertices, surface.faces, HOLDER, True)

    def _add_arrow(self, key):
        shaft, head = THICK.get(key, SLIM)
        return self._server.scene.add_arrows(
            f'/{self._name}/reference/{key}', np.zeros((1, 2, 3)), COLORS[key], visible=False,
            shaft_radius=shaft, head_radius=head, head_length=HEAD)

    def _add_trace(self, key):
        folder = f'/{self._name}/{"body" if key == "polhode" else "reference"}'
        return self._server.scene.add_line_segments(
            f'{folder}/trace_{key}', np.zeros((1, 2, 3)), TRACES[key], thickness=2.0,
            thickness_units='screen', visible=False)

    def show(self, snapshot, held=()):
        """Draw a Snapshot; `held` has (held point, cursor) of each mouse that pulls, world, m."""
        vector, unit = snapshot.vector, self.unit
        turn = Rotation.from_quat(vector[ORIENTATION])
        self._about = (vector[POSITION] + turn.apply(self._middle)) / unit
        self._follow(bool(held))
        with self._server.atomic():
            if not np.array_equal(self._root.position, self._offset):
                self._root.position = self._offset
            self._body.position = vector[POSITION] / unit
            self._body.wxyz = wxyz(vector[ORIENTATION])
            self._reference.position = self._about
            if self._holder:
                moved = self._about - self._held_at
                if np.abs(moved - self._holder.position).max() > SMALLEST_MOVE:
                    self._holder.position = moved
            if self._springs:
                self._coils.points = np.array(
                    [(spring.anchor, vector[POSITION] + turn.apply(spring.at))
                     for spring in self._springs], np.float32) / np.float32(unit)
            if self.mechanics:
                self._draw_arrows(snapshot)
            self._draw_spring(held)

    def _follow(self, pulled):
        """Move the world against the body; a pull halts this, and its lead fades afterwards."""
        target = -self._about if self.follows else np.zeros(3)
        if pulled:
            self._lead = self._offset - target
        else:
            self._lead *= FADING
            self._offset = target + self._lead

    def _draw_arrows(self, snapshot):
        arrows = self.mechanics.of(snapshot)
        center = self.mechanics.center(snapshot.vector) / self.unit - self._about
        for key, value in arrows._asdict().items():
            start = center if value is arrows.force else np.zeros(3)
            self._draw_arrow(key, start, value if self.shown.get(key) else np.zeros(3))

    def _draw_arrow(self, key, start, value):
        """Draw one arrow, in proportion to the first one of its kind; what grows rescales it.

        It begins where the largest ball about its start leaves the body that would hide it.
        """
        handle, size = self._arrows[key], float(np.linalg.norm(value))
        reference = self._references[key]
        if size > GROWTH * reference:
            reference = self._references[key] = size
        visible = size > 1e-6 * reference
        if visible:
            hidden, length = self._hidden[key], self._length(key) * size / reference
            along = value / size
            handle.points = np.array([[start + hidden * along,
                                       start + (hidden + length) * along]], np.float32)
            handle.head_length = min(HEAD, 0.5 * length)
        if handle.visible != visible:
            handle.visible = visible

    def _length(self, key):
        """Return the length of the first arrow of a kind beyond the ball that hides it."""
        return SHORTER.get(key, 1.0) * max(ARROW - self._hidden[key], LEAST_ARROW)

    def _draw_spring(self, held):
        handle = self._arrows['spring']
        if held:
            handle.points = (np.array(held) / self.unit - self._about).astype('f4')
        if handle.visible != bool(held):
            handle.visible = bool(held)

    def trace(self, snapshot):
        """Take the states of a Snapshot's trail into the traces."""
        if snapshot.restarted:
            self._references.clear()
            for trace in self._traces.values():
                trace.clear()
        turns = Rotation.from_quat(snapshot.trail[:, ORIENTATION])
        omega = snapshot.trail[:, ANGULAR_VELOCITY]
        speed = float(np.linalg.norm(omega[-1]))
        if speed > GROWTH * self._references['omega']:
            self._references['omega'] = speed
        # both curves are those of the arrow's tip
        sizes = np.linalg.norm(omega, axis=1, keepdims=True)
        sizes[sizes == 0.0] = 1.0
        tips = omega * (self._hidden['omega'] / sizes
                        + self._length('omega') / (self._references['omega'] or 1.0))
        self._traces['axis'].extend(self._radius * turns.apply(self._axis))
        self._traces['polhode'].extend(self._middle / self.unit + tips)
        self._traces['herpolhode'].extend(turns.apply(tips))

    def draw_traces(self):
        """Draw the traces as they are now; a few times a second is enough."""
        for key, trace in self._traces.items():
            handle, visible = self._lines[key], bool(self.shown.get(key)) and len(trace) > 1
            if visible:
                points = np.array(trace, np.float32)
                handle.points = np.stack([points[:-1], points[1:]], axis=1)
            if handle.visible != visible:
                handle.visible = visible

    def move_with(self, other):
        """Use the position of another stage."""
        self._root.position = other._root.position

    def to_world(self, point):
        """Return a point of the page in the world, m."""
        return (np.asarray(point, float) - self._offset) * self.unit

    def to_body(self, vector, point):
        """Return a point of the world (m) in the axes of the body with a state (14,)."""
        return Rotation.from_quat(vector[ORIENTATION]).inv().apply(point - vector[POSITION])

    def remove(self):
        """Remove everything from the page."""
        self._root.remove()
