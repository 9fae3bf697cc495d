# SPDX-License-Identifier: Apache-2.0
"""Modules that are made of source: threads and processes may make one at the same time."""

import concurrent.futures
import pathlib
import sys
import threading

from rigid_body_sim.compilation.templates import module_of


def test_two_threads_that_make_one_module_get_the_same(monkeypatch, tmp_path):
    """They write the source before one of them finishes it, as on the first run of a sweep."""
    both, write_text = threading.Barrier(2, timeout=30.0), pathlib.Path.write_text

    def write_together(path, text):
        written = write_text(path, text)
        both.wait()
        return written

    monkeypatch.setattr('rigid_body_sim.compilation.templates.cache_folder', lambda: tmp_path)
    monkeypatch.setattr(pathlib.Path, 'write_text', write_together)
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        first, second = pool.map(module_of, ['VALUE = 2.0 / 3.0\n'] * 2, ['thirds'] * 2)
    try:
        assert first is second and first.VALUE == 2.0 / 3.0
        assert [path.name for path in tmp_path.glob('thirds*')] == [f'{first.__name__}.py']
    finally:
        del sys.modules[first.__name__]
