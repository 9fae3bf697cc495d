# SPDX-License-Identifier: Apache-2.0
"""The pages: their numbers are those of check_scenes, and pictures, links and commands exist."""

import ast
import pathlib
import re
import sys

import pytest

from rigid_body_sim.cli.subcommands import COMMANDS
from rigid_body_sim.scene.scene import load_scene, scene_names

DOCS = pathlib.Path(__file__).resolve().parent.parent / 'docs'
sys.path.insert(0, str(DOCS))
import make_reference  # noqa: E402  (docs/ is no package)
from figures import tables  # noqa: E402

README = DOCS.parent / 'README.md'
PAGES = sorted(DOCS.rglob('*.md'))
# scenes whose kernels other tests compile anyway; one function makes the other tables too
QUICK = {'inertia_tensors', 'kater_pendulum', 'symmetric_top', 'chandler_wobble', 'asymmetric_top',
         'heavy_top', 'fast_top'}


def numbers(text):
    """Return the numbers of a table, and its words without them."""
    pattern = r'(?<![A-Za-z_^/(])[-+]?\d+\.?\d*(?:e[-+]?\d+)?'
    return [float(number) for number in re.findall(pattern, text)], re.sub(pattern, '#', text)


@pytest.mark.parametrize('path', tables.pages(), ids=lambda path: path.stem)
def test_numbers_of_the_page_are_those_of_check_scenes(path):
    text = path.read_text()
    if path.stem == 'corrections':
        for erratum in tables.ERRATA:
            if erratum[2] in QUICK:
                assert _same(tables.correction(*erratum), text), erratum
    fresh = tables.filled(text.replace('<!-- corrections -->', '<!-- left as it is -->'), QUICK)
    assert _same(
        fresh, text.replace('<!-- corrections -->', '<!-- left as it is -->')), 'run: make figures'


def _same(part, text):
    """Return whether each line of one text is in another, numbers to two units of last place."""
    there = [numbers(line) for line in text.splitlines()]
    return all(any(words == other and found == pytest.approx(shown, rel=2e-9)
                   for shown, other in there)
               for found, words in map(numbers, part.splitlines()))


def test_every_scene_has_a_page():
    text = ''.join(path.read_text() for path in (DOCS / 'systems').glob('*.md'))
    for name in scene_names():
        assert f'config/scenes/{name}.yaml' in text, name


@pytest.mark.parametrize('path', [*PAGES, README], ids=lambda path: path.stem)
def test_links_lead_somewhere(path):
    for target in re.findall(r'\]\(([^)#:]+)\)', path.read_text()):
        assert (path.parent / target).exists(), target


def test_every_page_is_in_the_site():
    """Each is in a table of contents; `make docs` fails on a page that is in none."""
    listed = set(re.findall(r'^[\w/]+$', (DOCS / 'index.md').read_text(), re.MULTILINE))
    for path in PAGES:
        page = path.relative_to(DOCS).with_suffix('').as_posix()
        assert page in listed | {'index'} or page.startswith('systems/'), page


@pytest.mark.parametrize('page', ['topics', 'commands', 'parameters'])
def test_tables_of_the_reference_are_those_of_the_package(page):
    if page == 'parameters':
        pytest.importorskip('rclpy')
    text = (DOCS / 'reference' / f'{page}.md').read_text()
    assert make_reference.filled(text) == text, 'run: python docs/make_reference.py'


def test_the_readme_is_short():
    """What a user needs first; parameters, topics and costs have pages of their own."""
    assert len(README.read_text().split()) < 1000


def test_the_gallery_shows_every_page_and_pictures_are_small():
    text = README.read_text()
    for path in (DOCS / 'systems').glob('*.md'):
        assert f'(docs/systems/{path.name})' in text
        if path.stem == 'index':
            continue
        assert (f'](../images/{path.stem}.png)\n'
                == path.read_text()[-len(f'](../images/{path.stem}.png)\n'):])
        for picture in (f'{path.stem}.png', f'body_{path.stem}.png'):
            assert (DOCS / 'images' / picture).stat().st_size < 100_000


@pytest.mark.parametrize('path', [*tables.pages(), DOCS / 'scenes.md'], ids=lambda path: path.stem)
def test_commands_of_the_page_exist_and_their_overrides_hold(path):
    for line in re.findall(r'^python -m rigid_body_sim (.*)$', path.read_text(), re.MULTILINE):
        assert line.split()[0] in COMMANDS
        scene = re.search(r'--scene (\w+)(?= |$)', line)
        overrides = re.findall(r'--set (?:"([^"]+)"|(\S+))', line)
        if scene and scene[1] in scene_names():
            load_scene(scene[1], [quoted or plain for quoted, plain in overrides])


def test_a_picture_of_other_numbers_than_the_scene_s_says_so():
    """Before a figure that changes keys of its scene stands what differs."""
    checked = []
    for path in sorted((DOCS / 'figures').glob('*.py')):
        calls = [node for node in ast.walk(ast.parse(path.read_text()))
                 if isinstance(node, ast.Call) and getattr(node.func, 'id', '') == 'run']
        if not any(len(call.args) > 1 for call in calls):
            continue
        pages = [text for page in (DOCS / 'systems').glob('*.md')
                 if f'](../images/{path.stem}.png)' in (text := page.read_text())]
        assert pages
        for text in pages:
            last = text.rpartition('![')[0].rstrip().split('\n\n')[-1]
            assert last.startswith('Where the picture departs from the scene'), path.stem
        checked.append(path.stem)
    assert 'heavy_top' in checked
