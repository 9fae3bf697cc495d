# SPDX-License-Identifier: Apache-2.0
"""The moving body of a report: what body.js draws, in lengths relative to the body's reach."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from rigid_body_sim.analysis.space import traced_axis
from rigid_body_sim.drawing import surfaces
from rigid_body_sim.drawing.body import drawing_of
from rigid_body_sim.drawing.setting import (
    cell_of,
    follows,
    ground_of,
    holder_of,
    middle_of,
    reach_of,
    springs_of,
    start_of,
)
from rigid_body_sim.scene.constraints.protocol import Mechanism

MOST_FRAMES, TURN_A_FRAME, LARGEST_TURN = 3000, 0.15, 0.8
"""Frames of a motion; the turn from one to the next (rad) where they are enough for the whole of
it, and the largest, between which body.js interpolates."""
COLORS = {'base': (0.29, 0.56, 0.85), 'accent': (0.96, 0.67, 0.26), 'holder': (0.5, 0.5, 0.53)}
ARROWS = {'angular velocity ω': (0.84, 0.37, 0.0), 'angular momentum L': (0.0, 0.62, 0.45)}
TRACE = (0.0, 0.55, 0.85)
"""Colour of the trace of an axis, legible on a light and on a dark page."""
ARROW = 1.35
"""Length of the longest arrow, relative to the body's reach."""
SHAPES = ((1.0, 0.018), (0.8, 0.028))
"""Length of each arrow relative to ARROW, and radius of its shaft: L is thicker and shorter than
omega, so that both are seen where they are parallel."""


@dataclass(frozen=True)
class Moving:
    """A recorded motion to be played.

    Attributes
    ----------
    times, orientation, angular_velocity, position : arrays
        (n,) s; (n, 4) quaternions; (n, 3) rad/s in body axes; (n, 3) m.
    scene : Scene or None
    """

    times: np.ndarray
    orientation: np.ndarray
    angular_velocity: np.ndarray
    position: np.ndarray
    scene: object

    @property
    def drawing(self):
        """The Drawing of the body."""
        return drawing_of(self.scene)

    def data(self):
        """Return what body.js takes, as plain data."""
        drawing, middle = self.drawing, middle_of(self.scene)
        unit = reach_of(self.scene, drawing)
        turns, ground = Rotation.from_quat(self.orientation), ground_of(self.scene, unit)
        what, axis = traced_axis(self.scene)
        reach = max(1.15 * float(((drawing.vertices - middle) @ axis).max()) / unit, 0.7)
        return {
            'times': _round(self.times, 7), 'orientation': _round(self.orientation, 5),
            'position': _round(self.position / unit, 5), 'middle': _round(middle / unit, 6),
            'floor': ground.height / unit, 'slope': list(ground.axes),
            'cell': cell_of(unit) / unit, 'follow': follows(self.scene),
            'axis': _round(reach * axis, 5), 'traced': what, 'trace': list(TRACE),
            'surfaces': [_mesh(one, unit) for one in drawing.surfaces],
            'holder': [_mesh(one, unit, 'holder') for one in holder_of(self.scene, unit)],
            'start': _round(start_of(self.scene) / unit, 6),
            'springs': [{'at': _round(one.at / unit, 5), 'anchor': _round(one.anchor / unit, 5)}
                        for one in springs_of(self.scene)],
            'shaft': _mesh(surfaces.cylinder(0.012, 1.0).placed(
                (0.0, 0.0, 0.5)), 1.0, 'holder'),
            'arrows': self._arrows(turns)}

    def _arrows(self, turns):
        """Return the arrows of omega and L in world axes, each relative to its longest."""
        values = [self.angular_velocity]
        if self.scene is not None:
            body = self.scene.body
            held = self.scene.constraint.mechanism is Mechanism.POINT
            inertia = (body.about_origin if held else body.about_center).matrix
            values.append(self.angular_velocity @ inertia)
        longest = [float(np.linalg.norm(one, axis=1).max()) or 1.0 for one in values]
        return [{'name': name, 'color': color, 'mesh': _mesh(_arrow(shaft), 1.0),
                 'values': _round(ARROW * share * turns.apply(value) / size, 4)}
                for (name, color), (share, shaft), value, size in zip(
                    ARROWS.items(), SHAPES, values, longest)]


def moving(measured):
    """Return the Moving of a Measured, or None.

    It holds the whole recording if frames that are dense enough to be played suffice for it, else
    the beginning.
    """
    if measured.motion is None or not measured.motion.samples.columns():
        return None
    columns = measured.motion.samples.columns()
    times, omega = columns[0], columns[2]
    fastest = float(np.sqrt((omega * omega).sum(axis=1)).max())
    if len(times) > 1 and fastest * float(np.diff(times).max()) > LARGEST_TURN:
        columns = measured.motion.head.columns()
        times = columns[0]
    step = 1
    if fastest > 0.0 and len(times) > 1:
        turn = fastest * (times[1] - times[0])
        step = max(1, min(int(TURN_A_FRAME / turn), len(times) // 200))
        if turn * (whole := -(-len(times) // MOST_FRAMES)) <= LARGEST_TURN:
            step = max(step, whole)
    return Moving(*(column[::step][:MOST_FRAMES] for column in columns), measured.source.scene)


def _arrow(radius):
    """Return an arrow of length 1 along z with a shaft of a radius."""
    head = surfaces.cone(2.5 * radius, 0.14)
    return surfaces.joined([surfaces.cylinder(radius, 0.86).placed((0.0, 0.0, 0.43)),
                            head.placed((0.0, 0.0, 0.895))])


def _mesh(surface, unit, color=None):
    names = ([color] * len(surface.faces) if color
             else ['accent' if accent else 'base' for accent in surface.accent])
    return {'points': _round(surface.vertices / unit, 5), 'faces': surface.faces.tolist(),
            'colors': [COLORS[name] for name in names], 'smooth': surface.smooth,
            'clear': surface.clear}


def _round(values, digits):
    return np.round(values, digits).tolist()
