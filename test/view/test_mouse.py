# SPDX-License-Identifier: Apache-2.0
"""The point where a ray meets a body, compared with a box whose faces are planes."""

import asyncio
import types

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rigid_body_sim.drawing import surfaces
from rigid_body_sim.drawing.body import Drawing
from rigid_body_sim.view.mouse import Mouse, hit

HALF = np.array([0.5, 1.0, 1.5])


def meets(start, along):
    """Return the distance at which a ray first meets the box |x_k| <= HALF_k from outside."""
    with np.errstate(divide='ignore'):
        near, far = np.sort([(-HALF - start) / along, (HALF - start) / along], axis=0)
    return near.max() if near.max() < far.min() and near.max() > 0.0 else None


@pytest.mark.parametrize('seed', range(40))
def test_a_ray_meets_a_box_where_its_planes_say(seed):
    draw = np.random.default_rng(seed)
    turn, place = Rotation.random(random_state=seed), draw.normal(size=3)
    start = draw.normal(size=3)
    start *= 5.0 / np.linalg.norm(start)
    along = draw.normal(size=3) * 0.5 - start
    along /= np.linalg.norm(along)
    along *= 1.0 if seed % 4 else -1.0    # away from it
    vector = np.zeros(14)
    vector[1:5], vector[8:11] = turn.as_quat(), place
    found = hit(Drawing([surfaces.box(2.0 * HALF)], ''), vector, place + turn.apply(start),
                turn.apply(along))
    distance = meets(start, along)
    if distance is None:
        assert found is None
    else:
        assert found == pytest.approx(place + turn.apply(start + distance * along), abs=1e-12)


def test_the_nearer_of_two_surfaces_is_met():
    still = np.zeros(14)
    still[4] = 1.0
    near = surfaces.box((1.0, 1.0, 1.0)).placed((5.0, 0.0, 0.0))
    far = surfaces.box((1.0, 1.0, 1.0)).placed((8.0, 0.0, 0.0))
    for both in ([near, far], [far, near]):
        found = hit(Drawing(both, ''), still, np.array([0.0, 0.2, 0.1]), np.array([1.0, 0, 0]))
        assert found == pytest.approx([4.5, 0.2, 0.1])


@pytest.mark.parametrize(('start', 'met'), [(4.0, 4.5), (4.9, 5.5), (5.5, None)])
def test_a_ray_may_begin_close_to_a_body_inside_it_or_where_it_ends(start, met):
    still = np.zeros(14)
    still[4] = 1.0
    one = surfaces.box((1.0, 1.0, 1.0)).placed((5.0, 0.0, 0.0))
    found = hit(Drawing([one], ''), still, np.array([start, 0.2, 0.1]), np.array([1.0, 0, 0]))
    assert found is None if met is None else found == pytest.approx([met, 0.2, 0.1])


def drag(mouse, phase, cursor=(0, 0, 0), client=0):
    """Report an event of a drag, as viser does."""
    asyncio.run(mouse._drag(types.SimpleNamespace(
        phase=phase, start_position=(1, 2, 3), end_position=cursor, client_id=client)))


def cursors(mouse):
    """Return where the mice are that drag, by their browsers."""
    return {key: pull.cursor.tolist() for key, pull in mouse.pulls.items()}


def test_a_drag_lasts_until_it_ends():
    mouse = Mouse()
    drag(mouse, 'start', (4, 5, 6))
    [pull] = mouse.pulls.values()
    drag(mouse, 'update', (7, 8, 9))
    assert mouse.pulls[0].begun is pull.begun
    assert (pull.begun.tolist(), cursors(mouse)) == ([1, 2, 3], {0: [7, 8, 9]})
    drag(mouse, 'end')
    assert mouse.pulls == {}


def test_two_browsers_drag_at_once_and_neither_ends_the_other():
    mouse = Mouse()
    drag(mouse, 'start', (1, 0, 0), client=3)
    drag(mouse, 'start', (2, 0, 0), client=7)
    drag(mouse, 'update', (3, 0, 0), client=3)
    assert cursors(mouse) == {3: [3, 0, 0], 7: [2, 0, 0]}
    drag(mouse, 'end', client=3)
    assert cursors(mouse) == {7: [2, 0, 0]}


def test_a_drag_of_a_body_that_is_gone_does_not_pull_the_next_one():
    mouse = Mouse()
    drag(mouse, 'start')
    mouse.listen([])
    drag(mouse, 'update', (5, 5, 5))
    assert mouse.pulls == {}
    drag(mouse, 'end')
    drag(mouse, 'start', (6, 6, 6))
    assert cursors(mouse) == {0: [6, 6, 6]}


def test_clicks_wait_in_their_order():
    mouse = Mouse()
    for k in range(2):
        asyncio.run(mouse._click(types.SimpleNamespace(ray_origin=(k, 0, 0),
                                                       ray_direction=(0, k, 0))))
    assert [(origin[0], along[1]) for origin, along in mouse.clicks] == [(0, 0), (1, 1)]
