# SPDX-License-Identifier: Apache-2.0
"""Flips counted in blocks of any size are those of a plain loop, and those of theory."""

import math

import numpy as np
import pytest

from rigid_body_sim.analysis.flips import Flips, can_flip
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.simulation.simulation import Simulation


def counted(scene, omega, sizes):
    """Return the count over blocks of the given sizes, again and again."""
    flips, begin, k = Flips(scene), 0, 0
    while begin < len(omega):
        end = begin + sizes[k % len(sizes)]
        flips.add(omega[begin:end])
        begin, k = end, k + 1
    return flips.count


def counted_plainly(omega, inertia, middle):
    count, armed, before = 0, False, None
    for sample in omega:
        m = inertia * sample
        positive = bool(m[middle] > 0.0)
        if before is not None and positive != before:
            count += armed
            armed = False
        armed = armed or abs(m[middle]) >= 0.5 * math.sqrt(m @ m)
        before = positive
    return count


@pytest.mark.parametrize('inertia', [(1.0, 2.0, 3.0), (2.0, 3.0, 1.0), (3.0, 1.0, 2.0)])
def test_any_blocks_count_what_a_plain_loop_counts(inertia):
    scene = parse_scene(f'{{scene: s, body: {{mass: 1, inertia: {list(inertia)}}}, constraint: '
                        'free, effects: [], '
                        'initial: {angular_velocity: [0, 0, 1]}}')
    steps = np.random.default_rng(3).normal(size=(4000, 3))
    # a walk that crosses zero often, strong and weak
    omega = np.cumsum(steps, axis=0) % 30.0 - 15.0
    middle = inertia.index(2.0)
    expected = counted_plainly(omega, np.array(inertia), middle)
    assert 100 < expected < np.count_nonzero(np.diff(omega[:, middle] > 0.0))
    for sizes in ([4000], [1], [7, 1, 230], [1999]):
        assert counted(scene, omega, sizes) == expected


def test_the_racket_flips_twice_a_period():
    scene = load_scene('tennis_racket')
    simulation = Simulation(scene)
    omega = simulation.states(np.arange(0, 100.0, 1e-3)).angular_velocity
    crossings = np.count_nonzero(np.diff(omega[:, 1] > 0.0))
    assert counted(scene, omega, [230]) == crossings == 20      # the period is 10.06 s


def test_a_body_near_a_stable_axis_does_not_flip_though_the_component_changes_sign():
    scene = load_scene('tennis_racket', ['initial.angular_velocity=[5.0, 0.5, 0.01]'])
    omega = Simulation(scene).states(np.arange(0, 20.0, 1e-3)).angular_velocity
    assert np.count_nonzero(np.diff(omega[:, 1] > 0.0)) > 10
    assert counted(scene, omega, [230]) == 0


def test_only_a_free_body_with_three_different_moments_flips():
    assert can_flip(load_scene('tennis_racket'))
    assert not can_flip(load_scene('tennis_racket', ['body.inertia=[1.0, 1.0, 2.0]']))
    assert not can_flip(load_scene('tennis_racket', ['constraint=pivot']))
    assert not can_flip(None)
