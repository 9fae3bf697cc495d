# SPDX-License-Identifier: Apache-2.0
"""The points of the quadrature stand for the shapes: their centre, products and extent."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.study.scenes import inertia_tensors
from rigid_body_sim.study.scenes.inertia_tensors import A, B, C, L, R

HALVES = {'rod about its centre': (0, 0, L / 2), 'lamina, I_zz = I_xx + I_yy': (A / 2, B / 2, 0),
          'hoop': (R, R, 0), 'disk': (R, R, 0), 'spherical shell': (R, R, R),
          'solid sphere': (R, R, R), 'box': (A / 2, B / 2, C / 2), 'cylinder': (R, R, L / 2),
          'ellipsoid': (A, B, C)}
SHAPES = {name: points for name, _, _, points in inertia_tensors._shapes()}


@pytest.mark.parametrize('name', HALVES)
def test_points_of_a_quadrature_fill_the_shape_evenly(name):
    assert set(SHAPES) == set(HALVES)
    *places, weight = SHAPES[name]
    places = np.array(places)
    total = weight.sum()
    assert weight.min() > 0.0
    half = np.array(HALVES[name])
    assert places @ weight / total == pytest.approx(np.zeros(3), abs=1e-15)
    moments = places * weight @ places.T / total
    assert moments - np.diag(np.diag(moments)) == pytest.approx(np.zeros((3, 3)), abs=1e-15)
    assert (np.abs(places).max(axis=1) <= half + 1e-15).all()
    # the outermost of eight Gauss points, and of rings of eight
    assert (np.abs(places).max(axis=1) >= 0.9 * half).all()
    # the third and fourth powers are those of an even filling along z, but for shells
    if half[2] and name not in ('spherical shell', 'solid sphere', 'ellipsoid'):
        fourth = (places[2] ** 4 * weight).sum() / total
        assert fourth == near(half[2] ** 4 / 5.0, rel=1e-13)


@pytest.mark.parametrize('method', inertia_tensors.METHODS)
def test_every_shape_has_the_moments_of_the_notes(method):
    rows = list(inertia_tensors.check(method))
    assert [row.name for row in rows] == [
        *HALVES, 'rod about its end', 'rod about its end, by the parallel axis']
    for row in rows:
        assert (row.tolerance, row.unit, row.absolute) == (1e-14, 'kg m^2', False)
        assert row.passed
