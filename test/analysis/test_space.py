# SPDX-License-Identifier: Apache-2.0
"""Paths in space: the polhode lies on both of its ellipsoids, an axis is traced on the sphere."""

import types

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rigid_body_sim.analysis.space import spaces, traced_axis
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba

TENSOR = (Rotation.from_rotvec([0.3, -0.2, 0.7]).as_matrix() @ np.diag([1.0, 2.0, 2.5])
          @ Rotation.from_rotvec([0.3, -0.2, 0.7]).as_matrix().T)
TENSOR = 0.5 * (TENSOR + TENSOR.T)


def scene(inertia, constraint='free', center=(0, 0, 0), omega=(0.3, 1.0, 0.2)):
    return parse_scene(f'scene: s\nbody: {{mass: 1, inertia: {np.array(inertia).tolist()}, '
                       f'center_of_mass: {list(center)}}}\nconstraint: {constraint}\n'
                       f'effects: []\ninitial: {{angular_velocity: {list(omega)}}}\n')


def measured(one):
    found = Simulation(one).states(np.linspace(0.0, 9.0, 40))
    columns = [found.vector[:, 0], found.orientation, found.angular_velocity, found.position]
    samples = types.SimpleNamespace(columns=lambda: columns)
    return types.SimpleNamespace(motion=types.SimpleNamespace(samples=samples),
                                 source=types.SimpleNamespace(scene=one))


def test_the_polhode_lies_on_the_ellipsoids_of_energy_and_momentum():
    body = measured(scene(TENSOR))
    polhode, trace = spaces(body)
    energy, momentum = polhode.surfaces.values()
    omega = polhode.path
    for net, form in ((energy, TENSOR), (momentum, TENSOR @ TENSOR)):
        values = np.einsum('...i,ij,...j', net, form, net)
        assert values == pytest.approx(np.full(values.shape, omega[0] @ form @ omega[0]))
        along = np.einsum('ni,ij,nj->n', omega, form, omega)
        assert along == pytest.approx(np.full(40, along[0]))
        # a closed net: from pole to pole, once around
        assert net[:, 0] == pytest.approx(net[:, -1])
        assert np.ptp(net[0], axis=0) == pytest.approx(np.zeros(3), abs=1e-12)
        assert net[0, 0] == pytest.approx(-net[-1, 0])
    assert list(polhode.surfaces) == ['energy ellipsoid, 2T', 'momentum ellipsoid, L']
    assert np.linalg.norm(trace.path, axis=1) == pytest.approx(np.ones(40))
    sphere, = trace.surfaces.values()
    assert np.linalg.norm(sphere, axis=2) == pytest.approx(np.ones(sphere.shape[:2]))
    _, axis = traced_axis(body.source.scene)
    turned = Rotation.from_quat(body.motion.samples.columns()[1]).apply(axis)
    assert trace.path == pytest.approx(turned)


def test_the_net_of_a_sphere_is_of_24_latitudes_and_48_longitudes():
    [trace] = spaces(measured(scene(TENSOR, 'pivot')))
    net = trace.surfaces['unit sphere']
    assert net.shape == (25, 49, 3)
    assert net[[6, 12, 12, 12], [0, 12, 24, 36]] == pytest.approx(np.array(
        [[0.5**0.5, 0.0, 0.5**0.5], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]),
        abs=1e-15)


def test_the_ellipsoids_are_those_of_the_first_tick_also_of_a_body_that_slows_down():
    body = measured(scene([1e-9, 1e-9, 1.5e-9]))
    body.motion.samples.columns()[2][:] = np.linspace(2.0, 1.0, 40)[:, np.newaxis] * [1, 0, 0]
    energy, momentum = spaces(body)[0].surfaces.values()
    assert np.abs(energy).max(axis=(0, 1)) == pytest.approx(
        [2.0, 2.0, 2.0 * (2.0 / 3.0)**0.5])
    assert np.abs(momentum).max(axis=(0, 1)) == pytest.approx([2.0, 2.0, 4.0 / 3.0])


@pytest.mark.parametrize(('moment', 'nets'), [(1.5e-6, 2), (1e-6, 0), (0.7e-6, 0), (1e-7, 0)])
def test_ellipsoids_that_would_be_too_long_to_see_are_left_out(moment, nets):
    polhode, _ = spaces(measured(scene([1.0, 1.0, moment], omega=(1, 0, 0))))
    assert len(polhode.surfaces) == nets


def test_a_body_at_rest_and_a_rod_have_no_ellipsoids_and_a_held_one_no_polhode():
    assert spaces(measured(scene(TENSOR, omega=(0, 0, 0))))[0].surfaces == {}
    assert spaces(measured(scene([1.0, 1.0, 0.0], omega=(1, 0, 0))))[0].surfaces == {}
    assert [one.name for one in spaces(measured(scene(TENSOR, 'pivot')))] == ['axis']
    assert spaces(types.SimpleNamespace(motion=None)) == []


@pytest.mark.parametrize(('inertia', 'constraint', 'center', 'what', 'axis'), [
    ([1, 1, 1.5], 'free', (0, 0, 0), 'symmetry axis', (0, 0, 1)),
    ([1.5, 1, 1], 'free', (0, 0, 0), 'symmetry axis', (1, 0, 0)),
    ([1, 1.5, 1], 'pivot', (0, 0, 0), 'symmetry axis', (0, 1, 0)),
    ([1, 2, 2.5], 'free', (0, 0, 0), 'middle axis', (0, 1, 0)),
    ([2.5, 1, 2], 'free', (0.3, 0, 0), 'middle axis', (0, 0, 1)),
    ([1, 2, 2.5], 'pivot', (0.3, 0, 0.4), 'direction to the centre of mass', (0.6, 0, 0.8)),
    ([1, 2, 2.5], 'pivot', (0, 0, 0), 'middle axis', (0, 1, 0)),
    ([1, 1, 1], 'free', (0, 0, 0), 'body z axis', (0, 0, 1)),
    ([1, 1, 1], 'free', (0, 0.2, 0), 'body z axis', (0, 0, 1))])
def test_the_axis_that_tells_most_is_traced(inertia, constraint, center, what, axis):
    found, vector = traced_axis(scene(inertia, constraint, center))
    assert found == what
    assert np.abs(vector) == pytest.approx(np.array(axis), abs=1e-14)


def test_of_an_unknown_body_its_z_axis_is_traced():
    assert traced_axis(None)[0] == 'body z axis'
    assert traced_axis(None)[1].tolist() == [0.0, 0.0, 1.0]
