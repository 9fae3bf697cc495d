# SPDX-License-Identifier: Apache-2.0
"""Which problems the command work_precision runs."""

import types

import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.study.precision import suite, work_precision


def problems(scene=None, overrides=(), duration=None, whole=False):
    """Return (name, duration, mass) of the problems that options ask for."""
    found = work_precision._problems(types.SimpleNamespace(
        scene=scene, set=list(overrides), duration=duration, suite=whole))
    return [(one.name, one.duration, one.scene.body.mass) for one in found]


def test_without_a_scene_they_are_some_or_all_of_the_suite():
    assert [name for name, *_ in problems()] == list(suite.QUICK)
    assert [name for name, *_ in problems(whole=True)] == [*suite.NAMES, *suite.ON_A_PLANE]


@pytest.mark.parametrize('name', ['driven_body', suite.ON_A_PLANE[0]])
def test_a_problem_of_the_suite_has_the_duration_that_it_has_there(name):
    one = suite.problem(name)
    assert problems(name) == [(name, one.duration, one.scene.body.mass)]


@pytest.mark.parametrize(('asked', 'found'), [
    ({}, ('tennis_racket', 20.0, 1.0)), ({'duration': 3.0}, ('tennis_racket', 3.0, 1.0)),
    ({'duration': 1e6}, ('tennis_racket', 1e6, 1.0)),
    ({'overrides': ['body.mass=0.5']}, ('tennis_racket', 20.0, 0.5))])
def test_any_scene_is_a_problem_of_twenty_seconds_or_as_long_as_is_said(asked, found):
    assert problems('tennis_racket', **asked) == [found]


@pytest.mark.parametrize(('asked', 'said'), [
    ({'scene': 'tennis_racket', 'duration': 0.0}, r'--duration: got 0\.0; simulated seconds'),
    ({'scene': 'tennis_racket', 'duration': 1.1e6}, '--duration: got 1100000.0'),
    ({'scene': 'driven_body', 'duration': 3.0}, '--scene: driven_body is a problem of the suite'),
    ({'scene': 'driven_body', 'overrides': ['body.mass=2']}, 'it takes no --set'),
    ({'duration': 3.0}, '--set, --duration: are for one scene; name it'),
    ({'overrides': ['body.mass=2'], 'whole': True}, '--set, --duration: are for one scene')])
def test_what_does_not_fit_is_refused_in_one_line(asked, said):
    with pytest.raises(BadInput, match=said):
        problems(**asked)
