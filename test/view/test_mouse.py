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
    near = surfaces.box((1.0, 1.0, 1.0)).placed(Rotation.identity(), (5.0, 0.0, 0.0))
    far = surfaces.box((1.0, 1.0, 1.0)).placed(Rotation.identity(), (8.0, 0.0, 0.0))
    for both in ([near, far], [far, near]):
        found = hit(Drawing(both, ''), still, np.array([0.0, 0.2, 0.1]), np.array([1.0, 0, 0]))
        assert found == pytest.approx([4.5, 0.2, 0.1])


def test_a_drag_lasts_until_it_ends_and_clicks_wait_in_their_order():
    mouse = Mouse()

    def event(**values):
        return types.SimpleNamespace(**values)
    asyncio.run(mouse._drag(event(phase='update', start_position=(1, 2, 3),
                                  end_position=(4, 5, 6))))
    assert (mouse.pull.grabbed.tolist(), mouse.pull.cursor.tolist()) == ([1, 2, 3], [4, 5, 6])
    asyncio.run(mouse._drag(event(phase='end')))
    assert mouse.pull is None
    for k in range(2):
        asyncio.run(mouse._click(event(ray_origin=(k, 0, 0), ray_direction=(0, k, 0))))
    assert [(origin[0], along[1]) for origin, along in mouse.clicks] == [(0, 0), (1, 1)]
