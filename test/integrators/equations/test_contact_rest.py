# SPDX-License-Identifier: Apache-2.0
"""The end of the motion of a body on a plane: a patch that grips, a ring that jams."""

import numpy as np
import pytest
from mechanics.contact.test_touch import scene_of
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.integrators.equations.contact_rest import grip_patch, jams, lies, spins
from rigid_body_sim.integrators.equations.contact_views import UNKNOWNS
from rigid_body_sim.mechanics.contact.numbers import contact_parameters
from rigid_body_sim.mechanics.contact.parameters import LOW

pytestmark = pytest.mark.without_numba


def unknowns(q, omega=(0.0, 0.0, 0.0)):
    """Return the unknowns of a body, with an impulse in its ledger."""
    y = np.zeros(UNKNOWNS.size)
    start = UNKNOWNS.load(y.tolist())
    UNKNOWNS.store(y, start._replace(q=q, omega=omega, ledger=start.ledger._replace(
        impulse=(0.1, -0.2, 0.3))))
    return y


@pytest.mark.parametrize('effects', [
    '', ', sliding_friction: {mu: 0.6}, spinning_friction: {radius: 0.01}'])
def test_a_patch_that_grips_takes_the_spin_about_the_normal_alone(effects):
    """What omega loses is along the normal, and I times that is the angular impulse."""
    p = contact_parameters(scene_of('sphere', effects))
    turn, omega = Rotation.random(random_state=4), np.array([3.0, -8.0, 5.0])
    y, normal = unknowns(tuple(turn.as_quat().tolist()), tuple(omega.tolist())), turn.inv().apply(
        [0.0, 0.0, 1.0])
    assert spins(p, y) == near((0.01 if effects else 0.0) * (normal @ omega), rel=1e-14)
    grip_patch(p, y)
    found = UNKNOWNS.load(y.tolist())
    change = -(normal @ omega) * normal if effects else np.zeros(3)
    inertia = np.array([[0.03, 0.001, 0.0], [0.001, 0.04, 0.002], [0.0, 0.002, 0.05]])
    assert found.omega == near(omega + change, rel=1e-14)
    # measured: 6e-17
    assert found.ledger.impulse == pytest.approx(
        np.array([0.1, -0.2, 0.3]) + turn.apply(inertia @ change), abs=1e-15)


@pytest.mark.parametrize(('surface', 'effects', 'tilt', 'jammed'), [
    ('torus', ', rolling_friction: {dry: 0.01}', 0.9 * LOW, True),
    ('disk', ', rolling_friction: {viscous: 0.01}', 0.9 * LOW, True),
    ('disk', ', air_film: {viscosity: 1.8e-5}', 0.9 * LOW, True),
    ('disk', '', 0.9 * LOW, False), ('disk', ', rolling_friction: {dry: 0.01}', 1.1 * LOW, False),
    ('sphere', ', rolling_friction: {dry: 0.01}', 0.9 * LOW, False)])
def test_rolling_friction_of_any_kind_jams_a_ring_that_lies_low(surface, effects, tilt, jammed):
    p = contact_parameters(scene_of(surface, ', sliding_friction: {mu: 0.6}' + effects))
    assert bool(jams(p, unknowns((np.sin(0.5 * tilt), 0.0, 0.0, np.cos(0.5 * tilt))))) is jammed


@pytest.mark.parametrize(('surface', 'tilt', 'flat'), [
    ('torus', 0.0, True), ('torus', np.pi, True), ('torus', 0.4, False), ('disk', 0.0, True),
    ('disk', 0.4, False), ('sphere', 0.0, False)])
def test_only_a_ring_can_lie_flat(surface, tilt, flat):
    p = contact_parameters(scene_of(surface, ', sliding_friction: {mu: 0.6}'))
    assert bool(lies(p, unknowns((np.sin(0.5 * tilt), 0.0, 0.0, np.cos(0.5 * tilt))))) is flat
