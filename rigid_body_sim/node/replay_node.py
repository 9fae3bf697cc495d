# SPDX-License-Identifier: Apache-2.0
"""The node that replays a recording: its publishers, /clock, a service to pause."""

import collections
import importlib
import time

from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock as ClockMessage
from std_srvs.srv import SetBool
from tqdm import tqdm

from rigid_body_sim.command_line import CHECK_FAILED, GOOD, print_json
from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages.timeline import NANOSECONDS
from rigid_body_sim.node.answering import Answering
from rigid_body_sim.node.offered_qos import offered_qos
from rigid_body_sim.realtime.playing import MOST_REAL_TIME, Player, Reading
from rigid_body_sim.realtime.priority import PRIORITY, ask_for_priority, quicken
from rigid_body_sim.realtime.shutdown import say, tell

CLOCK_TOPIC = '/clock'
ACKNOWLEDGED_WITHIN = 1.0
"""How long the node waits at its end for reliable subscribers to have everything, s."""
PROGRESS_PERIOD = 0.2


class ReplayNode(Answering, Node):
    """Replays from its construction on.

    Parameters
    ----------
    stop : shutdown.Stop
        Asked to end the process when all is played.
    recording : Recording
    options : argparse.Namespace
        ``rate``, ``start``, ``loop``, ``topics``, ``paused``, ``json`` of the subcommand.
    """

    def __init__(self, stop, recording, options):
        super().__init__('replay')
        self.answer_all()
        stop.last_resort = self.destroy_node
        self._recording, self._options = recording, options
        names = options.topics or [name for name, topic in recording.topics.items() if topic.count]
        self._sending = {name: self._publisher(recording.topics[name]) for name in names}
        # a recorded clock is replayed like any other topic
        clock = (
            None
            if CLOCK_TOPIC in names
            else self.create_publisher(ClockMessage, CLOCK_TOPIC, QoSProfile(depth=1))
        )
        start = recording.start_time + round(options.start * NANOSECONDS)
        reading = Reading(recording, names, start, recording.end_time, options.loop)
        publish = {name: publisher.handle.publish_raw for name, publisher in self._sending.items()}
        self._tell_clock = (
            (lambda _: None) if clock is None else lambda now: clock.publish(_clock_message(now))
        )
        self.player = Player(
            reading, publish, self._tell_clock, options.rate, options.paused, stop.request
        )
        self.create_service(SetBool, '~/pause', self._pause)
        seconds = (recording.end_time - start) / NANOSECONDS
        self._progress = tqdm(
            total=None if options.loop else round(seconds, 3), unit=' s', disable=None, leave=False
        )
        self._started = start
        # it also wakes the executor, which a request to end does not
        self.create_timer(
            PROGRESS_PERIOD, self._show, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )
        if options.start:
            self._publish_latched(names, start)
        quicken()
        # this thread and the reading one hold the interpreter at times, and then delay messages
        ask_for_priority(options.rate <= MOST_REAL_TIME, PRIORITY - 1)
        self.player.start()

    def _publisher(self, topic):
        package, _, name = (
            topic.type.split('/') if topic.type.count('/') == 2 else ('', '', topic.type)
        )
        try:
            message_type = getattr(importlib.import_module(f'{package}.msg'), name)
        except (ImportError, TypeError, ValueError, AttributeError):
            raise BadInput(
                topic.name,
                f'has messages of {topic.type}, which is not installed here',
                f'install {package or "it"}, or name others by --topics',
            ) from None
        if not topic.name.startswith('/'):
            raise BadInput(topic.name, 'is not the complete name of a topic', 'other --topics')
        return self.create_publisher(message_type, topic.name, offered_qos(topic.qos))

    def _publish_latched(self, names, start):
        """Publish the latched messages that a late subscriber would have received at the start."""
        for name in names:
            profile = self._sending[name].qos_profile
            if profile.durability == DurabilityPolicy.TRANSIENT_LOCAL:
                for message in collections.deque(
                    self._recording.messages([name], end=start - 1), maxlen=max(1, profile.depth)
                ):
                    self._sending[name].handle.publish_raw(message.data)

    def _pause(self, request, response):
        (self.player.pause if request.data else self.player.resume)()
        response.success, response.message = (
            True,
            f'{"paused" if request.data else "playing"} at {self._played():.9g} s',
        )
        return response

    def _played(self):
        """Return the player's position in the recording, s from its start."""
        return (self.player.now - self._recording.start_time) / NANOSECONDS

    def _show(self):
        if not self._progress.disable:
            self._progress.n = round((self.player.now - self._started) / NANOSECONDS, 2)
            self._progress.refresh()

    def close(self):
        """End the thread, wait for subscribers, and report; return the exit status."""
        player = self.player
        ended = not player.is_alive()
        player.stop()
        player.join()
        self._progress.close()
        if player.failure is None and ended:
            until = time.monotonic() + ACKNOWLEDGED_WITHIN
            for publisher in self._sending.values():
                publisher.wait_for_all_acked(Duration(seconds=max(0.0, until - time.monotonic())))
        return self._report(ended)

    def _report(self, ended):
        player, options = self.player, self._options
        if player.failure is not None:
            say(f'{self._recording.path}: {player.failure}')
            return CHECK_FAILED
        late = player.lateness.summary()
        if options.json:
            print_json(
                {
                    'recording': str(self._recording.path),
                    'topics': list(self._sending),
                    'messages': player.published,
                    'ended': ended,
                    'rate': options.rate,
                    'loops': player.loops,
                    'seconds': player.seconds,
                    'timing_error': {name: late[name] for name in ('p50', 'p99', 'max')},
                }
            )
        else:
            p50, p99, worst = (late[name] * 1e6 for name in ('p50', 'p99', 'max'))
            where = '' if ended else f', ended at {self._played():.9g} s'
            loops = f' in {player.loops} loops' if options.loop else ''
            tell(
                f'{player.published} messages on {len(self._sending)} topics{loops}, '
                f'{player.seconds:.3f} s{where}; '
                f'timing error p50 {p50:.0f}, p99 {p99:.0f}, max {worst:.0f} us'
            )
        return GOOD


def _clock_message(now):
    message = ClockMessage()
    message.clock.sec, message.clock.nanosec = divmod(now, NANOSECONDS)
    return message
