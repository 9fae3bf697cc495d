# SPDX-License-Identifier: Apache-2.0
"""A table: which bodies it takes, and where they lie on it."""

import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.constraints.plane import Plane
from rigid_body_sim.scene.constraints.table import Table
from rigid_body_sim.scene.scene import parse_scene

BALL = 'shape: {solid_sphere: {radius: 0.5}}'
SURFACE = 'surface: {sphere: {radius: 0.5}}'
TENSOR = 'inertia: [0.1, 0.1, 0.1]'


def scene_of(body, initial='', table='table'):
    return parse_scene(f'scene: s\nbody: {{mass: 2, {body}}}\nconstraint: {table}\neffects: []\n'
                       f'initial: {{{initial}}}\n')


@pytest.mark.parametrize(('body', 'table', 'kind'), [
    (BALL, 'table', Table), (f'{TENSOR}, radius: 0.5', 'table', Table),
    (f'{TENSOR}, {SURFACE}', 'table', Plane), (f'{BALL}, {SURFACE}', 'table', Plane),
    (f'{BALL}, {SURFACE}', '{table: {restitution: 0.5}}', Plane)])
def test_a_ball_lies_on_a_table_and_a_body_with_a_surface_on_a_plane(body, table, kind):
    assert type(scene_of(body, '', table).constraint) is kind


@pytest.mark.parametrize(('body', 'table', 'words'), [
    (TENSOR, 'table', 'a table needs a sphere'),
    (f'{BALL}, center_of_mass: [0, 0.1, 0]', 'table', r'\[0\.0, 0\.1, 0\.0\] is off the middle'),
    (BALL, '{table: {restitution: 0.5}}', 'settings for a ball that has no surface')])
def test_what_lies_on_no_table_is_refused(body, table, words):
    with pytest.raises(BadInput, match=words):
        scene_of(body, '', table)


def test_a_ball_lies_at_the_origin_or_where_it_is_put_at_the_height_of_its_radius():
    assert scene_of(BALL).initial.position.tolist() == [0.0, 0.0, 0.5]
    state = scene_of(BALL, 'position: [3, 4, 0.5], velocity: [5, 6, 0]').initial
    assert (state.position.tolist(), state.velocity.tolist()) == ([3, 4, 0.5], [5, 6, 0])


@pytest.mark.parametrize('initial', [
    'position: [0, 0, 0.6]', 'position: [0.5, 0.5, 0.4]', 'velocity: [0, 0, 1]',
    'velocity: [0, 0, -0.1]', 'position: [0, 0, 0.6], velocity: [0, 0, 1]'])
def test_a_ball_above_or_below_the_table_or_leaving_it_is_refused(initial):
    with pytest.raises(BadInput, match='the ball lies on the table'):
        scene_of(BALL, initial)
