# SPDX-License-Identifier: Apache-2.0
"""The key and the folder of the cache of compiled kernels.

numba looks at the time stamp of one file only, so a cached caller would go on with the old body of
a callee in another file. Here the cache folder is named by a hash of the sources that kernels come
from (KERNEL_SOURCES), of numba's version and of the processor. An edit to one of the sources gives
another folder, and copies of the same sources share one. An edit elsewhere recompiles nothing.

Nothing is hashed, created or removed before a kernel is called.
"""

import functools
import hashlib
import os
import pathlib
import platform
import shutil
import sys
import tempfile
import time

try:
    import numba
except ImportError:
    numba = None

HAVE_NUMBA = numba is not None and not numba.config.DISABLE_JIT
PACKAGE = pathlib.Path(__file__).resolve().parents[1]
KERNEL_SOURCES = ('compilation', 'numerics', 'scene', 'mechanics', 'motions', 'integrators',
                  'simulation/admission.py', 'simulation/command_rows.py',
                  'messages/tick_messages.py', 'messages/timeline.py', 'sweeps/draws.py',
                  'study/hard_cases/trends.py')
KEEP_UNUSED = 30 * 86400.0    # s


def processor():
    """Return the name and the feature flags of the processor that kernels are compiled for."""
    if HAVE_NUMBA:
        # numba compiles for another processor if its settings say so
        name, features = _host()
        given = numba.config.CPU_FEATURES
        return f'{numba.config.CPU_NAME or name} {features if given is None else given}'
    return platform.processor() or platform.machine()


@functools.cache
def _host():
    """Return the name and the feature flags of this machine's processor, as LLVM has them."""
    from llvmlite import binding
    return binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten()


def kernel_sources():
    """Return the paths of the source files that kernels come from, in order."""
    return sorted(path for source in KERNEL_SOURCES for path in (
        [PACKAGE / source] if source.endswith('.py') else (PACKAGE / source).rglob('*.py')))


@functools.cache
def sources_key():
    """Return a hash of everything compiled code depends on: sources, processor, versions."""
    digest = hashlib.sha256()
    for path in kernel_sources():
        digest.update(path.relative_to(PACKAGE).as_posix().encode())
        digest.update(path.read_bytes())
    versions = (sys.version, numba.__version__ if numba else 'no numba', processor())
    digest.update(repr(versions).encode())
    return digest.hexdigest()[:16]


@functools.cache
def cache_folder():
    """Return a writable folder for compiled code, or None.

    It is in the user's cache folder, or below the temporary folder if that cannot be written.
    """
    if not HAVE_NUMBA:
        return None
    home = os.environ.get('XDG_CACHE_HOME') or os.path.join(os.path.expanduser('~'), '.cache')
    temporary = os.path.join(tempfile.gettempdir(), f'rigid_body_sim-{os.getuid()}')
    for base in (os.path.join(home, 'rigid_body_sim'), temporary):
        folder = pathlib.Path(base) / sources_key()
        try:
            folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            if os.access(folder, os.W_OK) and folder.stat().st_uid == os.getuid():
                os.utime(folder)
                _remove_unused(folder.parent)
                return folder
        except OSError:
            continue
    return None


def _remove_unused(base):
    """Remove the caches that no process has used for a month."""
    for folder in base.iterdir():
        if time.time() - folder.stat().st_mtime > KEEP_UNUSED:
            shutil.rmtree(folder, ignore_errors=True)
