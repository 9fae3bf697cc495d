# SPDX-License-Identifier: Apache-2.0
"""The rates that vector code takes are those of contact_rates.py, which are written on their own.

They are compared at any attitude and slip, in all the phases that both have.
"""

import numpy as np
import pytest
from near import near

from rigid_body_sim.integrators.equations.contact_lanes import Coupled
from rigid_body_sim.integrators.equations.contact_views import (
    GLIDING,
    ROLLING,
    ROW,
    SLIDING,
    UNKNOWNS,
)
from rigid_body_sim.integrators.marching import contact_gauss
from rigid_body_sim.integrators.marching.contact_phase import MODE, SWIFT
from rigid_body_sim.scene.scene import parse_scene

pytestmark = pytest.mark.without_numba

BODIES = [
    ('ellipsoid: {semi_axes: [0.22, 0.21, 0.3], center: [0.02, -0.01, 0.03]}', ''),
    ('torus: {radius: 0.2, tube: 0.05}', ', rolling_friction: {viscous: 0.02}'),
    ('disk: {radius: 0.2}', ', rolling_friction: {viscous: 0.02}, air_film: {viscosity: 1.8e-5}')]
PHASES = {'rolls': (ROLLING, (0.0, 0.0)), 'slides': (SLIDING, (0.3, -0.4)),
          'stops': (SLIDING, (0.0, 0.0)), 'glides': (GLIDING, (0.3, -0.4))}


@pytest.mark.parametrize(('surface', 'laws'), BODIES, ids=['ellipsoid', 'torus', 'disk'])
@pytest.mark.parametrize(('mode', 'slip'), PHASES.values(), ids=PHASES)
def test_vector_code_has_the_rates_of_the_phases(surface, laws, mode, slip):
    """In any attitude, on an inclined plane; a slip that stops has a direction, but no rates."""
    scene = parse_scene(
        'scene: s\nbody: {mass: 0.6, inertia: [[0.03, 0.001, 0], [0.001, 0.04, 0.002], '
        f'[0, 0.002, 0.05]], surface: {{{surface}}}}}\n'
        'constraint: {table: {normal: [0.1, -0.2, 1]}}\n'
        f'effects: [gravity: {{g: 9.81}}, sliding_friction: {{mu: 0.3}}{laws}]\n'
        'initial: {position: [0, 0, 3]}\n')
    bound = contact_gauss.OnPlaneByGauss(scene, None, None)
    p, y, row = bound.parameters(0.0), np.zeros(UNKNOWNS.size), np.empty(ROW.size)
    p[MODE], p[SWIFT] = mode, 1.0
    q, omega = (0.1, -0.5, 0.3, 0.8), (3.0, -8.0, 5.0)
    q = tuple((np.array(q) / np.linalg.norm(q)).tolist())
    UNKNOWNS.store(y, UNKNOWNS.load(y.tolist())._replace(q=q, omega=omega, u=(*slip, 0.0)))
    bound.rates.rate(p, y, row)
    expected = ROW.load(row.tolist())
    lanes = contact_gauss.specialise(contact_gauss.contact_lanes, known=contact_gauss._known(
        bound._literals | {'mode': float(mode)}))
    found = lanes.stage(*lanes.parameters(p.tolist()), Coupled(q, omega, slip))
    # measured: the same numbers
    numbers, others = UNKNOWNS.numbers(found.rates), UNKNOWNS.numbers(expected.rates)
    assert numbers == pytest.approx(others, rel=1e-13, abs=1e-13)
    for name in ('normal', 'grip', 'firmness', 'motion'):
        assert getattr(found.watched, name) == near(getattr(expected.watched, name), rel=1e-13)
