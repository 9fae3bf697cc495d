# SPDX-License-Identifier: Apache-2.0
"""Size of a report, and how long a browser takes to open it.

    .venv/bin/python bench/report.py [--scenes tennis_racket heavy_top] [--duration 20]

A scene is simulated at 1 kHz and analysed; a headless Chromium, which draws without a graphics
card, opens the page. The time ends when the first curves are drawn; the body is drawn before.
The goals are 3 MB and 3 s for 20 s of motion. It needs playwright and the package chromium.
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

from playwright.sync_api import sync_playwright

from rigid_body_sim.compilation.environment import processor

ROOT = pathlib.Path(__file__).resolve().parent.parent
FLAGS = ['--no-sandbox', '--disable-gpu', '--enable-unsafe-swiftshader']
PATIENCE = 60e3    # ms


def report_of(scene, duration, folder):
    """Return the page of a scene's report."""
    recording, report = folder / scene, folder / f'{scene}_report'
    for arguments in (['simulate', '--scene', scene, '--duration', str(duration), '--output',
                       recording], ['analyze', recording, '--output', report]):
        subprocess.run([sys.executable, '-m', 'rigid_body_sim', *map(str, arguments)], cwd=ROOT,
                       check=True, stdout=subprocess.DEVNULL)
    return report / 'report.html'


def opened(browser, page):
    """Return the time (s) until the first curves are drawn, and the addresses asked for."""
    asked, tab = [], browser.new_page(viewport={'width': 1400, 'height': 900})
    tab.on('request', lambda request: asked.append(request.url))
    begin = time.perf_counter()
    tab.goto(page.as_uri())
    tab.wait_for_selector('.main-svg', timeout=PATIENCE)
    took = time.perf_counter() - begin
    tab.close()
    return took, [one for one in asked if not one.startswith(('file:', 'blob:', 'data:'))]


def main():
    """Run the benchmark and print its table; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('--scenes', nargs='+', default=['tennis_racket', 'heavy_top'])
    parser.add_argument('--duration', type=float, default=20.0, help='of the motion, s (20)')
    options = parser.parse_args()
    chromium = shutil.which('chromium') or sys.exit('needs chromium: apt install chromium')
    print(f'{processor().split()[0]}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}\n')
    print(f'{"":22}{"MB":>6}{"seconds, three times":>26}')
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        for scene in options.scenes:
            page = report_of(scene, options.duration, pathlib.Path(folder))
            times, asked = zip(*(opened(browser, page) for _ in range(3)))
            print(f'{scene:22}{page.stat().st_size / 1e6:6.2f}   '
                  f'{"  ".join(f"{one:.2f}" for one in times):>20}  '
                  f'{"asks for " + str(asked) if any(asked) else ""}')
        browser.close()
    return 0


if __name__ == '__main__':
    sys.exit(main())
