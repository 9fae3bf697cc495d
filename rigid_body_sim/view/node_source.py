# SPDX-License-Identifier: Apache-2.0
"""A running node as a source: its topics are drawn, and the mouse publishes its commands.

The node sends the latest state at the rate of a display (node/display.py); for a node without
these topics, such as a replay, those of every tick are used. Subscriptions keep one message and
are best effort. Nothing is spun: the page's loop takes the latest message of each when it draws. A
held wrench is sent again at every snapshot; if the page is gone, the node's ``command_timeout``
releases it.
"""

import math
import re
import time

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseStamped, Vector3Stamped, WrenchStamped
from rcl_interfaces.srv import GetParameters
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions
from scipy.spatial.transform import Rotation
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool, Trigger

from rigid_body_sim.errors import BadInput
from rigid_body_sim.node import display
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import (
    ANGULAR_VELOCITY,
    ORIENTATION,
    POSITION,
    TIME,
    VELOCITY,
    State,
)
from rigid_body_sim.simulation.command_rows import (
    AXES,
    BODY,
    FORCE,
    IMPULSE,
    KIND,
    TORQUE,
    wrench_of,
)
from rigid_body_sim.view.snapshots import (
    LONGEST_GAP,
    UNKNOWN,
    Mechanics,
    Snapshot,
    trail_between,
)

APPEARS_WITHIN = 8.0
"""Longest time for the node to be discovered, s."""
GONE_AFTER = 2.0
"""Time without a state after which a page asks if the node is still there, s."""
DISPLAY_WITHIN = 1.0
"""Longest time for a node that publishes a scene to show its topics for pages, s."""
STATES = {'angular_velocity': Vector3Stamped, 'energy': Float64, 'pose': PoseStamped}
"""Topics of the state, in the order in which they are taken."""
NANOSECONDS = 1e9


class NodeSource:
    """A node as a source of snapshots.

    Parameters
    ----------
    name : str
        Full name of the node; its topics are those of its namespace.

    Raises
    ------
    BadInput
        Where no such node publishes a scene within APPEARS_WITHIN.
    """

    pushes, edits, plays, paces = True, False, False, False
    speed, tick, beside, preparing = 1.0, 0.0, None, ''

    def __init__(self, name):
        self._name = name if name.startswith('/') else f'/{name}'
        if not re.fullmatch(r'(/[A-Za-z_][A-Za-z0-9_]*)+', self._name):
            raise BadInput('--node', f'got {name!r}', 'the name of a node, such as /sim_node')
        self.generation, self.method, self.messages, self.expected = 0, 'a running node', [], {}
        self._residuals, self._wrench = {}, Wrench()
        self._start, self._last, self._shown, self._net = None, {}, None, None
        self._velocity, self._asked = np.zeros(3), False
        self._heard, self._gone = time.monotonic(), False
        # signals are the subcommand's: those of rclpy take its context away while it is in use
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        self._node = rclpy.create_node('rigid_body_sim_view')
        # another node, so that the answers of services can be awaited without taking states
        self._asking = rclpy.create_node('rigid_body_sim_view_requests')
        try:
            self._connect(self._name.rpartition('/')[0])
        except BaseException:
            self.close()
            raise

    def _connect(self, namespace):
        self._types, self._subscriptions = {}, {}
        latched = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        for topic, kind in (('scene', String), ('events', DiagnosticStatus)):
            self._subscribe(topic, kind, f'{namespace}/{topic}', latched)
        self._subscribe('diagnostics', DiagnosticArray, '/diagnostics', QoSProfile(depth=10))
        self._held = self._node.create_publisher(WrenchStamped, f'{namespace}/cmd_wrench', 10)
        self._struck = self._node.create_publisher(WrenchStamped, f'{namespace}/cmd_impulse', 10)
        self._clients = {
            'pause': self._asking.create_client(SetBool, f'{self._name}/pause'),
            'step': self._asking.create_client(Trigger, f'{self._name}/step'),
            'reset': self._asking.create_client(Trigger, f'{self._name}/reset'),
            'timeout': self._asking.create_client(GetParameters, f'{self._name}/get_parameters')}
        deadline = time.monotonic() + APPEARS_WITHIN
        while not self._take_scene():
            if time.monotonic() > deadline:
                raise BadInput('--node', f'nobody publishes {namespace}/scene',
                               f'the name of a running sim_node on this ROS_DOMAIN_ID, not '
                               f'{self._name}')
            time.sleep(0.05)
        self._subscribe_to_states(namespace)

    def _subscribe(self, name, kind, topic, profile):
        self._types[name] = kind
        self._subscriptions[name] = self._node.create_subscription(kind, topic, lambda _: None,
                                                                   profile)

    def _subscribe_to_states(self, namespace):
        """Subscribe to the node's topics for pages, or else to those of every tick."""
        shown = {name: display.topic_of(name).replace('~', self._name) for name in STATES}
        deadline = time.monotonic() + DISPLAY_WITHIN
        while not all(map(self._node.count_publishers, shown.values())):
            if time.monotonic() > deadline:
                shown = {name: f'{namespace}/{name}' for name in STATES}
                break
            time.sleep(0.05)
        for name, topic in shown.items():
            self._subscribe(name, STATES[name], topic, display.PROFILE)

    def _take(self, topic):
        """Yield the messages that wait on a topic."""
        handle = self._subscriptions[topic].handle
        while (taken := handle.take_message(self._types[topic], False)) is not None:
            yield taken[0]

    def _take_scene(self):
        texts = [message.data for message in self._take('scene')]
        if texts:
            self.scene = parse_scene(texts[-1], where=f'{self._name}: scene')
            self.generation += 1
            self._shown, self._velocity = None, np.zeros(3)
            self._middle = np.array(self.scene.body.center_of_mass)
            # the topics for pages have no velocities
            self._net = UNKNOWN if Mechanics(self.scene).need_velocity() else None
        return bool(texts)

    wait = staticmethod(time.sleep)

    def poll(self):
        """Return the newest Snapshot, if there is a new one."""
        rclpy.spin_once(self._asking, timeout_sec=0.0)
        self._take_scene()
        for message in self._take('diagnostics'):
            self._diagnose(message)
        fresh = False
        for topic in STATES:
            for message in self._take(topic):
                self._last[topic], fresh = message, True
        self._miss(fresh)
        if not fresh or not {'pose', 'angular_velocity'} <= self._last.keys():
            return []
        return [self._snapshot()]

    def _miss(self, fresh):
        """Say once that the node is gone, where nothing of it has come for a while."""
        now = time.monotonic()
        if fresh:
            self._heard, self._gone = now, False
        elif not self._gone and now - self._heard > GONE_AFTER:
            topic = self._subscriptions['scene'].topic_name
            self._gone = not self._node.count_publishers(topic)
            if self._gone:
                self.messages.append(f'{self._name} is gone, and its last state is shown; the '
                                     'terminal that it ran in says why')

    def _snapshot(self):
        pose, turning = self._last['pose'], self._last['angular_velocity'].vector
        stamp = pose.header.stamp.sec + pose.header.stamp.nanosec / NANOSECONDS
        self._start = stamp if self._start is None else self._start
        at, q = pose.pose.position, pose.pose.orientation
        vector = State.of(stamp - self._start, (q.x, q.y, q.z, q.w),
                          (turning.x, turning.y, turning.z), (at.x, at.y, at.z)).vector
        events = tuple((stamp - self._start, message.message or message.name)
                       for message in self._take('events'))
        energy = self._last['energy'].data if 'energy' in self._last else math.nan
        self._add_velocity(vector)
        trail = vector[np.newaxis] if self._shown is None else trail_between(self._shown, vector)
        self._shown = vector
        return Snapshot(stamp - self._start, vector, trail, self._wrench, energy,
                     self._residuals.get('energy_residual', math.nan),
                     self._residuals.get('momentum_residual', math.nan), events, net=self._net)

    def _add_velocity(self, vector):
        """Fill in the velocity of a state, which no topic has, by the centre's last two moves.

        It damps a pull. The smaller of the two differences is taken, since a reset is no motion.
        """
        turn = Rotation.from_quat(vector[ORIENTATION])
        lever = turn.apply(self._middle)
        before = self._shown
        elapsed = 0.0 if before is None else vector[TIME] - before[TIME]
        found = self._velocity
        if 0.0 < elapsed < LONGEST_GAP:
            was = before[POSITION] + Rotation.from_quat(before[ORIENTATION]).apply(self._middle)
            now = (vector[POSITION] + lever - was) / elapsed
            found = min(now, self._velocity, key=np.linalg.norm)
            self._velocity = now
        vector[VELOCITY] = found - np.cross(turn.apply(vector[ANGULAR_VELOCITY]), lever)

    def _diagnose(self, message):
        for status in message.status:
            if status.name == f'{self._name.lstrip("/")}: ledger':
                self._residuals = {value.key: float(value.value) for value in status.values
                                   if value.key.endswith('_residual')}

    def command(self, rows):
        """Publish rows of commands (simulation.command_rows)."""
        for row in rows:
            message = WrenchStamped()
            if row[AXES] == BODY:
                # the frame of the angular velocity is the body's
                message.header.frame_id = self._last['angular_velocity'].header.frame_id
            force, torque = message.wrench.force, message.wrench.torque
            force.x, force.y, force.z = row[FORCE].tolist()
            torque.x, torque.y, torque.z = row[TORQUE].tolist()
            if row[KIND] == IMPULSE:
                self._struck.publish(message)
            else:
                self._ask_for_timeout()
                # a release is a wrench of zero
                self._held.publish(message)
                self._wrench = wrench_of(row)

    def _ask_for_timeout(self):
        """Warn once, at the first pull, if the node would hold it when this process has ended."""
        if self._asked or not self._clients['timeout'].service_is_ready():
            return
        self._asked = True

        def answered(future):
            [value] = future.result().values
            if value.double_value == 0.0:
                self.messages.append(
                    f'{self._name} holds a pull until it is replaced, even if this page is '
                    f'killed: "ros2 param set {self._name} command_timeout 0.5" ends it then')
        request = GetParameters.Request(names=['command_timeout'])
        self._clients['timeout'].call_async(request).add_done_callback(answered)

    def tell(self, name, value=None):
        """Call a service of the node: ``pause`` with a bool, ``step`` or ``reset``."""
        client = self._clients[name]
        if not client.service_is_ready():
            self.messages.append(f'{self._name} has no service {name}')
            return
        request = SetBool.Request(data=value) if name == 'pause' else Trigger.Request()
        client.call_async(request).add_done_callback(
            lambda future: None if future.result().success
            else self.messages.append(f'{name}: {future.result().message}'))

    def close(self):
        """Leave ROS."""
        self._node.destroy_node()
        self._asking.destroy_node()
        rclpy.try_shutdown()
