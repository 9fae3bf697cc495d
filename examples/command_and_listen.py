# SPDX-License-Identifier: Apache-2.0
"""Listen to a running sim_node, give the body an impulse, and see what the impulse changed.

In one shell run the node, in another this file::

    ros2 run rigid_body_sim sim_node --ros-args -p scene:=tennis_racket
    python3 examples/command_and_listen.py --torque 0.0 0.0 0.5
"""

import argparse
import sys
import time

import rclpy
from geometry_msgs.msg import PoseStamped, Vector3Stamped, WrenchStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class Listener(Node):
    """Keeps the latest messages of a simulated body, and sends it impulses."""

    def __init__(self):
        super().__init__('command_and_listen')
        self.pose = self.angular_velocity = self.energy = None
        self.create_subscription(PoseStamped, 'pose', self.on_pose, 10)
        self.create_subscription(Vector3Stamped, 'angular_velocity', self.on_velocity, 10)
        self.create_subscription(Float64, 'energy', self.on_energy, 10)
        self.impulses = self.create_publisher(WrenchStamped, 'cmd_impulse', 10)

    def on_pose(self, message):
        """Keep the pose of the body's origin in the world."""
        self.pose = message

    def on_velocity(self, message):
        """Keep the angular velocity, whose components are along the body's axes."""
        self.angular_velocity = message

    def on_energy(self, message):
        """Keep the energy, J."""
        self.energy = message.data

    @property
    def complete(self):
        """Whether a message of each topic has come."""
        return None not in (self.pose, self.angular_velocity, self.energy)

    def wait_for(self, condition, seconds):
        """Spin until a condition holds; return whether it did within the time (s)."""
        deadline = time.monotonic() + seconds
        while not condition() and time.monotonic() < deadline:
            rclpy.spin_once(self, timeout_sec=0.1)
        return condition()

    def strike(self, torque):
        """Send an angular impulse (N m s) along the world's axes; it acts once, at a tick."""
        impulse = WrenchStamped()
        # the header's frame_id may name the body's frame; empty means the world
        impulse.wrench.torque.x, impulse.wrench.torque.y, impulse.wrench.torque.z = torque
        self.impulses.publish(impulse)

    def show(self, when):
        """Print the latest messages."""
        q, omega = self.pose.pose.orientation, self.angular_velocity.vector
        stamp = self.pose.header.stamp
        print(f'{when} (stamp {stamp.sec}.{stamp.nanosec:09d})')
        print(f'  orientation       {q.x:+.6f} {q.y:+.6f} {q.z:+.6f} {q.w:+.6f}')
        print(f'  angular velocity  {omega.x:+.6f} {omega.y:+.6f} {omega.z:+.6f} rad/s')
        print(f'  energy            {self.energy:.9f} J')


def listen_and_strike(node, torque, patience):
    """Show the body before and after an impulse; return the exit status."""
    if not node.wait_for(lambda: node.complete, patience):
        print(f'no body is heard after {patience:g} s: is sim_node running in this domain and '
              'namespace?', file=sys.stderr)
        return 1
    if not node.wait_for(node.impulses.get_subscription_count, patience):
        print('nobody listens to cmd_impulse', file=sys.stderr)
        return 1
    node.show('before')
    before = node.energy
    node.strike(torque)
    # without a torque or dissipation in the scene, only a command changes the energy
    if not node.wait_for(lambda: abs(node.energy - before) > 1e-9 * abs(before), patience):
        print('the impulse changed nothing: see the topic /events', file=sys.stderr)
        return 1
    node.wait_for(lambda: False, 0.2)
    node.show('after the impulse')
    return 0


def main():
    """Run the example; return the exit status."""
    parser = argparse.ArgumentParser(description='Listen to a running sim_node and strike it.')
    parser.add_argument('--torque', nargs=3, type=float, default=[0.0, 0.0, 0.5],
                        metavar=('X', 'Y', 'Z'), help='angular impulse in the world, N m s')
    parser.add_argument('--patience', type=float, default=10.0, help='how long to wait, s (10)')
    arguments, ros_arguments = parser.parse_known_args()
    rclpy.init(args=['', *ros_arguments])
    node = Listener()
    try:
        return listen_and_strike(node, arguments.torque, arguments.patience)
    except (KeyboardInterrupt, ExternalShutdownException):
        return 130
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    sys.exit(main())
