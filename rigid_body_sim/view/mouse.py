# SPDX-License-Identifier: Apache-2.0
"""The mouse on the body: drags and clicks of a page, as requests for its loop.

viser reports them in its own thread; here they are only noted, in order.
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from rigid_body_sim.scene.state import ORIENTATION, POSITION


class Pull(NamedTuple):
    """A drag in progress: the grabbed point where it began, and the cursor, on the page."""

    begun: np.ndarray
    cursor: np.ndarray


class Mouse:
    """The mouse's actions on the body of a page; each browser has a mouse of its own.

    Attributes
    ----------
    pulls : dict of {int: Pull}
        The drag that goes on in each browser, by its number.
    clicks : list of (origin, direction)
        Rays of clicks that wait, on the page.
    """

    def __init__(self):
        self.pulls, self.clicks = {}, []

    def listen(self, handles):
        """Listen to the surfaces of a body that appears; drags of the one before are over."""
        self.pulls, self.clicks = {}, []
        for handle in handles:
            handle.on_drag('left')(self._drag)
            handle.on_click(self._click)

    async def _drag(self, event):
        """Take an event of a drag. viser reports the end also where the browser is gone.

        It reports no motion of the grabbed point while the mouse is still, so the page follows
        that itself from where it began.
        """
        if event.phase == 'start':
            self.pulls[event.client_id] = Pull(np.array(event.start_position),
                                               np.array(event.end_position))
        elif event.phase == 'end':
            self.pulls.pop(event.client_id, None)
        elif event.client_id in self.pulls:    # else its body is gone
            begun = self.pulls[event.client_id].begun
            self.pulls[event.client_id] = Pull(begun, np.array(event.end_position))

    async def _click(self, event):
        self.clicks.append((np.array(event.ray_origin), np.array(event.ray_direction)))


def hit(drawing, vector, origin, direction):
    """Return the point (world, m) where a ray first meets the body, or None (Moeller, Trumbore).

    Parameters
    ----------
    drawing : Drawing
    vector : array (14,)
        State of the body.
    origin, direction : array (3,)
        The ray, world, m.
    """
    turn = Rotation.from_quat(vector[ORIENTATION])
    start, along = turn.inv().apply(origin - vector[POSITION]), turn.inv().apply(direction)
    nearest = np.inf
    for surface in drawing.surfaces:
        a, b, c = np.moveaxis(surface.vertices[surface.faces], 1, 0)
        normal = np.cross(along, c - a)
        size = np.einsum('ij,ij->i', b - a, normal)
        with np.errstate(divide='ignore', invalid='ignore'):
            u = np.einsum('ij,ij->i', start - a, normal) / size
            across = np.cross(start - a, b - a)
            v = across @ along / size
            distance = np.einsum('ij,ij->i', c - a, across) / size
            inside = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (distance > 0.0)
        nearest = min(nearest, distance[inside].min(initial=np.inf))
    return origin + nearest * direction if np.isfinite(nearest) else None
