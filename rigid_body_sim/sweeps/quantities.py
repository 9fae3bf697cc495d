# SPDX-License-Identifier: Apache-2.0
"""Quantities whose minimum and maximum a sweep keeps, and the units of all variables.

They are made of + - * and square roots alone, which are rounded once on every machine.
"""

from dataclasses import dataclass

import numpy as np

from rigid_body_sim.mechanics import energy
from rigid_body_sim.scene.state import AXES, PLACES, STATE_SIZE, UNITS


@dataclass(frozen=True)
class Quantity:
    """A quantity of a state.

    Attributes
    ----------
    unit, long_name : str
    of : callable
        (states (..., 14), diagnosis (..., 6) or None) -> array (...).
    diagnosed : bool
        Whether it needs the diagnosis of mechanics/energy.py.
    """

    unit: str
    long_name: str
    of: object
    diagnosed: bool = False


def _component(place):
    return lambda states, _: states[..., place]


def _length(part):
    def of(states, _):
        x, y, z = (states[..., place] for place in range(PLACES[part].start, PLACES[part].stop))
        return np.sqrt(x * x + y * y + z * z)
    return of


def _height_of_third_axis(states, _):
    x, y = states[..., 1], states[..., 2]
    return 1.0 - 2.0 * (x * x + y * y)


QUANTITIES = {
    f'{part}.{axis}': Quantity(UNITS[part], f'{part.replace("_", " ")}, component {axis}',
                               _component(PLACES[part].start + place))
    for part, axes in AXES.items() for place, axis in enumerate(axes)
}
QUANTITIES |= {
    'turn_rate': Quantity('rad/s', 'magnitude of the angular velocity',
                          _length('angular_velocity')),
    'speed': Quantity('m/s', "speed of the body's origin", _length('velocity')),
    'cos_tilt': Quantity('1', 'cosine of the angle between body z and world z',
                         _height_of_third_axis),
    'energy': Quantity('J', 'kinetic plus potential energy', lambda _, found:
                       found[..., energy.KINETIC] + found[..., energy.POTENTIAL], True),
    'kinetic_energy': Quantity('J', 'kinetic energy',
                               lambda _, found: found[..., energy.KINETIC], True),
    'angular_momentum_squared': Quantity(
        'kg2 m4/s2', 'square of the angular momentum about the point of reference',
        lambda _, found: found[..., energy.MOMENTUM_SQUARED], True),
}

# the last word of a key path that is not a number -> unit
_OF_KEYS = {
    'mass': 'kg', 'inertia': 'kg m2', 'center_of_mass': 'm', 'radius': 'm', 'length': 'm',
    'width': 'm', 'height': 'm', 'size': 'm', 'semi_axes': 'm', 'tube': 'm', 'at': 'm',
    'through': 'm', 'distance': 'm', 'point': 'm', 'orientation': '1', 'euler_zyz': 'rad',
    'tilt': 'rad', 'spin': 'rad/s', 'angle': 'rad', 'rate': 'rad/s',
    'angular_velocity': 'rad/s', 'position': 'm', 'velocity': 'm/s', 'g': 'm/s2', 'mu': '1',
    'linear': 'kg/s', 'angular': 'kg m2/s', 'speed': 'm/s', 'impulse': 'N s', 'time': 's',
    'torque': 'N m',
}


def unit_of_key(key):
    """Return the unit of a key path of a scene, '' where it is not known."""
    words = [word for word in key.replace('[', '.').replace(']', '').split('.')
             if word and not word.isdigit()]
    return _OF_KEYS.get(words[-1], '') if words else ''


def diagnosis(kernels, parameters, states):
    """Return the diagnosis of states, shape (..., 14), by the kernels of a scene."""
    out = np.empty((*states.shape[:-1], energy.DIAGNOSIS_SIZE))
    kernels.diagnose_many(parameters, states.reshape(-1, STATE_SIZE),
                          out.reshape(-1, energy.DIAGNOSIS_SIZE))
    return out
