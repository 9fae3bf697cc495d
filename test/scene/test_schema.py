# SPDX-License-Identifier: Apache-2.0
"""The check of a part of a scene beside jsonschema, whatever was checked before."""

import copy
import math

import jsonschema
import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene import schema
from rigid_body_sim.scene.scene import load_scene, scene_schema
from rigid_body_sim.scene.schema import LARGEST, NUMBER, POSITIVE, VECTOR, check, mapping_of

OTHERS = None, True, 'x', -1.0, 0, 2, [], [1.0], [1.0, 2.0, 3.0], {}, {'x': 1}
SETTINGS = mapping_of(['mass'], mass=POSITIVE, arm=VECTOR, inner=mapping_of(rate=NUMBER))


def paths_of(value):
    """Yield the path of every entry of a mapping and of the lists and mappings in it."""
    entries = (value.items() if isinstance(value, dict) else
               enumerate(value) if isinstance(value, list) else ())
    for key, entry in entries:
        yield (key,)
        yield from ((key, *path) for path in paths_of(entry))


def changes_of(mapping):
    """Yield copies of a mapping with one entry replaced, removed or added."""
    for *above, last in paths_of(mapping):
        for other in (*OTHERS, KeyError):
            changed = copy.deepcopy(mapping)
            place = changed
            for key in above:
                place = place[key]
            if other is KeyError:
                del place[last]
            else:
                place[last] = other
            yield changed
    yield mapping | {'more': 1}


def passes(value, of):
    """Return whether the check finds no fault."""
    try:
        check(value, of, 'f.yaml')
    except BadInput:
        return False
    return True


@pytest.mark.parametrize('name', ['kapitza_pendulum', 'rattleback'])
def test_its_verdict_on_changed_scenes_is_that_of_jsonschema(name):
    beside = jsonschema.Draft202012Validator(scene_schema())
    verdicts = [(passes(changed, scene_schema()), beside.is_valid(changed))
                for changed in changes_of(load_scene(name).mapping)]
    assert all(one == other for one, other in verdicts)
    assert {one for one, _ in verdicts} == {True, False}


@pytest.mark.parametrize('other', [True, '2', None, [2], math.inf])
def test_a_value_that_was_right_before_says_nothing_of_one_that_looks_alike(other):
    check({'mass': 2, 'inner': {'rate': 2}}, SETTINGS, 'f.yaml')
    for changed in {'mass': other, 'inner': {'rate': 2}}, {'mass': 2, 'inner': {'rate': other}}:
        with pytest.raises(BadInput):
            check(changed, SETTINGS, 'f.yaml')


def test_the_same_value_may_fit_one_schema_and_not_another():
    check({'rate': -1.0}, mapping_of(rate=NUMBER), 'f.yaml')
    with pytest.raises(BadInput, match='needs a number above 0'):
        check({'rate': -1.0}, mapping_of(rate=POSITIVE), 'f.yaml')


def test_jsonschema_sees_once_what_is_no_mapping_list_or_number_with_bounds(monkeypatch):
    seen, judge = [], jsonschema.Draft202012Validator

    def noted(of):
        seen.append(of)
        return judge(of)
    monkeypatch.setattr(schema.jsonschema, 'Draft202012Validator', noted)
    frame = {'enum': ['body', 'world']}
    whole = SETTINGS | {'properties': SETTINGS['properties'] | {'frame': frame}}
    settings = {'mass': 1.25, 'arm': [0.5, 0.0, 0.125], 'inner': {'rate': 0.75}, 'frame': 'world'}
    check(settings, whole, 'f.yaml')
    assert seen == [frame]
    check(settings | {'mass': 1.5, 'arm': [1.0, 2.0, 3.0]}, whole, 'f.yaml')
    assert seen == [frame]


@pytest.mark.parametrize('value', [10 ** 400, -10 ** 400, 1.01 * LARGEST, -1.01 * LARGEST,
                                   math.inf, -math.inf, math.nan])
def test_a_number_beyond_all_bounds_is_named_by_its_path(value):
    with pytest.raises(BadInput, match=r'^f\.yaml: arm\.1: got .* needs a (finite )?number'):
        check({'mass': 1.0, 'arm': [0.0, value, 0.0]}, SETTINGS, 'f.yaml')
    check({'mass': 1.0, 'arm': [LARGEST, -LARGEST, 0.0]}, SETTINGS, 'f.yaml')
