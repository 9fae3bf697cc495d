# SPDX-License-Identifier: Apache-2.0
"""Which forces and torques are numbers for power series, and which are formulas."""

import pytest

from rigid_body_sim.scene.scene import parse_scene

CENTER, BESIDE = [0.1, 0, 0], [0.1, 0.2, 0]


def pull(effect, constraint):
    """Return the Pull of an effect on a body that turns about its origin or is free."""
    scene = parse_scene(
        'scene: s\nbody: {mass: 2.0, inertia: [0.3, 0.4, 0.5], center_of_mass: [0.1, 0, 0]}\n'
        f'constraint: {constraint}\neffects: [{effect}]\ninitial: {{}}\n')
    return scene.effects[0].series(scene.frame, 0.0)


@pytest.mark.parametrize(('value', 'at', 'axes', 'constraint', 'force', 'constant'), [
    # as the weight pulls: at the centre of mass, along the world
    ([1.0, 2.0, 3.0], CENTER, 'world', 'free', (1.0, 2.0, 3.0), (0.0, 0.0, 0.0)),
    ([1.0, 2.0, 3.0], CENTER, 'world', 'pivot', (1.0, 2.0, 3.0), (0.0, 0.0, 0.0)),
    # r x F, with r = (0.1, 0, 0) or (0.1, 0.2, 0) from the pivot
    ([1.0, 2.0, 3.0], CENTER, 'body', 'pivot', None, (0.0, -0.3, 0.2)),
    ([1.0, 2.0, 3.0], BESIDE, 'body', 'pivot', None, (0.6, -0.3, 0.0)),
    # an arm that turns against the force, a force that turns with a body that it moves
    ([1.0, 2.0, 3.0], BESIDE, 'world', 'free', None, None),
    ([1.0, 2.0, 3.0], BESIDE, 'world', 'pivot', None, None),
    ([1.0, 2.0, 3.0], CENTER, 'body', 'free', None, None),
    (['qx', 2.0, 3.0], CENTER, 'world', 'pivot', None, None)])
def test_a_force_is_told_in_numbers_where_its_moment_is_one_of_a_kind(
        value, at, axes, constraint, force, constant):
    found = pull(f'force: {{value: {value}, at: {at}, frame: {axes}}}', constraint)
    assert found.force == force
    if constant is None:
        assert len(found.formulas) == 1
        constant = 0.0, 0.0, 0.0
    else:
        assert found.formulas == ()
    assert found.constant == pytest.approx(constant, rel=0.0, abs=2e-16)    # 1.1e-16


@pytest.mark.parametrize(('value', 'axes', 'couple', 'constant'), [
    ([1.0, 2.0, 3.0], 'world', (1.0, 2.0, 3.0), (0.0, 0.0, 0.0)),
    ([1.0, 2.0, 3.0], 'body', None, (1.0, 2.0, 3.0)),
    ([1.0, 'qx', 3.0], 'world', None, None), ([1.0, 'qx', 3.0], 'body', None, None)])
def test_a_torque_in_numbers_is_a_couple_of_the_world_or_one_of_the_body(
        value, axes, couple, constant):
    found = pull(f'torque: {{value: {value}, frame: {axes}}}', 'free')
    assert len(found.formulas) == (constant is None)
    assert (found.couple, found.constant) == (couple, constant or (0.0, 0.0, 0.0))
