# SPDX-License-Identifier: Apache-2.0
"""Make the figures of README and docs, and the tables of the pages.

The figures are docs/images/*.png; the tables are those of docs/systems and docs/corrections.md.

::

    make figures
"""

import importlib
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

from figures import bodies, tables  # noqa: E402  (this folder is on the path only now)
from figures.style import IMAGES, save  # noqa: E402

# image -> scene, seconds, figure of the report
RUNS = {'run': ('tennis_racket', 20, 'overview'), 'recordings': ('heavy_top', 20, 'spectrum')}
NO_FIGURES = (
    '__init__', 'bars', 'bodies', 'error_time', 'marks', 'more_bodies', 'page_tables', 'style',
    'tables')
DRAWN = sorted(path.stem for path in (HERE / 'figures').glob('*.py')
               if path.stem not in NO_FIGURES)


def command(*arguments):
    """Run a command of the package."""
    subprocess.run([sys.executable, '-m', 'rigid_body_sim', *arguments], check=True,
                   cwd=HERE.parent)


def main(names):
    """Make the figures of these names, all by default, and then the tables."""
    for name, (scene, seconds, figure) in RUNS.items():
        if not names or name in names:
            with tempfile.TemporaryDirectory() as folder:
                recording = pathlib.Path(folder) / 'recording'
                command('simulate', '--scene', scene, '--duration', str(seconds),
                        '--output', str(recording))
                command('analyze', str(recording), '--output', folder)
                shutil.copy(pathlib.Path(folder) / f'{figure}.png', IMAGES / f'{name}.png')
    for name in DRAWN:
        if not names or name in names:
            print(f'docs/images/{name}.png')
            save(importlib.import_module(f'figures.{name}').draw(), name)
    for name in bodies.BODIES:
        if not names or {f'body_{name}', 'bodies'} & set(names):
            save(bodies.draw(name), f'body_{name}')
    if not names or 'tables' in names:
        tables.fill()


if __name__ == '__main__':
    main(sys.argv[1:])
