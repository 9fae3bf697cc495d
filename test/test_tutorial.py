# SPDX-License-Identifier: Apache-2.0
"""The tutorial and the page for Python users run as they are written, command by command."""

import contextlib
import importlib
import pathlib
import re
import shlex
import signal

import pytest

from rigid_body_sim.cli.subcommands import SUBCOMMANDS

DOCS = pathlib.Path(__file__).resolve().parent.parent / 'docs'


def blocks(page, language):
    """Return the code blocks of a page in one language; '' is the shell."""
    text = (DOCS / page).read_text()
    found = re.findall(r'^```(\w*)\n(.*?)^```$', text, re.DOTALL | re.MULTILINE)
    return [block for named, block in found if named == language]


def commands(page):
    """Return the arguments of each subcommand that a page shows on a line of its own."""
    lines = ''.join(blocks(page, '')).splitlines()
    return [shlex.split(line)[3:] for line in lines if line.startswith('python -m rigid_body_sim')]


def run(name, *arguments):
    """Run a subcommand in this process; it must end well."""
    module, _, function = SUBCOMMANDS[name][0].partition(':')
    try:
        status = getattr(importlib.import_module(module), function)(list(arguments))
    except SystemExit as ended:
        status = ended.code
    assert status in (None, 0), (name, *arguments)


@pytest.fixture(scope='module')
def followed(tmp_path_factory):
    """Follow the tutorial up to its analysis: the folder, with the scene and its recording."""
    folder = tmp_path_factory.mktemp('tutorial')
    [scene] = blocks('tutorial.md', 'yaml')
    (folder / 'my_top.yaml').write_text(scene)
    with contextlib.chdir(folder):
        for name, *arguments in commands('tutorial.md'):
            if name in ('scenes', 'simulate', 'analyze'):
                run(name, *arguments)
    return folder


def test_the_report_of_the_tutorial_is_there(followed):
    pytest.importorskip('plotly')
    assert (followed / 'reports' / 'report.html').stat().st_size > 100_000


def test_recording_fit_and_sweep_give_what_the_tutorial_says(followed, capsys):
    pytest.importorskip('xarray')
    _, *python = blocks('tutorial.md', 'python')
    with contextlib.chdir(followed):
        exec('\n'.join(python), {})
    shape, fit, measured, theory = capsys.readouterr().out.splitlines()
    assert shape == '10001 (10001, 4)'
    assert fit == '[1.e-03 9.e+01]'
    assert float(measured) - float(theory) == pytest.approx(0.5, abs=0.5)   # the grid's step is 1


def test_push_and_resimulation_are_as_the_tutorial_says(followed, ros_domain):
    pytest.importorskip('rclpy')
    (followed / 'push.py').write_text(blocks('tutorial.md', 'python')[0])
    [node] = [arguments for arguments in commands('tutorial.md') if arguments[0] == 'sim_node']
    with ros_domain.process('-m', 'rigid_body_sim', *node, cwd=followed) as process:
        done = ros_domain.run('push.py', cwd=followed, timeout=120)
        process.send_signal(signal.SIGINT)
        assert process.wait(30) == 0
    assert done.returncode == 0, done.stderr
    before, after = (side.split() for side in done.stdout.split('->'))
    assert before[2] == '90.000' != after[2]    # the spin of a top stays, but for the blow
    [again] = [arguments for arguments in commands('tutorial.md') if arguments[0] == 'resimulate']
    done = ros_domain.run('-m', 'rigid_body_sim', *again, cwd=followed, timeout=120)
    assert done.returncode == 0 and 'identical' in done.stdout, done.stdout + done.stderr


def test_the_page_for_python_runs(tmp_path, capsys):
    with contextlib.chdir(tmp_path):
        exec('\n'.join(blocks('python.md', 'python')), {})
    shown = capsys.readouterr().out
    assert 'exact' in shown and '(1000, 2, 4)' in shown and 'body.mass' in shown
