# SPDX-License-Identifier: Apache-2.0
"""The restitution that an impact can have, and what it does to a ball."""

import numpy as np
import pytest
from mechanics.contact.test_touch import scene_of
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.integrators.equations import contact_impacts
from rigid_body_sim.integrators.equations.contact_impacts import bearable, rebound
from rigid_body_sim.integrators.equations.contact_views import UNKNOWNS
from rigid_body_sim.mechanics.contact.numbers import contact_parameters
from rigid_body_sim.scene.scene import parse_scene

pytestmark = pytest.mark.without_numba

G = ((2.0, 0.0, 1.2), (0.0, 1.0, 0.0), (1.2, 0.0, 1.0))


@pytest.mark.parametrize('along', [-2.0, -1.0, -0.5])
def test_an_impact_that_sticks_rebounds_with_all_the_energy_that_there_is(along):
    """With J = -G^-1 (u_t, (1 + e) u_n) the loss is (u . G^-1 u - e^2 u_n^2 (G^-1)_nn)/2."""
    before, inverse = (along, 0.0, -1.0), np.linalg.inv(G)
    most = np.sqrt(before @ inverse @ before / inverse[2, 2])
    assert most < 1.0
    assert rebound(G, before, 1.0, np.inf).loss < 0.0
    found = bearable(G, before, 1.0, np.inf)
    assert found.restitution == near(most, rel=1e-15)    # 2.2e-16
    assert abs(found.loss) < 1e-15    # 1.1e-16
    assert found.after == pytest.approx((0.0, 0.0, most), abs=1e-15)    # 4e-16
    assert bearable(G, before, 0.5 * most, np.inf).restitution == 0.5 * most


@pytest.mark.parametrize('mu', [0.0, 0.1, 0.3, 0.8])
@pytest.mark.parametrize('restitution', [0.0, 0.5, 1.0])
def test_no_impact_creates_energy_and_none_loses_restitution_without_need(mu, restitution):
    for along in np.linspace(-3.0, 3.0, 25):
        before = float(along), 0.2, -1.0
        found = bearable(G, before, restitution, mu)
        assert found.loss >= 0.0
        if found.restitution < restitution:    # more would create energy
            assert rebound(G, before, found.restitution + 1e-12, mu).loss < 0.0


@pytest.mark.parametrize('share', [0.0, 0.1, 0.9, 1.1, 20.0])
@pytest.mark.parametrize(('mass', 'fall'), [(0.3, 1.7), (7.0, 3.1)])
def test_a_ball_that_bounces_loses_its_slip_or_slides_on_with_friction_mu(mass, fall, share):
    """Two sevenths of the momentum of the slip stop it; `share` is that over the largest."""
    radius, mu, e, way = 0.2, 0.25, 0.6, np.array([0.8, -0.6, 0.0])
    moment = 0.4 * mass * radius * radius
    ball = parse_scene(
        f'scene: ball\nbody: {{mass: {mass}, inertia: {[moment] * 3}, surface: '
        f'{{sphere: {{radius: {radius}}}}}}}\nconstraint: table\neffects: [gravity: {{g: 9.81}}, '
        f'sliding_friction: {{mu: {mu}}}]\ninitial: {{position: [0, 0, 1]}}\n')
    up, slip = np.array([0.0, 0.0, 1.0]), share * 3.5 * mu * (1.0 + e) * fall * way
    y, impact = np.zeros(UNKNOWNS.size), np.empty(contact_impacts.IMPACT.size)
    # a part of the slip comes from the spin: omega x (-radius up)
    omega = np.cross(up, 0.3 * slip) / -radius + 5.0 * up
    start = UNKNOWNS.load(y.tolist())._replace(
        q=(0.0, 0.0, 0.0, 1.0), omega=tuple(omega), u=tuple(0.7 * slip - fall * up))
    UNKNOWNS.store(y, start._replace(ledger=start.ledger._replace(
        struck=1.5, impulse=(1.0, 2.0, 3.0))))
    contact_impacts.collide(contact_parameters(ball), y, e, impact)
    normal = mass * (1.0 + e) * fall
    given = normal * up - min(share, 1.0) * mu * normal * way
    turn = np.cross(-radius * up, given)
    after, found = UNKNOWNS.load(y.tolist()), contact_impacts.IMPACT.load(impact.tolist())
    new, spin = np.array(start.u) + given / mass, omega + turn / moment
    assert after.u == near(new, rel=1e-14)
    assert after.omega == near(spin, rel=1e-14)
    assert (found.before, found.after, found.impulse) == near((-fall, e * fall, normal), rel=1e-14)
    if share < 1.0:
        assert found.slip == (0.0, 0.0)
    else:
        assert found.slip == near(((1.0 - 1.0 / share) * slip)[:2], rel=1e-13)
    lost = 0.5 * mass * (np.dot(start.u, start.u) - new @ new) + (
        0.5 * moment * (omega @ omega - spin @ spin))
    assert after.ledger.struck - 1.5 == near(lost, rel=1e-12)
    assert after.ledger.impulse == near(np.array([1.0, 2.0, 3.0]) + turn, rel=1e-14)


@pytest.mark.parametrize('seed', range(3))
def test_any_body_leaves_the_plane_with_the_restitution_at_its_lowest_point(seed):
    """Its energy, that of the motion of an ellipsoid, falls by what the ledger books."""
    p, draw = contact_parameters(scene_of('ellipsoid', ', sliding_friction: {mu: 0.25}')), (
        np.random.default_rng(seed))
    y, impact, inertia = np.zeros(UNKNOWNS.size), np.empty(contact_impacts.IMPACT.size), np.array(
        [[0.03, 0.001, 0.0], [0.001, 0.04, 0.002], [0.0, 0.002, 0.05]])
    omega, u = draw.normal(size=(2, 3))
    start = UNKNOWNS.load(y.tolist())._replace(
        q=tuple(Rotation.random(random_state=seed).as_quat().tolist()), omega=tuple(omega),
        u=(*u[:2], -3.0))
    UNKNOWNS.store(y, start)
    before = contact_impacts.velocity_of_lowest(p, y)
    contact_impacts.collide(p, y, 0.6, impact)
    after, found = UNKNOWNS.load(y.tolist()), contact_impacts.IMPACT.load(impact.tolist())
    left = contact_impacts.velocity_of_lowest(p, y)
    assert (found.before, found.after) == near((before[2], -0.6 * before[2]), rel=1e-14)
    assert left == pytest.approx((*found.slip, found.after), abs=1e-13)    # 3e-15
    lost = sum(sign * (2.0 * np.dot(one.u, one.u) + one.omega @ inertia @ one.omega) / 2.0
               for sign, one in ((1.0, start), (-1.0, after)))
    assert after.ledger.struck == near(lost, rel=1e-12)
