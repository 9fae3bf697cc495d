# SPDX-License-Identifier: Apache-2.0
"""Make docs/images/view.webp, the README's first picture: ``python docs/make_animation.py``.

A T-handle is simulated, and the body that reports and notebooks show is drawn frame by frame in a
headless Chromium. It needs playwright, Pillow and Debian's or Ubuntu's package chromium.
"""

import base64
import io
import pathlib
import shutil
import sys
import tempfile

from PIL import Image
from playwright.sync_api import sync_playwright

from rigid_body_sim import Simulation

HERE = pathlib.Path(__file__).resolve().parent
SECONDS, SLOWER, BETWEEN = 4.0, 2.0, 66
"""Simulated time (s), slow-motion factor, time between two pictures (ms)."""
SIZE = (640, 360)
BACKGROUND = (243, 244, 246)
DRAW = """k => {
    const slider = document.querySelector('input');
    slider.value = k;
    slider.oninput();
    return document.querySelector('canvas').toDataURL();
}"""


def pictures(tab):
    """Yield the pictures of the page of a View."""
    count = int(tab.evaluate("document.querySelector('input').max")) + 1
    wanted = int(SECONDS * SLOWER * 1000.0 / BETWEEN)
    for k in range(wanted):
        data = tab.evaluate(DRAW, k * count // wanted).partition(',')[2]
        drawn = Image.open(io.BytesIO(base64.b64decode(data))).convert('RGBA')
        page = Image.new('RGBA', drawn.size, (*BACKGROUND, 255))
        yield Image.alpha_composite(page, drawn).convert('RGB').resize(
            SIZE, Image.Resampling.LANCZOS)


def main():
    """Make the animation."""
    chromium = shutil.which('chromium') or sys.exit('needs chromium: apt install chromium')
    simulation = Simulation(HERE / 'figures' / 't_handle.yaml')
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        page = pathlib.Path(folder) / 'page.html'
        simulation.view(SECONDS).save(page)
        browser = playwright.chromium.launch(
            executable_path=chromium,
            args=['--no-sandbox', '--disable-gpu', '--enable-unsafe-swiftshader'])
        tab = browser.new_page(viewport={'width': 1000, 'height': 800}, device_scale_factor=2)
        tab.goto(page.as_uri())
        tab.add_style_tag(content=f'.body {{ width: {SIZE[0]}px; height: {SIZE[1]}px; }}')
        made = list(pictures(tab))
        browser.close()
    path = HERE / 'images' / 'view.webp'
    made[0].save(path, save_all=True, append_images=made[1:], duration=BETWEEN, loop=0,
                 quality=50, method=3)
    print(f'{path.relative_to(HERE.parent)}: {len(made)} pictures, '
          f'{path.stat().st_size // 1000} kB')


if __name__ == '__main__':
    main()
