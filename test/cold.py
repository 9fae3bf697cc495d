# SPDX-License-Identifier: Apache-2.0
"""Run each test file alone, with an empty kernel cache: none may depend on another.

::

    python test/cold.py                          # all files, hours of compiling; make test-cold
    python test/cold.py test/motions             # those below some folders
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
ELSEWHERE = {'test_installed.py'}    # what colcon runs on the installed package


def main(folders):
    """Run the files of some folders, print a line for each; return the exit status."""
    paths = sorted(path for folder in folders or ['test'] for path in
                   ([ROOT / folder] if folder.endswith('.py')
                    else (ROOT / folder).rglob('test_*.py'))
                   if path.name not in ELSEWHERE)
    failed = []
    for path in paths:
        begin = time.monotonic()
        with tempfile.TemporaryDirectory() as cache:
            run = subprocess.run([sys.executable, '-m', 'pytest', '-q', '--timeout', '1200', path],
                                 cwd=ROOT, env=os.environ | {'XDG_CACHE_HOME': cache},
                                 capture_output=True, text=True)
        lines = run.stdout.strip().splitlines() or run.stderr.strip().splitlines() or ['nothing']
        print(f'{path.relative_to(ROOT)}: {lines[-1]} ({time.monotonic() - begin:.0f} s)',
              flush=True)
        # 5: no test of this file runs here
        if run.returncode not in (0, 5):
            failed.append(str(path.relative_to(ROOT)))
            print('\n'.join(f'    {line}' for line in lines[-40:-1]), flush=True)
    print(f'{len(paths) - len(failed)} passed, {len(failed)} failed', *failed)
    return bool(failed)


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
