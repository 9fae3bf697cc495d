# SPDX-License-Identifier: Apache-2.0
"""Cut files made whole: nothing invented, nothing lost before the cut chunk.

What is lost is counted or said to be unknown. The second time nothing changes.
"""

import errno
import fcntl
import json
import os
import random

import pytest
import yaml
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Chunk, Header
from mcap.stream_reader import StreamReader
from mcap.writer import MCAP0_MAGIC, CompressionType
from mcap.writer import Writer as TheirWriter
from recording.conftest import ABOUT, START, write
from rosbags.rosbag2 import Reader
from soak import SOAK

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording.mcap import mending
from rigid_body_sim.recording.mcap.records import HEAD, to_bytes
from rigid_body_sim.recording.recover import _told, main, recover

OFFSETS = 1000 if SOAK else 25


def messages_of(path):
    """Return all messages of a file in its order, read by indexes and with checksums validated."""
    with open(path, 'rb') as stream:
        return [
            (channel.topic, message.log_time, message.publish_time, message.sequence, message.data)
            for _, channel, message in make_reader(stream, validate_crcs=True).iter_messages(
                log_time_order=False
            )
        ]


def chunks_of(path):
    """Return (end of the chunk and its indexes, messages up to there) for each chunk."""
    with open(path, 'rb') as stream:
        indexes = make_reader(stream).get_summary().chunk_indexes
        ends = sorted(index.chunk_start_offset + index.chunk_length for index in indexes)
    counts, done = [], 0
    for size in ([402] + [400] * (len(ends) - 1)):
        done += size
        counts.append(done)
    return list(zip(ends, counts, strict=True))


@pytest.mark.parametrize('compression_name', ['zstd', 'none'])
def test_files_cut_at_random_offsets(tmp_path, compression_name):
    whole = write(tmp_path / 'bag', compression_name=compression_name) / 'bag_0.mcap'
    content, messages, chunks = whole.read_bytes(), messages_of(whole), chunks_of(whole)
    folder = tmp_path / 'cut'
    folder.mkdir()
    file = folder / 'cut_0.mcap'
    for offset in random.Random(7).sample(range(len(content)), OFFSETS):
        file.write_bytes(content[:offset])
        result, = recover(folder)
        kept = messages_of(file)
        assert result.changed
        assert kept == messages[:len(kept)]
        assert (
            len(kept)
            == result.messages
            >= max((count for end, count in chunks if end <= offset), default=0)
        )
        if compression_name == 'none':  # then all that was complete is kept, also in the cut chunk
            assert len(kept) + result.lost_messages <= len(messages)
            assert result.messages >= max(
                (count for end, count in chunks if end <= offset), default=0
            )
        with Reader(folder) as reader:
            assert reader.message_count == len(kept)
        bag = yaml.safe_load((folder / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
        assert bag['message_count'] == len(kept)
        again = file.read_bytes(), (folder / 'metadata.yaml').read_bytes()
        second, = recover(folder)
        assert not second.changed
        assert (file.read_bytes(), (folder / 'metadata.yaml').read_bytes()) == again


def test_uncompressed_chunk_is_kept_up_to_the_cut_message(tmp_path):
    whole = write(tmp_path / 'bag', compression_name='none') / 'bag_0.mcap'
    messages, content = messages_of(whole), whole.read_bytes()
    marker = messages[601][4]       # somewhere in the second chunk
    at = content.index(marker, chunks_of(whole)[0][0])
    (tmp_path / 'cut.mcap').write_bytes(content[:at + len(marker) - 1])
    result, = recover(tmp_path / 'cut.mcap')
    assert messages_of(tmp_path / 'cut.mcap') == messages[:601]
    assert result.lost_messages == pytest.approx(
        802 - 601, abs=2
    )  # the first chunk has some longer ones
    assert result.lost_seconds == pytest.approx(0.05, abs=0.002)


def test_what_is_lost_is_said(tmp_path, capsys):
    whole = write(tmp_path / 'bag') / 'bag_0.mcap'
    end = chunks_of(whole)[4][0]
    os.truncate(whole, end - 10)    # in the fifth chunk
    (whole.parent / 'metadata.yaml').unlink()
    assert main([str(whole.parent)]) == 0
    assert (
        'made whole, 1602 messages kept, lost about 400 messages, 0.100 s'
        in capsys.readouterr().out
    )
    assert main([str(whole.parent), '--json']) == 0
    assert json.loads(capsys.readouterr().out) == [
        {
            'path': str(whole),
            'messages': 1602,
            'lost_messages': 0,
            'certainty': 'counted',
            'lost_seconds': 0.0,
            'lost_bytes': 0,
            'doubtful_messages': 0,
            'changed': False,
            'original': None,
        }
    ]


def test_cut_in_the_tail_loses_nothing(tmp_path):
    whole = write(tmp_path / 'bag') / 'bag_0.mcap'
    messages, content = messages_of(whole), whole.read_bytes()
    for offset in (content.rindex(HEAD.pack(Opcode.DATA_END, 4)) + 13, len(content) - 300,
                   len(content) - 1):
        (tmp_path / 'cut.mcap').write_bytes(content[:offset])
        result, = recover(tmp_path / 'cut.mcap')
        assert messages_of(tmp_path / 'cut.mcap') == messages
        assert str(result).endswith(f'made whole, {len(messages)} messages kept, lost nothing')


@pytest.mark.parametrize('place', [0, 100, 'chunk 5'])
def test_what_followed_a_cut_is_not_known_unless_metadata_yaml_tells(tmp_path, place):
    folder = write(tmp_path / 'bag')
    whole = folder / 'bag_0.mcap'
    messages, ends = messages_of(whole), chunks_of(whole)
    end, count = ends[4] if place == 'chunk 5' else (ends[-1][0] + place, len(messages))
    content = whole.read_bytes()[:end]
    (tmp_path / 'cut.mcap').write_bytes(content)
    result, = recover(tmp_path / 'cut.mcap')
    assert messages_of(tmp_path / 'cut.mcap') == messages[:count]
    assert result.certainty == 'unknown'
    assert 'what is lost is not known: the file does not tell how many' in str(result)
    whole.write_bytes(content)
    result, = recover(folder)
    assert (result.lost_messages, result.certainty) == (len(messages) - count, 'counted')
    assert 'not known' not in str(result)


@pytest.mark.parametrize('compression_name', ['zstd', 'lz4', 'none'])
def test_cut_in_the_first_chunk_is_not_said_to_cost_nothing(tmp_path, compression_name):
    whole = write(tmp_path / 'bag', compression_name=compression_name) / 'bag_0.mcap'
    messages = messages_of(whole)
    (tmp_path / 'cut.mcap').write_bytes(whole.read_bytes()[:chunks_of(whole)[0][0] - 3000])
    result, = recover(tmp_path / 'cut.mcap')
    assert result.messages < chunks_of(whole)[0][1]
    assert messages_of(tmp_path / 'cut.mcap') == messages[:result.messages]
    assert result.certainty == 'unknown'
    assert 'nothing' not in str(result)
    assert 'about 0' not in str(result)


def test_a_cut_chunk_of_several_blocks_keeps_those_that_are_there(tmp_path):
    path = tmp_path / 'theirs.mcap'
    with open(path, 'wb') as stream:
        writer = TheirWriter(stream, chunk_size=2**20, compression=CompressionType.ZSTD)
        writer.start('ros2', 'theirs')
        schema = writer.register_schema('std_msgs/msg/Float64', 'ros2msg', b'float64 data')
        channel = writer.register_channel('/x', 'cdr', schema)
        for k in range(20_000):
            writer.add_message(channel, START + k, os.urandom(20), START + k, k)
        writer.finish()
    messages = messages_of(path)
    os.truncate(path, path.stat().st_size // 2)
    result, = recover(path)
    assert messages_of(path) == messages[:result.messages]
    assert result.messages > 5000


def test_whole_recording_is_left_alone(recording):
    before = {path.name: path.read_bytes() for path in recording.iterdir()}
    result, = recover(recording)
    assert str(result) == f'{recording}/racket_0.mcap: whole, 4002 messages'
    assert {path.name: path.read_bytes() for path in recording.iterdir()} == before


def test_metadata_yaml_comes_back_as_it_was(tmp_path):
    path = write(tmp_path / 'bag', split_seconds=0.2)
    before = (path / 'metadata.yaml').read_text()
    for text in (
        None,
        '',
        before.replace('message_count: 1000', 'message_count: 999'),
        'x: [',
        'rosbag2_bagfile_information: 1',
    ):
        (path / 'metadata.yaml').write_text(text) if text is not None else (
            path / 'metadata.yaml'
        ).unlink()
        recover(path)
        told, there = (
            yaml.safe_load(one) for one in (before, (path / 'metadata.yaml').read_text())
        )
        if text and 'count: 999' in text:
            assert (
                there['rosbag2_bagfile_information']['message_count']
                == told['rosbag2_bagfile_information']['message_count']
            )
        else:
            assert there == told


def counted(path):
    return yaml.safe_load(path.read_text())['rosbag2_bagfile_information']


@pytest.mark.parametrize('change', [
    lambda bag: bag['files'][0].update(message_count=7),
    lambda bag: bag['files'][1].update(path='other_1.mcap'),
    lambda bag: bag.update(message_count=7)])
def test_metadata_yaml_that_counts_otherwise_is_written_anew_and_no_other(tmp_path, change):
    path = write(tmp_path / 'bag', count=60, block=10, split_seconds=0.02)
    file = path / 'metadata.yaml'
    whole, noted = counted(file), file.read_text() + '# noted by hand\n'
    file.write_text(noted)
    assert not any(result.changed for result in recover(path))
    assert file.read_text() == noted
    bag = counted(file)
    assert len(bag['files']) > 1
    change(bag)
    file.write_text(yaml.safe_dump({'rosbag2_bagfile_information': bag}))
    recover(path)
    assert counted(file) == whole


FILE = '{path: x_0.mcap, message_count: 3}'


@pytest.mark.parametrize('text', [
    f'{{message_count: 3, files: [{FILE}, {{path: 1, message_count: 3}}]}}',
    f"{{message_count: 3, files: [{FILE}, {{path: y, message_count: '3'}}]}}",
    f"{{message_count: '3', files: [{FILE}]}}", f'{{message_count: 3, files: [{FILE}, 5]}}',
    '{message_count: 3, files: 5}', f'{{files: [{FILE}]}}'])
def test_metadata_yaml_that_makes_no_sense_tells_nothing(tmp_path, text):
    (tmp_path / 'metadata.yaml').write_text(f'rosbag2_bagfile_information: {text}\n')
    assert _told(tmp_path) == {}


def test_metadata_yaml_tells_the_messages_of_each_file(tmp_path):
    (tmp_path / 'metadata.yaml').write_text(
        f'rosbag2_bagfile_information: {{message_count: 3, files: [{FILE}]}}\n')
    assert _told(tmp_path)['files'] == [{'path': 'x_0.mcap', 'message_count': 3}]


@pytest.mark.parametrize(('filename', 'named'), [(None, 'recover'), ('a/b.mcap', 'a/b.mcap')])
def test_a_disk_that_refuses_is_named(monkeypatch, capsys, filename, named):
    def refuses(path):
        raise OSError(errno.ENOSPC, 'No space left on device', filename)
    monkeypatch.setattr('rigid_body_sim.recording.recover.recover', refuses)
    assert main(['x']) == 1
    assert capsys.readouterr().err == (
        f'{named}: the disk refuses (No space left on device); make room and run it again\n')


def test_split_recording_cut_in_its_last_file(tmp_path):
    path = write(tmp_path / 'bag', split_seconds=0.3)
    last = sorted(path.glob('*.mcap'))[-1]
    os.truncate(last, 9000)
    (path / 'metadata.yaml').unlink()
    results = recover(path)
    assert [result.changed for result in results] == [False, False, True]
    with Reader(path) as reader:
        assert reader.message_count == sum(result.messages for result in results)
    assert (
        yaml.safe_load((path / 'metadata.yaml').read_text())['rosbag2_bagfile_information'][
            'custom_data'
        ]
        == ABOUT
    )


def damaged(path, place):
    """Change a byte of the fourth chunk's data, counted from its end; return what was there."""
    end, content = chunks_of(path)[3][0], bytearray(path.read_bytes())
    content[end + place] ^= 0x55
    path.write_bytes(content)
    return bytes(content)


def test_messages_under_a_wrong_checksum_are_kept_and_said_to_be_doubtful(tmp_path):
    whole = write(tmp_path / 'bag', compression_name='none') / 'bag_0.mcap'
    messages, content = messages_of(whole), damaged(whole, -2000)
    result, = recover(whole)
    found = messages_of(whole)
    assert sum(one != other for one, other in zip(found, messages, strict=True)) == 1
    assert (result.lost_messages, result.doubtful_messages) == (0, 400)
    assert '400 of them are doubtful: the checksum over them is wrong' in str(result)
    assert str(result).endswith('the file as it was: bag_0.mcap.orig')
    assert (whole.parent / 'bag_0.mcap.orig').read_bytes() == content
    with open(whole, 'rb') as stream:       # no checksum vouches for them
        chunks = [record for record in StreamReader(stream, emit_chunks=True).records
                  if isinstance(record, Chunk)]
    assert [chunk.uncompressed_crc == 0 for chunk in chunks] == [k == 3 for k in range(10)]
    assert recover(whole)[0].changed is False


def test_a_chunk_that_cannot_be_decompressed_is_counted_by_its_indexes(tmp_path):
    whole = write(tmp_path / 'bag') / 'bag_0.mcap'
    messages, begin = messages_of(whole), chunks_of(whole)[2][0]
    content = bytearray(whole.read_bytes())
    content[content.index(b'zstd', begin) + 12] ^= 1       # what a zstd frame begins with
    for cut in (0, content.rindex(HEAD.pack(Opcode.DATA_END, 4))):
        path = tmp_path / f'{cut}.mcap'
        path.write_bytes(content[:cut or None])
        result, = recover(path)
        assert messages_of(path) == messages[:1202] + messages[1602:]
        assert (result.lost_messages, result.certainty) == (400, 'unknown' if cut else 'counted')
        assert result.lost_seconds == pytest.approx(0.101, abs=0.002)


def test_lost_messages_between_two_chunks_are_counted_by_their_sequence(tmp_path):
    whole = write(tmp_path / 'bag') / 'bag_0.mcap'
    messages, content = messages_of(whole), bytearray(whole.read_bytes())
    begin, end = chunks_of(whole)[2][0], content.rindex(HEAD.pack(Opcode.DATA_END, 4))
    stop = content.index(b'zstd', chunks_of(whole)[3][0]) - 41
    content[begin + 6600:stop] = random.Random(8).randbytes(stop - begin - 6600)
    whole.write_bytes(content[:end])
    (tmp_path / 'bag' / 'metadata.yaml').unlink()
    result, = recover(whole)
    assert messages_of(whole) == messages[:1202] + messages[1602:]
    assert (result.lost_messages, result.certainty) == (400, 'unknown')


@pytest.mark.parametrize('moment', ['written', 'verified'])
def test_a_mending_that_dies_leaves_the_original(tmp_path, monkeypatch, moment):
    whole = write(tmp_path / 'bag') / 'bag_0.mcap'
    content = damaged(whole, -2000)
    name = {'written': '_verify', 'verified': 'read_metadata'}[moment]

    def dies(*_):
        raise OSError(errno.ENOSPC, 'No space left on device')
    monkeypatch.setattr(mending, name, dies)
    assert main([str(whole)]) == 1
    assert whole.read_bytes() == content
    assert sorted(path.name for path in whole.parent.iterdir()) == ['bag_0.mcap', 'metadata.yaml']


@pytest.mark.parametrize('compression', list(CompressionType))
def test_recording_of_another_writer_with_its_channels_inside_the_chunks(tmp_path, compression):
    path = tmp_path / 'theirs.mcap'
    with open(path, 'wb') as stream:
        writer = TheirWriter(stream, chunk_size=2000, compression=compression)
        writer.start('ros2', 'theirs')
        schema = writer.register_schema('std_msgs/msg/Float64', 'ros2msg', b'float64 data')
        channel = writer.register_channel('/x', 'cdr', schema)
        for k in range(1000):
            writer.add_message(channel, START + k, b'\0\1\0\0' + os.urandom(8), START + k, k)
        writer.finish()
    messages, content = messages_of(path), path.read_bytes()
    for offset in range(300, len(content), len(content) // 12):
        path.write_bytes(content[:offset])
        result, = recover(path)
        kept = messages_of(path)
        assert kept == messages[:len(kept)]
        assert len(kept) == result.messages >= (offset - 300) // 80 - 60


def test_zeros_of_a_power_cut_are_cut_off(tmp_path):
    whole = write(tmp_path / 'bag') / 'bag_0.mcap'
    messages = messages_of(whole)
    end = chunks_of(whole)[6][0]
    content = whole.read_bytes()
    whole.write_bytes(content[:end] + bytes(8192))
    recover(whole)
    assert messages_of(whole) == messages[:2802]


@pytest.mark.parametrize('size', [0, 1, 8, 9, 20, 40])
def test_file_cut_in_its_very_head_becomes_an_empty_one(tmp_path, recording, size):
    path = tmp_path / 'cut.mcap'
    path.write_bytes((recording / 'racket_0.mcap').read_bytes()[:size])
    result, = recover(path)
    assert result.messages == 0
    assert messages_of(path) == []
    assert recover(path)[0].changed is False


def test_lengths_that_lie_are_cut_off(tmp_path):
    path = tmp_path / 'liar.mcap'
    head = MCAP0_MAGIC + to_bytes(Header('ros2', 'x'))
    for lie in (HEAD.pack(Opcode.CHUNK, 2**63), HEAD.pack(Opcode.ATTACHMENT, 2**62) + bytes(99),
                to_bytes(Chunk('zstd', b'short', 2, 1, 0, 2**60)),
                HEAD.pack(Opcode.SCHEMA, 6) + b'\1\0\xff\xff\xff\xff'):
        path.write_bytes(head + lie)
        assert recover(path)[0].messages == 0
        assert messages_of(path) == []


def test_what_cannot_be_recovered_is_refused(tmp_path, recording, capsys):
    (tmp_path / 'text.mcap').write_text('not a recording')
    (tmp_path / 'empty').mkdir()
    for path, problem in (
        (tmp_path / 'text.mcap', 'is not an MCAP file'),
        (tmp_path / 'empty', 'holds no .mcap file'),
        (tmp_path / 'nowhere', 'cannot be read'),
    ):
        with pytest.raises(BadInput, match=problem):
            recover(path)
    assert main([str(tmp_path / 'nowhere')]) == 2
    assert capsys.readouterr().err.count('\n') == 1
    assert (tmp_path / 'text.mcap').read_text() == 'not a recording'


def test_recording_that_goes_on_is_not_touched(recording):
    with open(recording / 'racket_0.mcap', 'rb') as stream:
        fcntl.flock(stream, fcntl.LOCK_EX)
        with pytest.raises(BadInput, match='is still being recorded'):
            recover(recording)
