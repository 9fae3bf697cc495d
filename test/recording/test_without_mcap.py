# SPDX-License-Identifier: Apache-2.0
"""A machine without mcap: what needs no recording runs; the rest says what to install."""

import os
import pathlib
import subprocess
import sys

import pytest
from notices import without_notices

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLOCK = "import sys; sys.modules['mcap'] = None\n"
RUN = BLOCK + 'from rigid_body_sim.__main__ import main; sys.exit(main(sys.argv[1:]))'
LINE = ('recordings: the Python package mcap is not installed; "pip install mcap" '
        '(docs/install.md), or record:=false for the node')


def run(*arguments):
    """Run a command where mcap cannot be imported; return (exit status, stdout, stderr)."""
    environment = dict(os.environ, PYTHONPATH=str(ROOT))
    done = subprocess.run([sys.executable, '-c', RUN, *map(str, arguments)], env=environment,
                          capture_output=True, text=True, timeout=120, check=False)
    return done.returncode, done.stdout, without_notices(done.stderr)


def test_simulate_runs_as_long_as_nothing_is_recorded(tmp_path):
    status, out, err = run('simulate', '--duration', '1')
    assert (status, without_notices(err)) == (0, '')
    assert 'tennis_racket by exact: 1000 ticks' in out
    assert run('simulate', '--duration', '1', '--output', tmp_path / 'run') == (2, '', LINE + '\n')
    assert not (tmp_path / 'run').exists()


@pytest.mark.parametrize('arguments', [
    ('analyze', 'RECORDING'), ('resimulate', 'RECORDING'), ('recover', 'RECORDING'),
    ('export', 'RECORDING', '--output', 'out')], ids=lambda arguments: arguments[0])
def test_commands_on_recordings_say_what_to_install_in_one_line(recording, arguments):
    arguments = [str(recording) if word == 'RECORDING' else word for word in arguments]
    assert run(*arguments) == (2, '', LINE + '\n')


def test_the_node_says_what_to_install_and_runs_on_only_without_recording(ros_domain, tmp_path):
    pytest.importorskip('rclpy')
    arguments = ('sim_node', '--ros-args', '-p', 'duration:=0.2', '-p',
                 f'recording.directory:={tmp_path}')
    refused = ros_domain.run('-c', RUN, *arguments, timeout=120)
    assert refused.returncode == 2
    assert refused.stderr.count('\n') == 1
    assert LINE in refused.stderr
    runs = ros_domain.run('-c', RUN, *arguments, '-p', 'record:=false', timeout=120)
    assert runs.returncode == 0
    assert LINE not in runs.stderr and 'Traceback' not in runs.stderr
    assert list(tmp_path.glob('*/*.mcap')) == []
