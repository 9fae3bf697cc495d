# SPDX-License-Identifier: Apache-2.0
"""Make docs/images/view.webp, the picture that opens the README: ``python docs/make_animation.py``.

It opens the page of ``view`` in a headless Chromium and takes a picture after each step. It needs
playwright, Pillow and Debian's or Ubuntu's package chromium.
"""

import io
import pathlib
import shutil
import sys
import time

from PIL import Image
from playwright.sync_api import sync_playwright

from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.view.live import Live
from rigid_body_sim.view.page import Page

HERE = pathlib.Path(__file__).resolve().parent
PICTURES, SLOWER, BETWEEN = 84, 2.0, 66
"""Number of pictures, how much slower than real time they play, ms between two of them."""
WINDOW, WIDTH = (1000, 600), 760
START = 120.0
FLAGS = ['--no-sandbox', '--disable-gpu', '--enable-unsafe-swiftshader', '--no-first-run',
         '--disable-background-networking', '--disable-component-update', '--disable-sync']


def until(page, condition):
    """Turn the loop of a page until a condition holds."""
    deadline = time.monotonic() + START
    while not condition():
        if time.monotonic() > deadline:
            sys.exit('the page did not get ready')
        page.turn()
        time.sleep(0.005)


def pictures(page, tab):
    """Yield the pictures of the page, one a step."""
    page.panel.requests.put(('speed', BETWEEN * 1e-3 / SLOWER * 60.0))
    for _ in range(PICTURES):
        before = page.frame.time
        page.panel.requests.put(('run', 'step'))
        until(page, lambda before=before: page.frame.time > before)
        drawn = time.monotonic() + 0.35    # the browser draws by software here
        until(page, lambda drawn=drawn: time.monotonic() > drawn)
        picture = Image.open(io.BytesIO(tab.screenshot()))
        yield picture.convert('RGB').resize((WIDTH, WIDTH * picture.height // picture.width),
                                            Image.Resampling.LANCZOS)


def main():
    """Make the animation."""
    chromium = shutil.which('chromium') or sys.exit('needs chromium: apt install chromium')
    scene = load_scene(HERE / 'figures' / 't_handle.yaml')
    page = Page(Live(scene.text, {'rate': 1000.0}), port=0)
    page.panel.requests.put(('run', 'pause'))
    until(page, lambda: page.frame)
    page.panel.requests.put(('run', 'reset'))
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        tab = browser.new_page(viewport=dict(zip(('width', 'height'), WINDOW)))
        tab.goto(page.address)
        until(page, page.server.get_clients)
        settled = time.monotonic() + 5.0
        until(page, lambda: time.monotonic() > settled)
        tab.add_style_tag(content='.mantine-Notification-root { display: none; }')
        made = list(pictures(page, tab))
        browser.close()
    page.close()
    path = HERE / 'images' / 'view.webp'
    made[0].save(path, save_all=True, append_images=made[1:], duration=BETWEEN, loop=0,
                 quality=55, method=6)
    print(f'{path.relative_to(HERE.parent)}: {path.stat().st_size // 1000} kB')


if __name__ == '__main__':
    main()
