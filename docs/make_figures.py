"""Make the figures of README and docs anew: docs/images/*.png.

::

    .venv/bin/python docs/make_figures.py
"""

import pathlib
import shutil
import subprocess
import sys
import tempfile

IMAGES = pathlib.Path(__file__).resolve().parent / 'images'
RUNS = {'run': ('tennis_racket', 20)}


def command(*arguments):
    """Run a command of the package."""
    subprocess.run([sys.executable, '-m', 'rigid_body_sim', *arguments], check=True, cwd=IMAGES.parent.parent)


def main():
    """Simulate, analyse, keep the figure."""
    IMAGES.mkdir(exist_ok=True)
    for name, (scene, seconds) in RUNS.items():
        with tempfile.TemporaryDirectory() as folder:
            recording = pathlib.Path(folder) / 'recording'
            command('simulate', '--scene', scene, '--duration', str(seconds), '--output', str(recording))
            command('analyze', str(recording), '--output', folder)
            shutil.copy(pathlib.Path(folder) / 'overview.png', IMAGES / f'{name}.png')


if __name__ == '__main__':
    main()
