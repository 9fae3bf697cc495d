# SPDX-License-Identifier: Apache-2.0
"""Opens config/foxglove.json in Foxglove itself, beside a recording, and takes a picture.

    .venv/bin/python bench/foxglove.py [--scene heavy_top] [--dark] --output picture.png

The last free edition of Foxglove Studio is in the npm registry, as a library without the page
around it; a page of twenty lines opens it. It needs npm, playwright and the package chromium.
"""

import argparse
import functools
import http.server
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import threading

from playwright.sync_api import sync_playwright

ROOT = pathlib.Path(__file__).resolve().parent.parent
LAYOUT = ROOT / 'config' / 'foxglove.json'
PACKAGES = ('@foxglove/studio-base@1.48.0', 'react@17.0.2', 'react-dom@17.0.2')
PARTS = {'studio-base': 'assets/', 'react-17': 'umd/react.production.min.js',
         'react-dom': 'umd/react-dom.production.min.js'}
FLAGS = ['--no-sandbox', '--disable-gpu', '--enable-unsafe-swiftshader']
LOADED, PLAYED = 60e3, 6e3    # ms
PAGE = """<!doctype html><meta charset="utf-8">
<style>html, body, #root { height: 100%; margin: 0 }</style><div id="root"></div>
<script>window.global = window; window.process = {env: {}, cwd: () => '/'};
window.FOXGLOVE_STUDIO_VERSION = '1.48.0';</script>
<script src="react.production.min.js"></script><script src="react-dom.production.min.js"></script>
<script>window.react = React; window['react-dom'] = ReactDOM;</script>
<script src="index.js"></script><script>(async () => {
  const data = await (await fetch('layout.json')).json(), id = 'ours';
  const layout = {id, name: id, permission: 'CREATOR_WRITE', baseline: {data}};
  const kept = new Map([[id, layout]]);
  const storage = {list: async () => [...kept.values()], get: async (_, one) => kept.get(one),
    put: async (_, one) => { kept.set(one.id, one); return one; }, delete: async () => {},
    importLayouts: async () => {}};
  localStorage.setItem('studio.profile-data', JSON.stringify({currentLayoutId: id}));
  const settings = {colorScheme: new URLSearchParams(location.search).get('scheme'),
    'telemetry.telemetryEnabled': false, 'telemetry.crashReportingEnabled': false};
  const configuration = {get: key => settings[key], set: async () => {},
    addChangeListener() {}, removeChangeListener() {}};
  await initI18n();
  ReactDOM.render(React.createElement(App, {deepLinks: [location.href],
    appConfiguration: configuration, dataSources: [new RemoteDataSourceFactory()],
    layoutStorage: storage, extensionLoaders: [], enableGlobalCss: true}),
    document.getElementById('root'));
})();</script>"""


class Ranges(http.server.SimpleHTTPRequestHandler):
    """Serves files and parts of files; a recording is read in parts."""

    def log_message(self, *_):
        """Say nothing."""

    def do_GET(self):
        """Answer a request."""
        path = pathlib.Path(self.translate_path(self.path))
        wanted = re.match(r'bytes=(\d+)-(\d*)', self.headers.get('Range', ''))
        if not wanted or not path.is_file():
            super().do_GET()
            return
        data = path.read_bytes()
        first, last = int(wanted[1]), min(int(wanted[2] or len(data)), len(data) - 1)
        self.send_response(206)
        self.send_header('Content-Range', f'bytes {first}-{last}/{len(data)}')
        self.send_header('Content-Length', str(last - first + 1))
        self.end_headers()
        self.wfile.write(data[first:last + 1])

    def end_headers(self):
        """End the headers; the recording may be read by parts."""
        self.send_header('Accept-Ranges', 'bytes')
        super().end_headers()


def gathered(folder, scene):
    """Put Foxglove, the layout and a recording of a scene into a folder."""
    npm = shutil.which('npm') or sys.exit('needs npm')
    for package in PACKAGES:
        subprocess.run([npm, 'pack', package], cwd=folder, check=True, capture_output=True)
    for archive in folder.glob('*.tgz'):
        wanted = next(part for name, part in PARTS.items() if name in archive.name)
        with tarfile.open(archive) as packed:
            for member in packed:
                if member.isfile() and member.name.startswith(f'package/{wanted}'):
                    place = folder / pathlib.Path(member.name).name
                    place.write_bytes(packed.extractfile(member).read())
    subprocess.run([sys.executable, '-m', 'rigid_body_sim', 'simulate', '--scene', scene,
                    '--duration', '10', '--rate', '200', '--publish', 'odom', 'marker',
                    '--output', folder / 'run'], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    (folder / 'run' / 'run_0.mcap').rename(folder / 'run.mcap')
    shutil.copy(LAYOUT, folder / 'layout.json')
    (folder / 'index.html').write_text(PAGE)


def missing(page):
    """Return the texts of the layout that a page of Foxglove does not show."""
    panels = json.loads(LAYOUT.read_text())['configById']
    wanted = [panel['title'] for panel in panels.values() if 'title' in panel]
    shown = page.inner_text('body')
    return [text for text in [*wanted, '/marker', '/pose'] if text not in shown] + [
        line for line in shown.splitlines() if 'nknown panel' in line]


def main():
    """Open the layout; return 1 if a panel is not there."""
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('--scene', default='heavy_top')
    parser.add_argument('--dark', action='store_true')
    parser.add_argument('--output', required=True, help='picture to make')
    options = parser.parse_args()
    chromium = shutil.which('chromium') or sys.exit('needs chromium: apt install chromium')
    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright:
        gathered(pathlib.Path(name), options.scene)
        server = http.server.ThreadingHTTPServer(
            ('127.0.0.1', 0), functools.partial(Ranges, directory=name))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        site = f'http://127.0.0.1:{server.server_port}'
        browser = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        page = browser.new_page(viewport={'width': 1400, 'height': 900})
        page.goto(f'{site}/index.html?ds=remote-file&ds.url={site}/run.mcap&scheme='
                  + ('dark' if options.dark else 'light'))
        page.get_by_text('/angular_velocity').first.wait_for(timeout=LOADED)
        page.wait_for_timeout(PLAYED)
        page.keyboard.press('Space')
        page.wait_for_timeout(PLAYED)
        page.screenshot(path=options.output)
        lost = missing(page)
        browser.close()
        server.shutdown()
    print(f'not shown: {", ".join(lost)}' if lost else 'every panel of the layout is shown')
    return 1 if lost else 0


if __name__ == '__main__':
    sys.exit(main())
