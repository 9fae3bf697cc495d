# SPDX-License-Identifier: Apache-2.0
"""Recordings made to measure, without a node: known commands, lateness and losses."""

import numpy as np
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as ForeignWriter
from rosbags.typesys import Stores, get_typestore

from rigid_body_sim.messages.state_topics import EVERY_TICK, Frames
from rigid_body_sim.messages.tick_messages import TickMessages
from rigid_body_sim.messages.timeline import Timeline
from rigid_body_sim.recording import about
from rigid_body_sim.recording.topics import Topic, journal_message, journal_topic
from rigid_body_sim.recording.writer import Writer
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.scene.state import States
from rigid_body_sim.simulation.simulation import Simulation

START = 1_795_000_000_000_000_000


def record(path, scene='tennis_racket', ticks=1000, rate=1000.0, acts=None, late=None, left_out=(),
           namespace='', bodies=None):
    """Record a run as the node would and return its Simulation at the end.

    `acts`: tick -> list of (topic, force, torque, frame), or ``('reset',)``. `late`: ns, of each
    tick. `left_out`: a range of ticks that the recorder drops. `bodies`: further namespaces that
    get the same messages.
    """
    simulation = Simulation(scene if not isinstance(scene, str) else load_scene(scene), rate=rate)
    spaces = [namespace, *(bodies or ())]
    messages = TickMessages(EVERY_TICK, simulation.scene, Frames())
    ticking = [(Topic(f'{space}/{output.name}', output.type), size) for space in spaces
               for output, size in zip(EVERY_TICK, messages.sizes, strict=True)]
    others = [Topic(f'{space}/{name}', kind, depth, durability='transient_local')
              for space in spaces
              for name, kind, depth in (
                  ('events', about.STATUS_TYPE, 100), ('scene', about.STRING_TYPE, 1))]
    line = Timeline(START, rate)
    parameters = {'rate': rate, 'real_time_factor': 1.0}
    journal = journal_topic(namespace)
    with Writer(path, ticking, others, journal,
                about.about('sim_node', simulation, parameters)) as writer:
        def note(kind, when, **values):
            writer.message(journal.name, when, when, journal_message(kind, **values))

        for space in spaces:
            writer.message(f'{space}/scene', START, START, about.scene_message(simulation.scene))
        for tick in range(ticks + 1):
            stamp = line.instant(tick)
            if tick:
                simulation.advance()
            _act(simulation, (acts or {}).get(tick, ()), tick, stamp, note)
            for event in simulation.events:
                message, values = about.event_text(event)
                writer.message(
                    f'{namespace}/events', stamp, stamp,
                    about.event_message('sim_node', about.OK, event.name, message, values))
            simulation.events.clear()
            if tick in left_out:
                if tick == left_out[-1]:
                    note('gap', line.instant(left_out[0] - 1), ticks=len(left_out),
                         after=line.instant(left_out[0] - 1), until=stamp)
                continue
            states = States(simulation.vector[np.newaxis].copy())
            rows = messages.columns(states.vector, *simulation.diagnose(states), [stamp])
            writer.ticks(tick, [stamp], [stamp + (int(late[tick]) if late is not None else 0)],
                         rows * len(spaces))
            if writer.state_wanted:
                writer.state_wanted = False
                note('state', stamp, **about.state_entry(tick, stamp, simulation))
    return simulation


def _act(simulation, acts, tick, stamp, note):
    commands = []
    for what, *values in acts:
        if what == 'reset':
            simulation.reset()
            note('reset', stamp, tick=tick)
            continue
        force, torque, frame = values
        (simulation.impulse if what == 'cmd_impulse' else simulation.hold)(force, torque, frame)
        commands.append({'topic': what, 'frame': frame, 'force': force, 'torque': torque})
    if commands:
        note('commands', stamp, tick=tick, commands=commands)


def record_foreign(path, simulation, ticks, period, with_scene=True, seed=5):
    """Record pose, angular velocity, energy and L^2 as ``ros2 bag record`` would, by rosbags.

    Log times are times of arrival; they are returned.
    """
    store = get_typestore(Stores.ROS2_JAZZY)
    names = {'Time': 'builtin_interfaces/msg/Time', 'Header': 'std_msgs/msg/Header',
             'Float64': 'std_msgs/msg/Float64', 'String': 'std_msgs/msg/String',
             **{name: f'geometry_msgs/msg/{name}'
                for name in (
                    'Point', 'Pose', 'PoseStamped', 'Quaternion', 'Vector3', 'Vector3Stamped')}}
    make = {name: store.types[full] for name, full in names.items()}
    states = simulation.states(np.arange(ticks) * period)
    energies, momenta = simulation.diagnose(states)
    random = np.random.default_rng(seed)
    with ForeignWriter(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        topics = {name: writer.add_connection(f'/lab/{name}', names[kind], typestore=store)
                  for name, kind in (('pose', 'PoseStamped'),
                                     ('angular_velocity', 'Vector3Stamped'), ('energy', 'Float64'),
                                     ('angular_momentum_squared', 'Float64'), ('scene', 'String'))}

        def write(name, message, when):
            writer.write(topics[name], when, store.serialize_cdr(message, message.__msgtype__))

        if with_scene:
            write('scene', make['String'](simulation.scene.text), START)
        for k in range(ticks):
            stamp = START + round(k * period * 1e9)
            header = make['Header'](make['Time'](*divmod(stamp, 10**9)), 'world')
            q, w, p = states.orientation[k], states.angular_velocity[k], states.position[k]
            arrived = stamp + np.cumsum(random.integers(20_000, 90_000, 4))
            write('pose',
                  make['PoseStamped'](
                      header, make['Pose'](make['Point'](*p), make['Quaternion'](*q))),
                  int(arrived[0]))
            write('angular_velocity', make['Vector3Stamped'](header, make['Vector3'](*w)),
                  int(arrived[1]))
            write('energy', make['Float64'](energies[k]), int(arrived[2]))
            write('angular_momentum_squared', make['Float64'](momenta[k]), int(arrived[3]))
    return states
