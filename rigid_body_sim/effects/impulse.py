"""Impulse: a force and a couple of no duration. One place for strikes of a scene and for impulse commands."""

import numpy as np

from rigid_body_sim.effects.views import Frame
from rigid_body_sim.rotations import rotate, rotate_back
from rigid_body_sim.state import ANGULAR_VELOCITY, ORIENTATION, VELOCITY


def struck(scene, vector, impulse, couple, at=None):
    """Return the state just after an impulse.

    Parameters
    ----------
    scene : Scene
    vector : array of 14 floats
        The state just before (rigid_body_sim/state.py).
    impulse, couple : sequence of 3 floats
        N s and N m s, world components.
    at : sequence of 3 floats, optional
        Body point where the impulse acts, body components from the body's origin; default the centre of mass.

    Free body: M dv_center = J, dL = (at - center) x J + couple. Pivot, hinge: dL about the constraint, the rest is reaction. Table: the
    vertical part of J is the table's. A moment of zero takes no angular momentum.
    """
    frame = Frame.of(scene.body, scene.constraint)
    q, omega = vector[ORIENTATION], vector[ANGULAR_VELOCITY]
    at = scene.body.center_of_mass if at is None else at
    lever = np.subtract(at, frame.point)
    gained = np.cross(lever, rotate_back(*q, *impulse)) + rotate_back(*q, *couple)    # body components
    after = np.array(vector, dtype=float)
    if frame.kind == 'hinge':
        axis = np.array(scene.constraint.axis)
        change = axis * (axis @ gained / moment_about(axis, frame, scene.body))
    else:
        inner = [h / moment if moment > 0.0 else 0.0 for h, moment in zip(frame.from_body(gained), frame.moments, strict=True)]
        change = np.array(rotate(*frame.axes, *inner))
    after[ANGULAR_VELOCITY] = omega + change
    if frame.kind == 'free':
        push = np.asarray(impulse, dtype=float) / frame.mass
        after[VELOCITY] = after[VELOCITY] + push - rotate(*q, *np.cross(change, frame.point))
    elif frame.kind == 'hinge':
        after[VELOCITY] = after[VELOCITY] - rotate(*q, *np.cross(change, frame.point))
    elif frame.kind == 'table':
        after[VELOCITY] = after[VELOCITY] + np.array([impulse[0], impulse[1], 0.0]) / frame.mass
    return after


def moment_about(axis, frame, body):
    """Return the moment of inertia about a hinge's axis (unit vector, body components) through its point, kg m^2."""
    along = np.array(rotate_back(*body.about_center.axes, *axis))
    away = np.cross(axis, frame.arm)
    return float(along * along @ np.array(body.about_center.moments) + frame.mass * (away @ away))
