# SPDX-License-Identifier: Apache-2.0
"""The table of effects: one file each, one line each.

protocol.py says what an effect offers. This folder imports compilation, numerics and its
neighbours in scene/.
"""

import importlib.metadata

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.effects.air_film import AirFilm
from rigid_body_sim.scene.effects.drag import Drag
from rigid_body_sim.scene.effects.dry_friction import DryFriction
from rigid_body_sim.scene.effects.expressed import PotentialEnergy
from rigid_body_sim.scene.effects.force import Force
from rigid_body_sim.scene.effects.gravity import Gravity
from rigid_body_sim.scene.effects.gravity_gradient import GravityGradient
from rigid_body_sim.scene.effects.internal_dissipation import InternalDissipation
from rigid_body_sim.scene.effects.magnetic import Magnetic
from rigid_body_sim.scene.effects.protocol import Effect
from rigid_body_sim.scene.effects.rolling_friction import RollingFriction
from rigid_body_sim.scene.effects.rotor import Rotor
from rigid_body_sim.scene.effects.sliding_friction import SlidingFriction
from rigid_body_sim.scene.effects.spinning_friction import SpinningFriction
from rigid_body_sim.scene.effects.spring import Spring
from rigid_body_sim.scene.effects.strike import Strike
from rigid_body_sim.scene.effects.torque import Torque

GROUP = 'rigid_body_sim.effects'

EFFECTS: dict[str, type[Effect]] = {
    effect.name: effect
    for effect in (
        Gravity, Torque, Force, PotentialEnergy, Strike, SlidingFriction, InternalDissipation,
        Drag, Spring, Magnetic, GravityGradient, Rotor, DryFriction, RollingFriction,
        SpinningFriction, AirFilm)}


def effect_class(name: str) -> type[Effect] | None:
    """Return the effect of that name, or None if there is none.

    An effect that is not in the table is looked for among the installed packages, by the entry
    point group `rigid_body_sim.effects`.

    Raises
    ------
    BadInput
        If a package offers the name but cannot be imported, or offers something else.
    """
    if name in EFFECTS or not isinstance(name, str):
        return EFFECTS.get(name) if isinstance(name, str) else None
    for point in importlib.metadata.entry_points(group=GROUP, name=name):
        try:
            effect: type[Effect] = point.load()
        except Exception as error:    # whatever a foreign package raises
            raise BadInput(f'effect {name}', f'{point.value} cannot be imported: {error}',
                           'repair or remove the package that offers it') from None
        if not (isinstance(effect, type) and Effect in effect.__mro__):
            raise BadInput(f'effect {name}', f'{point.value} is not an Effect',
                           'a class that inherits rigid_body_sim.scene.effects.protocol.Effect')
        if effect.name != name:
            raise BadInput(f'effect {name}', f'{point.value} calls itself {effect.name!r}',
                           'the same name in the entry point and in the class')
        return effect
    return None
