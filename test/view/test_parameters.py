# SPDX-License-Identifier: Apache-2.0
"""Every number of every scene that ships is a control, and what a control writes is a scene."""

import pytest
import yaml

from rigid_body_sim import load_scene
from rigid_body_sim.scene.scene import parse_scene, scene_names
from rigid_body_sim.view import parameters


@pytest.mark.parametrize('name', scene_names())
def test_every_number_can_be_changed(name):
    scene = load_scene(name)
    entries = list(parameters.numbers(parameters.mapping_of(scene)))
    assert len({parameters.label(path) for path, _ in entries}) == len(entries) > 2
    for path, value in entries:
        text = parameters.changed(scene.text, path, value)
        assert yaml.safe_load(text) == yaml.safe_load(scene.text)


@pytest.mark.parametrize('name', scene_names())
def test_spin_and_tilt_come_back_as_they_were_set(name):
    scene = load_scene(name)
    if scene.body.about_center.moments.count(0.0) == 0:
        # above the other components, so that the spin stays about the same axis
        assert parameters.spin_of(parse_scene(parameters.with_spin(scene, 75.0)))[0] == 75.0
    if scene.constraint.kind != 'table':
        tilted = parse_scene(parameters.with_tilt(scene, 0.3))
        assert parameters.tilt_of(tilted) == pytest.approx(0.3, abs=1e-15)
