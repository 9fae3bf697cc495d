# SPDX-License-Identifier: Apache-2.0
"""The topic /diagnostics: ledger, timing, commands, recording and prediction.

It is published once a second of real time, whatever the simulated clock does.

Numbers have 17 digits, which identify the double. OK, WARN and ERROR follow bounds that are
parameters.
"""

import dataclasses

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock, ClockType
from rclpy.qos import QoSProfile

from rigid_body_sim.recording import about
from rigid_body_sim.recording.about import ERROR, OK, WARN

PERIOD = 1.0
LOOK = 0.25
"""Time between two checks of the recorder, s."""
SHORTEST = 200_000_000
"""Shortest running time over which a rate is computed, ns."""
SAME_NAME_CHECKS = 10


class Diagnostics:
    """Publishes the state of a node's session, ticker, commands and recording.

    Parameters
    ----------
    node : rclpy.node.Node
    settings : parameters.Settings
    session : session.Session
    ticker : ticking.Ticker
    command_queue : commands.Commands
    journal : journal.Journal
    """

    def __init__(self, node, settings, session, ticker, command_queue, journal):
        self._node, self._settings = node, settings
        self._session, self._ticker, self._commands, self._journal = (
            session,
            ticker,
            command_queue,
            journal,
        )
        self._name = node.get_fully_qualified_name().lstrip('/')
        self._before = {
            'ticks': 0,
            'running': 0,
            'overruns': 0,
            'slipped': 0,
            'refused': 0,
            'lost': 0,
            'dropped': 0,
        }
        self._same_name_checks = SAME_NAME_CHECKS
        self.rate = 0.0
        self.lateness = ticker.lateness.since_last()
        self._publisher = node.create_publisher(
            DiagnosticArray, '/diagnostics', QoSProfile(depth=10)
        )
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(PERIOD, self.publish, clock=steady)
        node.create_timer(LOOK, journal.look, clock=steady)

    def publish(self):
        """Publish one array now, and ask the tick thread for a fresh balance for the next."""
        statuses = [
            self._ledger(),
            self._timing(),
            self._command(),
            self._recording(),
            self._prediction(),
        ]
        message = DiagnosticArray(status=statuses)
        message.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(message)
        self._session.want_balance()
        self._commands.look_for_mismatches()
        if self._same_name_checks:
            self._look_for_same_name()

    def _status(self, name, level, message, values):
        pairs = [
            KeyValue(key=key, value=f'{value:.17g}' if isinstance(value, float) else str(value))
            for key, value in values.items()
        ]
        return DiagnosticStatus(
            level=bytes([level]),
            name=f'{self._name}: {name}',
            message=message,
            hardware_id=self._session.simulation.scene.name,
            values=pairs,
        )

    def _since(self, name, value):
        """Return by how much a counter has grown since the last time."""
        grown, self._before[name] = value - self._before[name], value
        return grown

    def _ledger(self):
        balance = self._session.balance
        level, message = self._bounded(
            {name: abs(balance[name]) for name in ('energy_residual', 'momentum_residual')}
        )
        simulation = self._session.simulation
        if level == OK and simulation.missed:
            level, message = WARN, simulation.missed
        method = {
            name: value
            for name, value in about.method_of(simulation.choice).items()
            if value is not None
        } | {'method': simulation.method}
        if simulation.departed is not None and 'expected_error' in method:
            unknown = f'unknown since the command at t = {simulation.departed:.9g} s'
            method |= {'expected_error': unknown, 'met_until': unknown}
        return self._status(
            'ledger',
            level,
            message or 'energy and angular momentum balance',
            {**balance, **method},
        )

    def _timing(self):
        ticker, settings = self._ticker, self._settings
        ticks, running = ticker.latest
        # a rate needs some time: the very first ticks come in a burst
        if running - self._before['running'] >= SHORTEST or ticks == self._before['ticks']:
            new_ticks, new_running = self._since('ticks', ticks), self._since('running', running)
            self.rate = new_ticks / new_running * 1e9 if new_running > 0 else 0.0
        self.lateness = lateness = ticker.lateness.since_last()
        slipped, overruns = (
            self._since('slipped', ticker.slipped),
            self._since('overruns', ticker.overruns),
        )
        return self._status(
            'timing',
            *self._punctuality(lateness['p99'], overruns, slipped),
            {
                'tick': self._session.next_tick - 1,
                'rate': settings.rate,
                'achieved_rate': self.rate,
                'real_time_factor': settings.real_time_factor,
                'lateness_p50': lateness['p50'],
                'lateness_p99': lateness['p99'],
                'lateness_max': lateness['max'],
                'overruns': ticker.overruns,
                'skipped': ticker.skipped,
                'slipped': ticker.slipped * 1e-9,
                'clock_jumps': ticker.clock_jumps,
                'overrun': settings.overrun,
                'paused': ticker.paused,
                'scheduling': ticker.scheduling,
            },
        )

    def _punctuality(self, late, overruns, slipped):
        """Return level and message of lateness (p99, s), overruns and slips since the last one."""
        ticker, settings = self._ticker, self._settings
        if ticker.waiting_for_clock:
            return WARN, 'waiting for the first message on /clock'
        if slipped or late > settings['diagnostics.lateness_error']:
            return ERROR, (f'it does not keep up: {self.rate:.6g} of {settings.rate:.6g} Hz; '
                           'lower rate, or publish and record less')
        if overruns or late > settings['diagnostics.lateness_warn']:
            return WARN, (f'{overruns} overruns in the last second, '
                          f'lateness p99 {late * 1e6:.0f} us')
        return OK, 'paused' if ticker.paused else 'on time'

    def _command(self):
        queue = self._commands
        refused, lost = sum(queue.refusals.values()), queue.lost
        new_refused, new_lost = self._since('refused', refused), self._since('lost', lost)
        values = {
            'received': queue.received,
            'accepted': queue.accepted,
            'applied': queue.applied,
            'waiting': queue.waiting,
            'lost': lost,
            'refused': refused,
            **{f'refused: {reason}': count for reason, count in queue.refusals.copy().items()},
        }
        message = f'{new_refused or "none"} refused in the last second'
        if new_refused:
            message += ': see events'
        if new_lost:
            message = f'{new_lost} lost on the way in the last second: send fewer; {message}'
        return self._status('commands', WARN if new_refused or new_lost else OK, message, values)

    def _recording(self):
        status = self._journal.status
        if status is None:
            return self._status('recording', OK, 'off', {})
        level, message = OK, 'recording'
        if self._since('dropped', status.dropped):
            level, message = WARN, 'ticks were left out in the last second'
        if status.error:
            level, message = ERROR, status.error
        return self._status(
            'recording', level, message, {'path': self._journal.path, **dataclasses.asdict(status)}
        )

    def _prediction(self):
        found = self._session.prediction.compared()
        difference = abs(found.get('relative_difference', 0.0))
        level, _ = self._bounded({'prediction': difference})
        if level != OK:
            message = f'what was measured differs from what is predicted by {difference:.3g} of it'
        else:
            message = (
                'as predicted'
                if 'relative_difference' in found
                else 'nothing measured yet'
                if found
                else 'theory has no prediction'
            )
        return self._status('prediction', level, message, found)

    def _bounded(self, sizes):
        """Return the level that some sizes reach, and a message that names the worst of them."""
        level, message = OK, ''
        for name, size in sizes.items():
            for reached, bound in ((WARN, 'warn'), (ERROR, 'error')):
                if reached > level and size > self._settings[f'diagnostics.{name}_{bound}']:
                    level, message = reached, f'{name.replace("_", " ")} {size:.3g}'
        return level, message

    def _look_for_same_name(self):
        """Warn once if another node has this name: services and parameters would be mixed up."""
        self._same_name_checks -= 1
        own = (self._node.get_name(), self._node.get_namespace())
        if self._node.get_node_names_and_namespaces().count(own) > 1:
            self._same_name_checks = 0
            self._node.get_logger().warning(
                f'there is another node /{self._name}; give one of them another name: '
                '--ros-args -r __node:=NAME'
            )
