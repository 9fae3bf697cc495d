"""The topics that a simulation fills: type, frames, and how a state becomes each message, one at a time or thousands at once.

The node publishes these bytes and records the same; ``simulate`` records them without a node: one serialisation for wire and recording.

All messages of a tick are made of one array of doubles, the *moment*:

======== ======================== ====================================================================================
place    name                     meaning
======== ======================== ====================================================================================
0:14     VECTOR                   the state, see state.py
14, 15   ENERGY, SQUARE           energy (J) and L . L ((kg m^2/s)^2)
16:19    BODY_VELOCITY            velocity of the body's origin in body axes (m/s)
19:22    ACCELERATION             proper acceleration of the body's origin in body axes (m/s^2)
22:28    REACTION                 force (N) and torque (N m) of the constraint on the body, world axes
28:30    HINGE                    angle (rad) and rate (rad/s) of a hinged body
30:37    BOX                      position (m) and quaternion of the principal axes at the centre of mass
======== ======================== ====================================================================================
"""

import dataclasses
import math
import typing

import numpy as np
import yaml

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.drawing.body import box_of
from rigid_body_sim.errors import BadInput
from rigid_body_sim.mechanics.balance import Dynamics
from rigid_body_sim.messages import cdr, definitions
from rigid_body_sim.messages.layout import Layout, Packer
from rigid_body_sim.messages.timeline import NANOSECONDS
from rigid_body_sim.numerics import rotations
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.state import (
    ANGULAR_VELOCITY,
    ORIENTATION,
    POSITION,
    STATE_SIZE,
    VELOCITY,
)

VECTOR = slice(0, STATE_SIZE)
ENERGY, SQUARE = 14, 15
BODY_VELOCITY, ACCELERATION, REACTION, HINGE, BOX = slice(16, 19), slice(19, 22), slice(22, 28), slice(28, 30), slice(30, 37)
MOMENT_SIZE = 37
STAMPS = ('header.stamp.sec', 'transforms[0].header.stamp.sec', 'clock.sec')


class Frames(typing.NamedTuple):
    """Names of the fixed frame and of the one that moves with the body, and what both begin with."""

    world: str = 'world'
    body: str = 'body'
    prefix: str = ''


@dataclasses.dataclass(frozen=True)
class Output:
    """A topic that is filled at every tick.

    Attributes
    ----------
    name, type : str
    constants : callable
        (scene, frames) -> the fields that never change, and the lengths of sequences; BadInput where the topic has no meaning for a scene.
    variable : tuple of str
        Paths of the doubles that change, in wire order; the stamp, if there is one, always does.
    places : tuple of (int or slice)
        Where they stand in the moment, in the same order.
    columns : callable, optional
        (stamps, states, energies, momenta) -> columns of many messages, for Packer.pack_many.
    derive : callable, optional
        scene -> function (moment, held wrench) that fills its part of the moment from the rest of it.
    absolute : bool
        Whether its name is not below the node's namespace.
    """

    name: str
    type: str
    constants: object
    variable: tuple
    places: tuple
    columns: object = None
    derive: object = None
    absolute: bool = False

    def packer(self, scene, frames):
        """Return the Packer of many of its messages."""
        stamp = ('header.stamp',) if 'header' in self.constants(scene, frames) else ()
        return Packer(self.type, self.constants(scene, frames), stamp + self.variable)


class TickMessages:
    """Makes all messages of a tick at once, for one tick or many.

    Each message is kept in a buffer such that its doubles lie on multiples of eight bytes (CDR aligns them so after its four bytes of
    encapsulation); those of all topics are set by one indexed assignment.

    Parameters
    ----------
    outputs : sequence of Output
    scene : scenes.Scene
    frames : Frames

    Attributes
    ----------
    sizes : list of int
        Bytes of each message.

    Raises
    ------
    BadInput
        Where a topic has no meaning for the scene.
    """

    def __init__(self, outputs, scene, frames):
        buffer, targets, sources, seconds, self._parts = bytearray(), [], [], [], []
        for output in outputs:
            blank = cdr.encode(output.type, output.constants(scene, frames))
            buffer += bytes((4 - len(buffer)) % 8)
            start = len(buffer)
            buffer += blank
            self._parts.append(slice(start, start + len(blank)))
            doubles, stamps = _places(output, blank)
            targets += [(start + place) // 8 for place in doubles]
            seconds += [(start + place) // 4 for place in stamps]
            sources += [place for entry in output.places
                        for place in (range(entry.start, entry.stop) if isinstance(entry, slice) else [entry])]
        self._blank = np.frombuffer(buffer + bytes(-len(buffer) % 8), dtype=np.float64)
        self._targets, self._sources, self._seconds = (np.array(places, dtype=np.intp) for places in (targets, sources, seconds))
        if len(self._targets) != len(self._sources):
            raise TypeError('an Output names more or fewer places than it has doubles')
        self.sizes = [part.stop - part.start for part in self._parts]
        self._derive = [output.derive(scene) for output in outputs if output.derive]

    def messages(self, vectors, energies, squares, stamps, wrench=Wrench()):    # noqa: B008 (immutable)
        """Return for each tick the list of its messages (bytes), in the order of the outputs.

        Parameters
        ----------
        vectors : array (n, 14)
            States, see state.py.
        energies, squares : array (n,)
            Energy (J) and L . L ((kg m^2/s)^2).
        stamps : sequence of int
            ns.
        wrench : Wrench
            Held at these ticks.
        """
        count = len(vectors)
        moments = np.zeros((count, MOMENT_SIZE))
        moments[:, VECTOR], moments[:, ENERGY], moments[:, SQUARE] = vectors, energies, squares
        for derive in self._derive:
            for moment in moments:
                derive(moment, wrench)
        words = np.empty((count, len(self._blank)))
        words[:] = self._blank
        _fill(moments, self._sources, self._targets, np.array(stamps, dtype=np.int64), self._seconds, words, words.view(np.uint32))
        data, size = words.tobytes(), words.itemsize * len(self._blank)
        return [[data[start + part.start:start + part.stop] for part in self._parts] for start in range(0, count * size, size)]


@compiled
def _fill(moments, sources, targets, stamps, seconds, words, halves):
    """Put the doubles of moments and the stamps (ns) into messages: `words`, of which `halves` are the same bytes by fours.

    Mostly it is one message: then a few calls of numpy would take longer than all the rest of it.
    """
    for k in range(len(moments)):
        for j in range(len(targets)):
            words[k, targets[j]] = moments[k, sources[j]]
        for j in range(len(seconds)):
            whole = stamps[k] // NANOSECONDS
            halves[k, seconds[j]] = whole
            halves[k, seconds[j] + 1] = stamps[k] - whole * NANOSECONDS


def _places(output, blank):
    """Return the offsets in a message of the doubles that change, and of its stamps."""
    doubles, stamps = [], []
    for path, code, offset, count in Layout(definitions.schema(output.type), output.type, blank).leaves:
        if code == 'd' and any(path == name or path.startswith((f'{name}.', f'{name}[')) for name in output.variable):
            doubles += range(offset, offset + 8 * count, 8)
        elif path in STAMPS:
            stamps.append(offset)
    return doubles, stamps


def _in_world(scene, frames):
    return {'header': {'frame_id': frames.world}}


def _in_body(scene, frames):
    return {'header': {'frame_id': frames.body}}


def _nothing(scene, frames):
    return {}


def _odometry(scene, frames):
    return {**_in_world(scene, frames), 'child_frame_id': frames.body}


def _velocity_in_body(scene):
    def derive(moment, wrench):
        moment[BODY_VELOCITY] = rotations.rotate_back(*moment[ORIENTATION], *moment[VELOCITY])
    return derive


def _proper_acceleration(scene):
    """Derive the proper acceleration a - g of the body's origin (REP 145), exact at the tick."""
    gravity, dynamics = scene.effect('gravity'), Dynamics(scene)
    friction = scene.effect('sliding_friction')
    g = np.array([0.0, 0.0, gravity.g if gravity else friction.g if friction else 0.0])

    def derive(moment, wrench):
        moment[ACCELERATION] = rotations.rotate_back(*moment[ORIENTATION], *(dynamics.balance(moment, wrench).acceleration + g))
    return derive


def _held(scene, frames):
    if scene.constraint.kind == 'free':
        raise BadInput('parameter publish', 'got reaction with constraint free', 'nothing holds a free body')
    return _in_world(scene, frames)


def _reaction(scene):
    """Derive force and torque of the constraint, about the fixed point, the point `through` of the hinge, or the point of contact."""
    dynamics = Dynamics(scene)

    def derive(moment, wrench):
        balance = dynamics.balance(moment, wrench)
        moment[REACTION] = *balance.force, *balance.torque
    return derive


def _joint(scene, frames):
    if scene.constraint.kind != 'hinge':
        raise BadInput('parameter publish', f'got joint_states with constraint {scene.constraint.kind!r}', 'only a hinge is a joint')
    return {**_in_world(scene, frames), 'name': [f'{frames.prefix}hinge'], 'position': [0.0], 'velocity': [0.0]}


def _hinge(scene):
    """Derive the hinge's angle as the scene file counts it; whole turns are kept as far as the sign of q keeps them, one either way."""
    axis = np.array(scene.constraint.axis)
    start = yaml.safe_load(scene.text)['initial'].get('angle', 0.0)
    x, y, z, w = scene.initial.orientation.tolist()

    def derive(moment, wrench):
        *turn, cosine = rotations.multiply(-x, -y, -z, w, *moment[ORIENTATION])
        moment[HINGE] = start + 2.0 * math.atan2(axis @ turn, cosine), axis @ moment[ANGULAR_VELOCITY]
    return derive


def _box(scene, frames):
    edges = box_of(scene.body)
    thinnest = 0.02 * max(edges)
    scale = dict(zip('xyz', (max(edge, thinnest) for edge in edges), strict=True))
    return {**_in_world(scene, frames), 'ns': frames.body, 'type': 1, 'scale': scale, 'color': {'r': 0.2, 'g': 0.5, 'b': 0.9, 'a': 1.0}}


def _box_pose(scene):
    center, axes = scene.body.center_of_mass, scene.body.about_center.axes

    def derive(moment, wrench):
        q = moment[ORIENTATION]
        moment[BOX] = *(moment[POSITION] + rotations.rotate(*q, *center)), *rotations.multiply(*q, *axes)
    return derive


def _transform(scene, frames):
    return {'transforms': [{**_in_world(scene, frames), 'child_frame_id': frames.body}]}


EVERY_TICK = (
    Output('pose', 'geometry_msgs/msg/PoseStamped', _in_world, ('pose',), (POSITION, ORIENTATION),
           lambda stamps, states, energies, momenta: {
               'header.stamp': stamps, 'pose.position': states.position, 'pose.orientation': states.orientation}),
    Output('angular_velocity', 'geometry_msgs/msg/Vector3Stamped', _in_body, ('vector',), (ANGULAR_VELOCITY,),
           lambda stamps, states, energies, momenta: {'header.stamp': stamps, 'vector': states.angular_velocity}),
    Output('energy', 'std_msgs/msg/Float64', _nothing, ('data',), (ENERGY,), lambda stamps, states, energies, momenta: {'data': energies}),
    Output('angular_momentum_squared', 'std_msgs/msg/Float64', _nothing, ('data',), (SQUARE,),
           lambda stamps, states, energies, momenta: {'data': momenta}),
)
ON_REQUEST = (
    Output('odom', 'nav_msgs/msg/Odometry', _odometry, ('pose.pose', 'twist.twist'), (POSITION, ORIENTATION, BODY_VELOCITY, ANGULAR_VELOCITY),
           derive=_velocity_in_body),
    Output('imu', 'sensor_msgs/msg/Imu', _in_body, ('orientation', 'angular_velocity', 'linear_acceleration'),
           (ORIENTATION, ANGULAR_VELOCITY, ACCELERATION), derive=_proper_acceleration),
    Output('joint_states', 'sensor_msgs/msg/JointState', _joint, ('position', 'velocity'), (HINGE,), derive=_hinge),
    Output('reaction', 'geometry_msgs/msg/WrenchStamped', _held, ('wrench',), (REACTION,), derive=_reaction),
    Output('marker', 'visualization_msgs/msg/Marker', _box, ('pose',), (BOX,), derive=_box_pose),
    Output('tf', 'tf2_msgs/msg/TFMessage', _transform, ('transforms[0].transform',), (POSITION, ORIENTATION), absolute=True),
    Output('clock', 'rosgraph_msgs/msg/Clock', _nothing, (), (), absolute=True),
)


def chosen(names):
    """Return the outputs of every tick and those among the others that are asked for, in the order of the table."""
    return [*EVERY_TICK, *(output for output in ON_REQUEST if output.name in names)]


OUTPUTS = {output.name: output for output in EVERY_TICK + ON_REQUEST}
