# SPDX-License-Identifier: Apache-2.0
"""The command `replay`: every recorded bit reaches subscribers in order, with its QoS."""

import collections
import importlib
import itertools
import json
import shutil
import signal
import sys
import types

import pytest
from analysis import made
from mcap.writer import MCAP0_MAGIC
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from std_srvs.srv import SetBool

from rigid_body_sim.errors import BadInput
from rigid_body_sim.node import replay
from rigid_body_sim.node.offered_qos import offered_qos
from rigid_body_sim.realtime.playing import Player, Reading
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.recording.topics import Topic

SECOND = 10**9


@pytest.fixture(scope='module')
def recording(tmp_path_factory):
    """Return the path of a recording of 2 s at 200 Hz, with commands and events."""
    path = tmp_path_factory.mktemp('replay') / 'run'
    made.record(path, 'tennis_racket', 400, rate=200.0, acts={
        40: [('cmd_impulse', (0.0, 0.0, 0.0), (0.5, 0.0, 0.0), 'world')], 100: [('reset',)]})
    return path


def subscribe(client, topic, depth=10_000):
    """Subscribe to a recorded topic as it was offered; return the list of its messages, bytes."""
    package, _, name = topic.type.split('/')
    message_type, taken = getattr(importlib.import_module(f'{package}.msg'), name), []
    profile = QoSProfile(depth=depth, durability=offered_qos(topic.qos).durability)
    client.node.create_subscription(message_type, topic.name, taken.append, profile, raw=True)
    return taken


def padded(data):
    """Return a message as it arrives: DDS pads to a multiple of four bytes."""
    return data + bytes(-len(data) % 4)


def matched(client, recording):
    return all(client.node.count_publishers(name) for name in recording.topics)


def test_a_subscriber_gets_every_message_bit_by_bit_in_order(recording, ros_domain, new_client):
    with ros_domain.process(
            '-m', 'rigid_body_sim', 'replay', recording, '--paused', '--json', '--rate',
            '2') as process, new_client(ros_domain) as client, Recording(recording) as recorded:
        expected = {name: [padded(message.data) for message in recorded.messages([name])]
                    for name in recorded.topics}
        taken = {name: subscribe(client, topic) for name, topic in recorded.topics.items()}
        clocks = []
        client.node.create_subscription(Clock, '/clock', lambda message: clocks.append(
            message.clock.sec * SECOND + message.clock.nanosec), QoSProfile(depth=10_000))
        client.until(lambda: process.poll() is not None or (matched(client, recorded) and clocks),
                     timeout=60.0, what='the publishers')
        client.spin(0.5)        # both sides have found each other then
        # paused before the first message
        assert not taken['/pose'] and set(clocks) == {recorded.start_time}
        assert client.call(SetBool, '/replay/pause', data=False).success
        client.until(lambda: all(len(taken[name]) >= len(expected[name]) for name in expected),
                     what='all messages')
        output, error = process.communicate(timeout=20)
        assert (process.returncode, error) == (0, '')
    assert {name: [bytes(data) for data in messages]
            for name, messages in taken.items()} == expected
    report = json.loads(output)
    assert (report['messages'] == sum(map(len, expected.values())) and report['ended']
            and report['loops'] == 1)
    assert (set(report['topics']) == set(expected)
            and set(report['timing_error']) == {'p50', 'p99', 'max'})
    assert clocks == sorted(clocks) and clocks[-1] <= recorded.end_time and len(set(clocks)) > 10


def test_in_a_loop_from_the_middle_with_a_pause_until_ctrl_c(recording, ros_domain, new_client):
    arguments = ('--loop', '--start', '1.7', '--topics', '/pose', '/scene', '--json')
    with ros_domain.process('-m', 'rigid_body_sim', 'replay', recording, *arguments) as process, \
            new_client(ros_domain) as client, Recording(recording) as recorded:
        expected = [message.data
                    for message in recorded.messages(
                        ['/pose'], recorded.start_time + 17 * SECOND // 10)]
        poses = subscribe(client, recorded.topics['/pose'])
        client.until(lambda: process.poll() is not None or len(poses) > 3 * len(expected),
                     timeout=60.0, what='three loops')
        # one that comes late gets the scene, which was recorded before the start
        scenes = subscribe(client, recorded.topics['/scene'])
        client.until(lambda: scenes, what='the latched scene')
        assert [bytes(data) for data in scenes] == [padded(message.data)
                                                    for message in recorded.messages(['/scene'])]
        assert client.node.count_publishers('/energy') == 0
        assert client.call(SetBool, '/replay/pause', data=True).success
        client.spin(0.3)        # what was on its way has come
        standing = len(poses)
        client.spin(0.5)
        assert len(poses) == standing
        assert client.call(SetBool, '/replay/pause', data=False).success
        client.until(
            lambda: len(poses) > standing + len(expected), what='messages after the pause')
        process.send_signal(signal.SIGINT)
        output, error = process.communicate(timeout=20)
        assert (process.returncode, error) == (0, '')
    begin = expected.index(bytes(poses[0]))
    assert [bytes(data) for data in poses] == list(itertools.islice(
        itertools.cycle(expected), begin, begin + len(poses)))
    report = json.loads(output)
    assert not report['ended'] and report['loops'] >= 4 and report['messages'] >= len(poses)


def test_loops_do_not_drift(recording):
    with Recording(recording) as recorded:
        start, end = recorded.start_time + SECOND, recorded.end_time
        reading = Reading(recorded, ['/energy'], start, end, loop=True)
        reading.start()
        messages = list(itertools.islice(reading, 3 * 201))
    times = [start + tick * SECOND // 200 for tick in range(201)]
    assert [message.log_time for _, message in messages] == 3 * times
    assert [position for position, _ in messages] == [time - start + loop * (end - start)
                                                      for loop in range(3) for time in times]


def test_a_message_is_never_early_whatever_the_rate(recording, monkeypatch):
    """A clock that only sleep moves: a pause moves all messages that come after it."""
    clock, published = types.SimpleNamespace(now=5 * SECOND), collections.defaultdict(list)

    def sleep(seconds):
        clock.now += max(1, round(seconds * SECOND))
        if player.published == 20 and player._paused is False and not player.now_paused:
            player.now_paused = clock.now
            player.pause()
        elif player._paused and clock.now > player.now_paused + SECOND:
            player.resume()

    monkeypatch.setattr('rigid_body_sim.realtime.playing.time',
                        types.SimpleNamespace(monotonic_ns=lambda: clock.now, sleep=sleep))
    monkeypatch.setattr('rigid_body_sim.realtime.playing.ask_for_priority', lambda _: None)
    with Recording(recording) as recorded:
        reading = Reading(
            recorded, ['/energy'], recorded.start_time, recorded.end_time, loop=False)
        told = []
        player = Player(reading, {'/energy': lambda _: published['at'].append(clock.now)},
                        told.append, 0.3, False, lambda: None)
        player.now_paused = 0
        player.run()
    assert player.failure is None and player.published == 401
    instants = [5 * SECOND + (tick * SECOND // 200) * 10 // 3 for tick in range(401)]
    shift = published['at'][20] - instants[20]
    late = [at - instant - (shift if tick >= 20 else 0)
            for tick, (at, instant) in enumerate(zip(published['at'], instants))]
    # ns: the pause counts what passed, in steps of the sleeps
    assert max(map(abs, late)) <= 2 and shift >= SECOND
    assert told == sorted(told) and told[-1] == reading.end_time


@pytest.mark.parametrize(('text', 'reliability', 'durability', 'depth'), [
    (Topic('/a', 'x', 7, 'best_effort').qos_text(), 'BEST_EFFORT', 'VOLATILE', 7),
    (Topic('/a', 'x', 3, 'reliable', 'transient_local').qos_text(),
     'RELIABLE', 'TRANSIENT_LOCAL', 3),
    # rosbag2 of Humble wrote numbers; two publishers of one topic
    ('- {history: 1, depth: 5, reliability: 2, durability: 2, deadline: FOREVER, '
     'lifespan: FOREVER, liveliness: 1, liveliness_lease_duration: FOREVER, '
     'avoid_ros_namespace_conventions: false}'.replace(
         'FOREVER', '{sec: 9223372036, nsec: 854775807}'),
     'BEST_EFFORT', 'VOLATILE', 5),
    (Topic('/a', 'x', 2, 'best_effort').qos_text()
     + Topic('/a', 'x', 9, 'reliable', 'transient_local').qos_text(),
     'RELIABLE', 'TRANSIENT_LOCAL', 9),
    *((text, 'RELIABLE', 'VOLATILE', 10) for text in ('', '[1, 2]', '{'))])
def test_recorded_qos(text, reliability, durability, depth):
    profile = offered_qos(text)
    durability = DurabilityPolicy[durability] if text and text[0] == '-' else profile.durability
    assert (profile.reliability, profile.durability, profile.depth) == (
        ReliabilityPolicy[reliability], durability, depth)
    assert profile.history in (HistoryPolicy.KEEP_LAST, HistoryPolicy.SYSTEM_DEFAULT)


def test_bad_input_is_one_line(recording, tmp_path, monkeypatch, capfd):
    monkeypatch.setattr(replay, 'leave', sys.exit)
    cut = tmp_path / 'cut.mcap'
    shutil.copy(recording / f'{recording.name}_0.mcap', cut)
    cut.write_bytes(cut.read_bytes()[:-500])
    strange = tmp_path / 'strange.mcap'
    strange.write_bytes(recording.joinpath(f'{recording.name}_0.mcap').read_bytes()[:1]
                        + MCAP0_MAGIC[1:])
    for arguments, said in [([tmp_path / 'missing'], 'recover'), ([cut], 'recover'),
                            ([strange], 'recover'), ([recording, '--rate', '0'], '--rate: got 0'),
                            ([recording, '--rate', 'nan'], '--rate: got nan'),
                            ([recording, '--start', '3'], 'from 0 to 2,'),
                            ([recording, '--start', '2', '--loop'], 'only one instant'),
                            ([recording, '--topics', '/poses'], "no topic '/poses'")]:
        with pytest.raises(SystemExit) as ended:
            replay.main([str(argument) for argument in arguments])
        error = capfd.readouterr().err
        assert ended.value.code == 2 and said in error and error.count('\n') == 1, error


def test_what_is_for_ros_is_left_to_it(tmp_path, monkeypatch, capfd):
    monkeypatch.setattr(replay, 'leave', sys.exit)
    monkeypatch.setattr(sys, 'argv', ['replay', str(tmp_path / 'missing'), '--ros-args', '-r',
                                      '__node:=again'])
    with pytest.raises(SystemExit):
        replay.main()
    assert 'recover' in capfd.readouterr().err    # so the arguments before it were taken


def opened(monkeypatch, *arguments, count=1, length=2.5):
    """Open a recording that lasts so long (s), as the options of a command line say."""
    monkeypatch.setattr(replay, 'Recording', lambda path: types.SimpleNamespace(
        start_time=SECOND, end_time=SECOND + round(length * SECOND), message_count=count))
    return replay._opened(replay._parser().parse_args(['run', *arguments]))


@pytest.mark.parametrize('arguments', [
    (), ('--rate', '1e6'), ('--rate', '1e-9'), ('--start', '2.5'), ('--loop',),
    ('--loop', '--start', '2.499')])
def test_what_fits_a_recording_is_played(monkeypatch, arguments):
    assert opened(monkeypatch, *arguments).end_time == SECOND + 5 * SECOND // 2


@pytest.mark.parametrize(('arguments', 'said'), [
    (('--rate', '1.1e6'), 'got 1.1e.06; a number above 0, up to 1e.06'),
    (('--rate', '-1'), '--rate: got -1'), (('--rate', '0'), '--rate: got 0'),
    (('--rate', 'inf'), '--rate: got inf'),
    (('--start', '-0.1'), 'got -0.1; from 0 to 2.5, the length'),
    (('--start', 'nan'), '--start: got nan'), (('--start', '2.501'), '--start: got 2.501'),
    (('--loop', '--start', '2.5'), 'there is only one instant')])
def test_what_does_not_fit_a_recording_is_refused(monkeypatch, arguments, said):
    with pytest.raises(BadInput, match=said):
        opened(monkeypatch, *arguments)


def test_a_recording_of_nothing_cannot_be_played(monkeypatch):
    with pytest.raises(BadInput, match='run: holds no messages'):
        opened(monkeypatch, count=0, length=0.0)


def test_a_recording_is_played_once_from_its_start_at_its_own_pace_unless_asked_otherwise():
    options = replay._parser().parse_args(['run'])
    assert (options.rate, options.start, options.loop, options.topics, options.paused) == (
        1.0, 0.0, False, None, False)


@pytest.mark.parametrize(('hidden', 'shown'), [(False, [12.35]), (True, [])])
def test_the_bar_shows_how_much_has_been_played_unless_it_is_hidden(hidden, shown):
    from rigid_body_sim.node.replay_node import ReplayNode
    seen = []
    bar = types.SimpleNamespace(disable=hidden, refresh=lambda: seen.append(bar.n))
    ReplayNode._show(types.SimpleNamespace(
        _progress=bar, _started=5_000_000_000, player=types.SimpleNamespace(now=17_345_678_901)))
    assert seen == shown


@pytest.mark.parametrize(('depth', 'kept'), [(1, [b'3']), (2, [b'2', b'3']), (0, [b'3'])])
def test_who_comes_late_gets_the_latched_messages_from_before_the_start(depth, kept):
    """As many as the depth, of those with an earlier time; a depth of 0 was not recorded."""
    from rigid_body_sim.node.replay_node import ReplayNode
    sent, asked = [], []

    def publisher(durability):
        return types.SimpleNamespace(
            qos_profile=types.SimpleNamespace(durability=durability, depth=depth),
            handle=types.SimpleNamespace(publish_raw=sent.append))

    def messages(names, end):
        asked.append((names, end))
        return (types.SimpleNamespace(data=data) for data in (b'1', b'2', b'3'))
    stands_for = types.SimpleNamespace(
        _recording=types.SimpleNamespace(messages=messages),
        _sending={'/scene': publisher(DurabilityPolicy.TRANSIENT_LOCAL),
                  '/pose': publisher(DurabilityPolicy.VOLATILE)})
    ReplayNode._publish_latched(stands_for, ['/pose', '/scene'], 500)
    assert sent == kept and asked == [(['/scene'], 499)]


@pytest.mark.parametrize(('loop', 'ended', 'told'), [
    (False, True, '70 messages on 2 topics, 1.500 s; timing error p50 12, p99 345, max 6789 us'),
    (True, False, '70 messages on 2 topics in 3 loops, 1.500 s, ended at 0.25 s; timing error '
     'p50 12, p99 345, max 6789 us')])
def test_the_report_is_in_seconds_and_microseconds(monkeypatch, loop, ended, told):
    from rigid_body_sim.node import replay_node
    lines = []
    monkeypatch.setattr(replay_node, 'tell', lines.append)
    player = types.SimpleNamespace(
        failure=None, published=70, loops=3, seconds=1.5, now=5_250_000_000,
        lateness=types.SimpleNamespace(
            summary=lambda: {'p50': 12e-6, 'p99': 345e-6, 'max': 6.789e-3}))
    stands_for = types.SimpleNamespace(
        player=player, _recording=types.SimpleNamespace(start_time=5 * SECOND),
        _sending={'/pose': None, '/scene': None},
        _options=types.SimpleNamespace(json=False, loop=loop))
    stands_for._played = lambda: replay_node.ReplayNode._played(stands_for)
    assert replay_node.ReplayNode._report(stands_for, ended) == 0
    assert lines == [told]


@pytest.mark.parametrize(('name', 'kind', 'said'), [
    ('/a', 'std_msgs/msg/Nothing', 'has messages of std_msgs/msg/Nothing, which is not installed'),
    ('/a', 'no_msgs/msg/String', 'has messages of no_msgs/msg/String, which is not installed'),
    ('/a', 'String', 'has messages of String, which is not installed'),
    ('a', 'std_msgs/msg/String', 'is not the complete name of a topic')])
def test_a_topic_that_cannot_be_published_is_refused(name, kind, said):
    from rigid_body_sim.node.replay_node import ReplayNode
    with pytest.raises(BadInput, match=said):
        ReplayNode._publisher(types.SimpleNamespace(), Topic(name, kind))


@pytest.mark.parametrize(('options', 'begins', 'total', 'clock', 'real_time', 'latched'), [
    ({}, 5 * SECOND, 12.346, True, True, False),
    ({'start': 2.25}, 7_250_000_000, 10.096, True, True, True),
    ({'loop': True, 'topics': ['/a', '/clock'], 'rate': 20.0}, 5 * SECOND, None, False, True,
     False),
    ({'rate': 25.0, 'topics': ['/a']}, 5 * SECOND, 12.346, True, False, False)])
def test_parts_are_made_as_the_options_say(
        monkeypatch, options, begins, total, clock, real_time, latched):
    """A recorded clock is played like any other topic; topics without a message are not."""
    from rigid_body_sim.node import replay_node
    made = collections.defaultdict(list)

    def keep(name, result=None):
        return lambda *arguments, **more: made[name].append((*arguments, *more.items())) or result
    player = types.SimpleNamespace(start=keep('started'))
    for name, result in (('Reading', 'reading'), ('Player', player), ('tqdm', None),
                         ('quicken', None), ('ask_for_priority', None)):
        monkeypatch.setattr(replay_node, name, keep(name, result))
    monkeypatch.setattr(replay_node.Node, '__init__', keep('node'))
    publishers = {}

    class Made(replay_node.ReplayNode):
        answer_all, create_service = keep('answers'), keep('services')
        _publish_latched = keep('latched')

        def _publisher(self, topic):
            return types.SimpleNamespace(handle=types.SimpleNamespace(publish_raw=topic.name))

        def create_publisher(self, kind, name, profile):
            publishers[name] = kind, profile.depth
            return types.SimpleNamespace(publish=keep('told'))

        def create_timer(self, period, show, clock):
            made['timers'].append((period, clock.clock_type.name))

        def destroy_node(self):
            pass
    topics = {name: types.SimpleNamespace(name=name, count=count)
              for name, count in (('/a', 3), ('/b', 0), ('/c', 1), ('/clock', 0))}
    recording = types.SimpleNamespace(
        topics=topics, start_time=5 * SECOND, end_time=17_345_678_901)
    wanted = types.SimpleNamespace(**{'start': 0.0, 'loop': False, 'topics': None, 'rate': 1.0,
                                      'paused': False} | options)
    stop = types.SimpleNamespace(request='stop', last_resort=None)
    Made(stop, recording, wanted)
    names = wanted.topics or ['/a', '/c']
    assert made['Reading'] == [(recording, names, begins, 17_345_678_901, wanted.loop)]
    [(reading, publish, tell_clock, *asked)] = made['Player']
    assert (reading, publish) == ('reading', {name: name for name in names})
    assert asked == [wanted.rate, False, 'stop']
    tell_clock(7 * SECOND)
    assert [message.clock.sec for message, in made['told']] == ([7] if clock else [])
    # only the latest time counts
    assert publishers == ({'/clock': (Clock, 1)} if clock else {})
    assert made['tqdm'] == [(('total', total), ('unit', ' s'), ('disable', None),
                             ('leave', False))]
    # below the thread that publishes, which has 10
    assert made['ask_for_priority'] == [(real_time, 9)]
    assert [where for *_, where in made['latched']] == ([begins] if latched else [])
    assert made['timers'] == [(replay_node.PROGRESS_PERIOD, 'STEADY_TIME')]
    assert made['started'] == [()]


@pytest.mark.parametrize(('failure', 'alive', 'waits'), [
    (None, False, True), (None, True, False), (ValueError('cut'), False, False)])
def test_at_its_end_it_waits_a_second_in_all_for_subscribers(monkeypatch, failure, alive, waits):
    """One that was interrupted, or failed, ends at once."""
    from rigid_body_sim.node import replay_node
    now, waited = [50.0], []

    def wait(duration):
        waited.append(duration.nanoseconds * 1e-9)
        now[0] += 0.75
    monkeypatch.setattr(replay_node, 'time', types.SimpleNamespace(monotonic=lambda: now[0]))
    publisher = types.SimpleNamespace(wait_for_all_acked=wait)
    stands_for = types.SimpleNamespace(
        player=types.SimpleNamespace(failure=failure, is_alive=lambda: alive, stop=lambda: None,
                                     join=lambda: None),
        _progress=types.SimpleNamespace(close=lambda: None), _report=lambda ended: ended,
        _sending=dict.fromkeys('abc', publisher))
    assert replay_node.ReplayNode.close(stands_for) is not alive
    assert waited == pytest.approx([1.0, 0.25, 0.0] if waits else [], abs=1e-9)


def test_the_clock_is_in_seconds_and_nanoseconds():
    from rigid_body_sim.node.replay_node import _clock_message
    told = _clock_message(1_700_000_000_999_999_999).clock
    assert (told.sec, told.nanosec) == (1_700_000_000, 999_999_999)


@pytest.mark.parametrize(('data', 'called', 'said'), [
    (True, 'pause', 'paused at 2.25 s'), (False, 'resume', 'playing at 2.25 s')])
def test_a_pause_is_begun_and_ended_and_its_place_is_told(data, called, said):
    from rigid_body_sim.node.replay_node import ReplayNode
    calls = []
    player = types.SimpleNamespace(pause=lambda: calls.append('pause'),
                                   resume=lambda: calls.append('resume'), now=7_250_000_000)
    stands_for = types.SimpleNamespace(
        player=player, _recording=types.SimpleNamespace(start_time=5 * SECOND))
    stands_for._played = lambda: ReplayNode._played(stands_for)
    response = ReplayNode._pause(stands_for, types.SimpleNamespace(data=data),
                                 types.SimpleNamespace())
    assert (response.success, response.message, calls) == (True, said, [called])
