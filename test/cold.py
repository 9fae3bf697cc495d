# SPDX-License-Identifier: Apache-2.0
"""Run each test file alone, with an empty kernel cache: none may depend on another.

::

    python test/cold.py                          # all files, hours of compiling; make test-cold
    python test/cold.py test/motions             # those below some folders

As many files run at a time as there are cores. Files that passed are kept in .cache/cold.json, and
the next run skips them until an edit changes the file or a source of the package or the tests; so
a run that was interrupted resumes. The table names the kernels that a file compiled; a file with
none does not depend on the cache.
"""

import concurrent.futures
import hashlib
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
KEPT = ROOT / '.cache' / 'cold.json'
ELSEWHERE = {'test_installed.py'}    # what colcon runs on the installed package
PATIENCE = '1200'                    # s, for one test; a busy machine compiles slowly
NO_TEST_RUNS_HERE = 5


def _digest(paths):
    total = hashlib.sha256()
    for path in sorted(paths):
        total.update(path.read_bytes())
    return total.hexdigest()[:16]


def _sources():
    """Return a digest of all that a test file may use besides itself."""
    helpers = (path for path in (ROOT / 'test').rglob('*.py')
               if not path.name.startswith('test_'))
    return _digest([*(ROOT / 'rigid_body_sim').rglob('*.py'), *helpers])


def run(path):
    """Run a file; return (whether it passed, its last lines, kernels compiled, seconds)."""
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as cache:
        done = subprocess.run(
            [sys.executable, '-m', 'pytest', '-q', '--timeout', PATIENCE, '-p',
             'no:cacheprovider', path],
            cwd=ROOT, env=os.environ | {'XDG_CACHE_HOME': cache}, capture_output=True, text=True)
        kernels = sum(1 for _ in pathlib.Path(cache).rglob('*.nbc'))
    lines = done.stdout.strip().splitlines() or done.stderr.strip().splitlines() or ['nothing']
    return (done.returncode in (0, NO_TEST_RUNS_HERE), lines[-40:], kernels,
            time.monotonic() - begin)


def main(folders):
    """Run the files of some folders, print a line for each; return the exit status."""
    paths = sorted(path for folder in folders or ['test'] for path in
                   ([ROOT / folder] if folder.endswith('.py')
                    else (ROOT / folder).rglob('test_*.py'))
                   if path.name not in ELSEWHERE)
    sources, lock, failed = _sources(), threading.Lock(), []
    passed = json.loads(KEPT.read_text()) if KEPT.exists() else {}
    KEPT.parent.mkdir(exist_ok=True)

    def visit(path):
        name = path.relative_to(ROOT).as_posix()
        key = f'{sources} {_digest([path])}'
        if passed.get(name) == key:
            print(f'{name}: passed before', flush=True)
            return
        good, lines, kernels, seconds = run(path)
        with lock:
            print(f'{name}: {lines[-1]}; {kernels} kernels, {seconds:.0f} s', flush=True)
            if good:
                passed[name] = key
                KEPT.write_text(json.dumps(passed, indent=1))
            else:
                failed.append(name)
                print('\n'.join(f'    {line}' for line in lines[:-1]), flush=True)

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(visit, paths))
    print(f'{len(paths) - len(failed)} passed, {len(failed)} failed', *failed)
    return bool(failed)


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
