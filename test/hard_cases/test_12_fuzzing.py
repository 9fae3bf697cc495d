# SPDX-License-Identifier: Apache-2.0
"""Group 12, mutated scene files: each runs or gets one clear line, in bounded time and memory."""

import os
import pathlib
import random
import re
import subprocess
import sys
import time

import numpy as np
import pytest
from hard_cases.random_scenes import in_one_line
from soak import SOAK

from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.motions import absorbing_motion
from rigid_body_sim.scene.scene import parse_scene, scene_folder
from rigid_body_sim.simulation.simulation import Simulation

FILES = 100_000 if SOAK else 1000
RUN_EVERY = 10
NUMBERS = [
    '0', '-1', '1e308', '-1e308', '1e309', '.inf', '-.inf', '.nan', '5e-324', '1e-300', '9' * 400,
    '0x10', '1_000', '1:30', '07', '+.5e', 'true', 'null', '~', '""', '[]', '{}', '[1, 2]',
    '[1, 2, 3]', '*a', '&a 1', '!!python/object:os.system 1', '"\\u0000"', 'é', '1e', '1e-3']
LINES = ['\t', ' ' * 50, 'body: {mass: 1.0}', 'effects: []', '---', '...', '? a', '- a',
         '%YAML 9.9', '&a [*a]', '<<: *a', 'scene: x', '\x00', '\x85', '\ufeff', '{' * 40,
         '[' * 3000, 'a: ' * 200, '#' * 1000, '\u2028', 'commands: maybe',
         'constraint: {hinge: {axis: [0, 0, 0]}}', '"' * 3, "it's: 'x", 'about: |', 'about: >',
         '!!binary aGk=', 'x: !!float 1', '1: 2', 'null: 1', 'initial: {tilt: 0.5, spin: 1e200}']


def mutated(text, source):
    """Return a scene text with one to four changes."""
    for _ in range(source.randint(1, 4)):
        lines, kind = text.split('\n'), source.randrange(9)
        place = source.randrange(len(lines))
        if kind == 0:
            numbers = list(re.finditer(r'-?\d+\.?\d*(?:e-?\d+)?', text))
            if numbers:
                found = source.choice(numbers)
                text = text[:found.start()] + source.choice(NUMBERS) + text[found.end():]
        elif kind == 1:
            text = '\n'.join([*lines[:place], source.choice(LINES), *lines[place:]])
        elif kind == 2:
            text = '\n'.join([*lines[:place], *lines[place + 1:]])
        elif kind == 3:
            text = '\n'.join([*lines[:place], lines[place], *lines[place:]])
        elif kind == 4 and text:
            at = source.randrange(len(text))
            text = (text[:at] + chr(source.choice([
                *range(128), 0x85, 0xa0, 0x2028, 0xfeff, 0xfffd, 0x1f600])) + text[at + 1:])
        elif kind == 5 and text:
            at = source.randrange(len(text))
            text = text[:at] + text[at + source.randint(1, 20):]
        elif kind == 6 and text:
            first, last = sorted((source.randrange(len(text)), source.randrange(len(text))))
            text = text[:first] + text[first:last] * source.randint(2, 3) + text[last:]
        elif kind == 7:
            words = re.findall(r'[a-z_]{3,}', text)
            if words:
                text = text.replace(source.choice(words), source.choice(words), 1)
        else:
            text = text[:source.randrange(len(text) + 1)]
    return text


def outcome(text, run):
    """Return 'runs' or 'refused'; anything else is raised."""
    try:
        scene = parse_scene(text, where='fuzzed.yaml')
        # without a closed form the kernels of its kind take seconds to compile
        if run and (SOAK or absorbing_motion(scene)):
            simulation = Simulation(scene)
            simulation.advance()
            assert np.isfinite(simulation.vector).all()
    except (BadInput, NotConverged) as refusal:
        in_one_line(refusal)
        return 'refused'
    return 'runs'


@pytest.fixture(scope='module')
def shipped():
    return [path.read_text() for path in sorted(scene_folder().glob('*.yaml'))]


def test_mutated_files_run_or_get_one_line(shipped):
    source, counts, slowest = random.Random(12), {'runs': 0, 'refused': 0}, 0.0
    for k in range(FILES):
        text = mutated(source.choice(shipped), source)
        began = time.process_time()
        try:
            result = outcome(text, run=k % RUN_EVERY == 0)
        except Exception as error:
            raise AssertionError(f'{type(error).__name__}: {error}\n{text!r}') from error
        counts[result] += 1
        if k % RUN_EVERY:
            slowest = max(slowest, time.process_time() - began)
    # measured: 0.10 of the files run; none takes 0.1 s of processor time to be read
    assert min(counts.values()) > FILES // 20
    assert slowest < 5.0


@pytest.mark.parametrize('text', [
    'a: &a [x, x]\nb: &b [*a, *a]\nc: &c [*b, *b]\n', '[' * 100_000, '{a: ' * 5000, 'x' * 300_000,
    'a: 1\na: 2\n', 'scene: \x00', '\ufeff',
    '', '- 1', '7', 'null', '\t', 'a: ' + '9' * 5000, 'body: {mass: ' + '9' * 5000 + '}',
    '!!python/object/apply:os.system [ls]', '--- a\n--- b',
    'scene: x\nbody: {mass: 1.0, inertia: [1e308, 1e308, 1e308]}\nconstraint: free\neffects: []\n'
    'initial: {angular_velocity: [1e10, 0, 0]}',
    'scene: x\nbody: {mass: 1.0, inertia: [1, 1, 1]}\nconstraint: free\neffects: []\n'
    'initial: {position: [0, 0, '
    + '9' * 309 + ']}',
    'scene: x\nbody: {mass: 1.0, inertia: [1, 1, 1], center_of_mass: [0.5, 0, -1e308]}\n'
    'constraint: {hinge: {axis: [0, 0, 1]}}\n'
    'effects: []\ninitial: {}',
    'scene: x\nbody: {mass: 1.0, inertia: [1, 1, 1]}\n'
    'constraint: {hinge: {axis: [0, 1, 0], distance: 1e160}}\n'
    'effects: []\ninitial: {}',
    'scene: x\nbody: {mass: 1e-320, parts: []}\nconstraint: free\neffects: []\ninitial: {}'],
    ids=lambda text: repr(text[:20]))
def test_known_traps_get_one_line(text):
    assert outcome(text, run=True) == 'refused'


def test_bytes_that_are_no_text_get_one_line(tmp_path):
    place = tmp_path / 'binary.yaml'
    for content in (b'\xff\xfe\x00', bytes(range(256)), b'\x80' * 1000, b'\x00' * 1000):
        place.write_bytes(content)
        with pytest.raises(BadInput) as refused:
            Simulation(place)
        assert str(refused.value).isprintable()


@pytest.mark.parametrize('first', range(0, 20_000, 5000) if SOAK else [4114])
def test_random_scenes_of_all_effects_run_ten_seconds_give_up_or_are_refused(first):
    test = pathlib.Path(__file__).resolve().parents[1]
    settings = os.environ | {'NUMBA_DISABLE_JIT': '1',
                             'PYTHONPATH': os.pathsep.join((str(test.parent), str(test)))}
    script, scenes = test / 'hard_cases' / 'fuzzed_scenes.py', 5000 if SOAK else 12
    done = subprocess.run([sys.executable, str(script), str(first), str(first + scenes)],
                          env=settings, capture_output=True, text=True,
                          timeout=7000 if SOAK else 280, check=False)
    lines = done.stdout.splitlines()
    assert done.returncode == 0 and len(lines) == scenes, (done.stdout[-3000:], done.stderr)
    # measured: a quarter runs, a half gives up
    assert sum(' runs: ' in line for line in lines) > scenes // 10
