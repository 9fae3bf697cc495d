# SPDX-License-Identifier: Apache-2.0
"""The numbers of a scene as controls: every one that its YAML text has, and spin and tilt."""

import math

import yaml

from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.state import ANGULAR_VELOCITY


def mapping_of(scene):
    """Return the mapping of a Scene's YAML text without its name and description."""
    mapping = yaml.safe_load(scene.text)
    return {key: value for key, value in mapping.items() if key not in ('scene', 'about')}


def numbers(mapping):
    """Yield (path, value) of every number in a scene mapping, in its order; a path is a tuple."""
    entries = mapping.items() if isinstance(mapping, dict) else enumerate(mapping)
    for key, value in entries:
        if isinstance(value, (dict, list)):
            for path, number in numbers(value):
                yield (key, *path), number
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            yield (key,), float(value)


def label(path):
    """Return a path as a person reads it: `effects.0.gravity.g` is `gravity.g`."""
    names = [str(key) for key in path]
    return '.'.join(names[2:] if names[0] == 'effects' and len(names) > 2 else names)


def changed(text, path, value):
    """Return the YAML text of a scene with another number at a path."""
    mapping = yaml.safe_load(text)
    target = mapping
    for key in path[:-1]:
        target = target[key]
    target[path[-1]] = value
    return yaml.safe_dump(mapping, sort_keys=False, allow_unicode=True)


def spin_of(scene):
    """Return (spin, spinning axis): the largest initial component of omega (rad/s) and its axis.

    Of a hinged body it is the rate about its axis, and the axis is None.
    """
    if scene.constraint.mechanism is Mechanism.AXIS:
        return float(yaml.safe_load(scene.text)['initial'].get('rate', 0.0)), None
    omega = scene.initial.angular_velocity
    axis = int(abs(omega).argmax()) if omega.any() else 2
    return float(scene.initial.vector[ANGULAR_VELOCITY][axis]), axis


def with_spin(scene, spin):
    """Return the YAML text of a scene with another spin."""
    mapping = yaml.safe_load(scene.text)
    initial = mapping['initial']
    _, axis = spin_of(scene)
    if axis is None:
        initial['rate'] = spin
    else:
        omega = scene.initial.angular_velocity.tolist()
        omega[axis] = spin
        for other in ('spin', 'angular_velocity_world', 'angular_momentum'):
            initial.pop(other, None)
        initial['angular_velocity'] = omega
    return yaml.safe_dump(mapping, sort_keys=False, allow_unicode=True)


def tilt_of(scene):
    """Return the initial angle (rad) between body z and world z; of a hinged body its angle."""
    mapping = yaml.safe_load(scene.text)
    if scene.constraint.mechanism is Mechanism.AXIS:
        return float(mapping['initial'].get('angle', 0.0))
    x, y, z, w = scene.initial.orientation.tolist()
    return 2.0 * math.atan2(math.hypot(x, y), math.hypot(z, w))


def with_tilt(scene, tilt):
    """Return the YAML text of a scene with another initial tilt, angular velocity unchanged."""
    mapping = yaml.safe_load(scene.text)
    initial = mapping['initial']
    if scene.constraint.mechanism is Mechanism.AXIS:
        initial['angle'] = tilt
    elif 'euler_zyz' in initial:
        initial['euler_zyz'] = [initial['euler_zyz'][0], tilt, initial['euler_zyz'][2]]
    else:
        for other in ('orientation', 'euler', 'rotation_vector'):
            initial.pop(other, None)
        initial['tilt'] = tilt
    return yaml.safe_dump(mapping, sort_keys=False, allow_unicode=True)
