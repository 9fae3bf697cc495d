"""The table of methods: one file each, one line each.

A method is a module with NAME, ORDER, PRESERVES (what it keeps exactly), SOURCE (where it is published) and NEEDS (the view of every
effect that it asks for, rigid_body_sim/effects/views.py).
"""

from rigid_body_sim.integrators import dop8

METHODS = {method.NAME: method for method in (dop8,)}


def runnable(scene):
    """Return the names of the methods that can run a scene: those that find the view they need in every effect (strikes are impulses)."""
    if scene.constraint.kind == 'table':
        return []
    effects = [effect for effect in scene.effects if effect.name != 'strike']
    return [name for name, method in METHODS.items() if all(hasattr(effect, method.NEEDS) for effect in effects)]
