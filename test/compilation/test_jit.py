# SPDX-License-Identifier: Apache-2.0
"""Compiled code and its cache: the same code without numba, and no stale answers after an edit.

The home folder need not be writable.
"""

import ast
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

import pytest

from rigid_body_sim.compilation import environment, jit, templates
from rigid_body_sim.motions import loops

PACKAGE = pathlib.Path(jit.__file__).parents[1]
TURN = ('from rigid_body_sim.numerics.rotations import rotate\n'
        'print(rotate(0.0, 0.0, 0.6, 0.8, 1.0, 0.0, 0.0))')
needs_numba = pytest.mark.skipif(not jit.HAVE_NUMBA, reason='about the cache of compiled code')


def run(code, folder, **environment):
    """Run code in a fresh process on the package in `folder` and return what it printed."""
    # Python's own bytecode depends on the time stamp, which is not tested here
    settings = {
        **os.environ, 'PYTHONPATH': str(folder), 'PYTHONDONTWRITEBYTECODE': '1', **environment}
    return subprocess.run([sys.executable, '-c', code], env=settings, cwd=folder,
                          capture_output=True, text=True, timeout=100, check=True).stdout


@pytest.fixture
def copy_of_package(tmp_path):
    """Return a copy of the package with a cache of its own."""
    shutil.copytree(
        PACKAGE, tmp_path / 'rigid_body_sim', ignore=shutil.ignore_patterns('__pycache__'))
    return tmp_path


@needs_numba
def test_editing_a_callee_changes_the_answer_of_its_cached_caller(copy_of_package):
    cache = {'XDG_CACHE_HOME': str(copy_of_package / 'cache')}
    caller = ('from rigid_body_sim.numerics.rotations import rotate_back\n'
              'print(rotate_back(0.0, 0.0, 0.6, 0.8, 1.0, 0.0, 0.0)[0])')
    before = run(caller, copy_of_package, **cache)
    assert run(caller, copy_of_package, **cache) == before
    module = copy_of_package / 'rigid_body_sim' / 'numerics' / 'rotations.py'
    stamp = module.stat()
    module.write_text(module.read_text().replace(
        '+ qy * tz - qz * ty,', '- qy * tz + qz * ty,', 1))
    # an unpacked archive may have such a time stamp
    os.utime(module, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
    assert run(caller, copy_of_package, **cache) != before


@needs_numba
def test_two_processes_on_a_cold_cache_agree(copy_of_package):
    settings = {**os.environ, 'PYTHONPATH': str(copy_of_package),
                'XDG_CACHE_HOME': str(copy_of_package / 'cache')}
    both = [subprocess.Popen([sys.executable, '-c', TURN], env=settings, cwd=copy_of_package,
                             stdout=subprocess.PIPE, text=True) for _ in range(2)]
    answers = [process.communicate(timeout=100)[0] for process in both]
    assert answers[0] == answers[1] != ''
    assert all(process.returncode == 0 for process in both)
    # a copy installed elsewhere from the same sources finds all kernels compiled
    found = set((copy_of_package / 'cache').rglob('*.nbc'))
    shutil.copytree(
        copy_of_package / 'rigid_body_sim', copy_of_package / 'elsewhere' / 'rigid_body_sim')
    assert run(TURN, copy_of_package / 'elsewhere',
               XDG_CACHE_HOME=str(copy_of_package / 'cache')) == answers[0]
    if hasattr(jit.numba.config, 'CACHE_LOCATOR_CLASSES'):
        assert set((copy_of_package / 'cache').rglob('*.nbc')) == found


@needs_numba
def test_of_two_processes_one_compiles_and_the_other_waits_and_loads(copy_of_package):
    code = ('from rigid_body_sim.numerics.rotations import rotate\n'
            'print("ready", flush=True), input()\n'
            'rotate(0.0, 0.0, 0.6, 0.8, 1.0, 0.0, 0.0)\n'
            'found = rotate.stats\n'
            'print(sum(found.cache_misses.values()), sum(found.cache_hits.values()))')
    settings = {**os.environ, 'PYTHONPATH': str(copy_of_package),
                'XDG_CACHE_HOME': str(copy_of_package / 'cache')}
    both = [subprocess.Popen([sys.executable, '-c', code], env=settings, cwd=copy_of_package,
                             stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
            for _ in range(2)]
    assert [process.stdout.readline() for process in both] == ['ready\n'] * 2
    for process in both:
        process.stdin.write('\n')
        process.stdin.flush()
    told = [process.communicate(timeout=100)[0].strip() for process in both]
    assert sorted(told) == ['0 1', '1 0']


@needs_numba
def test_a_process_that_is_stopped_while_it_compiles_holds_another_up_for_a_while_only(
        monkeypatch):
    from rigid_body_sim.compilation import cache
    from rigid_body_sim.numerics.rotations import rotate
    monkeypatch.setattr(cache, 'PATIENCE', 0.05)
    with rotate._cache.alone():    # as another process would
        began = time.monotonic()
        with rotate._cache.alone():
            assert time.monotonic() - began >= cache.PATIENCE
        monkeypatch.setattr(cache, 'PATIENCE', 100.0)
    began = time.monotonic()
    with rotate._cache.alone():    # the lock is gone with its holder
        pass
    assert time.monotonic() - began < 50.0


@needs_numba
def test_without_a_writable_home_the_cache_is_in_the_temporary_folder(copy_of_package):
    code = 'from rigid_body_sim.compilation import environment\nprint(environment.cache_folder())'
    where = run(code, copy_of_package, XDG_CACHE_HOME='/proc/none', TMPDIR=str(copy_of_package))
    assert where.startswith(str(copy_of_package))


def test_no_kernel_lives_where_the_cache_does_not_look():
    for path in set(PACKAGE.rglob('*.py')) - set(environment.kernel_sources()):
        assert not re.search(r'compilation\.(jit|templates) import (?!HAVE_NUMBA)|@compiled',
                             path.read_text()), path


def test_constants_that_kernels_import_are_in_the_key_of_the_cache():
    """A constant is compiled into the kernels: an edit to it must recompile them."""
    sources, wrong = environment.kernel_sources(), []
    for path in sources:
        for part in ast.walk(ast.parse(path.read_text())):
            if isinstance(part, ast.ImportFrom) and part.module.startswith('rigid_body_sim.'):
                file = PACKAGE.joinpath(*part.module.split('.')[1:]).with_suffix('.py')
                wrong += [f'{path.name}: {one.name} of {part.module}' for one in part.names
                          if one.name.isupper() and file.exists() and file not in sources]
    assert wrong == []


@needs_numba
def test_importing_hashes_writes_and_deletes_nothing_and_the_first_kernel_does(copy_of_package):
    cache = copy_of_package / 'cache'
    settings = {'XDG_CACHE_HOME': str(cache), 'TMPDIR': str(cache)}
    old = cache / 'rigid_body_sim' / 'old'
    old.mkdir(parents=True)
    os.utime(old, (0.0, 0.0))    # unused for more than a month
    hashed = run(
        'import rigid_body_sim.simulation.simulation, rigid_body_sim.study.check_scenes\n'
        'from rigid_body_sim.compilation.environment import sources_key\n'
        'print(sources_key.cache_info().currsize)', copy_of_package, **settings)
    assert hashed == '0\n'
    assert list(cache.rglob('*')) == [old.parent, old]
    run(TURN, copy_of_package, **settings)
    assert list(cache.rglob('*.nbc'))
    assert not old.exists()


@needs_numba
def test_an_edit_to_the_shell_the_study_or_a_document_recompiles_nothing(copy_of_package):
    """All that is no source of kernels is edited at once: the cache keeps its name."""
    key = 'from rigid_body_sim.compilation.environment import sources_key\nprint(sources_key())'
    before, package = run(key, copy_of_package), copy_of_package / 'rigid_body_sim'
    kernels = {path.relative_to(PACKAGE) for path in environment.kernel_sources()}
    others = {path for path in package.rglob('*')
              if path.is_file() and path.relative_to(package) not in kernels}
    assert {package / 'cli/simulate.py', package / 'study/check_scenes.py',
            package / 'node/qos.py', package / 'simulation/simulation.py'} <= others
    (copy_of_package / 'docs').mkdir()
    for path in (*others, copy_of_package / 'docs' / 'architecture.md'):
        with path.open('ab') as file:
            file.write(b'# edited\n')
    assert run(key, copy_of_package) == before
    with (package / 'motions' / 'loops.py').open('ab') as file:
        file.write(b'# edited\n')
    assert run(key, copy_of_package) != before


def test_without_numba_the_same_code_runs(copy_of_package):
    plain = run(TURN, copy_of_package, NUMBA_DISABLE_JIT='1')
    assert plain == run(TURN, copy_of_package, XDG_CACHE_HOME=str(copy_of_package / 'cache'))


def test_template_refuses_a_name_left_unbound():
    with pytest.raises(TypeError, match='declares'):
        templates.specialise(loops, anchor='rigid_body_sim.motions.free_body.free_body:anchor')
