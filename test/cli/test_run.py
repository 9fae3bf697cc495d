# SPDX-License-Identifier: Apache-2.0
"""The command `run`: node, recording and report in one go, as `make run` starts it."""

import json
import os
import pathlib
import signal
import time

import pytest
from near import near

pytest.importorskip('rclpy')

from rigid_body_sim.recording.reader import Recording

ROOT = pathlib.Path(__file__).resolve().parents[2]


def options(domain, folder):
    return {'cwd': folder, 'env': {**domain.environment, 'PYTHONPATH': str(ROOT)}}


def recorded(folder):
    [path] = [path for path in (folder / 'recordings').iterdir()
              if not path.name.endswith('_report')]
    return path


def test_it_records_and_reports(ros_domain, tmp_path):
    done = ros_domain.run('-m', 'rigid_body_sim', 'run', '--rate', '500', '--duration', '2',
                          **options(ros_domain, tmp_path))
    assert done.returncode == 0, done.stderr
    path = recorded(tmp_path)
    assert path.name.startswith('tennis_racket_')
    report = path.with_name(f'{path.name}_report')
    text = (report / 'report.txt').read_text()
    assert text in done.stdout and text.startswith('tennis_racket: exact, 500 Hz, by sim_node')
    files = [report.relative_to(tmp_path) / name
             for name in ('report.txt', 'report.json', 'overview.png')]
    *_, first, second, third, heading, analyze, view = done.stdout.splitlines()
    assert [first, second, third] == [f'  {file}' for file in files]
    assert heading == 'next:'
    assert f' analyze {path.relative_to(tmp_path)} ' in analyze
    assert f' view {path.relative_to(tmp_path)} ' in view
    [body] = json.loads((report / 'report.json').read_text())['bodies']
    assert body['timing']['ticks'] + body['left_out_by_recorder'] == 1001
    assert body['timing']['achieved_rate'] == near(500.0, rel=0.02)
    assert body['energy']['largest_residual'] < 1e-14
    assert Recording(path).about['made_by'] == 'sim_node'
    assert (report / 'overview.png').read_bytes().startswith(b'\x89PNG')


@pytest.mark.parametrize(('number', 'status'), [(signal.SIGINT, 0), (signal.SIGTERM, 143)])
def test_a_signal_ends_the_node_and_leaves_a_whole_recording(ros_domain, tmp_path, number, status):
    with ros_domain.process('-m', 'rigid_body_sim', 'run', '--duration', '0',
                            **options(ros_domain, tmp_path)) as process:
        deadline = time.monotonic() + 60.0
        while not any(file.stat().st_size > 200_000
                      for file in tmp_path.glob('recordings/*/*.mcap')):
            assert process.poll() is None and time.monotonic() < deadline, process.stderr.read()
            time.sleep(0.1)
        process.send_signal(number)     # to this process alone: it passes it on
        output, error = process.communicate(timeout=30)
    assert process.returncode == status, error
    path = recorded(tmp_path)
    assert Recording(path).topics['/pose'].count > 1000
    # a user who presses Ctrl-C wants the report
    assert ('drops' in output) == (number == signal.SIGINT)
    assert path.with_name(f'{path.name}_report').is_dir() == (number == signal.SIGINT)


def test_bad_input_is_the_node_s_one_line(ros_domain, tmp_path):
    done = ros_domain.run(
        '-m', 'rigid_body_sim', 'run', '--scene', 'racket', **options(ros_domain, tmp_path))
    assert done.returncode == 2
    [line] = done.stderr.splitlines()
    assert 'did you mean tennis_racket?' in line
    assert not os.path.exists(tmp_path / 'recordings')
