# SPDX-License-Identifier: Apache-2.0
"""The two commands on machines other than this one: a sourced ROS, no fitting Python."""

import os
import pathlib
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent
SOURCED = {
    'AMENT_PREFIX_PATH': '/opt/ros/jazzy', 'CMAKE_PREFIX_PATH': '/opt/ros/jazzy',
    'COLCON_PREFIX_PATH': '/ws/install',
    'LD_LIBRARY_PATH': '/opt/ros/jazzy/lib',
    'PYTHONPATH': '/opt/ros/jazzy/lib/python3.12/site-packages',
    'RMW_IMPLEMENTATION': 'rmw_cyclonedds_cpp', 'ROS_DISTRO': 'jazzy',
    '_ROS_WHEELS_BOOTSTRAP_COMPLETE': '1',
}

pytestmark = pytest.mark.skipif(not shutil.which('make'), reason='needs make')


def make(*arguments, environment, extra=''):
    return subprocess.run(['make', '--no-print-directory', '-f', '-', *arguments],
                          input=f'include Makefile\n{extra}', cwd=ROOT, env=environment,
                          capture_output=True, text=True, timeout=30)


def test_a_sourced_ros_is_unset_and_said_in_one_line():
    clean = {name: value
             for name, value in os.environ.items()
             if name not in SOURCED and name not in ('MAKEFLAGS', 'MFLAGS', 'MAKELEVEL')}
    shown = make('shown', environment={**clean, **SOURCED, 'ROS_DOMAIN_ID': '7'},
                 extra='shown: ; @env\n').stdout.splitlines()
    assert set(shown[0].partition(': ')[2].split()) == set(SOURCED)
    seen = dict(line.partition('=')[::2] for line in shown[1:])
    assert {name: seen.get(name) for name in SOURCED} == {
        **dict.fromkeys(SOURCED), 'AMENT_PREFIX_PATH': f'{ROOT}/.venv'}
    assert seen['ROS_DOMAIN_ID'] == '7'     # the user's own choice stays
    assert make('shown', environment=clean,
                extra='shown: ; @echo nothing to say\n').stdout == 'nothing to say\n'


def test_the_soak_runs_each_file_that_leaves_cases_to_it():
    recipe = (ROOT / 'Makefile').read_text().partition('\nsoak:')[2].partition('\n\n')[0]
    run = [ROOT / word for word in recipe.split() if word.startswith('test/')]
    leave = [file for file in (ROOT / 'test').rglob('test_*.py')
             if '\nfrom soak import ' in file.read_text()]
    assert len(leave) > 50
    assert [file for file in leave if not any(file.is_relative_to(place) for place in run)] == []


TOOLS = 'chmod', 'cp', 'dirname', 'false', 'grep', 'ln', 'ls', 'mkdir', 'sed', 'sh', 'uname'


def make_venv(folder, *versions, pythons):
    """Run make_venv.sh on a machine with a POSIX shell and the given Pythons only.

    Pythons are given as name -> shell script.
    """
    tools = folder / 'bin'
    tools.mkdir()
    for name in TOOLS:
        (tools / name).symlink_to(shutil.which(name))
    for name, script in pythons.items():
        (tools / name).write_text(f'#!/bin/sh\n{script}\n')
        (tools / name).chmod(0o755)
    return subprocess.run(
        [ROOT / 'requirements' / 'make_venv.sh', folder / '.venv', 'pins', *versions],
        env={'PATH': tools, 'HOME': tools}, capture_output=True, text=True, timeout=30)


OLD = """case "$1" in -V) echo Python 3.10.12;; *) exit 1;; esac"""
WITHOUT_VENV = """case "$2" in *ensurepip*) exit 1;; *print*) echo python3.12-venv;; esac"""


@pytest.mark.parametrize(
    ('pythons', 'said'),
    [({}, 'needs Python 3.11, 3.12 or 3.13, found no python3;'),
     ({'python3': OLD}, 'needs Python 3.11, 3.12 or 3.13, found python3 = Python 3.10.12;'),
     ({'python3': OLD, 'python3.12': WITHOUT_VENV},
      'lacks the module venv or ensurepip; install it (Debian, Ubuntu: apt install '
      'python3.12-venv)')])
def test_a_machine_without_a_fitting_python_gets_one_clear_line(tmp_path, pythons, said):
    result = make_venv(tmp_path, '3.11', '3.12', '3.13', pythons=pythons)
    assert result.returncode == 1
    [line] = result.stderr.splitlines()
    assert said in line
    assert not (tmp_path / '.venv').exists()


def test_another_python_is_found_where_python3_is_too_old(tmp_path):
    made = tmp_path / 'made'
    fitting = f"""case "$*" in *venv\\ --clear*) echo "$0" > {made}; exit 7;; esac"""
    result = make_venv(tmp_path, '3.12', pythons={'python3': OLD, 'python3.12': fitting})
    assert result.returncode == 7, result.stderr
    assert made.read_text().strip().endswith('python3.12')


@pytest.mark.parametrize('pip', [
    '*config*) echo global.index-url=mirror;; *--target*) exit 7;;',
    '*--target*) exit 1;;',
    '*--target*) mkdir -p $V/uv/bin; ln -s "$(command -v false)" $V/uv/bin/uv;;'],
    ids=['pip has a mirror', 'there is no uv', 'uv fails'])
def test_where_uv_cannot_fetch_pip_does(tmp_path, pip):
    made, environment = tmp_path / 'made', tmp_path / '.venv'
    result = make_venv(tmp_path, '3.12', pythons={'python3': f"""V={environment}
case "$*" in
    *venv\\ --clear*) mkdir -p $V/bin $V/lib/python3.12/site-packages; cp "$0" $V/bin/python;;
    {pip}
    *pip\\ --disable*) echo "$*" > {made};;
esac"""})
    assert (result.returncode, result.stderr) == (0, '')
    assert made.read_text().endswith('install --quiet --no-compile --no-deps -r pins\n')
