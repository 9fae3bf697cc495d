# SPDX-License-Identifier: Apache-2.0
"""The installed package as its users run it: executables, data files, a short run of the node.

`make package` builds it and runs this.
"""

import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys

import pytest

from rigid_body_sim.cli.subcommands import SUBCOMMANDS

ROOT = pathlib.Path(__file__).resolve().parent.parent


@pytest.fixture(scope='module')
def prefix():
    """Return the folder into which the package was installed, found as `ros2 run` finds it."""
    for path in os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep):
        if (pathlib.Path(path) / 'share' / 'ament_index' / 'resource_index' / 'packages'
            / 'rigid_body_sim').is_file():
            return pathlib.Path(path)
    if 'COLCON' in os.environ:
        pytest.fail('colcon test runs this, but colcon build has not installed the package')
    return pytest.skip('the package is not installed: colcon build, and source install/setup.sh')


def run(prefix, domain, folder, name, *arguments):
    """Run an installed executable in an empty folder."""
    # the command compiles first, with other load on the machine
    return subprocess.run(
        [prefix / 'lib' / 'rigid_body_sim' / name, *arguments], cwd=folder,
        env=domain.environment, capture_output=True, text=True, timeout=240)


def test_every_command_is_installed_and_shows_its_help(prefix, ros_domain, tmp_path):
    installed = {path.name for path in (prefix / 'lib' / 'rigid_body_sim').iterdir()}
    assert installed == set(SUBCOMMANDS)
    with concurrent.futures.ThreadPoolExecutor() as pool:
        results = pool.map(lambda name: run(prefix, ros_domain, tmp_path, name, '--help'),
                           SUBCOMMANDS)
        for name, result in zip(SUBCOMMANDS, results, strict=True):
            assert (result.returncode, result.stderr) == (0, ''), name
            assert 'example' in result.stdout, name


def test_executables_run_in_the_environment_that_built_them(prefix):
    for name in SUBCOMMANDS:
        assert (prefix / 'lib' / 'rigid_body_sim'
                / name).read_text().splitlines()[0] == f'#!{sys.executable}'


def test_all_files_of_config_and_launch_are_installed(prefix):
    share = prefix / 'share' / 'rigid_body_sim'
    for folder in ('config', 'launch'):
        for path in (ROOT / folder).rglob('*'):
            if path.is_file() and path.suffix != '.pyc':
                assert (share / path.relative_to(ROOT)).read_bytes() == path.read_bytes(), path
    assert (share / 'package.xml').read_bytes() == (ROOT / 'package.xml').read_bytes()


def test_what_is_imported_is_what_was_installed(prefix, tmp_path):
    code = 'from rigid_body_sim.scene import scene; print(scene.__file__, scene.scene_folder())'
    imported = subprocess.run([sys.executable, '-c', code], cwd=tmp_path, capture_output=True,
                              text=True, timeout=60, check=True).stdout
    # colcon build --symlink-install leaves everything where it is
    home = ROOT if (prefix / 'share' / 'rigid_body_sim' / 'package.xml').is_symlink() else prefix
    assert all(pathlib.Path(path).resolve().is_relative_to(home)
               for path in imported.split()), imported


def test_simulate_gives_the_final_state(prefix, ros_domain, tmp_path):
    result = run(prefix, ros_domain, tmp_path, 'simulate', '--scene', 'tennis_racket',
                 '--duration', '2', '--json')
    assert result.returncode == 0, result.stderr
    assert json.loads(result.stdout)['state']['time'] == 2.0


def test_the_node_runs_records_and_its_recording_is_analysed(prefix, ros_domain, tmp_path):
    node = run(prefix, ros_domain, tmp_path, 'sim_node', '--ros-args', '-p', 'rate:=1000', '-p',
               'duration:=2')
    assert node.returncode == 0, node.stderr
    [recording] = (tmp_path / 'recordings').iterdir()
    report = run(prefix, ros_domain, tmp_path, 'analyze', recording, '--json')
    assert report.returncode == 0, report.stderr
    json.loads(report.stdout)
