# SPDX-License-Identifier: Apache-2.0
"""Quantities of states by hand, and the units of keys."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rigid_body_sim.mechanics.energy import KINETIC, MOMENTUM_SQUARED, POTENTIAL
from rigid_body_sim.sweeps.quantities import QUANTITIES, diagnosis, unit_of_key

NAMES = ('time', 'orientation.x', 'orientation.y', 'orientation.z', 'orientation.w',
         'angular_velocity.x', 'angular_velocity.y', 'angular_velocity.z', 'position.x',
         'position.y', 'position.z', 'velocity.x', 'velocity.y', 'velocity.z')
STATES = np.random.default_rng(2).normal(size=(2, 3, 14))
STATES[..., 1:5] /= np.linalg.norm(STATES[..., 1:5], axis=-1)[..., np.newaxis]


@pytest.mark.parametrize('place', range(1, 14))
def test_a_component_is_its_place_in_the_state(place):
    quantity = QUANTITIES[NAMES[place]]
    assert (quantity.of(STATES, None) == STATES[..., place]).all()
    assert not quantity.diagnosed
    assert quantity.unit == ('1' if place < 5 else 'rad/s' if place < 8 else
                             'm' if place < 11 else 'm/s')


def test_lengths_and_the_tilt_are_those_of_the_vectors():
    for name, first in (('turn_rate', 5), ('speed', 11)):
        found = QUANTITIES[name].of(STATES, None)
        assert found == pytest.approx(np.linalg.norm(STATES[..., first:first + 3], axis=-1))
    turned = Rotation.from_quat(STATES[..., 1:5].reshape(-1, 4)).apply([0.0, 0.0, 1.0])
    assert QUANTITIES['cos_tilt'].of(STATES, None).ravel() == pytest.approx(turned[:, 2])


def test_energies_come_from_the_diagnosis():
    found = np.arange(6.0)
    for name, expected in (('energy', found[KINETIC] + found[POTENTIAL]),
                           ('kinetic_energy', found[KINETIC]),
                           ('angular_momentum_squared', found[MOMENTUM_SQUARED])):
        assert QUANTITIES[name].diagnosed
        assert QUANTITIES[name].of(None, found) == expected


def test_a_diagnosis_has_a_row_for_each_state():
    class Kernels:
        @staticmethod
        def diagnose_many(parameters, states, out):
            assert states.shape == (6, 14)
            out[:] = parameters + states[:, :1]
    found = diagnosis(Kernels, 3.0, STATES)
    assert found.shape == (2, 3, 6)
    assert (found == 3.0 + STATES[..., :1]).all()


@pytest.mark.parametrize(('key', 'unit'), [
    ('body.mass', 'kg'), ('body.inertia.1', 'kg m2'), ('body.inertia[1][2]', 'kg m2'),
    ('initial.angular_velocity.0', 'rad/s'), ('effects[0].gravity.g', 'm/s2'),
    ('strike.time', 's'), ('parameters.k', ''), ('0.1', ''), ('', '')])
def test_a_key_has_the_unit_of_its_last_word(key, unit):
    assert unit_of_key(key) == unit
