# SPDX-License-Identifier: Apache-2.0
"""Paths and surfaces in space: the polhode on its two ellipsoids, the trace of an axis."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from rigid_body_sim.scene.constraints.protocol import Mechanism

FLATTEST = 1e-6
"""Ratio of moments below which an ellipsoid looks like a cylinder; it is not drawn then."""


@dataclass(frozen=True)
class Space:
    """A path and what it lies on.

    Attributes
    ----------
    name, title : str
    axes : tuple of str
        Labels with units.
    times, path : arrays (n,), (n, 3)
    surfaces : dict
        Name -> points of a net of latitudes and longitudes, (m, k, 3).
    """

    name: str
    title: str
    axes: tuple
    times: np.ndarray
    path: np.ndarray
    surfaces: dict


def spaces(measured):
    """Return the Spaces of a Measured."""
    if measured.motion is None or not measured.motion.samples.columns():
        return []
    return [space for space in (_polhode(measured), _trace(measured)) if space]


def _sphere(rows=25, columns=49):
    latitude, longitude = np.meshgrid(
        np.linspace(0.0, np.pi, rows), np.linspace(0.0, 2.0 * np.pi, columns), indexing='ij'
    )
    return np.stack(
        [
            np.sin(latitude) * np.cos(longitude),
            np.sin(latitude) * np.sin(longitude),
            np.cos(latitude),
        ],
        axis=2,
    )


def _polhode(measured):
    """Return omega of a free body in body axes, with two ellipsoids of the first tick.

    They are omega . I omega = 2 T and |I omega| = L.
    """
    scene = measured.source.scene
    if scene is None or scene.constraint.mechanism is not Mechanism.FREE:
        return None
    times, _, omega, _ = measured.motion.samples.columns()
    inertia = scene.body.about_center
    moments = np.array(inertia.moments)
    first = Rotation.from_quat(inertia.axes).inv().apply(omega[0])
    surfaces = {}
    if first.any() and moments.min() > FLATTEST * moments.max():
        energy, momentum = (
            np.sqrt(moments @ first**2 / moments),
            np.linalg.norm(moments * first) / moments,
        )
        for name, axes in (('energy ellipsoid, 2T', energy), ('momentum ellipsoid, L', momentum)):
            net = _sphere() * axes
            surfaces[name] = (
                Rotation.from_quat(inertia.axes).apply(net.reshape(-1, 3)).reshape(net.shape)
            )
    labels = tuple(f'ω{name} (rad/s)' for name in 'xyz')
    return Space(
        'polhode',
        'Polhode: ω in the body, on the ellipsoids of its energy and its momentum',
        labels,
        times,
        omega,
        surfaces,
    )


def _trace(measured):
    """Return the path of an axis of the body on the unit sphere of the world."""
    times, orientation, _, _ = measured.motion.samples.columns()
    what, axis = traced_axis(measured.source.scene)
    return Space(
        'axis',
        f'Trace of the {what} on the sphere',
        ('x', 'y', 'z'),
        times,
        Rotation.from_quat(orientation).apply(axis),
        {'unit sphere': _sphere()},
    )


def traced_axis(scene):
    """Return (what it is, unit vector in body axes) of the axis whose path is drawn.

    It is the symmetry axis, else the way to the centre of mass, else the middle principal axis.
    """
    if scene is None:
        return 'body z axis', np.array([0.0, 0.0, 1.0])
    held = scene.constraint.holds_a_point
    inertia = (
        scene.constraint.inertia(scene.body)
    )
    axes = Rotation.from_quat(inertia.axes).as_matrix()
    moments = list(inertia.moments)
    if len(set(moments)) == 2:
        distinct = next(k for k in range(3) if moments.count(moments[k]) == 1)
        return 'symmetry axis', axes[:, distinct]
    center = np.array(scene.body.center_of_mass)
    if held and center.any():
        return 'direction to the centre of mass', center / np.linalg.norm(center)
    if len(set(moments)) == 3:
        return 'middle axis', axes[:, int(np.argsort(moments)[1])]
    return 'body z axis', np.array([0.0, 0.0, 1.0])
