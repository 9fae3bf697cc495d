# SPDX-License-Identifier: Apache-2.0
"""The linters of ROS 2 where they are installed, the header of each source file, loose bounds.

ament_copyright is not run: it knows no SPDX header (ament_lint #462).
"""

import ast
import os
import pathlib
import shutil
import subprocess

import pytest

TEST = pathlib.Path(__file__).resolve().parent
ROOT = TEST.parent
CLEAN = {name: value for name, value in os.environ.items()
         if name not in ('PYTHONPATH', 'AMENT_PREFIX_PATH')}


def sources():
    """Return the Python files of the package and of what is installed with it."""
    return sorted([*ROOT.glob('*.py'), *(
        path for folder in ('examples', 'launch', 'rigid_body_sim', 'requirements')
        for path in (ROOT / folder).rglob('*.py'))])


def lint(program, *arguments):
    """Run a linter of ROS on the sources."""
    if not shutil.which(program):
        pytest.skip(f'{program} is not installed')
    done = subprocess.run([program, *arguments], cwd=ROOT, env=CLEAN, capture_output=True,
                          text=True, timeout=120)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]


def test_ament_flake8():
    lint('ament_flake8', '--config', 'test/ament_flake8.ini', *map(str, sources()))


def test_ament_pep257():
    # ruff checks D401 (it knows properties, which are nouns); the other two are its exceptions too
    lint('ament_pep257', '--convention', 'numpy', '--add-ignore', 'D104', 'D105', 'D401', '--',
         *map(str, sources()))


def test_ament_xmllint():
    lint('ament_xmllint', 'package.xml')


def test_every_source_file_has_its_license_on_the_first_line():
    for path in sources():
        lines = path.read_text().splitlines()
        first = next((line for line in lines if not line.startswith('#!')), None)
        assert not lines or first == '# SPDX-License-Identifier: Apache-2.0', path


def test_a_relative_bound_says_what_absolute_one_stands_beside_it():
    """``pytest.approx(x, rel=1e-15)`` accepts 1e-12 as well: near.py does not."""
    loose = []
    for path in sorted(TEST.rglob('*.py')):
        for part in ast.walk(ast.parse(path.read_text())):
            if isinstance(part, ast.Call) and ast.unparse(part.func).endswith('approx'):
                named = {one.arg for one in part.keywords}
                if 'rel' in named and 'abs' not in named:
                    loose.append(f'{path.relative_to(TEST)}:{part.lineno}')
    assert loose == []
