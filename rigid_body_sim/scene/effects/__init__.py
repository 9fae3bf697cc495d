"""The table of effects: one file each, one line each. What an effect must offer is said in rigid_body_sim/scene/effects/views.py."""

from rigid_body_sim.scene.effects.drag import Drag
from rigid_body_sim.scene.effects.gravity import Gravity
from rigid_body_sim.scene.effects.internal_dissipation import InternalDissipation
from rigid_body_sim.scene.effects.sliding_friction import SlidingFriction
from rigid_body_sim.scene.effects.strike import Strike
from rigid_body_sim.scene.effects.torque import Torque

EFFECTS = {effect.name: effect for effect in (Gravity, Torque, Strike, SlidingFriction, InternalDissipation, Drag)}
