# SPDX-License-Identifier: Apache-2.0
"""Table: a balanced sphere on a horizontal plane; its middle stays at the height of the radius.

A body with another surface, or a plane that is inclined or lets bodies bounce, is a Plane
(plane.py).
"""

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene import initial
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.plane import Plane
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.initial import Start
from rigid_body_sim.scene.state import State


@dataclass(frozen=True)
class Table(Constraint):
    """``constraint: table``. The reference point is the centre of mass, which moves in a plane."""

    kind: ClassVar[str] = 'table'
    usage: ClassVar[str] = 'table'
    INITIAL: ClassVar[dict] = {**initial.ORIENTATION, **initial.TURNING, **initial.PLACE,
                               **initial.MOTION}
    mechanism: ClassVar[Mechanism] = Mechanism.TABLE

    @classmethod
    def variant(cls, body: Body, settings: Any) -> type[Constraint]:
        """Return Plane for a body with a surface and for a plane with settings, else Table."""
        return Plane if settings or body.surface is not None else cls

    @classmethod
    def variants(cls) -> tuple[type[Constraint], ...]:
        """Return Table and Plane."""
        return cls, Plane

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, where: str) -> Self:
        """Return the constraint; it takes a sphere whose centre of mass is its middle."""
        if body.radius is None:
            raise BadInput(where, 'a table needs a sphere',
                           'give body.shape solid_sphere or spherical_shell, '
                           'or body.radius with equal moments, or a smooth body.surface (sphere, '
                           'ellipsoid, torus, disk): edges and polyhedra are not supported')
        if any(body.center_of_mass):
            raise BadInput(where,
                           f'the centre of mass {list(body.center_of_mass)} is off the middle',
                           'a ball on a table is balanced')
        return cls()

    def initial(self, start: Start, body: Body, where: str) -> State:
        """Return the state of a ball that lies on the table; by default it lies at the origin."""
        assert body.radius is not None    # from_scene takes spheres only
        if 'position' not in start.mapping:
            start = start.at((0.0, 0.0, body.radius))
        if start.position[2] != body.radius or start.velocity[2] != 0.0:
            raise BadInput(where, f'got height {start.position[2]!r} and vertical velocity '
                           f'{start.velocity[2]!r}',
                           f'the ball lies on the table: height {body.radius!r} (its radius), '
                           'vertical velocity 0')
        start.refuse_spin_without_moment(body.about_center, where)
        return start.state()
