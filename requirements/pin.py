# SPDX-License-Identifier: Apache-2.0
"""Write NAME.txt with the versions of all packages that NAME.in needs: ``pin.py NAME``.

The pip of the running Python finds them. Run it with the oldest Python that is to use the file:
new versions of packages drop old Pythons.
"""

import json
import pathlib
import platform
import subprocess
import sys


def main(name):
    """Pin one file."""
    folder = pathlib.Path(__file__).resolve().parent
    pip = [sys.executable, '-m', 'pip', 'install', '--quiet', '--dry-run', '--ignore-installed',
           '--report', '-']
    report = subprocess.run([*pip, '-r', folder / f'{name}.in'], stdout=subprocess.PIPE,
                            check=True).stdout
    packages = sorted((package['metadata'] for package in json.loads(report)['install']),
                      key=lambda package: package['name'].lower())
    lines = [f'# Made by requirements/pin.py from {name}.in with Python '
             f'{platform.python_version()}.']
    lines += [f'{package["name"]}=={package["version"]}' for package in packages]
    (folder / f'{name}.txt').write_text('\n'.join(lines) + '\n')


if __name__ == '__main__':
    main(*sys.argv[1:])
