# SPDX-License-Identifier: Apache-2.0
"""The energy that keeps a body on a hinge from the ends of its angle, by hand calculation."""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.winding import energy_at_ends, may_reach_ends, potential_energy

M, J, G, K = 2.0, 0.5 + 2.0 * 0.3 ** 2, 9.81, 4.0    # J: about the axis, 0.3 m from the centre
LAST = 2.0 * math.pi


def hinged(effects, initial='{}'):
    """Return a scene of a body on an axis along y, 0.3 m above its centre of mass."""
    return parse_scene(
        f'scene: a\nbody: {{mass: {M}, inertia: [0.3, 0.5, 0.4]}}\n'
        'constraint: {hinge: {axis: [0, 1, 0], through: [0, 0, 0.3]}}\n'
        f'effects: [{effects}]\ninitial: {initial}\n')


@pytest.mark.parametrize(('zero', 'angle'), [(0.3, LAST - 0.3), (-0.3, LAST - 0.3), (0.0, LAST)])
def test_a_torsion_spring_has_least_energy_at_the_nearer_end(zero, angle):
    """The weight has the same energy at both: after two turns it hangs as at the start."""
    scene = hinged(f'gravity: {{g: {G}}}, spring: {{stiffness: {K}, angle: {zero}}}')
    assert energy_at_ends(scene) == near(-M * G * 0.3 + K * angle ** 2 / 2.0, rel=1e-11)


@pytest.mark.parametrize(('effects', 'energy'), [
    # nothing that jumps; its turns add no energy
    (f'gravity: {{g: {G}}}', math.inf),
    ("potential: {energy: '3*cos(angle)'}", math.inf),
    # energy may come without end
    (f"spring: {{stiffness: {K}}}, torque: {{value: [0, 'cos(rate)', 0]}}", -math.inf),
    (f"spring: {{stiffness: {K}}}, torque: {{value: [0, '-rate', 0], books: heat}}", -math.inf),
    (f'spring: {{stiffness: {K}}}, torque: {{times: [1], values: [[0, 1, 0]]}}', -math.inf),
    # of a root of what is negative at one end nothing is known
    ("potential: {energy: 'angle*sqrt(angle)'}", -math.inf)])
def test_where_nothing_jumps_all_ends_are_far_and_where_all_may_come_none(effects, energy):
    scene = hinged(effects, '{angle: 1}')
    assert energy_at_ends(scene) == energy
    assert may_reach_ends(scene, scene.initial.vector) == (energy < 0.0)


def test_a_body_that_is_free_has_no_end_of_an_angle():
    free = parse_scene('scene: a\nbody: {mass: 1, inertia: [1, 1, 1]}\nconstraint: free\n'
                       'effects: [spring: {at: [0, 0, 1], anchor: [0, 0, 2], stiffness: 1}]\n'
                       'initial: {}\n')
    assert energy_at_ends(free) == math.inf


@pytest.mark.parametrize('angle', [0.5, 5.9])
@pytest.mark.parametrize(('short', 'reaches'), [(1e-6, False), (1e-9, True), (-1e-6, True)])
def test_a_body_gets_there_with_the_energy_that_the_end_has(angle, short, reaches):
    """Its kinetic energy is J rate^2/2; what is lost in rounding counts as enough."""
    bare = hinged(f'gravity: {{g: {G}}}, spring: {{stiffness: {K}}}')
    end = -M * G * 0.3 + K * LAST ** 2 / 2.0
    here = -M * G * 0.3 * math.cos(angle) + K * angle ** 2 / 2.0
    rate = math.sqrt(2.0 * (end * (1.0 - short) - here) / J)
    scene = hinged(f'gravity: {{g: {G}}}, spring: {{stiffness: {K}}}',
                   f'{{angle: {angle}, rate: {rate!r}}}')
    assert potential_energy(bare, scene.initial.vector) == near(here, rel=1e-13)    # 2e-16
    assert may_reach_ends(bare, scene.initial.vector) is reaches


def test_a_body_of_which_nothing_is_known_may_get_there():
    scene = hinged(f'spring: {{stiffness: {K}}}')
    assert not may_reach_ends(scene, scene.initial.vector)
    vector = np.where(np.arange(14) == 6, math.nan, scene.initial.vector)    # its rate
    assert may_reach_ends(scene, vector)
