# SPDX-License-Identifier: Apache-2.0
"""The rooms of the package: imports run one way, from higher rooms to lower ones.

The source is read, not run, so an import inside a function counts like any other.
"""

import ast
import functools
import graphlib
import pathlib

import pytest

PACKAGE = pathlib.Path(__file__).resolve().parent.parent / 'rigid_body_sim'
ROOMS = ('errors', 'command_line', 'compilation', 'numerics', 'scene', 'theory', 'mechanics',
         'motions', 'integrators', 'choice', 'simulation', 'drawing', 'messages', 'recording',
         'sweeps', 'analysis', 'study', 'realtime', 'node', 'view', 'cli')
"""Rooms from the ground up: one may import those before it. The front door is above them all."""
FRONT_DOOR = ('__init__', '__main__', 'testing')
ROS = ('rclpy', 'rcl_interfaces', 'rosidl_runtime_py', 'std_srvs')
"""Packages that only ROS has, besides those whose names end in _msgs."""


def room_of(module):
    """Return the room of a dotted module below the package, without the package's name."""
    return module.partition('.')[0]


def module_of(path):
    """Return the dotted name of a source file of the package."""
    parts = path.relative_to(PACKAGE.parent).with_suffix('').parts
    return '.'.join(parts).removesuffix('.__init__')


def imports_of(path, name):
    """Yield (line, imported module) of a source file; `name` is its own dotted name."""
    for part in ast.walk(ast.parse(path.read_text())):
        if isinstance(part, ast.Import):
            for alias in part.names:
                yield part.lineno, alias.name
        elif isinstance(part, ast.ImportFrom):
            assert not part.level, f'{name}:{part.lineno} imports relatively'
            yield part.lineno, part.module
            if part.module == 'rigid_body_sim':
                yield from ((part.lineno, f'rigid_body_sim.{alias.name}') for alias in part.names)
        elif (isinstance(part, ast.Call) and part.args and isinstance(part.args[0], ast.Constant)
                and 'import_module' in ast.unparse(part.func)):
            yield part.lineno, part.args[0].value


@functools.cache
def arrows():
    """Return (module, line, imported module) of each import in the package."""
    found = []
    for path in sorted(PACKAGE.rglob('*.py')):
        name = '.'.join(path.relative_to(PACKAGE).with_suffix('').parts)
        found += [(name, line, imported) for line, imported in imports_of(path, name)]
    return found


def test_every_folder_is_a_room_that_has_its_place():
    found = {path.name for path in PACKAGE.iterdir() if (path / '__init__.py').exists()}
    found |= {path.stem for path in PACKAGE.glob('*.py')}
    assert found - set(ROOMS) - set(FRONT_DOOR) == set()


def test_no_arrow_points_upwards():
    wrong = []
    for name, line, imported in arrows():
        below = imported.removeprefix('rigid_body_sim.')
        if not imported.startswith('rigid_body_sim.') or room_of(name) in FRONT_DOOR:
            continue
        here, there = room_of(name), room_of(below)
        if there not in FRONT_DOOR and ROOMS.index(there) > ROOMS.index(here):
            wrong.append(f'{name}:{line} imports {below}: {here} is below {there}')
    assert wrong == []


def test_nothing_below_the_node_imports_ros():
    wrong = [f'{name}:{line} imports {imported}' for name, line, imported in arrows()
             if room_of(name) not in (*FRONT_DOOR, 'view')
             and ROOMS.index(room_of(name)) < ROOMS.index('node')
             and (imported.split('.')[0] in ROS or imported.split('.')[0].endswith('_msgs'))]
    assert wrong == []


def test_no_room_is_in_a_circle():
    """Follow the imports between rooms from each of them: none leads back, in any order."""
    leads_to = {}
    for name, _, imported in arrows():
        if imported.startswith('rigid_body_sim.') and room_of(name) not in FRONT_DOOR:
            there = room_of(imported.removeprefix('rigid_body_sim.'))
            if there != room_of(name) and there not in FRONT_DOOR:
                leads_to.setdefault(room_of(name), set()).add(there)

    def follow(room, way):
        assert room not in way, f'a circle: {" -> ".join([*way[way.index(room):], room])}'
        for there in sorted(leads_to.get(room, ())):
            follow(there, [*way, room])
    for room in leads_to:
        follow(room, [])


def test_no_module_is_in_a_circle():
    """Imports inside functions count: they save time, and hide no circle."""
    modules = {module_of(path) for path in PACKAGE.rglob('*.py')}
    leads_to = {}
    for path in PACKAGE.rglob('*.py'):
        for part in ast.walk(ast.parse(path.read_text())):
            if isinstance(part, ast.ImportFrom):
                leads_to.setdefault(module_of(path), set()).update(
                    inner if (inner := f'{part.module}.{alias.name}') in modules else part.module
                    for alias in part.names)
    try:
        graphlib.TopologicalSorter(leads_to).prepare()
    except graphlib.CycleError as error:
        raise AssertionError(f'a circle: {" -> ".join(reversed(error.args[1]))}') from None


@pytest.mark.parametrize(
    'room', [room for room in ROOMS if (PACKAGE / room / '__init__.py').exists()])
def test_a_room_says_what_lives_there(room):
    about = ast.get_docstring(ast.parse((PACKAGE / room / '__init__.py').read_text()))
    assert about, f'rigid_body_sim/{room}/__init__.py says nothing'
    assert 'import' in about, f'rigid_body_sim/{room}/__init__.py does not say what it may import'



def test_folders_of_tests_are_those_of_the_package():
    test = PACKAGE.parent / 'test'
    folders = {path.parent.relative_to(test) for path in test.rglob('test_*.py')}
    assert all((PACKAGE / folder).is_dir()
               for folder in folders - {pathlib.Path('hard_cases')}), folders
