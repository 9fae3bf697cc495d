# SPDX-License-Identifier: Apache-2.0
"""A real browser on a real page; without one these tests are skipped."""

import contextlib
import shutil
import time
import urllib.parse

import pytest

START = 120.0
"""A process that imports numba, viser and rclpy on a loaded machine. Seconds."""
BROWSERS = 'chromium', 'chromium-browser', 'google-chrome'
FLAGS = ['--no-sandbox', '--disable-gpu', '--enable-unsafe-swiftshader', '--disable-quic',
         '--no-first-run', '--disable-background-networking', '--disable-component-update',
         '--disable-sync']
SLOWLY = """
window.requestAnimationFrame = draw => setTimeout(() => draw(performance.now()), 200);
window.cancelAnimationFrame = clearTimeout;
"""
"""Five pictures a second: software that draws sixty of them leaves no time for the mouse."""
WIDTH, HEIGHT = 800, 400
"""A small window of large pixels: it may be drawn by software. The panel is docked on its right
half."""


@pytest.fixture(scope='session')
def chromium():
    """Return a browser (playwright), or skip."""
    pytest.importorskip('viser', reason='viser is not installed')
    pytest.importorskip('playwright.sync_api', reason='playwright is not installed')
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    if path is None:
        pytest.skip('no chromium on this machine')
    from playwright.sync_api import sync_playwright
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def other_chromium(chromium):
    """Return a browser that a test may kill, and the number of its process."""
    browser = chromium.browser_type.launch(
        executable_path=next(filter(None, map(shutil.which, BROWSERS))), args=FLAGS)
    known = browser.new_browser_cdp_session().send('SystemInfo.getProcessInfo')['processInfo']
    yield browser, next(one['id'] for one in known if one['type'] == 'browser')
    with contextlib.suppress(Exception):
        browser.close()


class Tab:
    """A page in the browser, with the addresses that it asked for."""

    def __init__(self, browser, address):
        self.requests = []
        self.page = browser.new_page(
            viewport={'width': WIDTH, 'height': HEIGHT}, device_scale_factor=0.5)
        self.page.on('request', lambda request: self.requests.append(request.url))
        self.page.on('websocket', lambda socket: self.requests.append(socket.url))
        self.page.add_init_script(SLOWLY)
        self.page.goto(address)

    def see(self, text):
        """Wait until a text is shown on the page."""
        self.page.get_by_text(text).first.wait_for(timeout=1000 * START)

    def drag(self, begin, end, hold=1.0):
        """Drag from one point to another (pixels), hold the button for a time (s), let go."""
        self.grab(begin, end)
        time.sleep(hold)
        self.page.mouse.up()

    def cell(self, text):
        """Return what finds the cells of the panel's table of values that have just this text."""
        return self.page.get_by_role('cell', name=text, exact=True)

    def grab(self, begin, end):
        """Drag from one point to another (pixels), and keep the button down."""
        self.page.mouse.move(*begin)
        time.sleep(0.3)
        self.page.mouse.down()
        for k in range(1, 4):
            self.page.mouse.move(*(a + (b - a) * k / 3 for a, b in zip(begin, end)))
            time.sleep(0.1)

    @property
    def outside(self):
        """The addresses asked for that are not on this machine."""
        parts = [urllib.parse.urlsplit(url.removeprefix('blob:')) for url in self.requests]
        return [part.geturl() for part in parts
                if part.scheme != 'data' and part.hostname not in ('127.0.0.1', 'localhost')]


@pytest.fixture
def open_tab(chromium):
    """Return a function that opens an address in a Tab, closed at the end of the test."""
    with contextlib.ExitStack() as stack:
        def opened(address, browser=chromium):
            tab = Tab(browser, address)
            if browser is chromium:    # another one is closed by whoever opened it
                stack.callback(tab.page.close)
            return tab
        yield opened


@pytest.fixture
def address_of():
    """Return a function that returns the address which a process of the command `view` prints."""
    def printed(process):
        line = process.stdout.readline()
        assert line.startswith('http://'), line + process.stderr.read()
        return line.split()[0]
    return printed
