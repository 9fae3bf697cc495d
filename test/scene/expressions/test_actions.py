# SPDX-License-Identifier: Apache-2.0
"""What is told of the torques and forces that expressions give, beside their values."""

import pytest

from rigid_body_sim.scene.scene import parse_scene


def acting(effect, constraint='free'):
    """Return what acts of an effect of a scene."""
    scene = parse_scene(
        'scene: s\nparameters: {k: 1.7}\nbody: {mass: 2.0, inertia: [0.3, 0.4, 0.5], '
        f'center_of_mass: [0.1, 0, 0]}}\nconstraint: {constraint}\neffects: [{effect}]\n'
        'initial: {}\n')
    return scene.effects[0].acting(scene.frame, 0.0)


@pytest.mark.parametrize(('value', 'told'), [
    ('qx + 2*k', ()), ('wx', ('of_motion',)), ('Wy*qx', ('of_motion',)),
    ('t', ('in_field', 'timed')), ('x*qx', ('in_field',)), ('vz', ('in_field', 'of_motion')),
    # a root of what changes comes near a kink where it is nearly zero
    ('sqrt(qx^2 + 1)', ('rooted',)), ('abs(qx)^1.5', ('rooted',)), ('(2 + qx)^k', ('rooted',)),
    ('qx^3', ()), ('sqrt(k)*qx', ()), ('k^0.5', ()), ('qx*2^0.5', ()),
    ('sin(sqrt(2 + cos(t)))', ('in_field', 'timed', 'rooted'))])
@pytest.mark.parametrize('books', ['work', 'heat'])
def test_what_a_torque_depends_on_is_told(value, told, books):
    [one] = acting(f"torque: {{value: [0, '{value}', 0.1], books: {books}}}")
    flags = [name for name in ('in_field', 'of_motion', 'timed', 'rooted') if getattr(one, name)]
    # what takes heat depends on velocities anyway
    assert flags == [name for name in told if (name, books) != ('of_motion', 'heat')]
    assert (one.gives, one.books) == ('torque', books)


@pytest.mark.parametrize(('effect', 'constraint', 'gives'), [
    ('force: {value: [qx, 0, 1]}', 'free', ['force']),
    ('force: {value: [qx, 0, 1], at: [0.2, 0, 0]}', 'free', ['force', 'torque']),
    ('force: {value: [qx, 0, 1], at: [0.2, 0, 0]}', 'pivot', ['torque']),
    ('force: {value: [qx, 0, 1], at: [0, 0, 0]}', 'pivot', []),
    ("potential: {energy: 'x'}", 'free', ['force', 'torque']),
    ("potential: {energy: 'qx'}", 'free', ['torque']),
    ("potential: {energy: 'x'}", 'pivot', []), ("potential: {energy: 'x*qx'}", 'pivot', ['torque'])
])
def test_a_force_acts_on_what_moves_and_its_moment_where_it_has_an_arm(effect, constraint, gives):
    """An expression of place is at the body's origin, which a pivot holds."""
    assert [one.gives for one in acting(effect, constraint)] == gives


def test_a_moment_about_the_origin_itself_does_not_depend_on_the_force_there():
    """A free body's is about the centre of mass, which is beside the origin."""
    energy = "potential: {energy: 'x^2 + qx'}"
    assert [one.in_field for one in acting(energy, 'pivot')] == [False]
    assert [one.in_field for one in acting(energy)] == [True, True]
