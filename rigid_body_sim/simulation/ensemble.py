"""Ensembles: the same body from many starts, on all cores."""

from collections.abc import Sequence

import numpy as np

from rigid_body_sim.choice.choose import choose
from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import Scene, load_scene
from rigid_body_sim.scene.state import STATE_SIZE, States


class Ensemble(Sequence):
    """The States of many bodies: one array, `vector`, of shape (bodies, n, 14)."""

    __slots__ = ('vector',)

    def __init__(self, vector):
        self.vector = vector

    def __len__(self):
        return len(self.vector)

    def __getitem__(self, body):
        return Ensemble(self.vector[body]) if isinstance(body, slice) else States(self.vector[body])


def ensemble(scene, starts, times, integrator='auto', accuracy=1e-12):
    """Return the states of a scene's body from many starts at many times.

    Parameters
    ----------
    scene : Scene, str or path
        Body, constraint and effects; its strikes are left out, its initial state is not used.
    starts : array (bodies, 14) or list of State
        Each with its own time.
    times : array (n,)
        s, in any order.
    integrator, accuracy
        As for Simulation. In closed form and by most methods each body gets the bits that it has alone; `taylor` takes eight bodies at once,
        with other steps to the same accuracy.

    Returns
    -------
    Ensemble
        States by body, in the order of the starts; its `vector` holds all, shape (bodies, n, 14).

    Raises
    ------
    BadInput
        Starts of another shape, numbers that are not finite, a time before a start where there is no closed form.
    NotConverged
        With the number of the body and the time where a method gave up.
    """
    scene = scene if isinstance(scene, Scene) else load_scene(scene)
    if not isinstance(starts, np.ndarray):
        starts = [getattr(start, 'vector', start) for start in starts]
    starts = np.ascontiguousarray(starts, dtype=float)
    times = np.ascontiguousarray(times, dtype=float).reshape(-1)
    if starts.ndim != 2 or starts.shape[1] != STATE_SIZE:
        raise BadInput('ensemble', f'got starts of shape {starts.shape}', f'(bodies, {STATE_SIZE})')
    if not (np.isfinite(starts).all() and np.isfinite(times).all()):
        raise BadInput('ensemble', 'got numbers that are not finite', 'finite starts and times')
    out = np.empty((len(starts), len(times), STATE_SIZE))
    choose(scene, integrator, accuracy).many(starts, times, out)
    return Ensemble(out)
