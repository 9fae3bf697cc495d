# SPDX-License-Identifier: Apache-2.0
"""Compute the digests as on other machines: processors, C libraries, BLAS cores, Pythons, ARM64.

::

    python test/machines.py                  # all; make test-machines
    python test/machines.py ARM64 OpenBLAS   # those whose names begin with one of these words
    python test/machines.py --digests        # without the numeric tests, which take longest

This machine stands for others by settings, which its libraries take from the environment; ARM64 is
emulated (Debian's qemu-user-static). On each one the digests are computed and compared with those
kept in rigid_body_sim/simulation/digests.json, and a recording made here runs again to the bit; on
some the numeric tests run as well. If this machine cannot stand for another one, what it lacks is
printed, and that is no failure.

As many machines are visited at a time as there are cores. The results are kept in
docs/machines.json, one row for each machine, from which docs/make_machines.py makes the table of
the page; a visit to a few machines leaves the rows of the others.
"""

import concurrent.futures
import datetime
import json
import os
import pathlib
import platform
import re
import subprocess
import sys
import tempfile
import time
import typing

from rigid_body_sim.compilation import environment
from rigid_body_sim.simulation import arithmetic
from rigid_body_sim.study.machines import digests, scenes
from rigid_body_sim.study.machines.targets import TARGETS

ROOT = pathlib.Path(__file__).resolve().parents[1]
CACHE = ROOT / '.cache' / 'machines'
KEPT = ROOT / 'docs' / 'machines.json'
OLD_LIBC = ','.join(f'-{name}' for name in (
    'FMA', 'FMA4', 'AVX', 'AVX2', 'AVX512F', 'AVX512CD', 'AVX512BW', 'AVX512DQ', 'AVX512VL'))
OLD_NUMPY = ('X86_V3 X86_V4 AVX2 FMA3 AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL '
             'AVX512_ICL AVX512_SPR')
PLAIN = {'NUMBA_DISABLE_JIT': '1'}
TESTS = ('test/numerics', 'test/motions', 'test/integrators/methods/test_taylor.py',
         'test/integrators/marching/test_batch.py', 'test/scene/test_bodies.py')
PATIENCE = 4.0 * 3600.0    # s, for one run; a busy machine compiles slowly
SHOWN = 10           # most differences shown of one machine


class Unavailable(Exception):
    """Error that names what this machine lacks to stand for another one."""


class Machine(typing.NamedTuple):
    """A machine that this one stands for: settings, how Python is called, the tests that run."""

    name: str
    settings: dict
    python: typing.Callable = lambda: [sys.executable]
    tests: tuple = ()
    needs: str = ''


def _other_python(version):
    """Return the call of a Python of another version, in an environment made for it."""
    folder = CACHE / version
    settings = {name: value for name, value in os.environ.items()
                if name not in ('PYTHON', 'PYTHONPATH', 'PYTHONHOME')}
    made = subprocess.run([ROOT / 'requirements' / 'make_venv.sh', folder,
                           ROOT / 'requirements' / 'test.txt', version],
                          env=settings, capture_output=True, text=True, cwd=ROOT)
    if made.returncode:
        raise Unavailable(made.stderr.strip().splitlines()[-1])
    return [str(folder / 'bin' / 'python')]


def _arm64():
    """Return the call of Debian's Python for ARM64 under emulation, with wheels from PyPI."""
    made = subprocess.run([ROOT / 'test' / 'make_arm64.sh', CACHE / 'arm64'],
                          capture_output=True, text=True, cwd=ROOT)
    if made.returncode:
        raise Unavailable((made.stderr.strip().splitlines() or ['make_arm64.sh failed'])[-1])
    root = CACHE / 'arm64' / 'root'
    [python] = root.glob('usr/bin/python3.[0-9]*[0-9]')
    return ['qemu-aarch64-static', '-L', str(root), str(python)]


def machines():
    """Return the table of machines."""
    others = [version for version in ('3.11', '3.12', '3.13')
              if version != '.'.join(platform.python_version_tuple()[:2])]
    arm = {'PYTHONPATH': os.pathsep.join(map(str, (ROOT, CACHE / 'arm64' / 'packages'))),
           'PYTHONDONTWRITEBYTECODE': '1'}
    return [
        Machine('this one', {}),
        Machine('no numba', PLAIN, tests=TESTS),
        *(Machine(f'OpenBLAS {core}', {'OPENBLAS_CORETYPE': core})
          for core in ('Prescott', 'Nehalem', 'Haswell', 'Zen', 'SkylakeX')),
        Machine('NumPy without dispatch', {'NPY_DISABLE_CPU_FEATURES': OLD_NUMPY}),
        Machine('C library without FMA, AVX', {'GLIBC_TUNABLES': f'glibc.cpu.hwcaps={OLD_LIBC}'}),
        Machine('C library without FMA, AVX; no numba',
                {'GLIBC_TUNABLES': f'glibc.cpu.hwcaps={OLD_LIBC}', **PLAIN}),
        Machine('numba for generic x86-64', TARGETS['generic'], tests=TESTS),
        Machine('numba for Haswell (AVX2)', TARGETS['avx2'], tests=TESTS, needs='avx2'),
        Machine('numba for AVX-512', TARGETS['avx512'], tests=TESTS,
                needs='avx512vl'),
        *(Machine(f'Python {version}', {}, lambda version=version: _other_python(version), TESTS)
          for version in others),
        *(Machine(f'Python {version}, no numba', PLAIN,
                  lambda version=version: _other_python(version)) for version in others),
        Machine('ARM64 (emulated), no numba', arm, _arm64),
    ]


def _processor_has(flag):
    try:
        return not flag or re.search(rf'\b{flag}\b', pathlib.Path('/proc/cpuinfo').read_text())
    except OSError:
        return False


def _record():
    """Make a recording on this machine that runs again on the others; return its path."""
    folder = pathlib.Path(tempfile.mkdtemp(dir=CACHE))
    scene, path = folder / 'composite_top.yaml', folder / 'recording'
    scene.write_text(scenes.text('composite_top'))
    subprocess.run([sys.executable, '-m', 'rigid_body_sim', 'simulate', '--scene', scene,
                    '--duration', '2', '--output', path], cwd=ROOT, check=True,
                   stdout=subprocess.DEVNULL)
    return path


def _run(call, settings):
    """Run a command with the settings of a machine and without those of all other machines."""
    foreign = {name for machine in machines() for name in machine.settings} - {'PYTHONPATH'}
    usual = {name: value for name, value in os.environ.items() if name not in foreign}
    return subprocess.run(call, env=usual | settings, cwd=ROOT, capture_output=True,
                          text=True, timeout=PATIENCE)


def visit(machine, recording):
    """Run the digests and tests of a machine; return (number of digests, differences, tests)."""
    if not _processor_has(machine.needs):
        raise Unavailable(f'this processor has no {machine.needs}')
    python = machine.python()
    run = _run([*python, '-W', 'ignore', '-m', digests.__name__, '--json'], machine.settings)
    if run.returncode:
        lines = run.stderr.strip().splitlines() or ['no word']
        return 0, [f'failed: {lines[-1]}'], ''
    found, kept = json.loads(run.stdout), arithmetic.digests()
    apart = digests.different(found, kept)
    with tempfile.TemporaryDirectory(dir=CACHE) as differences:
        run = _run([*python, '-W', 'ignore', '-m', 'rigid_body_sim', 'resimulate', recording,
                    '--output', differences], machine.settings)
    if not run.stdout.startswith('identical'):
        apart.append('; '.join((run.stdout or run.stderr).strip().splitlines()[-3:]))
    tests = ''
    if machine.tests and '--digests' not in sys.argv:
        run = _run([*python, '-m', 'pytest', '-q', '--timeout', '1200', '-p', 'no:cacheprovider',
                    *machine.tests], machine.settings)
        tests = re.sub(r' in .*', '', (run.stdout.strip().splitlines() or ['failed'])[-1])
        if run.returncode:
            failed = [line for line in run.stdout.splitlines() if line.startswith('FAILED')]
            apart += failed or [f'tests: {tests}']
    return sum(map(len, kept.values())), apart, tests


def _tell(machine, apart):
    """Print the first differences on a machine, and write all of them into a file."""
    path = CACHE / f'{machine.name}.txt'
    path.write_text('\n'.join(apart))
    for line in apart[:SHOWN]:
        print(f'{machine.name}: {line}')
    if len(apart) > SHOWN:
        print(f'{machine.name}: ... all in {path}')


def _commit():
    """Return the commit that is visited, with a + if files differ from it."""
    def git(*words):
        return subprocess.run(['git', *words], cwd=ROOT, capture_output=True, text=True).stdout
    return git('rev-parse', '--short', 'HEAD').strip() + '+' * bool(
        git('status', '--porcelain', '--', 'rigid_body_sim'))


def _visited(machine, recording):
    """Visit a machine, print what is found, and return its row of the table."""
    begin = time.monotonic()
    row = {'name': machine.name, 'arithmetic': arithmetic.version(), 'tests': '', 'differ': 0,
           'processor': environment.processor().split()[0], 'commit': _commit(),
           'date': datetime.datetime.now(datetime.UTC).date().isoformat()}
    try:
        row['digests'], apart, row['tests'] = visit(machine, recording)
        row['differ'] = len(apart)
        row['verdict'] = f'{len(apart)} differ' if apart else f'{row["digests"]} the same'
        _tell(machine, apart)
    except (Unavailable, subprocess.TimeoutExpired) as lack:
        row['verdict'] = f'not here: {lack}'
    row['seconds'] = round(time.monotonic() - begin)
    print(row['name'], row['verdict'], row['tests'] or '-', f'{row["seconds"]} s', sep=' | ',
          flush=True)
    return row


def _wanted(words):
    """Return the machines whose names begin with a word; a whole name means that machine alone."""
    known = {one.name: one for one in machines()}
    found = {name for word in words or [''] for name in known
             if (name == word if word in known else name.startswith(word))}
    return [one for name, one in known.items() if name in found]


def main(words):
    """Visit the machines, keep the table; return the exit status."""
    CACHE.mkdir(parents=True, exist_ok=True)
    recording = _record()
    wanted = _wanted([word for word in words if word != '--digests'])
    # the first one compiles the kernels that machines with other libraries then find in the cache
    rows = [_visited(one, recording) for one in wanted[:1]]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        rows += pool.map(lambda one: _visited(one, recording), wanted[1:])
    kept = {row['name']: row for row in json.loads(KEPT.read_text())} if KEPT.exists() else {}
    kept |= {row['name']: row for row in rows
             if 'digests' in row or 'digests' not in kept.get(row['name'], {})}
    table = [kept.get(one.name, {'name': one.name, 'verdict': 'not visited'})
             for one in machines()]
    KEPT.write_text(json.dumps(table, indent=1) + '\n')
    return int(any(row['differ'] for row in rows))


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
