# SPDX-License-Identifier: Apache-2.0
"""Note which test runs which line of the package, in plain Python, and choose tests by it.

::

    python test/covering.py test/mechanics test/scene    # each gets a file in .cache/covering

coverage.py traces the lines; each test is a context of its own, and so is each digest of the table
in study/machines. Lines that a fixture of a module runs count for each test that uses it, and
lines of a bound template count as those of the template. Lines that other processes run are not
seen. If a file has been edited since, each test that ran any of its lines counts for all of them.
"""

import functools
import hashlib
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import time

import coverage
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[1]
FOLDER = ROOT / '.cache' / 'covering'
DIGEST = 'digest: '
"""Beginning of the name of a context that is a digest."""
LONGEST = 90    # s of a test that is noted
PATIENCE = 60.0    # s, the least time that a chosen test is given
SHORT = 2.0     # CPU seconds of a test that passes, however busy the machine is


# ---------------------------------------------------------------------------------- to note

class Notes:
    """A plugin of pytest that notes the lines of each test that passes, and its CPU time."""

    def __init__(self, name):
        FOLDER.mkdir(parents=True, exist_ok=True)
        self.name, self.seconds, self.users, self._within = name, {}, {}, ['']
        self._failed = set()
        cache = pathlib.Path(os.environ['XDG_CACHE_HOME'])
        self.trace = coverage.Coverage(
            data_file=FOLDER / f'{name}.coverage', config_file=False,
            include=[f'{ROOT}/rigid_body_sim/*', f'{cache}/*'])
        self.trace.erase()
        self.trace.start()

    def within(self, name):
        """Begin a context; the one before goes on at :meth:`over`."""
        self._within.append(name)
        self.trace.switch_context(name)

    def over(self):
        """End the innermost context."""
        self._within.pop()
        self.trace.switch_context(self._within[-1])

    @pytest.hookimpl(hookwrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item):
        for name in item.fixturenames:
            for one in item._fixtureinfo.name2fixturedefs.get(name, ())[-1:]:
                if one.scope != 'function':
                    self.users.setdefault(_name(one), []).append(item.nodeid)
        self.within(item.nodeid)
        begin = time.process_time()
        yield
        if item.nodeid not in self._failed:
            self.seconds[item.nodeid] = round(time.process_time() - begin, 3)
        self.over()

    def pytest_runtest_logreport(self, report):
        if report.failed:
            self._failed.add(report.nodeid)

    @pytest.hookimpl(hookwrapper=True)
    def pytest_fixture_setup(self, fixturedef):
        shared = fixturedef.scope != 'function'
        if shared:
            self.within(_name(fixturedef))
        yield
        if shared:
            self.over()

    def save(self):
        """Write what was noted."""
        self.trace.stop()
        self.trace.save()
        (FOLDER / f'{self.name}.json').write_text(json.dumps(
            {'root': str(ROOT), 'seconds': self.seconds, 'users': self.users,
             'sources': {path: _hash(path) for path in self._files(own=True)},
             'longer': {path: _lines(path) for path in self._files(own=False)}}))

    def _files(self, own):
        """Return the files of which lines were run: those of the package, or bound templates."""
        return [path for path in self.trace.get_data().measured_files()
                if path.startswith(f'{ROOT}/rigid_body_sim/') == own]


def _name(fixture):
    return f'fixture: {fixture.baseid}::{fixture.argname}'


def _hash(path):
    return hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()[:16]


def _lines(path):
    try:
        return pathlib.Path(path).read_text().count('\n')
    except OSError:
        return 0


def note(tests):
    """Note the lines of tests, or of the digests if `tests` is 'digests'."""
    name = tests.removeprefix('test/').replace('/', '.')
    notes = Notes(name)
    if tests != 'digests':
        pytest.main(['-q', '-p', 'no:cacheprovider', '--tb', 'line', '-rfE', '--timeout',
                     str(LONGEST), tests], plugins=[notes])
    else:
        from rigid_body_sim.study.machines.cases import cases
        for case, this in cases().items():
            notes.within(DIGEST + case)
            begin = time.process_time()
            this.run()
            notes.seconds[DIGEST + case] = round(time.process_time() - begin, 3)
            notes.over()
    notes.save()


# -------------------------------------------------------------------------------- to choose

@functools.cache
def _noted():
    """Return a list of what was noted: (data of coverage.py, all else)."""
    found = []
    for path in sorted(FOLDER.glob('*.json')):
        of, data = json.loads(path.read_text()), coverage.CoverageData(path.with_suffix(
            '.coverage'))
        data.read()
        found.append((data, of))
    return found


@functools.cache
def _contexts(file):
    """Return (line -> contexts, context -> CPU seconds, context -> those that use it)."""
    lines, seconds, users = {}, {}, {}
    bound = re.compile(rf'/{pathlib.PurePath(file).stem}_[0-9a-f]{{12}}\.py')
    for data, of in _noted():
        seconds |= of['seconds']
        users |= of['users']
        own, now = f'{of["root"]}/{file}', ROOT / file
        edited = of['sources'].get(own) != _hash(now)
        shifts = {own: 0} | {path: more - _lines(now) for path, more in of['longer'].items()
                             if bound.search(path)}
        for path, shift in shifts.items():
            for line, names in data.contexts_by_lineno(path).items():
                lines.setdefault(0 if edited else line - shift, set()).update(names)
    return lines, seconds, users


def covering(file, first, last):
    """Return name -> CPU seconds of the tests and digests that run a line of `first` to `last`.

    If no test runs them, because they run when the module is imported, it is all that run any
    line.
    """
    lines, seconds, users = _contexts(file)
    found = set().union(*(lines.get(line, ()) for line in (0, *range(first, last + 1)))) - {''}
    found = found or set().union(*lines.values()) - {''}
    found = found.union(*(users.get(name, ()) for name in found))
    return {name: seconds[name] for name in found if name in seconds}


@functools.cache
def short():
    """Return the names, without parameters, of tests of which each run passed and was short."""
    longest = {}
    for _, of in _noted():
        for name, took in of['seconds'].items():
            test = name.partition('[')[0]
            longest[test] = max(took, longest.get(test, 0.0))
    return {test for test, took in longest.items() if took < SHORT}


def noted_files():
    """Return the files of the tests that were noted."""
    return {name.partition('::')[0] for _, of in _noted() for name in of['seconds']}


class Chosen:
    """A plugin of pytest that keeps the tests named in a file, in their order."""

    def __init__(self, path):
        self._seconds = json.loads(pathlib.Path(path).read_text())

    def pytest_collection_modifyitems(self, items):
        places = {name: place for place, name in enumerate(self._seconds)}
        items[:] = sorted((item for item in items if item.nodeid in places),
                          key=lambda item: places[item.nodeid])
        for item in items:
            longest = max(PATIENCE, 20.0 * self._seconds[item.nodeid])
            item.add_marker(pytest.mark.timeout(longest), append=False)


def _judge(path):
    """Run the tests or digests of a file in their order; return the exit status."""
    names = json.loads(pathlib.Path(path).read_text())
    if not next(iter(names)).startswith(DIGEST):
        return pytest.main(
            ['-q', '-x', '-p', 'no:cacheprovider', '--tb', 'no', '-rfE',
             *dict.fromkeys(name.partition('::')[0] for name in names)], plugins=[Chosen(path)])
    from rigid_body_sim.simulation import arithmetic
    from rigid_body_sim.study.machines import cases, digests
    table, kept = cases.cases(), arithmetic.digests()
    signal.signal(signal.SIGALRM, signal.default_int_handler)
    for name, took in names.items():
        case = name.removeprefix(DIGEST)
        signal.setitimer(signal.ITIMER_REAL, max(PATIENCE, 20.0 * took))
        try:
            found = {part: digests.digest(of) for part, of in table[case].run().items()}
        except (Exception, KeyboardInterrupt) as error:
            found = error
        if found != kept[case]:
            print(f'FAILED {name}')
            return 1
    return 0


def main(arguments):
    """Note the tests of each argument in a process of its own, or judge (--judge FILE)."""
    if arguments[:1] == ['--judge']:
        return _judge(arguments[1])
    if arguments[:1] == ['--note']:
        return note(arguments[1])
    for tests in arguments:
        begin = time.monotonic()
        subprocess.run([sys.executable, __file__, '--note', tests], cwd=ROOT, env=os.environ | {
            'NUMBA_DISABLE_JIT': '1', 'PYTHONPATH': f'{ROOT}:{ROOT}/test',
            'XDG_CACHE_HOME': str(ROOT / '.cache' / 'covering' / 'kernels')})
        print(f'{tests}: {time.monotonic() - begin:.0f} s', flush=True)
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
