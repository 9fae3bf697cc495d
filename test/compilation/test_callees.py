# SPDX-License-Identifier: Apache-2.0
"""A kernel that a kernel calls has code for its caller alone, until Python calls it itself."""

import concurrent.futures
import importlib.util
import json
import os
import subprocess
import sys
import uuid

import pytest
import ros

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
import importlib.util, json, sys
told = {}
for folder, names in json.load(sys.stdin).items():
    specification = importlib.util.spec_from_file_location(
        f'kernels of {folder}', f'{folder}/kernels.py')
    kernels = sys.modules[specification.name] = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(kernels)
    told[folder] = []
    for name in names:
        answer = getattr(kernels, name)(10.0)
        told[folder].append((answer, [sum(one.stats.cache_hits.values()) for one in (
            kernels.third, kernels.sixth, kernels.twelfth)]))
print(json.dumps(told))
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


CASES = {
    # what one process calls; what the next one calls, and after each call how often third, sixth
    # and twelfth were read from the cache
    'the same': (['twelfth'], {'twelfth': [0, 0, 1]}),
    'its caller': (['sixth'], {'twelfth': [1, 0, 0]}),
    'its callees': (['twelfth'], {'sixth': [1, 0, 0], 'third': [1, 0, 0]}),
    'both': (['third', 'twelfth'], {'third': [1, 0, 0], 'sixth': [1, 0, 0]})}


@pytest.fixture(scope='module')
def told(tmp_path_factory):
    """Return case -> (answer, hits) of each call of a second process, after a first one's."""
    root = tmp_path_factory.mktemp('processes')
    for case in CASES:
        (root / case).mkdir()
        (root / case / 'kernels.py').write_text(KERNELS, encoding='utf-8')

    def run(names):
        environment = os.environ | {
            'XDG_CACHE_HOME': str(root / 'cache'), 'PYTHONPATH': str(ros.ROOT)}
        return json.loads(subprocess.run(
            [sys.executable, '-c', CALLS], input=json.dumps(names), capture_output=True, text=True,
            cwd=root, env=environment, check=True, timeout=200).stdout)
    run({case: first for case, (first, _) in CASES.items()})
    return run({case: list(then) for case, (_, then) in CASES.items()})


@pytest.mark.parametrize('case', CASES)
def test_another_process_reads_callees_and_callers_from_the_cache(told, case):
    third, (_, then) = 10.0 / 3.0, CASES[case]
    answers = {'third': third, 'sixth': third / 2.0, 'twelfth': third / 2.0 / 3.0 * 1.5}
    assert told[case] == [[answers[name], hits] for name, hits in then.items()]
