"""Compilation of kernels: numba where it is installed, plain Python where it is not, and a cache that never lies.

numba looks at the time stamp of one file only, so a cached caller would go on with the old body of
a callee in another file. Here the cache folder is named by a hash of the sources that kernels come
from (KERNEL_SOURCES), of numba's version and of the processor: after an edit to one of them it is
another folder, and copies of the same sources share one. An edit elsewhere recompiles nothing.

Kernels follow four rules, so that they mean the same with and without numba: scalars and small arrays only, functions of ``math`` only, no
division by zero (plain Python would raise), no ``**`` (its rounding differs between the two).
"""

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
KERNEL_SOURCES = ('compilation', 'numerics', 'scene', 'mechanics', 'motions', 'integrators', 'simulation/admission.py',
                  'messages/state_topics.py', 'study/hard_cases/trends.py')
KEEP_UNUSED = 30 * 86400.0    # s


def processor():
    """Return the name and feature flags of the processor, on which compiled code and the bits of sin and cos depend."""
    if HAVE_NUMBA:
        from llvmlite import binding
        # numba compiles for another processor where its settings say so
        features = numba.config.CPU_FEATURES
        return (f'{numba.config.CPU_NAME or binding.get_host_cpu_name()} '
                f'{binding.get_host_cpu_features().flatten() if features is None else features}')
    return platform.processor() or platform.machine()


def kernel_sources():
    """Return the paths of the source files that kernels come from, in order."""
    return sorted(path for source in KERNEL_SOURCES
                  for path in ([PACKAGE / source] if source.endswith('.py') else (PACKAGE / source).rglob('*.py')))


def sources_key():
    """Return a hash of all that compiled code depends on: the sources, Python's and numba's version, the processor."""
    digest = hashlib.sha256()
    for path in kernel_sources():
        digest.update(path.relative_to(PACKAGE).as_posix().encode())
        digest.update(path.read_bytes())
    versions = (sys.version, numba.__version__ if numba else 'no numba', processor())
    digest.update(repr(versions).encode())
    return digest.hexdigest()[:16]


def _cache_folder():
    """Return a writable folder for this key, or None: the user's cache folder, else one under the temporary folder."""
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
    """Remove the caches of sources that no process has imported for a month."""
    for folder in base.iterdir():
        if time.time() - folder.stat().st_mtime > KEEP_UNUSED:
            shutil.rmtree(folder, ignore_errors=True)


CACHE_FOLDER = _cache_folder() if HAVE_NUMBA else None
_SETTINGS = {'CACHE_DIR': str(CACHE_FOLDER or ''), 'CACHE_LOCATOR_CLASSES': 'rigid_body_sim.compilation.cache.Place'}


def _jit(function, **options):
    if not HAVE_NUMBA:
        return function
    # a numba that does not know a setting goes on without it: then every copy of the package compiles for itself
    before = {name: getattr(numba.config, name) for name in _SETTINGS if hasattr(numba.config, name)}
    for name in before:
        setattr(numba.config, name, _SETTINGS[name])
    try:
        return numba.njit(cache=CACHE_FOLDER is not None, error_model='numpy', nogil=True, no_cfunc_wrapper=True, **options)(function)
    finally:
        for name, value in before.items():
            setattr(numba.config, name, value)


def compiled(function):
    """Compile a kernel at its first call, without any reordering of floating-point operations (no ``fastmath``).

    It can make no array, so that numba need not count who holds one: with the counting, each slice of an array costs up to 40 ns.
    """
    return _jit(function, _nrt=False)


def compiled_allocating(function):
    """Compile a kernel that makes arrays for its own use."""
    return _jit(function, _nrt=True)


def compiled_inline(function):
    """Compile a short kernel that is copied into its callers."""
    return _jit(function, forceinline=True, _nrt=False)
