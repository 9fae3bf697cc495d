# SPDX-License-Identifier: Apache-2.0
"""The bits of every scene and method are those stored in the repo, on every machine.

Plain Python computes nearly all of them. Compiled are the closed forms of every scene, and a few
methods on one scene. ``make soak`` computes the others too: those that take plain Python longest,
and every method compiled for every scene, which takes seven minutes. ``make test-machines`` does
so for the machines that this one stands for.
"""

import json
import os
import subprocess
import sys

import pytest
from soak import SOAK

from rigid_body_sim.choice.choose import methods_for
from rigid_body_sim.scene.scene import load_scene, scene_names
from rigid_body_sim.simulation import arithmetic
from rigid_body_sim.study.machines import digests
from rigid_body_sim.study.machines.cases import cases

KEPT = arithmetic.digests()
SCENES = sorted({case.scene for case in cases().values()})
WITHOUT_NUMBA = """
import json, sys
from rigid_body_sim.study.machines import digests
print(json.dumps(digests.compute(lambda name, case: name not in sys.argv[1:])))
"""
COMPILED = ('driven_body by dop8', 'fast_top by gauss16', 'driven_body by taylor',
            '8 of skew_top by taylor: 2 threads',
            'ball_with_side_spin under commands in world axes')
"""Of kernels that other tests compile, too."""
LONG = ('kapitza_pendulum: choice of auto', 'kapitza_pendulum by taylor',
        'kapitza_pendulum by dop8', 'rising_egg: choice of auto', 'rising_egg by dop8',
        'tippe_top: choice of auto', 'euler_disk: choice of auto', 'composite_top: choice of auto',
        'skew_top_damped: choice of auto', 'tossed_coin: choice of auto',
        'skew_top: choice of auto', 'driven_in_pieces: choice of auto',
        'rattleback: choice of auto', 'stiff_relaxation: choice of auto',
        'major_axis_relaxation: choice of auto', 'librating_satellite: choice of auto',
        'struck_needle: choice of auto', 'skew_needle: choice of auto',
        'skew_hinge_damped: choice of auto', 'routh_sphere: choice of auto',
        'kapitza_pendulum by gauss16', 'tippe_top by dop8', 'euler_disk by dop8',
        'rattleback by dop8', 'rising_egg by taylor', 'tippe_top by gauss16',
        'rising_egg by gauss16', 'rattleback by taylor',
        *(f'40 of heavy_top by dop8: {threads} threads' for threads in (1, 2)),
        *(f'{bodies} of skew_top by taylor: {threads} threads'
          for bodies in (17, 40) for threads in (1, 2, 5)),
        # the equations of a heavy top, which runs
        *(f'{top} by split{order}' for order in (6, 8)
          for top in ('fast_top', 'sleeping_top', 'steady_precession')))
"""What takes plain Python four fifths of the time of all cases: others of its kind run."""


@pytest.mark.timeout(1200)    # a cold cache: each kind of scene is compiled for each method
@pytest.mark.parametrize('scene', SCENES)
def test_the_bits_of_a_scene_are_those_kept(scene):
    mine = {name for name, case in cases().items() if case.scene == scene
            and (SOAK or name in (f'{scene}: set-up', f'{scene} by exact', *COMPILED))}
    found = digests.compute(lambda name, case: name in mine)
    assert digests.different(found, {name: KEPT[name] for name in mine & set(KEPT)}) == []


@pytest.mark.timeout(600)
def test_without_numba_the_bits_are_the_same():
    left_out = () if SOAK else LONG
    run = subprocess.run([sys.executable, '-W', 'ignore', '-c', WITHOUT_NUMBA, *left_out],
                         env=os.environ | {'NUMBA_DISABLE_JIT': '1'}, capture_output=True,
                         text=True, check=True, timeout=600)
    wanted = {name: KEPT[name] for name in KEPT if name not in left_out}
    assert len(wanted) >= len(KEPT) - len(LONG)
    assert digests.different(json.loads(run.stdout), wanted) == []


def test_every_scene_and_method_has_a_digest():
    table = cases()
    assert set(KEPT) == set(table)
    expected = {f'{name} by {method}' for name in scene_names()
                for method in methods_for(load_scene(name)) if method not in arithmetic.EXCEPTED}
    assert expected <= set(KEPT)
    assert len(KEPT) > 400


def test_ways_to_ask_for_the_same_have_the_same_digests():
    """Ticks come one by one, in slices, foreseen and backwards; bodies use 1, 2 and 5 threads."""
    table = cases()
    pairs = {name: case.same_as for name, case in table.items() if case.same_as}
    assert len(pairs) > 40
    assert [name for name, other in pairs.items() if KEPT[name] != KEPT[other]] == []


def test_one_bit_in_one_number_is_another_digest():
    assert digests.digest([[1.0, 2.0]]) != digests.digest([[1.0, 2.0000000000000004]])
    assert digests.digest([[0.0]]) != digests.digest([[-0.0]])
    assert digests.different({'a': {'x': '1', 'y': '2'}},
                             {'a': {'x': '1', 'y': '3'}, 'b': {'z': '1'}}) == ['a: y', 'b: z']


def test_the_command_names_what_differs(monkeypatch, capsys):
    case = 'tennis_racket: set-up'
    monkeypatch.setattr(digests, 'cases', lambda: {case: cases()[case]})
    monkeypatch.setattr(arithmetic, 'digests', lambda: {case: KEPT[case] | {'start': 'another'}})
    assert digests.main([]) == 1
    assert capsys.readouterr().out == f'{case}: start\n1 cases, 1 digests differ\n'
