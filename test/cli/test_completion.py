# SPDX-License-Identifier: Apache-2.0
"""The completion script: what bash offers after some words, and what is refused."""

import shutil
import subprocess

import pytest

from rigid_body_sim.cli import completion
from rigid_body_sim.cli.subcommands import SUBCOMMANDS
from rigid_body_sim.scene.scene import scene_names

OPTIONS = {name: [f'--of-{name.replace("_", "-")}', '--scene'] for name in SUBCOMMANDS}


@pytest.fixture
def script(monkeypatch):
    """Return the script for bash, with options that are made up: their modules are not run."""
    monkeypatch.setattr(completion, 'options_of', OPTIONS.get)
    return completion.script('bash')


def offered(script, *words):
    """Return what bash offers for the last one of some words."""
    ask = (f'{script}\nCOMP_WORDS=(rigid_body_sim {" ".join(words)})\nCOMP_CWORD={len(words)}\n'
           '_rigid_body_sim\nprintf "%s\\n" "${COMPREPLY[@]}"')
    return subprocess.run(['bash', '-c', ask], capture_output=True, text=True, timeout=30,
                          check=True).stdout.split()


@pytest.mark.skipif(not shutil.which('bash'), reason='needs bash')
def test_bash_offers_subcommands_their_options_and_scenes(script):
    assert offered(script, '""') == [*SUBCOMMANDS, '--help', '--version', '--completion']
    assert offered(script, '--') == ['--help', '--version', '--completion']
    for name, options in OPTIONS.items():
        assert offered(script, name, '-') == options
        assert offered(script, name, '--scene', '""') == scene_names()
        assert offered(script, name, '""') == (scene_names() if name == 'scenes' else [])
    assert offered(script, 'simulate', '--rate', '""') == []


def test_zsh_reads_the_script_of_bash(script):
    assert completion.script('zsh') == f'autoload -U +X bashcompinit && bashcompinit\n{script}'
    assert script.startswith('# completion of rigid_body_sim')


def test_options_are_those_of_the_help():
    assert completion.options_of('scenes') == ['--help', '--json', '--schema']
    assert completion.options_of('sweep') == ['--dask', '--dry-run', '--help', '--json',
                                              '--output']


def test_a_subcommand_whose_packages_are_absent_has_no_options(monkeypatch):
    monkeypatch.setitem(SUBCOMMANDS, 'scenes', ('rigid_body_sim.cli.nowhere:main', ''))
    assert completion.options_of('scenes') == []


@pytest.mark.parametrize(('arguments', 'said'), [
    ([], 'got nothing'), (['tcsh'], 'got tcsh'), (['bash', 'zsh'], 'got bash zsh')])
def test_one_shell_is_named(arguments, said, capsys):
    assert completion.main(arguments) == 2
    assert capsys.readouterr() == ('', f'--completion: {said}; one of bash, zsh\n')


def test_the_script_is_printed(script, capsys):
    assert completion.main(['bash']) == 0
    assert capsys.readouterr() == (script, '')
