"""Ensembles: the same body from many starts, on all cores."""

import concurrent.futures
import os

import numpy as np

from rigid_body_sim.choice import choose
from rigid_body_sim.effects.wrench import Wrench
from rigid_body_sim.errors import BadInput
from rigid_body_sim.motions import absorbing_motion
from rigid_body_sim.motions.exact import loops
from rigid_body_sim.scenes import Scene, load_scene
from rigid_body_sim.state import STATE_SIZE, States


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
        As for Simulation.

    Returns
    -------
    list of States
        One per start, views on one array of shape (bodies, n, 14).

    Raises
    ------
    BadInput
        Starts of another shape, or numbers that are not finite.
    """
    scene = scene if isinstance(scene, Scene) else load_scene(scene)
    starts = np.ascontiguousarray([getattr(start, 'vector', start) for start in starts], dtype=float)
    times = np.ascontiguousarray(times, dtype=float).reshape(-1)
    if starts.ndim != 2 or starts.shape[1] != STATE_SIZE:
        raise BadInput('ensemble', f'got starts of shape {starts.shape}', f'(bodies, {STATE_SIZE})')
    if not (np.isfinite(starts).all() and np.isfinite(times).all()):
        raise BadInput('ensemble', 'got numbers that are not finite', 'finite starts and times')
    out = np.empty((len(starts), len(times), STATE_SIZE))
    choice = choose(scene, integrator, accuracy)
    if choice.method == 'exact':
        motion = absorbing_motion(scene)
        loops(motion).ensemble(motion.parameters(scene)[None], starts, times, out)
    else:
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as threads:
            # the kernels hold no interpreter lock
            list(threads.map(lambda pair: choice.solver(pair[0], Wrench()).states(times, pair[1]), zip(starts, out, strict=True)))
    return [States(states) for states in out]
