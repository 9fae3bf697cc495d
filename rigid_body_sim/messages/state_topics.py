# SPDX-License-Identifier: Apache-2.0
"""The topics that a simulation fills: types, frames, and the sources of their numbers.

The node publishes and records them, and ``simulate`` records them; tick_messages.py makes the
bytes for both.
"""

import dataclasses
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import yaml

from rigid_body_sim.errors import BadInput
from rigid_body_sim.mechanics.balance import Dynamics
from rigid_body_sim.messages import marker
from rigid_body_sim.messages.tick_messages import (
    ACCELERATION,
    BODY_VELOCITY,
    ENERGY,
    HINGE,
    REACTION,
    SHAPE,
    SQUARE,
    VECTOR,
    TickMessages,
)
from rigid_body_sim.numerics import rotations
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, POSITION, VELOCITY


class Frames(NamedTuple):
    """Names of the fixed frame and of the body's frame, and their common prefix."""

    world: str = 'world'
    body: str = 'body'
    prefix: str = ''


@dataclasses.dataclass(frozen=True)
class Output:
    """A topic that is filled from states.

    Attributes
    ----------
    name, type : str
    about : str
        What it holds, and in which axes: one line for docs/reference/topics.md.
    constants : callable
        Takes (scene, frames) and returns the fields that never change, and the lengths of
        sequences; raises BadInput if the topic has no meaning for a scene.
    variable : tuple of str
        Paths of the doubles that change, in wire order. A stamp always changes.
    places : tuple of (int or slice)
        Places of these doubles in the sample (tick_messages.py), in the same order.
    derive : callable, optional
        Takes a scene and returns a function (samples, held wrench) that computes its part of the
        samples, shape (n, SAMPLE_SIZE), from their states.
    absolute : bool
        Whether the name is outside the node's namespace.
    paced : bool
        Whether the topic has a rate of its own instead of the tick rate.
    """

    name: str
    type: str
    about: str
    constants: Callable
    variable: tuple
    places: tuple
    derive: Callable | None = None
    absolute: bool = False
    paced: bool = False


def _in_world(scene, frames):
    return {'header': {'frame_id': frames.world}}


def _in_body(scene, frames):
    return {'header': {'frame_id': frames.body}}


def _nothing(scene, frames):
    return {}


def _odometry(scene, frames):
    return {**_in_world(scene, frames), 'child_frame_id': frames.body}


def _velocity_in_body(scene):
    def derive(samples, wrench):
        for sample in samples:
            sample[BODY_VELOCITY] = rotations.rotate_back(*sample[ORIENTATION], *sample[VELOCITY])

    return derive


def _proper_acceleration(scene):
    """Derive the proper acceleration a - g of the body's origin (REP 145), exact at the tick."""
    dynamics, (x, y, z) = Dynamics(scene), scene.field
    g = np.array([0.0 - x, 0.0 - y, scene.contact.g - z])

    def derive(samples, wrench):
        for sample in samples:
            felt = dynamics.balance(sample[VECTOR], wrench).acceleration + g
            sample[ACCELERATION] = rotations.rotate_back(*sample[ORIENTATION], *felt)

    return derive


def _held(scene, frames):
    if scene.constraint.mechanism is Mechanism.FREE:
        raise BadInput(
            'parameter publish', 'got reaction with constraint free', 'nothing holds a free body')
    return _in_world(scene, frames)


def _reaction(scene):
    """Derive the force and the torque of the constraint.

    The torque is about the fixed point, the point `through` of the hinge, or the point of contact.
    """
    dynamics = Dynamics(scene)

    def derive(samples, wrench):
        for sample in samples:
            balance = dynamics.balance(sample[VECTOR], wrench)
            sample[REACTION] = *balance.force, *balance.torque

    return derive


def _joint(scene, frames):
    if scene.constraint.axis is None:
        raise BadInput(
            'parameter publish', f'got joint_states with constraint {scene.constraint.kind!r}',
            'only a hinge is a joint')
    return {
        **_in_world(scene, frames),
        'name': [f'{frames.prefix}hinge'],
        'position': [0.0],
        'velocity': [0.0],
    }


def _hinge(scene):
    """Derive the hinge's angle as the scene file counts it.

    Whole turns are known only as far as the sign of q tells them: one either way.
    """
    axis = np.array(scene.constraint.axis)
    start = yaml.safe_load(scene.text)['initial'].get('angle', 0.0)
    x, y, z, w = scene.initial.orientation.tolist()

    def derive(samples, wrench):
        for sample in samples:
            *turn, cosine = rotations.multiply(-x, -y, -z, w, *sample[ORIENTATION])
            sample[HINGE] = (
                start + 2.0 * math.atan2(axis @ turn, cosine), axis @ sample[ANGULAR_VELOCITY])

    return derive


def _marker(scene, frames):
    return {**_in_world(scene, frames), 'ns': frames.body, **marker.shape_fields(scene)}


def _marker_pose(scene):
    center, axes = marker.place_of(scene)

    def derive(samples, wrench):
        for sample in samples:
            q = sample[ORIENTATION]
            sample[SHAPE] = (*(sample[POSITION] + rotations.rotate(*q, *center)),
                             *rotations.multiply(*q, *axes))

    return derive


def _transform(scene, frames):
    return {'transforms': [{**_in_world(scene, frames), 'child_frame_id': frames.body}]}


EVERY_TICK = (
    Output(
        'pose',
        'geometry_msgs/msg/PoseStamped',
        'position (m) and orientation of the body frame in the world',
        _in_world,
        ('pose',),
        (POSITION, ORIENTATION),
    ),
    Output(
        'angular_velocity',
        'geometry_msgs/msg/Vector3Stamped',
        'angular velocity, rad/s, components along the axes of the body',
        _in_body,
        ('vector',),
        (ANGULAR_VELOCITY,),
    ),
    Output(
        'energy',
        'std_msgs/msg/Float64',
        'kinetic and potential energy, J',
        _nothing,
        ('data',),
        (ENERGY,),
    ),
    Output(
        'angular_momentum_squared',
        'std_msgs/msg/Float64',
        'L^2 about the fixed point, else about the centre of mass, (kg m^2/s)^2',
        _nothing,
        ('data',),
        (SQUARE,),
    ),
)
ON_REQUEST = (
    Output(
        'odom',
        'nav_msgs/msg/Odometry',
        'pose in the world; velocity (m/s) and angular velocity along the axes of the body',
        _odometry,
        ('pose.pose', 'twist.twist'),
        (POSITION, ORIENTATION, BODY_VELOCITY, ANGULAR_VELOCITY),
        _velocity_in_body,
    ),
    Output(
        'imu',
        'sensor_msgs/msg/Imu',
        'orientation, angular velocity, proper acceleration a - g of the origin (REP 145)',
        _in_body,
        ('orientation', 'angular_velocity', 'linear_acceleration'),
        (ORIENTATION, ANGULAR_VELOCITY, ACCELERATION),
        _proper_acceleration,
    ),
    Output(
        'joint_states',
        'sensor_msgs/msg/JointState',
        'angle (rad) and rate (rad/s) of a hinge',
        _joint,
        ('position', 'velocity'),
        (HINGE,),
        _hinge,
    ),
    Output(
        'reaction',
        'geometry_msgs/msg/WrenchStamped',
        'force (N) and torque (N m) of pivot, hinge or table on the body, world axes',
        _held,
        ('wrench',),
        (REACTION,),
        _reaction,
    ),
    Output(
        'marker',
        'visualization_msgs/msg/Marker',
        'the true shape of the body, for RViz',
        _marker,
        ('pose',),
        (SHAPE,),
        _marker_pose,
        paced=True,
    ),
    Output(
        'tf',
        'tf2_msgs/msg/TFMessage',
        'the transform from the world frame to the body frame',
        _transform,
        ('transforms[0].transform',),
        (POSITION, ORIENTATION),
        absolute=True,
        paced=True,
    ),
    Output(
        'clock',
        'rosgraph_msgs/msg/Clock',
        'simulated time',
        _nothing,
        (),
        (),
        absolute=True,
    ),
)
DISPLAY_RATE = 30.0
"""Default rate of paced outputs (Hz of simulated time), which are for display, not control."""
OUTPUTS = {output.name: output for output in EVERY_TICK + ON_REQUEST}


class Outputs(NamedTuple):
    """The outputs of a run: those of every tick, and those with a rate of their own."""

    ticking: list[Output]
    paced: list[Output]


def chosen(names) -> Outputs:
    """Return the outputs of every tick and the named ones on request."""
    named = [output for output in ON_REQUEST if output.name in names]
    return Outputs([*EVERY_TICK, *(output for output in named if not output.paced)],
                   [output for output in named if output.paced])


class SceneMessages(NamedTuple):
    """The makers of a scene's messages.

    Attributes
    ----------
    ticking : TickMessages
        Messages of every tick.
    paced : TickMessages or None
        Messages of the outputs with a rate of their own; None if there are none.
    """

    ticking: TickMessages
    paced: TickMessages | None


def scene_messages(outputs: Outputs, scene, frames: Frames) -> SceneMessages:
    """Return the SceneMessages of a scene; BadInput if a topic has no meaning for it."""
    paced = TickMessages(outputs.paced, scene, frames) if outputs.paced else None
    return SceneMessages(TickMessages(outputs.ticking, scene, frames), paced)
