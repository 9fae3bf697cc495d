# SPDX-License-Identifier: Apache-2.0
"""Hinged bodies for the tests of the pendulum: the recorded cases, and random ones."""

import json
import pathlib

import numpy as np
from scipy.spatial.transform import Rotation

from rigid_body_sim.motions.pendulum import pendulum as motion
from rigid_body_sim.scene.bodies import Body, Inertia, make_body
from rigid_body_sim.scene.constraints import Hinge
from rigid_body_sim.scene.effects.gravity import Gravity
from rigid_body_sim.scene.scene import Scene
from rigid_body_sim.scene.state import STATE_SIZE, State

ROOT = pathlib.Path(__file__).resolve().parents[2]
RECORDS = json.loads((ROOT / 'test' / 'data' / 'pendulum.json').read_text())
HANGING, UPRIGHT = (0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.0)


def scene_of(body, axis, through=(0.0, 0.0, 0.0), g=9.81, initial=None):
    effects = (Gravity(g),) if g else ()
    return Scene('pendulum', '', body, Hinge(tuple(axis), tuple(through)), effects,
                 initial or State.of(), True, {})


def unit_scene(g=13.5, axis=(1.0, 0.0, 0.0)):
    """Return a thin rod of I = 0.75 kg m^2 about its end.

    For g = 13.5 m/s^2 and a level axis Omega is 3 rad/s to the last bit.
    """
    return scene_of(make_body(1.0, (0.5, 0.0, 0.5), (0.0, 0.0, -0.5)), axis, g=g)


def start_of(orientation=HANGING, angular_velocity=(0.0, 0.0, 0.0), time=0.0):
    return np.array([time, *orientation, *angular_velocity, *np.zeros(6)])


def anchored(scene, start):
    return anchored_by(motion.parameters(scene), start)


def anchored_by(parameters, start):
    anchor = np.empty(motion.ANCHOR_SIZE)
    motion.anchor(parameters, start, anchor)
    return anchor


def at(anchor, time):
    out = np.empty(STATE_SIZE)
    motion.state(anchor, time, out)
    return out


def recorded(name):
    """Return the scene, start and anchor of a recorded case."""
    record = RECORDS[name]
    inertia = Inertia(tuple(record['moments']), tuple(record.get('axes', HANGING)))
    scene = scene_of(Body(record['mass'], tuple(record['center_of_mass']), inertia, inertia),
                     record['axis'], record.get('through', (0.0, 0.0, 0.0)), record['g'])
    start = start_of(record['orientation'], record['angular_velocity'])
    return scene, start, anchored(scene, start)


def random_scene(rng):
    """Return a random scene: hinge tilted and off the origin; it swings or turns over."""
    turn = Rotation.random(random_state=rng).as_matrix()
    tensor = turn @ np.diag(rng.uniform(0.5, 1.0, 3)) @ turn.T
    body = make_body(
        rng.uniform(0.3, 3.0), ((tensor + tensor.T) / 2.0).tolist(), rng.normal(size=3).tolist())
    axis = rng.normal(size=3)
    scene = scene_of(body, (axis / np.linalg.norm(axis)).tolist(), rng.normal(size=3).tolist(),
                     rng.uniform(1.0, 20.0))
    start = start_of(Rotation.random(random_state=rng).as_quat(),
                     rng.normal() * 5.0 * np.array(scene.constraint.axis))
    start[8:11] = rng.normal(size=3)
    return scene, start


def bearing(scene, state):
    out = np.empty(6)
    motion.reaction(motion.parameters(scene), state, out)
    return out
