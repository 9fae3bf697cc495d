# SPDX-License-Identifier: Apache-2.0
"""Cost of the parts of a 1 kHz tick at each accuracy: physics, messages, wire, recording.

    .venv/bin/python bench/tick.py [--figure docs/images/tick.png] [--json]

Physics is Simulation.advance for one tick; messages are the bytes of the four topics; wire is
publishing them to one subscriber process (plain rclpy); recording is packing and writing them as
`simulate` does, per tick. Figures are CPU times of this process, medians of interleaved repeats.
"""

import argparse
import importlib
import json
import os
import pathlib
import statistics
import sys
import tempfile
import time

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import node as node_bench

from rigid_body_sim.messages.state_topics import EVERY_TICK, Frames
from rigid_body_sim.messages.tick_messages import TickMessages
from rigid_body_sim.recording.of_simulation import SimulationRecording
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.study.precision import suite

SCENES = {'racket (exact)': load_scene('tennis_racket'),
          'asymmetric top (stepped)': suite.problem('asymmetric_heavy_top').scene}
ACCURACIES = (1e-3, 1e-6, 1e-9, 1e-12)
TICKS, REPEATS = 2000, 7
PARTS = ('physics', 'messages', 'wire', 'recording')


def per_tick(act):
    """Return the CPU time of one tick, of which `act` does TICKS, s."""
    began = time.process_time()
    act()
    return (time.process_time() - began) / TICKS


def physics(simulation):
    """Advance tick by tick."""
    for _ in range(TICKS):
        simulation.advance()
    simulation.forget_past()
    simulation.events.clear()


def making(simulation):
    """Return a callable that makes the messages of TICKS ticks, one tick at a time."""
    ticking = TickMessages(EVERY_TICK, simulation.scene, Frames())
    vector, energy, square = (simulation.vector[np.newaxis].copy(), [simulation.energy],
                              [simulation.angular_momentum_squared])

    def make():
        for tick in range(TICKS):
            ticking.messages(vector, energy, square, [tick * 1_000_000])
    return make


def recording(simulation, folder):
    """Return a callable that records TICKS ticks in blocks, as a recorder takes them."""
    made = SimulationRecording(folder, 'simulate', simulation, {})
    states = simulation.states(simulation.time + np.arange(1, TICKS + 1) / simulation.rate)
    first = [1]

    def record():
        made.ticks(first[0], states)
        first[0] += TICKS
    return record


def wire(node, simulation):
    """Return a callable that publishes the messages of a tick TICKS times."""
    ticking = TickMessages(EVERY_TICK, simulation.scene, Frames())
    messages = ticking.messages(simulation.vector[np.newaxis], [1.0], [1.0], [0])[0]
    pairs = []
    for output, name, data in zip(EVERY_TICK, node_bench.TOPICS, messages, strict=True):
        package, _, kind = output.type.split('/')
        pairs.append((node.create_publisher(
            getattr(importlib.import_module(f'{package}.msg'), kind), name, 10).handle.publish_raw,
            data))

    def publish():
        for _ in range(TICKS):
            for send, data in pairs:
                send(data)
            time.sleep(2e-5)    # a short pause, as between ticks
    return publish


def measured():
    """Return {scene: {accuracy: {part: s}}}."""
    import rclpy
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    os.environ.setdefault('ROS_DOMAIN_ID', '97')
    rclpy.init(args=[])
    node, listener = (rclpy.create_node('tick'),
                      node_bench.spawn(node_bench.__file__, '--subscribe'))
    acts = {}
    with tempfile.TemporaryDirectory() as folder:
        for number, (label, scene) in enumerate(SCENES.items()):
            simulation = Simulation(scene)
            acts[label, 'messages'], acts[label, 'recording'] = (
                making(simulation), recording(simulation, f'{folder}/{number}'))
            for accuracy in ACCURACIES:
                one = Simulation(scene, accuracy=accuracy)
                acts[label, accuracy] = lambda one=one: physics(one)
        acts['wire'] = wire(node, simulation)
        while node.count_subscribers('pose') == 0:
            time.sleep(0.05)
        for act in acts.values():
            act()
        turns = [{key: per_tick(act) for key, act in acts.items()} for _ in range(REPEATS)]
    listener.terminate()
    listener.wait()
    node.destroy_node()
    rclpy.shutdown()
    median = {key: statistics.median(turn[key] for turn in turns) for key in acts}
    return {label: {accuracy: {
        'physics': median[label, accuracy], 'messages': median[label, 'messages'],
        'wire': median['wire'], 'recording': median[label, 'recording']}
        for accuracy in ACCURACIES} for label in SCENES}


def draw(found, path):
    """Write the figure: stacked bars, one for each accuracy."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    figure = Figure(figsize=(8.0, 3.2), dpi=100, layout='constrained')
    FigureCanvasAgg(figure)
    looks = zip(PARTS, ('#D55E00', '#E69F00', '#56B4E9', '#0072B2'), ('////', '', '..', ''),
                strict=True)
    looks = list(looks)
    for axes, (label, rows) in zip(
            figure.subplots(1, len(found), sharey=True), found.items(), strict=True):
        names = [f'{accuracy:.0e}' for accuracy in rows]
        bottom = np.zeros(len(rows))
        for part, colour, hatch in looks:
            values = np.array([row[part] for row in rows.values()]) * 1e6
            axes.bar(names, values, bottom=bottom, color=colour, hatch=hatch, edgecolor='white',
                     linewidth=0.5, label=part)
            bottom += values
        axes.set_title(label, fontsize=10, loc='left')
        axes.set_xlabel('accuracy asked for (rad)')
        axes.spines[['top', 'right']].set_visible(False)
    figure.axes[0].set_ylabel('CPU time of a tick (us)')
    figure.axes[-1].legend(loc='center left', bbox_to_anchor=(1.0, 0.5), frameon=False)
    figure.savefig(path, metadata={'Software': None})


def main():
    """Measure, print and draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--figure', metavar='FILE', help='draw the figure into this file')
    parser.add_argument('--json', action='store_true')
    options = parser.parse_args()
    found = measured()
    if options.figure:
        draw(found, options.figure)
    if options.json:
        print(json.dumps(found, indent=2))
        return
    print(f'{"us a tick":26}{"accuracy":>10}{"".join(f"{part:>11}" for part in PARTS)}'
          f'{"physics %":>11}')
    for label, rows in found.items():
        for accuracy, row in rows.items():
            share = 100.0 * row['physics'] / sum(row.values())
            print(f'{label:26}{accuracy:10.0e}'
                  f'{"".join(f"{row[part] * 1e6:11.2f}" for part in PARTS)}{share:11.1f}')


if __name__ == '__main__':
    main()
