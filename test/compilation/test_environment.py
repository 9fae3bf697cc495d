# SPDX-License-Identifier: Apache-2.0
"""The folder of compiled kernels: whose it is, where it lies, and when it goes."""

import os
import platform
import types

import pytest

from rigid_body_sim.compilation import environment

pytestmark = pytest.mark.without_numba
DAY = 86400.0


@pytest.fixture
def folder_of(tmp_path, monkeypatch):
    """Return a function that asks for the folder anew, with a key and a home of its own."""
    monkeypatch.setattr(environment, 'HAVE_NUMBA', True)
    monkeypatch.setattr(environment, 'sources_key', lambda: 'key')
    monkeypatch.setattr(environment.tempfile, 'gettempdir', lambda: str(tmp_path / 'temporary'))
    monkeypatch.setenv('HOME', str(tmp_path / 'home'))
    monkeypatch.delenv('XDG_CACHE_HOME', raising=False)
    return environment.cache_folder.__wrapped__


def test_compiled_code_lies_in_the_cache_of_the_user(folder_of, tmp_path, monkeypatch):
    assert folder_of() == tmp_path / 'home' / '.cache' / 'rigid_body_sim' / 'key'
    monkeypatch.setenv('XDG_CACHE_HOME', str(tmp_path / 'cache'))
    for _ in range(2):    # the second time it is there
        assert folder_of() == tmp_path / 'cache' / 'rigid_body_sim' / 'key'
    monkeypatch.setattr(environment, 'HAVE_NUMBA', False)
    assert folder_of() is None


def test_others_cannot_put_code_into_it(folder_of):
    assert folder_of().stat().st_mode & 0o777 == 0o700


def test_where_a_cache_cannot_be_made_the_temporary_folder_serves(
        folder_of, tmp_path, monkeypatch):
    (tmp_path / 'file').write_text('')
    monkeypatch.setenv('XDG_CACHE_HOME', str(tmp_path / 'file'))
    assert folder_of() == tmp_path / 'temporary' / f'rigid_body_sim-{os.getuid()}' / 'key'


def test_a_folder_of_somebody_else_is_not_used(folder_of, monkeypatch):
    """Whoever owns it could exchange the code that is run."""
    folder_of()
    user = os.getuid() + 1
    monkeypatch.setattr(os, 'getuid', lambda: user)
    assert folder_of() is None


def test_what_was_not_used_for_a_month_goes(tmp_path, monkeypatch):
    now = 1000.0 * DAY
    for name, age in (('new', 0.0), ('a month', 30.0), ('older', 30.0 + 1.0 / 64.0)):
        (tmp_path / name).mkdir()
        (tmp_path / name / 'kernel').write_text('')
        os.utime(tmp_path / name, (now - age * DAY, now - age * DAY))
    monkeypatch.setattr(environment, 'time', types.SimpleNamespace(time=lambda: now))
    (tmp_path / 'no folder').write_text('')    # nor is this a cache
    os.utime(tmp_path / 'no folder', (0.0, 0.0))
    environment._remove_unused(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ['a month', 'new', 'no folder']


@pytest.mark.parametrize(('told', 'name'), [('', 'riscv64'), ('rv64gc', 'rv64gc')])
def test_without_numba_a_processor_has_the_name_that_python_knows(monkeypatch, told, name):
    monkeypatch.setattr(environment, 'HAVE_NUMBA', False)
    monkeypatch.setattr(platform, 'processor', lambda: told)
    monkeypatch.setattr(platform, 'machine', lambda: 'riscv64')
    assert environment.processor() == name


@pytest.mark.parametrize(('given', 'expected'), [
    ((None, None), 'host +own'), (('generic', None), 'generic +own'),
    (('generic', '+sse2'), 'generic +sse2'), (('generic', ''), 'generic '),
    (('', '+sse2'), 'host +sse2')])
def test_a_processor_is_the_one_that_numba_compiles_for(monkeypatch, given, expected):
    monkeypatch.setattr(environment, 'HAVE_NUMBA', True)
    monkeypatch.setattr(environment, '_host', lambda: ('host', '+own'))
    monkeypatch.setattr(environment, 'numba', types.SimpleNamespace(
        config=types.SimpleNamespace(CPU_NAME=given[0], CPU_FEATURES=given[1])))
    assert environment.processor() == expected
