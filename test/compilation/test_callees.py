# SPDX-License-Identifier: Apache-2.0
"""A kernel that a kernel calls has code for its caller alone, until Python calls it itself."""

import concurrent.futures
import importlib.util
import os
import subprocess
import sys
import uuid

import pytest

from rigid_body_sim.compilation import jit

callees = pytest.importorskip('rigid_body_sim.compilation.callees')
pytestmark = pytest.mark.skipif(not jit.HAVE_NUMBA, reason='about compiled code')
KERNELS = """
from rigid_body_sim.compilation.jit import compiled

@compiled
def third(x):
    return x / 3.0

@compiled
def sixth(x):
    return third(x) / 2.0

@compiled
def twelfth(x):
    return third(sixth(x)) * 1.5
"""
CALLS = """
import sys
sys.path.insert(0, sys.argv[1])
import kernels
for name in sys.argv[2:]:
    kernel = getattr(kernels, name)
    print(kernel(10.0), *(sum(one.stats.cache_hits.values()) for one in (
        kernels.third, kernels.sixth, kernels.twelfth)))
"""


@pytest.fixture
def kernels(tmp_path, monkeypatch):
    """Return a module of three kernels, each called by the one after it."""
    path = tmp_path / 'kernels.py'
    path.write_text(KERNELS, encoding='utf-8')
    specification = importlib.util.spec_from_file_location(f'kernels_{uuid.uuid4().hex}', path)
    module = importlib.util.module_from_spec(specification)
    monkeypatch.setitem(sys.modules, specification.name, module)
    specification.loader.exec_module(module)
    return module


def known(kernel):
    """Return whether each compiled version of a kernel is a callee."""
    return [callees.is_callee(kernel, types) for types in kernel.overloads]


def test_only_the_kernel_that_python_calls_has_machine_code(kernels):
    assert kernels.twelfth(36.0) == 3.0
    assert [known(kernel) for kernel in (kernels.third, kernels.sixth, kernels.twelfth)] == [
        [True], [True], [False]]
    (types,) = kernels.sixth.overloads
    library = kernels.sixth.overloads[types].library
    with pytest.raises(ValueError, match='object caching not enabled'):
        library._get_compiled_object()
    assert 'PyArg_UnpackTuple' not in str(library._final_module)
    assert 'PyArg_UnpackTuple' in kernels.twelfth.inspect_llvm(types)


def test_a_callee_that_python_calls_later_is_compiled_for_it(kernels):
    assert kernels.twelfth(36.0) == 3.0
    assert kernels.sixth(36.0) == 6.0
    assert known(kernels.sixth) == [False]
    assert known(kernels.third) == [True]
    assert kernels.third(36.0) == 12.0
    assert kernels.twelfth(72.0) == 6.0
    # other types are another version
    assert kernels.twelfth(36) == 3.0
    assert known(kernels.third) == [False, True]


def test_a_kernel_that_python_called_before_serves_its_callers_as_it_is(kernels):
    assert kernels.sixth(36.0) == 6.0
    assert kernels.twelfth(36.0) == 3.0
    assert known(kernels.sixth) == [False]
    assert len(kernels.sixth.overloads) == 1


def test_threads_that_call_a_caller_and_its_callees_at_once_all_get_their_answer(kernels):
    asked = [kernels.twelfth, kernels.third, kernels.sixth] * 3
    with concurrent.futures.ThreadPoolExecutor(len(asked)) as threads:
        answers = list(threads.map(lambda kernel: kernel(36.0), asked))
    assert answers == [3.0, 12.0, 6.0] * 3


def test_an_error_while_a_caller_compiles_leaves_nothing_behind(kernels):
    with pytest.raises(Exception, match='No implementation of function'):
        kernels.twelfth('36')
    assert not callees.in_a_caller()
    assert kernels.twelfth(36.0) == 3.0


@pytest.mark.parametrize(('first', 'then', 'hits'), [
    # each line: the answer, and how often third, sixth and twelfth were read from the cache
    (['twelfth'], ['twelfth'], ['0 0 1']),
    (['sixth'], ['twelfth'], ['1 0 0']),
    (['twelfth'], ['sixth', 'third'], ['1 0 0', '1 0 0']),
    (['third', 'twelfth'], ['third', 'sixth'], ['1 0 0', '1 0 0'])])
def test_another_process_reads_callees_and_callers_from_the_cache(tmp_path, first, then, hits):
    (tmp_path / 'kernels.py').write_text(KERNELS, encoding='utf-8')

    def run(names):
        return subprocess.run(
            [sys.executable, '-c', CALLS, str(tmp_path), *names], capture_output=True, text=True,
            env=os.environ | {'XDG_CACHE_HOME': str(tmp_path / 'cache')}, check=True,
            timeout=100).stdout.splitlines()
    run(first)
    told = run(then)
    third = 10.0 / 3.0
    answers = {'third': third, 'sixth': third / 2.0, 'twelfth': third / 2.0 / 3.0 * 1.5}
    assert [float(line.split()[0]) for line in told] == [answers[name] for name in then]
    assert [line.split(maxsplit=1)[1] for line in told] == hits
