# SPDX-License-Identifier: Apache-2.0
"""Values of a sweep as a spec writes them: lists, spaces, samples, times (spec.py)."""

import collections.abc
import math

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.functions import power
from rigid_body_sim.scene import yaml_text
from rigid_body_sim.sweeps.draws import KINDS, Sampled

SPACES = ('linspace', 'logspace')
MOST_VALUES = 10**7
"""Most values of one key of `vary`, and most times."""


def a_number(value, where, what='a finite number'):
    """Return a finite number as a double."""
    if isinstance(value, bool) or not isinstance(value, (int, float, np.number)) \
            or not math.isfinite(value):
        raise BadInput(where, f'got {yaml_text.brief(value)}', what)
    return float(value)


def a_count(value, where, least=1, most=10**12):
    """Return a whole number within bounds."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) \
            or not least <= value <= most:
        raise BadInput(where, f'got {yaml_text.brief(value)}',
                       f'a whole number from {least} to {most}')
    return int(value)


def _space(value, where):
    """Return the array of a linspace or logspace, or None where the value is neither."""
    if not isinstance(value, collections.abc.Mapping):
        return None
    if len(value) != 1 or next(iter(value)) not in SPACES:
        raise BadInput(where, f'got {yaml_text.brief(value)}',
                       'a list, {linspace: [first, last, count]} or {logspace: [first exponent '
                       'of ten, last exponent, count]}')
    (kind, bounds), = value.items()
    if not isinstance(bounds, (list, tuple)) or len(bounds) != 3:
        raise BadInput(f'{where}.{kind}', f'got {yaml_text.brief(bounds)}', '[first, last, count]')
    first, last = (a_number(bound, f'{where}.{kind}') for bound in bounds[:2])
    count = a_count(bounds[2], f'{where}.{kind}', most=MOST_VALUES)
    values = np.linspace(first, last, count)
    # not numpy.logspace: it asks the C library for powers, whose bits differ between machines
    return values if kind == 'linspace' else np.array([power(10.0, x) for x in values.tolist()])


def values_of(value, where):
    """Return the values of a key: an array of doubles, or a list of what a scene file may hold."""
    values = _space(value, where)
    if values is not None:
        return values
    values = value.tolist() if isinstance(value, np.ndarray) else value
    if not isinstance(values, (list, tuple)) or not 0 < len(values) <= MOST_VALUES:
        raise BadInput(where, f'got {yaml_text.brief(value)}',
                       'a list of values, {linspace: [first, last, count]} or '
                       '{logspace: [first exponent of ten, last exponent, count]}')
    if all(isinstance(one, (int, float)) and not isinstance(one, bool) for one in values):
        return np.array([a_number(one, where) for one in values])
    return list(values)


def sample_of(mapping, where):
    """Return (key -> Sampled, number of samples, seed)."""
    if not mapping:
        return {}, 0, 0
    if 'runs' not in mapping:
        raise BadInput(where, "the key 'runs' is missing", 'the number of samples, runs: 1000')
    runs = a_count(mapping.pop('runs'), f'{where}.runs')
    seed = a_count(mapping.pop('seed', 0), f'{where}.seed', 0, 2**63)
    if not mapping:
        raise BadInput(where, 'names no key of the scene',
                       'for example initial.angular_velocity.1: {uniform: [4, 6]}')
    return {str(key): _sampled(str(key), value, seed, f'{where}.{key}')
            for key, value in mapping.items()}, runs, seed


def _sampled(key, value, seed, where):
    wanted = ('{uniform: [least, largest]}, {normal: [mean, standard deviation]}, '
              '{direction: length} or rotation')
    if value == 'rotation':
        return Sampled('rotation', 0.0, 0.0, seed, key)
    if not isinstance(value, collections.abc.Mapping) or len(value) != 1 \
            or next(iter(value)) not in KINDS or 'rotation' in value:
        raise BadInput(where, f'got {yaml_text.brief(value)}', wanted)
    (kind, given), = value.items()
    if kind == 'direction':
        return Sampled(kind, a_number(given, where, wanted), 0.0, seed, key)
    if not isinstance(given, (list, tuple)) or len(given) != 2:
        raise BadInput(where, f'got {yaml_text.brief(value)}', wanted)
    a, b = (a_number(one, where, wanted) for one in given)
    if (kind == 'uniform' and not a <= b) or (kind == 'normal' and not b >= 0.0):
        raise BadInput(where, f'got {yaml_text.brief(value)}', wanted)
    return Sampled(kind, a, b, seed, key)


def times_of(value, where):
    """Return the times (s), each later than the one before."""
    times = _space(value, where)
    if times is None:
        given = np.atleast_1d(np.asarray(value)).tolist()
        times = np.array([a_number(one, where, 'seconds: a number, a list or a linspace')
                          for one in given])
    if not len(times) or not (np.diff(times) > 0.0).all() or times[0] < 0.0:
        raise BadInput(where, f'got {yaml_text.brief(times.tolist())}',
                       'seconds from 0 on, each later than the one before')
    return times
