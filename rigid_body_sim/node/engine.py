# SPDX-License-Identifier: Apache-2.0
"""The engine: all parts of a running node, made from its parameters.

The plain node and the managed node are two ways to start it.
"""

import concurrent.futures

from std_srvs.srv import SetBool, Trigger

from rigid_body_sim.choice.choice import HORIZON
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.messages import robot_description, state_topics
from rigid_body_sim.node.commands import Commands
from rigid_body_sim.node.diagnostics import Diagnostics
from rigid_body_sim.node.followed_clock import Followed
from rigid_body_sim.node.journal import open_journal
from rigid_body_sim.node.publishing import Publishing, frames_of
from rigid_body_sim.node.rehearsal import rehearse
from rigid_body_sim.node.status_line import StatusLine
from rigid_body_sim.realtime.priority import quicken
from rigid_body_sim.realtime.session import Session
from rigid_body_sim.realtime.shutdown import say, tell
from rigid_body_sim.realtime.ticking import Steady, Ticker
from rigid_body_sim.recording.about import SIMULATION_PARAMETERS
from rigid_body_sim.recording.needed import need_mcap
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation

ANSWER_WITHIN = 0.2
"""Longest time that a service waits for the tick that does what it asks, s.

Afterwards it answers with what will happen.
"""
STOP_WITHIN = 0.4


class Engine:
    """Scene, topics, services, recording and tick thread of one node.

    Parameters
    ----------
    node : rclpy.node.Node
    settings : parameters.Settings
    at_end : callable
        Called in the tick thread at its end: when the duration is over, or after a failure.

    Raises
    ------
    BadInput
        Before anything runs.
    """

    def __init__(self, node, settings, at_end):
        if 'clock' in settings.publish and settings.use_sim_time:
            raise BadInput(
                'parameter publish',
                'got clock together with use_sim_time',
                'a node cannot follow the /clock that it publishes',
            )
        if settings.record:
            need_mcap()     # checked before kernels are compiled for a run that could not begin
        self._node, self._settings = node, settings
        self._entities_before, self.commands = set(_entities(node)), None
        try:
            self._set_up(node, settings, at_end)
        except BaseException:
            # a managed node may be configured again
            self.remove()
            raise

    def _set_up(self, node, settings, at_end):
        simulation = self._prepare({})
        for line in simulation.scene.notes:
            node.get_logger().info(line)
        if simulation.missed:
            node.get_logger().warning(f'{simulation.scene.name}: {simulation.missed}')
        frames = frames_of(node, settings)
        outputs = state_topics.chosen(settings.publish)
        messages = state_topics.scene_messages(outputs, simulation.scene, frames)
        # done before anything is advertised: whoever finds the topics finds them alive
        rehearse(simulation, messages)
        self.commands = Commands(node, frames)
        described = robot_description.TOPIC in settings.publish
        self.publishing = Publishing(node, outputs, frames, messages, described)
        settings.refuse_unknown_qos()
        self.journal = open_journal(node, settings, simulation, self.publishing, frames)
        self.session = Session(
            simulation, self.commands, self.publishing, self.journal, settings, self._epoch
        )
        self._source = Followed(node.get_clock()) if settings.use_sim_time else Steady()
        self.ticker = Ticker(
            self.session,
            self._source,
            settings.rate,
            settings.real_time_factor,
            settings.overrun == 'skip_publish',
            at_end,
        )
        self.diagnostics = Diagnostics(
            node, settings, self.session, self.ticker, self.commands, self.journal
        )
        node.create_service(Trigger, '~/reset', self._reset)
        node.create_service(SetBool, '~/pause', self._pause)
        node.create_service(Trigger, '~/step', self._step)
        self._status_line = StatusLine(node, self)
        self._prepared = None
        settings.on_change(self._before_change, self._after_change)

    def start(self):
        """Start ticking."""
        quicken()
        self.ticker.start()

    def _epoch(self):
        """Return the stamp of tick 0, ns."""
        return (
            0
            if self._settings.stamp_origin == 'zero'
            else self._node.get_clock().now().nanoseconds
        )

    def _prepare(self, changes):
        """Return the simulation that the parameters, with changes, describe.

        This may take a while, so it is done before the tick that needs it.
        """
        wanted = {name: changes.get(name, self._settings[name]) for name in SIMULATION_PARAMETERS}
        scene = load_scene(wanted['scene'], wanted['scene_overrides'])
        return Simulation(
            scene,
            wanted['integrator'],
            wanted['accuracy'],
            wanted['rate'],
            wanted['step'] or None,
            horizon=self._settings.duration or HORIZON,
        )

    # -- services

    def _reset(self, _, response):
        future = self.session.request(Session.reset)
        tick = _result_soon(future)
        response.success = True
        response.message = (
            f'the state went back at tick {tick}'
            if tick is not None
            else 'the state goes back at the next tick'
            + (': resume or step' if self.ticker.paused else '')
        )
        return response

    def _pause(self, request, response):
        if request.data:
            self.ticker.pause()
        else:
            self.ticker.resume()
        response.success, response.message = True, 'paused' if request.data else 'running'
        return response

    def _step(self, _, response):
        if not self.ticker.paused:
            response.success, response.message = (
                False,
                'the node is running: a step is for a paused one; '
                'call ~/pause with data: true first',
            )
            return response
        tick = _result_soon(self.ticker.step())
        response.success, response.message = (
            True,
            f'tick {tick}' if tick is not None else 'the tick has not been run yet',
        )
        return response

    # -- parameters

    def _before_change(self, changes):
        """Refuse impossible changes; prepare what takes long."""
        self._prepared = None
        if SIMULATION_PARAMETERS & set(changes):
            simulation = self._prepare(changes)
            messages = self.publishing.messages_for(simulation.scene)
            rehearse(simulation, messages)
            self._prepared = simulation, messages

    def _after_change(self, changes):
        """Apply the changes at a tick, where they are recorded."""
        if not changes:
            return
        prepared, self._prepared = self._prepared, None
        keep_state = not {'scene', 'scene_overrides'} & set(changes)
        settings = self._settings

        def change(session):
            if prepared is not None:
                session.switch(*prepared, keep_state)
            session.command_timeout = settings.command_timeout
            self.ticker.skip_publish = settings.overrun == 'skip_publish'
            if {'rate', 'real_time_factor'} & set(changes):
                self.ticker.pace(settings.rate, settings.real_time_factor)
            session.note_parameters(changes, keep_state)

        self.session.request(change)

    # -- the end

    def close(self):
        """End ticks and recording, and report; return the exit status.

        The status is 1, after one line, if the simulation or the recording failed.
        """
        self._settings.on_change(lambda changes: None, lambda changes: None)
        self._status_line.close()
        if self.ticker.is_alive():
            self.ticker.stop()
            self.ticker.join(STOP_WITHIN)
        self._source.close()
        if not self.ticker.is_alive() and self.ticker.failure is None:
            try:
                self.session.take_balance()
            except NotConverged as error:
                self.ticker.failure = error
        self.journal.close(STOP_WITHIN)
        self._report()
        status, name = 0, self._node.get_name()
        if self.ticker.failure is not None:
            say(
                f'{name}: tick {self.session.next_tick}: '
                f'{type(self.ticker.failure).__name__}: {self.ticker.failure}'
            )
            status = 1
        if self.journal.status is not None and self.journal.status.error:
            say(f'{name}: recording: {self.journal.status.error}')
            status = 1
        return status

    def remove(self):
        """Remove from the node everything that the engine added, after :meth:`close`."""
        if self.commands is not None:
            self.commands.remove()
        for entity in set(_entities(self._node)) - self._entities_before:
            for destroy in (
                self._node.destroy_publisher,
                self._node.destroy_subscription,
                self._node.destroy_service,
                self._node.destroy_timer,
            ):
                if destroy(entity):
                    break

    def _report(self):
        """Print the report of the run."""
        session, ticker, balance = self.session, self.ticker, self.session.balance
        ticks, running = ticker.latest
        late, recording = ticker.lateness.summary(), self.journal.status
        events = ''.join(
            f', {count} x {name}' for name, count in sorted(session.event_counts.items())
        )
        for line in (
            f'{self._node.get_fully_qualified_name()}: {session.simulation.scene.name}, '
            f'{ticks} ticks in {running * 1e-9:.3f} s'
            f' ({(ticks - 1) / running * 1e9 if running else 0.0:.3f} Hz)',
            f'  ticks began late by p50 {late["p50"] * 1e6:.0f}, p99 {late["p99"] * 1e6:.0f}, '
            f'max {late["max"] * 1e6:.0f} us; '
            f'{ticker.overruns} overruns, {ticker.skipped} ticks not published, '
            f'{ticker.slipped * 1e-9:.3f} s slipped',
            f'  energy residual {balance["energy_residual"]:.2e}, '
            f'angular momentum residual {balance["momentum_residual"]:.2e}{events}',
            f'  recorded {recording.recorded} messages, {recording.dropped} ticks left out: '
            f'{self.journal.path}'
            if recording
            else '  not recorded',
        ):
            tell(line)


def _entities(node):
    return (*node.publishers, *node.subscriptions, *node.services, *node.timers)


def _result_soon(future):
    """Return the result of a Future, or None if it takes too long."""
    try:
        return future.result(ANSWER_WITHIN)
    except concurrent.futures.TimeoutError:
        return None
