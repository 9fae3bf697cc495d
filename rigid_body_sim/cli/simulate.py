# SPDX-License-Identifier: Apache-2.0
"""The subcommand `simulate`: run a scene to a recording as fast as it goes, without ROS.

The recording is the one that the node would write.
"""

import collections
import contextlib
import signal
import sys
import time

import numpy as np
from tqdm import tqdm

from rigid_body_sim import command_line
from rigid_body_sim.choice.choice import HORIZON
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.messages import state_topics
from rigid_body_sim.messages.timeline import Timeline
from rigid_body_sim.recording import about, compression
from rigid_body_sim.recording.of_simulation import SimulationRecording
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.scene.state import States
from rigid_body_sim.simulation.simulation import Simulation

BLOCK = 4096
"""Ticks that are computed, packed and written at once."""
LONGEST = 10**9
"""Most ticks of a run: more would fill any disk."""
PARTS = ('orientation', 'angular_velocity', 'position', 'velocity')


class Asked(list):
    """Numbers of the signals that asked to end, in their order.

    They end nothing by themselves: the caller finishes its work and then looks here. Only within
    `at_once` a signal raises KeyboardInterrupt.
    """

    def __init__(self):
        super().__init__()
        self._at_once = False

    def hear(self, number, _):
        """Take a signal, as its handler."""
        self.append(number)
        if self._at_once:
            raise KeyboardInterrupt

    @contextlib.contextmanager
    def at_once(self):
        """Let a signal end what runs within."""
        self._at_once = True
        try:
            yield
        finally:
            self._at_once = False


@contextlib.contextmanager
def interruptible():
    """Yield an Asked, which hears SIGINT, SIGTERM and SIGHUP."""
    asked = Asked()
    numbers = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
    before = {number: signal.signal(number, asked.hear)
              for number in numbers if signal.getsignal(number) != signal.SIG_IGN}
    try:
        yield asked
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def simulate(simulation, ticks, recording=None, stop=None, progress=None):
    """Run a simulation from tick 0 to `ticks`; return how often each event occurred, by name.

    Parameters
    ----------
    simulation : Simulation
        A new one, at tick 0.
    ticks : int
    recording : SimulationRecording, optional
        Gets the states at all ticks, the first one included.
    stop : Asked, optional
        The run ends early when it is not empty any more; a tick that takes long is given up.
    progress : callable, optional
        Called with the number of ticks done.

    Raises
    ------
    NotConverged
        Where the run ends early; all before is in the recording.
    """
    counts = collections.Counter()
    if recording:
        recording.ticks(0, States(simulation.vector[np.newaxis].copy()))
    while simulation.tick < ticks and not stop:
        first, count = simulation.tick + 1, min(BLOCK, ticks - simulation.tick)
        try:
            with contextlib.nullcontext() if stop is None else stop.at_once():
                if recording:
                    states = simulation.advance_through(count)
                else:
                    simulation.advance(count)
        except KeyboardInterrupt:
            if not stop:
                raise
            break
        except NotConverged:
            if recording:
                recording.note(simulation.events)
            raise
        if recording:
            recording.note(simulation.events)
            recording.ticks(first, states)
        counts.update(event.name for event in simulation.events)
        simulation.events.clear()
        simulation.forget_past()
        if progress:
            progress(simulation.tick + 1 - first)
    return counts


def main(arguments=None):
    """Run the subcommand; return the exit status."""
    parser = command_line.parser(
        'simulate',
        'Run a scene to a recording as fast as it goes; without --output, to its last state only.',
        'python -m rigid_body_sim simulate --scene tennis_racket --duration 100 '
        '--output recordings/racket --json')
    add = parser.add_argument
    add('--scene', default='tennis_racket',
        help='name of a scene that ships, or a .yaml file (default: tennis_racket)')
    add('--duration', type=float, default=20.0, help='simulated seconds (20)')
    add('--rate', type=float, default=1000.0, help='ticks per simulated second (1000)')
    add('--integrator', default='auto',
        help='method (auto: exact if there is one, else the cheapest that meets --accuracy)')
    add('--accuracy', type=float, default=1e-12,
        help='error of the attitude that is asked for, rad (1e-12)')
    add('--step', type=float, metavar='SECONDS',
        help='fixed step of the method, instead of steps that meet --accuracy')
    add('--set', action='append', default=[], metavar='KEY=VALUE',
        help='change of the scene, key.path=value; may be repeated')
    add('--output', metavar='FOLDER', help='recording to make; it must not exist yet')
    names = [output.name for output in state_topics.ON_REQUEST]
    add('--publish', nargs='+', default=[], metavar='TOPIC', choices=names,
        help=f'topics to record beside those of every tick: {", ".join(names)}')
    add('--compression', choices=compression.NAMES, default=compression.DEFAULT,
        help=f'of chunks ({compression.DEFAULT})')
    add('--split-bytes', type=float, default=0.0, metavar='BYTES',
        help='a new file begins after so many bytes (4 GB)')
    add('--split-seconds', type=float, default=0.0, metavar='SECONDS',
        help='a new file begins after so much simulated time')
    add('--json', action='store_true',
        help='print final state, ledger, method and cost, with 17 digits')
    return command_line.run(_run, parser.parse_args(arguments))


def _run(options):
    # shown at once, since choosing and compiling a method may take seconds
    with tqdm(desc='setting up', unit=' ticks', unit_scale=True, disable=None,
              leave=False) as bar:
        return _simulate(options, bar)


def _check_duration(options):
    if not (options.duration >= 0.0 and not options.duration * options.rate > LONGEST):
        raise BadInput('--duration', f'got {options.duration!r}',
                       f'seconds, not negative, at most {LONGEST / options.rate:g} at this rate')


def _warn(simulation):
    """Print the notes of the scene, and a line if the accuracy is missed."""
    for line in simulation.scene.notes:
        print(f'{simulation.scene.name}: {line}', file=sys.stderr)
    if simulation.missed:
        print(f'{simulation.scene.name}: {simulation.missed}', file=sys.stderr)


def _simulate(options, bar):
    began = time.perf_counter()
    scene = load_scene(options.scene, options.set)
    _check_duration(options)
    simulation = Simulation(scene, options.integrator, options.accuracy, options.rate,
                            options.step, horizon=options.duration or HORIZON)
    ticks = Timeline(0, simulation.rate).ticks_in(options.duration)
    with interruptible() as asked:
        recording = SimulationRecording(
            options.output, 'simulate', simulation, _parameters(options), options.publish,
            **_writing(options)) if options.output else None
        prepared = time.perf_counter()
        bar.set_description(simulation.scene.name)
        bar.reset(ticks)
        try:
            with contextlib.closing(recording) if recording else contextlib.nullcontext():
                events = simulate(simulation, ticks, recording, asked, bar.update)
                bar.set_description('finishing')
        except OSError as error:
            print(f'{options.output}: the disk refuses ({error.strerror}) at t = '
                  f'{simulation.time:.9g} s; make room and run "recover {options.output}": '
                  'it keeps all up to there', file=sys.stderr)
            return command_line.CHECK_FAILED
    finished = time.perf_counter()
    bar.close()
    cost = {'set_up': prepared - began, 'run': finished - prepared, 'ticks': simulation.tick,
            'messages': recording.messages if recording else 0}
    _warn(simulation)
    result = {'state': _plain(simulation.state), 'ledger': simulation.ledger(),
              'method': about.run_of(simulation), 'events': dict(events), 'cost': cost}
    if options.json:
        command_line.print_json(result)
    else:
        _tell(result, simulation.scene, options.output)
    if asked:
        whole = f'; {options.output} is whole up to there' if recording else ''
        print(f'interrupted at t = {simulation.time:.9g} s{whole}', file=sys.stderr)
        return command_line.SIGNALLED + asked[0]
    return command_line.GOOD


def _parameters(options):
    """Return the settings by the names of the node's parameters."""
    return {'scene': options.scene, 'scene_overrides': options.set, 'rate': options.rate,
            'integrator': options.integrator, 'accuracy': options.accuracy,
            'step': options.step, 'duration': options.duration, 'publish': options.publish}


def _writing(options):
    """Return the settings of the Writer; raise BadInput if they contradict each other."""
    for name in ('split_bytes', 'split_seconds'):
        if not 0.0 <= getattr(options, name) <= LONGEST * 4.0:
            raise BadInput(f'--{name.replace("_", "-")}', f'got {getattr(options, name):g}',
                           f'a number from 0 to {LONGEST * 4.0:g}')
    return {'compression_name': options.compression, 'split_bytes': options.split_bytes,
            'split_seconds': options.split_seconds}


def _plain(state):
    return {'time': state.time, **{name: getattr(state, name).tolist() for name in PARTS}}


def _tell(result, scene, output):
    """Print a summary of the run."""
    state, ledger, cost = result['state'], result['ledger'], result['cost']
    print(f'{scene.name} by {result["method"]["method"]}: {cost["ticks"]} ticks, '
          f't = {state["time"]!r} s, in {cost["run"]:.3f} s')
    for name in PARTS:
        print(f'  {name:17}{", ".join(map(repr, state[name]))}')
    events = ''.join(f', {count} x {name}' for name, count in sorted(result['events'].items()))
    print(f'  energy residual {ledger["energy_residual"]:.2e}, '
          f'angular momentum residual {ledger["momentum_residual"]:.2e}{events}')
    if output:
        per_second = cost['messages'] / cost['run']
        print(f'  {cost["messages"]} messages, {per_second:.0f} a second: {output}')


if __name__ == '__main__':
    sys.exit(main())
