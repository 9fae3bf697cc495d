# SPDX-License-Identifier: Apache-2.0
"""recording/mcap/ could leave this package: it imports nothing else of it."""

import ast
import pathlib

import pytest

import rigid_body_sim

OURS = 'rigid_body_sim.recording.mcap'
FOLDER = pathlib.Path(rigid_body_sim.__file__).parent / 'recording' / 'mcap'


@pytest.mark.parametrize('path', sorted(FOLDER.glob('*.py')), ids=lambda path: path.stem)
def test_nothing_else_of_the_package_is_imported(path):
    names = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom):
            assert not node.level
            names.add(node.module)
        elif isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
    mine = {name for name in names if name.split('.')[0] == 'rigid_body_sim'}
    assert all(name == OURS or name.startswith(f'{OURS}.') for name in mine), mine


@pytest.mark.parametrize('path', sorted(FOLDER.glob('[a-z]*.py')), ids=lambda path: path.stem)
def test_every_file_says_why_it_is_not_left_to_the_library(path):
    about = ast.get_docstring(ast.parse(path.read_text()))
    assert 'Why not' in about or (path.stem == 'records' and "the library's" in about)
