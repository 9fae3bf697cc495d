"""The topics that a simulation fills: type, frames, and how a state becomes each message, one at a time or thousands at once.

The node publishes these bytes and records the same; ``simulate`` records them without a node: one serialisation for wire and recording.
"""

import dataclasses
import math
import typing

import yaml

from rigid_body_sim import rotations
from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages.layout import Packer


class Frames(typing.NamedTuple):
    """Names of the fixed frame and of the one that moves with the body, and what both begin with."""

    world: str = 'world'
    body: str = 'body'
    prefix: str = ''


class Moment(typing.NamedTuple):
    """All that the messages of one tick are made of.

    `stamp` as (s, ns); `vector`: the state as 14 floats; `energy` (J) and `angular_momentum_squared` ((kg m^2/s)^2); `acceleration` of the
    body's origin, world axes (m/s^2), None where it is not known (at the first tick and after a reset).
    """

    stamp: tuple
    vector: list
    energy: float
    angular_momentum_squared: float
    acceleration: tuple | None = None


@dataclasses.dataclass(frozen=True)
class Output:
    """A topic that is filled at every tick.

    `absolute`: its name is not below the node's namespace. `constants(scene, frames)`: the fields that never change; `variable`: paths of
    those that do; `numbers(scene)`: the function from a Moment to their values in wire order; `columns(stamps, states, energies, momenta)`:
    the same for many, by column.
    """

    name: str
    type: str
    constants: object
    variable: tuple
    numbers: object
    columns: object = None
    absolute: bool = False

    def packer(self, scene, frames):
        """Return the Packer of its messages for a scene."""
        return Packer(self.type, self.constants(scene, frames), self.variable)


def _in_world(scene, frames):
    return {'header': {'frame_id': frames.world}}


def _in_body(scene, frames):
    return {'header': {'frame_id': frames.body}}


def _nothing(scene, frames):
    return {}


def always(numbers):
    """Return a function of a scene that ignores the scene."""
    return lambda scene: numbers


def _pose(moment):
    v = moment.vector
    return *moment.stamp, v[8], v[9], v[10], v[1], v[2], v[3], v[4]


def _angular_velocity(moment):
    v = moment.vector
    return *moment.stamp, v[5], v[6], v[7]


def _odometry(moment):
    v = moment.vector
    twist = rotations.rotate_back(v[1], v[2], v[3], v[4], v[11], v[12], v[13])
    return *moment.stamp, v[8], v[9], v[10], v[1], v[2], v[3], v[4], *twist, v[5], v[6], v[7]


# covariances of sensor_msgs/Imu, row by row
_EXACT, _UNKNOWN = (0.0,) * 9, (-1.0, *(0.0,) * 8)


def _imu(scene):
    """Return attitude, angular velocity and proper acceleration a - g of the body's origin, in body axes (REP 145).

    A covariance of -1 marks an acceleration that is not known.
    """
    gravity = scene.effect('gravity')
    g = gravity.g if gravity else 0.0

    def numbers(moment):
        v = moment.vector
        if moment.acceleration is None:
            return *moment.stamp, *v[1:8], 0.0, 0.0, 0.0, *_UNKNOWN
        x, y, z = moment.acceleration
        return *moment.stamp, *v[1:8], *rotations.rotate_back(v[1], v[2], v[3], v[4], x, y, z + g), *_EXACT

    return numbers


def _joint(scene, frames):
    if scene.constraint.kind != 'hinge':
        raise BadInput('parameter publish', f'got joint_states with constraint {scene.constraint.kind!r}', 'only a hinge is a joint')
    return {'header': {'frame_id': frames.world}, 'name': [f'{frames.prefix}hinge'], 'position': [0.0], 'velocity': [0.0]}


def _joint_state(scene):
    """Return the hinge's angle (rad) as the scene file counts it, and its rate (rad/s).

    Whole turns are kept as far as the continuous sign of the quaternion keeps them, one either way.
    """
    nx, ny, nz = scene.constraint.axis
    start = yaml.safe_load(scene.text)['initial'].get('angle', 0.0)
    px, py, pz, pw = scene.initial.orientation.tolist()

    def numbers(moment):
        v = moment.vector
        x, y, z, w = rotations.multiply(-px, -py, -pz, pw, v[1], v[2], v[3], v[4])
        return *moment.stamp, start + 2.0 * math.atan2(nx * x + ny * y + nz * z, w), nx * v[5] + ny * v[6] + nz * v[7]

    return numbers


def box_of(body):
    """Return the edges (m) of the box that has the body's mass and moments of inertia: what to draw for any body."""
    a, b, c = body.about_center.moments
    return tuple(math.sqrt(max(6.0 * square / body.mass, 0.0)) for square in (b + c - a, a + c - b, a + b - c))


def _box(scene, frames):
    edges = box_of(scene.body)
    thinnest = 0.02 * max(edges)
    scale = dict(zip('xyz', (max(edge, thinnest) for edge in edges), strict=True))
    return {'header': {'frame_id': frames.world}, 'ns': frames.body, 'type': 1, 'scale': scale,
            'color': {'r': 0.2, 'g': 0.5, 'b': 0.9, 'a': 1.0}, 'frame_locked': False}


def _box_pose(scene):
    """Return the pose of the principal axes at the centre of mass: there the box is drawn."""
    center, axes = scene.body.center_of_mass, scene.body.about_center.axes

    def numbers(moment):
        v = moment.vector
        q = v[1:5]
        offset = rotations.rotate(*q, *center)
        return *moment.stamp, v[8] + offset[0], v[9] + offset[1], v[10] + offset[2], *rotations.multiply(*q, *axes)

    return numbers


def _transform(scene, frames):
    return {'transforms': [{'header': {'frame_id': frames.world}, 'child_frame_id': frames.body}]}


EVERY_TICK = (
    Output('pose', 'geometry_msgs/msg/PoseStamped', _in_world, ('header.stamp', 'pose'), always(_pose),
           lambda stamps, states, energies, momenta: {
               'header.stamp': stamps, 'pose.position': states.position, 'pose.orientation': states.orientation}),
    Output('angular_velocity', 'geometry_msgs/msg/Vector3Stamped', _in_body, ('header.stamp', 'vector'), always(_angular_velocity),
           lambda stamps, states, energies, momenta: {'header.stamp': stamps, 'vector': states.angular_velocity}),
    Output('energy', 'std_msgs/msg/Float64', _nothing, ('data',), always(lambda moment: (moment.energy,)),
           lambda stamps, states, energies, momenta: {'data': energies}),
    Output('angular_momentum_squared', 'std_msgs/msg/Float64', _nothing, ('data',),
           always(lambda moment: (moment.angular_momentum_squared,)),
           lambda stamps, states, energies, momenta: {'data': momenta}),
)
ON_REQUEST = (
    Output('odom', 'nav_msgs/msg/Odometry', lambda scene, frames: {**_in_world(scene, frames), 'child_frame_id': frames.body},
           ('header.stamp', 'pose.pose', 'twist.twist'), always(_odometry)),
    Output('imu', 'sensor_msgs/msg/Imu', _in_body,
           ('header.stamp', 'orientation', 'angular_velocity', 'linear_acceleration', 'linear_acceleration_covariance'), _imu),
    Output('joint_states', 'sensor_msgs/msg/JointState', _joint, ('header.stamp', 'position', 'velocity'), _joint_state),
    Output('marker', 'visualization_msgs/msg/Marker', _box, ('header.stamp', 'pose'), _box_pose),
    Output('tf', 'tf2_msgs/msg/TFMessage', _transform, ('transforms[0].header.stamp', 'transforms[0].transform'), always(_pose),
           absolute=True),
    Output('clock', 'rosgraph_msgs/msg/Clock', _nothing, ('clock',), always(lambda moment: moment.stamp), absolute=True),
)
OUTPUTS = {output.name: output for output in EVERY_TICK + ON_REQUEST}
