# SPDX-License-Identifier: Apache-2.0
"""The pages: their numbers are those of check_scenes, and pictures, links and commands exist."""

import ast
import importlib
import os
import pathlib
import re
import shlex
import subprocess
import sys

import pytest
from near import near
from soak import IN_SOAK

from rigid_body_sim.cli.subcommands import SUBCOMMANDS
from rigid_body_sim.integrators.marching import contact_succession
from rigid_body_sim.mechanics import events
from rigid_body_sim.motions import sliding_sphere
from rigid_body_sim.scene.effects import EFFECTS
from rigid_body_sim.scene.scene import load_scene, scene_names

DOCS = pathlib.Path(__file__).resolve().parent.parent / 'docs'
sys.path.insert(0, str(DOCS))
import make_accuracy  # noqa: E402  (docs/ is no package)
import make_figures  # noqa: E402
import make_reference  # noqa: E402
from figures import page_tables, tables  # noqa: E402

README = DOCS.parent / 'README.md'
PAGES = sorted(DOCS.rglob('*.md'))
HANDOUTS = [path for path in PAGES if path.parent.name == 'systems' and path.stem != 'index']
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
    return all(any(words == other and found == near(shown, rel=2e-9)
                   for shown, other in there)
               for found, words in map(numbers, part.splitlines()))


def test_every_scene_has_a_page():
    text = ''.join(path.read_text() for path in (DOCS / 'systems').glob('*.md'))
    for name in scene_names():
        assert f'config/scenes/{name}.yaml' in text, name


COST = re.compile(r'\d\s?(?:us|µs|ns)\b|\b(?:a|\d[\d.]*) microseconds?|\d CPU (?:s\b|seconds|ms)'
                  r'|\d (?:%|s) of (?:a core|CPU)|million (?:states|messages|runs)')
COMMAND = re.compile(r'bench/\w+\.py|make [a-z]|python -m rigid_body_sim')
PROCESSOR, DAY = re.compile(r'Zen [345]|znver[345]'), re.compile(r'November 2026|2026-\d\d-\d\d')


def _names_its_machine(text):
    """Return whether one paragraph of a page names both the processor and the day."""
    return any(PROCESSOR.search(part) and DAY.search(part) for part in text.split('\n\n'))


@pytest.mark.parametrize('path', [*PAGES, README], ids=lambda path: path.stem)
def test_times_rest_on_a_processor_a_day_and_a_command_that_are_named(path):
    """On the page itself, or on one that every paragraph with a time refers to."""
    text = path.read_text()
    if _names_its_machine(text):
        assert COMMAND.search(text)
        return
    for part in filter(COST.search, text.split('\n\n')):
        pages = [path.parent / target for target in re.findall(r'\]\(([^)#:]+\.md)', part)]
        assert any(_names_its_machine(page.read_text()) for page in pages), part


def test_a_second_machine_is_measured_where_methods_are_compared():
    other, many, accuracy = ((DOCS / f'{page}.md').read_text() for page in (
        'methods/another_processor', 'methods/many_bodies', 'accuracy/problems'))
    assert '| | AVX-512 | AVX2 | ratio |' in other
    assert 'Zen 5' in many and 'Zen 3' in many
    assert '(../methods/another_processor.md)' in accuracy


WITHOUT_FIGURE = 'closed_forms', 'end_of_a_run', 'lost'    # tables of words


@pytest.mark.parametrize('path', [
    path for folder in ('methods', 'accuracy', 'extending')
    for path in (DOCS / f'{folder}.md', *sorted((DOCS / folder).glob('*.md')))
    if path.stem not in WITHOUT_FIGURE], ids=lambda path: str(path.relative_to(DOCS)))
def test_a_page_asks_one_question_and_ends_in_a_figure(path):
    text = path.read_text()
    assert re.match(r'# .*\?\n', text) and len(text.splitlines()) <= 100
    picture, caption = re.search(r'images/(\w+)\.png\)\n\n\*((?:.+\n)+)\Z', text).groups()
    assert COMMAND.search(caption)
    assert (picture in make_figures.DRAWN) == ('`make figures`' in caption)


def test_the_headline_shows_ours_and_the_best_peer_of_each_of_three_programs():
    headline = importlib.import_module('figures.headline')

    def line(name, *points):
        return {'name': name, 'points': [{'cpu': {'median': time}, 'error': error}
                                         for time, error in points]}
    found = headline.best([
        line('slow RK4', (9.0, 1e-9)), line('quick', (3.0, 1e-4), (1.0, 1e-2)),
        line('quick, 80 bit', (8.0, 1e-15)), line('coarse', (0.1, 0.5)),
        line('slow RK5', (4.0, 0.0))])
    assert [one['name'] for one in found] == ['quick', 'slow RK5']    # coarse is not good enough
    [axes] = headline.draw().axes
    assert [text.get_text() for text in axes.texts][1:] == [
        'closed form, at any time and accuracy', 'taylor, stepped', 'heyoka', 'numba RK4',
        'MuJoCo RK4']
    assert '(docs/images/headline.png)' in README.read_text()


@pytest.mark.parametrize(('arguments', 'data', 'pages'), [
    ((), 'work_precision', ['problems', 'plane']),
    (('--second',), 'work_precision_second', ['second_processor'])])
def test_the_tables_of_accuracy_are_those_of_their_data(
        arguments, data, pages, tmp_path, monkeypatch):
    """What is measured again is joined to the data that is kept: alone it makes the same pages."""
    others = {'problems', 'plane', 'second_processor'} - set(pages)
    (tmp_path / 'accuracy').mkdir()
    for page in pages:
        said = (DOCS / 'accuracy' / f'{page}.md').read_text()
        begin = said.index('<!-- ')
        begin += said[begin:].index('\n') + 1
        (tmp_path / 'accuracy' / f'{page}.md').write_text(
            said[:begin] + 'an older table\n' + said[said.index('<!-- end -->', begin):])
    drawn = []

    class Drawn:
        def savefig(self, path, **options):
            drawn.append(path.stem)
    monkeypatch.setattr(make_accuracy, 'DOCS', tmp_path)
    monkeypatch.setattr(make_accuracy.figure, 'draw', lambda results: Drawn())
    make_accuracy.main(*arguments, DOCS / f'{data}.json')
    for name in (*(f'accuracy/{page}.md' for page in pages), f'{data}.json'):
        assert (tmp_path / name).read_text() == (DOCS / name).read_text(), name
    assert not any((tmp_path / 'accuracy' / f'{page}.md').exists() for page in others)
    assert len(drawn) == (0 if arguments else 3)


def test_figures_of_costs_draw_the_numbers_of_their_tables():
    assert page_tables.numbers('82 (0.43)') == [82.0, 0.43]
    assert page_tables.numbers('1.13 (1e-4)') == [1.13, 1e-4]
    assert page_tables.numbers('0.39* (not reached)') == [0.39]
    assert page_tables.groups([['a', 'x', '1'], ['', 'y', '2'], ['b', 'x', '3']]) == {
        'a': {'x': ['1'], 'y': ['2']}, 'b': {'x': ['3']}}
    figure = importlib.import_module('figures.cost_many_bodies').draw()
    found = {tuple(line.get_xydata()[0]) for line in figure.axes[0].lines
             if len(line.get_xdata()) == 1}
    title, cell, *_ = page_tables.table('methods/many_bodies', 1)[-1]
    ours, theirs = page_tables.numbers(cell)
    assert title == 'damped hinge'
    assert (ours / theirs, 0.0) in found    # the last row is the lowest


def anchors(text):
    """Return the names by which links find the headings of a page."""
    prose = re.sub(r'^```.*?^```$', '', text, flags=re.DOTALL | re.MULTILINE)
    return {re.sub(r'[^\w\- ]', '', title.lower()).replace(' ', '-')
            for title in re.findall(r'^#+ (.*)$', prose, re.MULTILINE)}


@pytest.mark.parametrize('path', [*PAGES, *DOCS.parent.glob('*.md')], ids=lambda path: path.stem)
def test_links_lead_somewhere(path):
    for target, heading in re.findall(r'\]\(([^)#:]*)#?([^):]*)\)', path.read_text()):
        assert (path.parent / target).exists(), target
        if heading:
            assert heading in anchors((path.parent / target if target else path).read_text())


def test_every_page_is_in_the_site():
    """Each is in a table of contents; `make docs` fails on a page that is in none."""
    listed = set(re.findall(r'^[\w/]+$', (DOCS / 'index.md').read_text(), re.MULTILINE))
    folders = {'systems': 'systems/index', 'methods': 'methods', 'accuracy': 'accuracy',
               'extending': 'extending'}
    for path in PAGES:
        page = path.relative_to(DOCS).with_suffix('').as_posix()
        folder = page.partition('/')[0] if '/' in page else None
        if folder in folders:    # the page of the folder lists all of it
            page = folders[folder]
            assert re.search(r':glob:\n\n(\w+/)?\*\n', (DOCS / f'{page}.md').read_text())
        assert page in listed | {'index'}, page


@pytest.mark.parametrize('page', ['topics', 'subcommands', 'parameters', 'effects'])
def test_tables_of_the_reference_are_those_of_the_package(page):
    if page == 'parameters':
        pytest.importorskip('rclpy')
    text = (DOCS / 'reference' / f'{page}.md').read_text()
    assert make_reference.filled(text) == text, 'run: python docs/make_reference.py'


def test_the_readme_is_short():
    """Half of the 1,910 words it once had; parameters, topics and costs have their pages."""
    assert len(README.read_text().split()) <= 950


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
        assert line.split()[0] in SUBCOMMANDS
        scene = re.search(r'--scene (\w+)(?= |$)', line)
        overrides = re.findall(r'--set (?:"([^"]+)"|(\S+))', line)
        if scene and scene[1] in scene_names():
            load_scene(scene[1], [quoted or plain for quoted, plain in overrides])


def test_every_effect_has_its_law_and_keys_on_the_page_of_scenes():
    text = (DOCS / 'scenes.md').read_text()
    for name, effect in EFFECTS.items():
        rows = [line.split(' | ') for line in text.splitlines() if line.startswith(f'| `{name}`')]
        assert rows and all(len(row) == 4 and all(row) for row in rows), name
        for key in effect.SCHEMA['properties']:
            assert any(f'`{key}`' in row[2] or f'`{key}:' in row[2] for row in rows), (name, key)


def test_every_event_is_on_the_page_of_scenes():
    names = {*events.WATCHED, *sliding_sphere.EVENTS, *contact_succession.BEGAN.values()}
    source = pathlib.Path(contact_succession.__file__).read_text()
    names |= set(re.findall(r"events.append\(\([^']*'([^']+)'", source))
    assert {'impact', 'lift-off', 'rest', 'flip'} <= names
    text = (DOCS / 'scenes.md').read_text()
    for name in names:
        assert f'`{name}`' in text, name


def test_every_handout_has_all_its_parts():
    """Question, labelled body, scene, symbols with units, steps, both columns, what to try."""
    for path in HANDOUTS:
        text = path.read_text()
        head, *parts = re.split(r'^## (.*)\n', text, flags=re.MULTILINE)
        assert re.match(r'# .*\?\n', head), path.stem
        assert f'](../images/body_{path.stem}.png)' in head, path.stem
        shapes = path.stem == 'inertia_tensors'     # its bodies do not move
        assert shapes or re.search(r'^Scenes?: \[`', head, re.MULTILINE), path.stem
        titles, bodies = parts[::2], parts[1::2]
        assert titles == ['Symbols', 'From the law to the result', 'Theory and measurement',
                          'Try it'], path.stem
        symbols, steps, table, tries = bodies
        rows = [re.split(r' *(?<!\\)\| *', line.strip('| ')) for line in symbols.split('\n')
                if line.startswith('|')]
        assert rows[0] == ['symbol', 'meaning', 'unit'] and len(rows) > 3, path.stem
        assert all(len(row) == 3 and all(row) for row in rows), path.stem
        assert len(re.findall(r'^\d\. ', steps, re.MULTILINE)) >= 2, path.stem
        assert '$$' in steps, path.stem
        assert '| predicted | measured |' in table, path.stem
        assert '\npython -m rigid_body_sim ' in tries, path.stem


NAMES = re.compile(r'\\[A-Za-z]+|[A-Za-z]')
NO_SYMBOLS = re.compile(
    r'\\(Delta|approx|arctan|cdot|cos|cot|ddot|dot|frac|ge|gg|infty|int|langle|ldots|le|left|ll|'
    r'mathbf|max|min|ne|partial|perp|pi|qquad|quad|rangle|right|sin|sqrt|sum|tfrac|tilde|times)')


def symbols(text):
    """Return the letters of the formulas of a text, without words, indices and powers."""
    found = set()
    for displayed, inline in re.findall(r'\$\$(.*?)\$\$|\$(.*?)\$', text, re.DOTALL):
        formula = re.sub(r'\\(text|operatorname)\{.*?\}|[_^](\{.*?\}|\\?\w+)', ' ',
                         displayed or inline)
        found |= set(NAMES.findall(formula))
    return {name for name in found if not NO_SYMBOLS.fullmatch(name)} - set('deitxyz')


def test_every_symbol_of_the_steps_is_in_the_table():
    """Whatever a formula of a handout says has its meaning and its unit."""
    assert symbols(r'$\frac12 M g \dot\beta^2_0 + \text{const}$') == {'M', 'g', r'\beta'}
    for path in HANDOUTS:
        _, table, steps = re.split(r'^## (?:Symbols|From the law to the result)$',
                                   path.read_text().partition('## Theory')[0], flags=re.MULTILINE)
        assert symbols(steps) <= symbols(table), (path.stem, symbols(steps) - symbols(table))


@IN_SOAK
@pytest.mark.parametrize('path', HANDOUTS, ids=lambda path: path.stem)
def test_what_a_handout_proposes_to_try_runs(path, tmp_path):
    for line in re.findall(r'^python -m rigid_body_sim (.*)$', path.read_text(), re.MULTILINE):
        done = subprocess.run([sys.executable, '-m', 'rigid_body_sim', *shlex.split(line)],
                              cwd=tmp_path, env=os.environ | {'PYTHONPATH': str(DOCS.parent)},
                              capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, (line, done.stderr)


def test_every_handout_names_its_source():
    """A section of the notes that the index lists, or authors with a year."""
    index = (DOCS / 'systems' / 'index.md').read_text()
    sections = [row.split(' | ')[0].strip('| ').lower()
                for row in index.splitlines() if row.startswith('| ')]
    for path in HANDOUTS:
        steps = path.read_text().partition('## From the law to the result\n\n')[2]
        source = ' '.join(steps.partition('\n\n')[0].split())
        cited = re.findall(r'"([^"]+)"', source) if source.startswith('Notes, ') else []
        if cited:
            first = cited[0].lower().replace('→', 'to')
            assert any(first in section or section in first for section in sections), path.stem
        else:
            assert re.search(r'[A-Z]\. [A-Z].*\b(18|19|20)\d\d\b', source), path.stem


def test_figures_of_the_gallery_name_their_processor_date_and_command():
    """Once for all pages of systems, which show no times of computing."""
    index = (DOCS / 'systems' / 'index.md').read_text()
    assert re.search(r'`make figures`.*AMD EPYC.*\b20\d\d\b', index, re.DOTALL)
    for path in HANDOUTS:
        text = path.read_text()
        assert not re.search(r'CPU|\d (µs|us|ns)\b|processor', text), path.stem
        for scene in re.findall(r'<!-- check_scenes: (\w+) -->', text):
            assert scene in text.replace(f'check_scenes: {scene}', ''), path.stem


def test_a_picture_of_other_numbers_than_the_scene_s_says_so():
    """The page says what differs before a figure that changes keys of its scene."""
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
