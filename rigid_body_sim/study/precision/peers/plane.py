# SPDX-License-Identifier: Apache-2.0
"""A body with a surface on a level plane, as a peer's user writes it down.

Engines bring their own contact. They have no ideal rolling, but for Exudyn: a coefficient of
friction of STICKY stands for it. A disk is a cylinder; half its thickness is THICK of its radius.
"""

from dataclasses import dataclass

import numpy as np

from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.study.precision.peers import start
from rigid_body_sim.study.precision.runner import RefusedError

STICKY, THICK = 1e3, 2e-4


@dataclass(frozen=True)
class OnPlane:
    """The numbers of a body on a plane, about its centre of mass.

    Attributes
    ----------
    disk : bool
        Whether it is a disk about body axis z; otherwise a sphere.
    radius : float
    middle : array (3,)
        From the centre of mass to the middle of the surface, body axes, m.
    inertia : array (3, 3)
        Body axes, kg m^2.
    mass, mu, g : float
    rolls : bool
        Whether it rolls without slip, whatever friction that takes.
    place, velocity : arrays (3,)
        Start of the centre of mass, world axes.
    start : array (7,)
        q, and omega in world axes.
    """

    disk: bool
    radius: float
    middle: np.ndarray
    inertia: np.ndarray
    mass: float
    mu: float
    g: float
    rolls: bool
    place: np.ndarray
    velocity: np.ndarray
    start: np.ndarray

    def state(self, values):
        """Return q (normalised) and omega in body axes, from q and omega in world axes."""
        q = np.array(values[:4]) / np.linalg.norm(values[:4])
        return *q, *rotate_back(*q, *values[4:7])

    def in_body(self):
        """Return omega at the start in body axes, shape (3,)."""
        return np.array(rotate_back(*self.start))


def has_surface(scene):
    """Return whether a scene is a body with a surface over a plane."""
    return scene.constraint.mechanism is Mechanism.PLANE


def of(scene):
    """Return the OnPlane of a scene; RefusedError tells what engines are not asked to run."""
    body, surface, plane = scene.body, scene.body.surface, scene.constraint
    if surface.kind not in ('sphere', 'disk'):
        raise RefusedError(f'a surface of the kind {surface.kind}: the harness gives engines '
                           'spheres and disks')
    if plane.normal != (0.0, 0.0, 1.0) or plane.restitution:
        raise RefusedError('a slope or impacts: the harness gives engines a level plane without')
    if {effect.name for effect in scene.effects} - {'gravity', 'sliding_friction'}:
        raise RefusedError('more than weight and sliding friction on a plane: '
                           'engines have other laws, or none')
    gravity, center = scene.effect('gravity'), np.array(body.center_of_mass)
    q, omega, velocity = start.of(scene)
    spin, arm = np.array(rotate(*q, *omega)), np.array(rotate(*q, *center))
    mu = scene.contact.mu
    return OnPlane(
        surface.kind == 'disk', surface.size[0], np.array(surface.center) - center,
        np.array(body.about_center.matrix), body.mass, min(mu, STICKY),
        gravity.g if gravity else 0.0, mu > STICKY, np.array(scene.initial.position) + arm,
        np.array(velocity) + np.cross(spin, arm), np.array([*q, *spin]))
