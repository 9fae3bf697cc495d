# SPDX-License-Identifier: Apache-2.0
"""Recordings that were played and recorded again, and recordings of remapped topics.

They are run again by the stamps in their headers, and what cannot be compared is said.
"""

import json

import numpy as np
import pytest
from analysis import made
from mcap.reader import make_reader
from mcap.writer import CompressionType
from mcap.writer import Writer as TheirWriter

from rigid_body_sim.analysis.analyze import main as analyze
from rigid_body_sim.analysis.resimulate import main
from rigid_body_sim.recording.reader import Recording

pytestmark = pytest.mark.without_numba

LATER = 86_400_123_456_789      # ns
ACTS = {50: [('cmd_impulse', (0.0, 0.0, 0.0), (0.1, 0.0, 0.2), 'body')],
        120: [('cmd_wrench', (0.1, 0.2, 0.3), (0.3, 2.0, 0.1), 'body')], 200: [('reset',)]}


@pytest.fixture(scope='module')
def recording(tmp_path_factory):
    """Return the path of a recording with commands."""
    path = tmp_path_factory.mktemp('replayed') / 'run'
    made.record(path, 'tennis_racket', 300, acts=ACTS)
    return path


def again(source, path, renamed=None, without=(), stamps=True):
    """Record what `ros2 bag play` gives of a recording: other log times, no metadata record.

    `renamed` maps topics; `without` lists (topic, number of the message) that do not arrive;
    `stamps` says whether the journal has its own.
    """
    rng, seen, late = np.random.default_rng(3), {}, 0
    with open(source / f'{source.name}_0.mcap', 'rb') as stream, open(path, 'wb') as out:
        writer = TheirWriter(out, chunk_size=9000, compression=CompressionType.ZSTD)
        writer.start('ros2', 'theirs')
        channels = {}
        for schema, channel, message in make_reader(stream).iter_messages():
            number = seen[channel.topic] = seen.get(channel.topic, -1) + 1
            if (channel.topic, number) in without:
                continue
            if channel.topic not in channels:
                name = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.topic] = writer.register_channel(
                    (renamed or {}).get(channel.topic, channel.topic), 'cdr', name)
            late = max(late + 1000, message.log_time + LATER + int(rng.integers(900_000)))
            data = message.data
            if channel.topic == '/journal' and not stamps:
                data = data.replace(b'"stamp": ', b'"stomp": ')
            writer.add_message(channels[channel.topic], late, data, late, number)
        writer.finish()
    return path


def outcome(capsys, path):
    status = main([str(path), '--json'])
    return status, json.loads(capsys.readouterr().out)['bodies'][0]


@pytest.mark.usefixtures('undrawn')
@pytest.mark.parametrize('stamps', [True, False])
def test_a_recording_played_and_recorded_again_is_reproduced_to_the_bit(
        recording, tmp_path, capsys, stamps):
    status, found = outcome(capsys, again(recording, tmp_path / 'again.mcap', stamps=stamps))
    assert (status, found['identical'], found['not_compared']) == (0, True, [])
    assert found['messages'] == 4 * 301
    assert analyze([str(tmp_path / 'again.mcap')]) == 0


def test_one_that_misses_its_first_messages_is_compared_where_stamps_tell(
        recording, tmp_path, capsys):
    missing = [(f'/{name}', k) for name in ('pose', 'angular_velocity', 'energy')
               for k in range(7 if name == 'pose' else 20)]
    path = again(recording, tmp_path / 'again.mcap', without=missing)
    status, found = outcome(capsys, path)
    assert (status, found['identical']) == (0, True)
    assert found['not_compared'] == ['energy', 'angular_momentum_squared']
    assert found['messages'] == 2 * 301 - 27
    assert main([str(path)]) == 0
    text = capsys.readouterr().out
    assert text.startswith('identical in 2 of 4 topics, ')
    assert 'not compared: energy, angular_momentum_squared (' in text


def test_a_changed_bit_is_found_in_one_played_again(recording, tmp_path, capsys):
    value = Recording(recording).read('/angular_velocity')['vector'][77, 1]
    path = again(recording, tmp_path / 'again.mcap')
    with open(path, 'rb') as stream:
        found = list(make_reader(stream).iter_messages(log_time_order=False))
    with open(path, 'wb') as stream:
        writer = TheirWriter(stream, compression=CompressionType.NONE)
        writer.start('ros2', 'theirs')
        channels = {}
        for schema, channel, message in found:
            if channel.topic not in channels:
                channels[channel.topic] = writer.register_channel(
                    channel.topic, 'cdr', writer.register_schema(schema.name, 'ros2msg',
                                                                 schema.data))
            data = message.data.replace(value.tobytes(),
                                        np.nextafter(value, np.inf).tobytes())
            writer.add_message(channels[channel.topic], message.log_time, data,
                               message.publish_time)
        writer.finish()
    status, found = outcome(capsys, path)
    assert (status, found['parting']['tick']) == (1, 77)
    assert found['parting']['quantity'] == 'angular_velocity'


def test_a_topic_under_another_name_is_not_compared_in_silence(recording, tmp_path, capsys):
    path = again(recording, tmp_path / 'again.mcap', renamed={'/energy': '/heat'})
    status, found = outcome(capsys, path)
    assert (status, found['not_compared']) == (0, ['energy'])
    assert main([str(path)]) == 0
    assert 'identical in 3 of 4 topics' in capsys.readouterr().out


def test_a_topic_that_the_node_remapped_is_found(tmp_path, capsys, monkeypatch):
    from rigid_body_sim.recording import about
    told, names = about.about, {'energy': '/lab/heat', 'pose': '/attitude'}
    monkeypatch.setattr(about, 'about', lambda *given: {**told(*given),
                                                        'topics': json.dumps(names)})
    made.record(tmp_path / 'run', 'tennis_racket', 100)
    path = again(tmp_path / 'run', tmp_path / 'again.mcap',
                 renamed={'/energy': '/lab/heat', '/pose': '/attitude'})
    status, found = outcome(capsys, path)
    assert (status, found['identical'], found['not_compared']) == (0, True, [])
    with Recording(path) as opened:
        assert len(opened.states()) == 101


def test_a_topic_in_a_namespace_without_a_journal_is_left_out(recording, tmp_path, capsys):
    path = again(recording, tmp_path / 'again.mcap', renamed={'/pose': '/lab/pose'})
    assert main([str(path)]) == 0
    text = capsys.readouterr().out
    assert text.startswith('identical in 3 of 4 topics')
    assert 'not compared: pose' in text and '/lab: not run again: it has no journal' in text
    assert main([str(path), '--json']) == 0
    assert json.loads(capsys.readouterr().out)['left_out'] == ['/lab']


def test_a_missing_journal_is_not_one_that_makes_no_sense(recording, tmp_path, capsys):
    path = again(recording, tmp_path / 'again.mcap', renamed={'/journal': '/notes'})
    assert main([str(path)]) == 2
    assert capsys.readouterr().err.startswith(f'{path}: journal: is missing; a recording by ')
