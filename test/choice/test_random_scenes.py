# SPDX-License-Identifier: Apache-2.0
"""A few of the scenes of bench/choice_random.py: what `auto` promises, beside a truth."""

import pathlib
import sys

import numpy as np
import pytest
from soak import SOAK

BENCH = pathlib.Path(__file__).resolve().parents[2] / 'bench'
SCENES = {2: 'a ball on a table', 205: 'drag by matrices'}
IN_WORDS = {2: 'dissipation at a pivot'}
if SOAK:    # three to ten seconds of plain Python each
    SCENES |= {166: 'dry friction of a hinge', 172: 'gravity along a vector'}
    IN_WORDS |= {0: 'a moving pivot', 186: 'a swing whose velocity nearly vanishes'}


@pytest.fixture
def judge(monkeypatch):
    if np.finfo(np.longdouble).nmant < 63:
        pytest.skip('no 80-bit numbers here: nothing to compare with')
    monkeypatch.syspath_prepend(str(BENCH))
    from random_scenes import judge
    yield judge
    for name in [name for name in sys.modules if name.startswith('random_scenes')]:
        del sys.modules[name]


@pytest.mark.without_numba
@pytest.mark.parametrize('number', SCENES, ids=SCENES.values())
def test_the_error_is_met_foretold_and_balanced(judge, number):
    for line, *good in judge.judged(number, 11):
        assert all(good), line


@pytest.mark.without_numba
@pytest.mark.parametrize('number', IN_WORDS, ids=IN_WORDS.values())
def test_so_it_is_for_effects_in_the_words_of_a_scene(judge, number):
    from random_scenes import new_language
    for line, *good in judge.judged(number, 21, new_language.drawn):
        assert all(good), line


@pytest.mark.without_numba
def test_a_wrong_law_is_seen(judge, monkeypatch):
    from random_scenes import laws
    right = laws._dragged
    monkeypatch.setattr(laws, '_dragged', lambda *given: 1.001 * right(*given))
    assert not any(met for _, met, *_ in judge.judged(205, 11))


# 2e-17; 2e-14 where the rounding of the unknowns themselves was extrapolated
# 2e-17; 2e-12 where places were not under control of their error
@pytest.mark.without_numba
@pytest.mark.parametrize(('number', 'times'), [(282, np.linspace(0.05, 1.6, 32)),
                                               (80, np.linspace(0.5, 4.0, 8))])
def test_the_truth_does_not_depend_on_how_often_it_is_asked(judge, number, times):
    from random_scenes.draw import drawn
    scene, found = judge.parse_scene(drawn(number, 77)[0]), []
    for asked in (times[-1:], times):
        truth = judge.truth_of(scene)
        for time in asked:
            truth.to(float(time))
        found.append(truth.y[0])
    assert np.abs(found[0] - found[1])[:7].max() < 3e-16
