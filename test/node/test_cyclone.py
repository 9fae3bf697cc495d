# SPDX-License-Identifier: Apache-2.0
# ruff: noqa: D101 - the types are what their names say
"""A client of another vendor, Eclipse Cyclone DDS, hears the node and commands it.

Its types are written out by hand.
"""

import time
from dataclasses import dataclass

import numpy as np
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64, int32, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from near import near

CONFIGURATION = """<CycloneDDS><Domain><General>
<Interfaces><NetworkInterface name="lo"/></Interfaces><AllowMulticast>false</AllowMulticast>
</General><Discovery><ParticipantIndex>auto</ParticipantIndex>
<Peers><Peer address="127.0.0.1"/></Peers></Discovery></Domain></CycloneDDS>"""


@dataclass
class Time(IdlStruct, typename='builtin_interfaces::msg::dds_::Time_'):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct, typename='std_msgs::msg::dds_::Header_'):
    stamp: Time
    frame_id: str


@dataclass
class Vector3(IdlStruct, typename='geometry_msgs::msg::dds_::Vector3_'):
    x: float64
    y: float64
    z: float64


@dataclass
class Vector3Stamped(IdlStruct, typename='geometry_msgs::msg::dds_::Vector3Stamped_'):
    header: Header
    vector: Vector3


@dataclass
class Wrench(IdlStruct, typename='geometry_msgs::msg::dds_::Wrench_'):
    force: Vector3
    torque: Vector3


@dataclass
class WrenchStamped(IdlStruct, typename='geometry_msgs::msg::dds_::WrenchStamped_'):
    header: Header
    wrench: Wrench


SPHERE_MOMENT = 0.004
RELIABLE = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(1000))


def until(condition, what):
    deadline = time.monotonic() + 20.0
    while not (result := condition()):
        assert time.monotonic() < deadline, f'waited 20 s for {what}'
        time.sleep(0.02)
    return result


def test_cyclone_client_hears_the_node_and_commands_it(run_node):
    with run_node('-p', 'scene:=sphere', '-p', 'rate:=200', '-p', 'record:=false') as node:
        _domain = Domain(node.domain.id, CONFIGURATION)
        participant = DomainParticipant(node.domain.id)
        reader = DataReader(
            participant, Topic(participant, 'rt/angular_velocity', Vector3Stamped), RELIABLE)
        writer = DataWriter(
            participant, Topic(participant, 'rt/cmd_impulse', WrenchStamped), RELIABLE)
        heard = []

        def more():
            heard.extend(reader.take(1000))
            return len(heard)
        until(lambda: more() > 50, 'fifty angular velocities')
        assert {sample.header.frame_id for sample in heard} == {'body'}
        until(writer.get_matched_subscriptions, 'the subscription of the node')
        zero = Vector3(0.0, 0.0, 0.0)
        writer.write(WrenchStamped(
            Header(Time(0, 0), 'body'), Wrench(zero, Vector3(0.0, 0.0, 0.25))))
        before = len(heard)
        until(lambda: more() > before + 100, 'the impulse')
        omega = np.array([(sample.vector.x, sample.vector.y, sample.vector.z) for sample in heard])
        stamps = np.array([sample.header.stamp.sec * 10**9 + sample.header.stamp.nanosec
                           for sample in heard])
        assert set(np.diff(stamps)) == {5_000_000}
        steps = np.diff(omega, axis=0)
        [k] = np.flatnonzero(np.abs(steps).max(axis=1) > 1e-9)
        moment = 0.25 / steps[k, 2]
        assert moment == near(SPHERE_MOMENT, rel=1e-14)
        # two momenta of size 10 (kg m^2/s), each turned to the world: an entry of the matrix is a
        # sum of products of rounded components, a component of the momentum a sum of three of
        # them, 12 roundings of each; measured up to 3.7e-14, at a tick that differs between runs
        assert np.abs(steps[k, :2]).max() < 24 * np.finfo(float).eps * 10.0
