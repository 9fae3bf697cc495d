# SPDX-License-Identifier: Apache-2.0
"""The installed package agrees with package.xml, setup.py, requirements/, config/ and launch/."""

import ast
import importlib
import pathlib
import re
import subprocess
import sys
import xml.etree.ElementTree

import pytest
import yaml

from rigid_body_sim import __main__ as shell
from rigid_body_sim.cli.subcommands import SUBCOMMANDS

ROOT = pathlib.Path(__file__).resolve().parent.parent
PACKAGE = ROOT / 'rigid_body_sim'
SOURCES = sorted(PACKAGE.rglob('*.py'))

# import name -> key of package.xml; a name without a key is optional, imported only where it is
# used, and its absence does no harm
KEYS = {
    'yaml': 'python3-yaml',
    **{name: f'python3-{name}'
       for name in ('jsonschema', 'matplotlib', 'mpmath', 'numpy', 'scipy', 'tqdm')},
    **{name: name for name in (
        'builtin_interfaces', 'diagnostic_msgs', 'geometry_msgs', 'lifecycle_msgs', 'nav_msgs',
        'rcl_interfaces', 'rclpy', 'rosgraph_msgs',
        'sensor_msgs', 'std_msgs', 'std_srvs', 'tf2_msgs', 'visualization_msgs')},
}
OPTIONAL = {'distributed', 'llvmlite', 'lz4', 'mcap', 'numba', 'pandas', 'plotly', 'pyarrow',
            'rosbags', 'viser', 'websockets', 'xarray', 'zarr', 'zstandard'}
COMES_WITH = {'llvmlite': 'numba', 'websockets': 'viser'}
# import names of what work_precision --peers and hard_cases --peers measure; requirements/peers.in
# lists them
PEERS = {'Basilisk': 'bsk', 'exudyn': 'exudyn', 'heyoka': 'heyoka', 'jpype': 'JPype1',
         'mujoco': 'mujoco', 'orekit_jpype': 'orekit-jpype', 'pinocchio': 'pin',
         'pybullet': 'pybullet', 'pydrake': 'drake'}


def dependencies(tag):
    """Return the keys under one tag of package.xml."""
    return {element.text
            for element in xml.etree.ElementTree.parse(ROOT / 'package.xml').getroot().iter(tag)}


def imported(path):
    """Return the top-level packages that a file imports, with those of message types it names."""
    text = path.read_text()
    names = set(re.findall(r"'(\w+)/(?:msg|srv)/\w+'", text))
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition('.')[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            names.add(node.module.partition('.')[0])
    return (names - set(sys.stdlib_module_names) - {'rigid_body_sim'}
            - (set(PEERS) if 'study' in path.parts else set()))


def test_package_xml_names_what_is_imported_and_nothing_else():
    used = set().union(*map(imported, SOURCES))
    assert used <= set(KEYS) | OPTIONAL
    needed = {KEYS[name] for name in used - OPTIONAL}
    # ros2 launch runs the files of launch/
    assert dependencies('exec_depend') == needed | {'launch', 'launch_ros', 'lifecycle_msgs',
                                                    'ros2launch'}


def test_requirements_name_what_is_imported():
    used = set().union(*map(imported, SOURCES))
    named = ''.join((ROOT / 'requirements' / f'{name}.in').read_text().lower()
                    for name in ('run', 'test'))
    for name in used - set(KEYS) | {name
                                    for name in used if KEYS.get(name, '').startswith('python3-')}:
        assert re.search(rf'^(py)?{COMES_WITH.get(name, name)}==', named, re.MULTILINE), name


def test_requirements_name_the_peers():
    used = {name for path in SOURCES if 'study' in path.parts
            for name in PEERS if name in path.read_text()}
    named = (ROOT / 'requirements' / 'peers.in').read_text()
    for name in used:
        assert re.search(rf'^{PEERS[name]}==', named, re.MULTILINE), name


def test_every_folder_is_a_package_that_gets_installed():
    for folder in {path.parent for path in SOURCES}:
        assert (folder / '__init__.py').is_file(), folder


def test_the_table_of_commands_needs_no_package():
    code = ('import sys; sys.path.insert(0, sys.argv[1]); from rigid_body_sim.cli.subcommands '
            'import SUBCOMMANDS; print(*SUBCOMMANDS)')
    listed = subprocess.run([sys.executable, '-I', '-S', '-c', code, ROOT], capture_output=True,
                            text=True, timeout=30, check=True).stdout
    assert listed.split() == list(SUBCOMMANDS)


def scripts_of(tmp_path, command):
    """Return the console scripts and the metadata that `setup.py COMMAND` would install."""
    code = (f"import sys; sys.argv = ['setup.py', {command!r}]\n"
            'from distutils.core import run_setup\n'
            "found = run_setup('setup.py', sys.argv[1:], stop_after='commandline')\n"
            'print(found.get_version(), *found.entry_points["console_scripts"], sep="\\n")')
    done = subprocess.run([sys.executable, '-c', f'import setuptools\n{code}'], cwd=ROOT,
                          check=True, timeout=60, capture_output=True, text=True)
    version, *scripts = done.stdout.splitlines()
    return version, dict(script.split(' = ') for script in scripts)


@pytest.mark.parametrize('command', ['install', 'develop'])
def test_colcon_makes_an_executable_of_every_command(tmp_path, command):
    _, scripts = scripts_of(tmp_path, command)
    # by way of the program, which hears Ctrl-C before anything slow is imported
    assert scripts == {name: f'rigid_body_sim.__main__:{name}' for name in SUBCOMMANDS}
    assert all(callable(getattr(shell, name)) for name in SUBCOMMANDS)


def test_a_wheel_has_one_command_and_the_version_of_package_xml(tmp_path):
    version, scripts = scripts_of(tmp_path, 'bdist_wheel')
    assert scripts == {'rigid_body_sim': 'rigid_body_sim.__main__:main'}
    manifest = xml.etree.ElementTree.parse(ROOT / 'package.xml').getroot()
    assert version == manifest.findtext('version')


def test_every_command_has_a_function_and_a_line_of_help():
    for name, (target, about) in SUBCOMMANDS.items():
        module, _, function = target.partition(':')
        assert callable(getattr(importlib.import_module(module), function)), name
        assert about and '\n' not in about, name


def test_the_parameter_file_is_made_from_the_table():
    parameters = pytest.importorskip('rigid_body_sim.node.parameters', reason='no ROS here')
    text = (ROOT / 'config' / 'sim_node.yaml').read_text()
    assert text == parameters.parameter_file() + '\n', (
        'run: python -m rigid_body_sim.node.parameters > config/sim_node.yaml')
    shown = yaml.safe_load(text)['/**']['ros__parameters']
    flat = {}
    for name, value in shown.items():
        flat |= ({f'{name}.{inner}': part for inner, part in value.items()}
                 if isinstance(value, dict) else {name: value})
    defaults = {entry.name: list(entry.default) if isinstance(entry.default, tuple) else
                entry.default for entry in parameters.TABLE}
    assert flat == defaults
    assert {name: type(value) for name, value in flat.items()} == \
        {name: type(value) for name, value in defaults.items()}


@pytest.mark.parametrize('pins', ['run', 'test', 'kilted', 'noble', 'noble-numba'])
def test_pins_are_exact_and_hold_what_is_asked_for(pins):
    folder = ROOT / 'requirements'
    lines = [line
             for line in (folder / f'{pins}.txt').read_text().splitlines()
             if not line.startswith('#')]
    assert all(re.fullmatch(r'[\w.-]+==[\w.]+', line) for line in lines)
    asked = folder / f'{pins}.in'
    for line in asked.read_text().splitlines() if asked.exists() else ():
        if line and line[0] not in '#-':
            assert re.sub(r'\[.*\]', '', line) in lines


def test_the_test_pins_are_the_run_pins_and_more():
    run, test = (set((ROOT / 'requirements' / f'{name}.txt').read_text().splitlines()[1:])
                 for name in ('run', 'test'))
    assert run < test


def test_the_version_is_that_of_the_manifest():
    import rigid_body_sim
    manifest = xml.etree.ElementTree.parse(ROOT / 'package.xml').getroot()
    assert rigid_body_sim.__version__ == manifest.findtext('version')
