# SPDX-License-Identifier: Apache-2.0
"""docs/recordings.md: its Python runs as it stands there, its commands exist."""

import pathlib
import re

import numpy as np

from rigid_body_sim import Recording, States
from rigid_body_sim.cli.simulate import main as simulate
from rigid_body_sim.cli.subcommands import SUBCOMMANDS

PAGE = pathlib.Path(__file__).resolve().parents[2] / 'docs' / 'recordings.md'


def test_the_python_of_the_page_does_what_it_says(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert simulate(['--duration', '2', '--output', 'recordings/racket']) == 0
    names = {}
    examples = re.findall(r'```python\n(.*?)```', PAGE.read_text(), re.DOTALL)
    assert len(examples) == 2
    # five lines beside the import
    lines = [line for line in examples[0].splitlines() if line and not line.startswith('from')]
    assert len(lines) == 5
    for example in examples:
        exec(example, names)
    assert '/pose' in capsys.readouterr().out
    assert isinstance(names['recording'], Recording)
    assert isinstance(names['states'], States)
    assert names['states'].orientation.shape == (2001, 4)
    assert names['scene'].name == 'tennis_racket'
    assert names['commands']['force'].shape == (0, 3)
    np.testing.assert_array_equal(names['energy']['data'].shape, (2001,))
    names['recording'].close()


def test_the_commands_of_the_page_exist():
    named = re.findall(r'^    python -m rigid_body_sim (\w+)', PAGE.read_text(), re.MULTILINE)
    assert set(named) <= set(SUBCOMMANDS)
    assert len(named) >= 6
