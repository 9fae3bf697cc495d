"""Digests of the scenes that ship: what has to be the same, bit for bit, in every process and on every Python.

::

    python -m rigid_body_sim.study.hard_cases.digests      # {"python": ..., "numba": ..., "digests": {scene: {part: SHA-256}}}
"""

import hashlib
import json
import platform

import numpy as np

from rigid_body_sim.compilation import environment
from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import parse_scene, scene_names
from rigid_body_sim.simulation.simulation import Simulation

DURATION, STATES = 20.0, 500    # s
COMPOSITE = """scene: composite
body:
  parts: [{mass: 0.1, shape: {cylinder: {radius: 0.02, length: 0.3}}, at: [0.0, 0.0, 0.1], orientation: [0.1, 0.2, 0.3, 0.9]},
          {mass: 0.2, shape: {solid_sphere: {radius: 0.03}}, at: [0.01, 0.2, 0.0]},
          {mass: 0.3, shape: {box: {size: [0.1, 0.2, 0.3]}}, at: [-0.1, 0.05, 0.07]}]
constraint: free
effects: []
initial: {angular_velocity: [0.3, 5.0, -0.2]}
"""
"""Its mass, centre and axes are sums over parts."""
METHODS = (
    ('tennis_racket', 'dop8', {}),
    ('tennis_racket', 'gauss16', {}),
    *(
        ('heavy_top', name, {'step': 0.01})
        for name in ('split2', 'split4', 'split6', 'split8', 'rk4', 'semi_implicit_euler')
    ),
    ('heavy_top', 'lsoda', {'accuracy': 1e-9}),
    ('heavy_top', 'radau', {'accuracy': 1e-6}),
)
"""Beside what `auto` takes for each scene: (scene, method, its control)."""


def _digest(numbers):
    return hashlib.sha256(np.ascontiguousarray(numbers, dtype=float).tobytes()).hexdigest()


def of_scene(scene):
    """Return a digest for each part of a scene's run: states at any times, events, after an impulse, the ledger."""
    simulation = Simulation(scene)
    found = {'states': _digest(simulation.states(np.linspace(0.0, DURATION, STATES)).vector)}
    simulation.advance(5000)
    found['events'] = _digest([event.time for event in simulation.events])
    try:
        simulation.impulse(force=(0.03, -0.02, 0.0), torque=(1e-3, 2e-3, -1e-3), frame='body')
    except BadInput:    # of a rod, about its axis
        simulation.impulse(force=(0.03, -0.02, 0.0), torque=(1e-3, 2e-3, 0.0), frame='body')
    simulation.advance(2000)
    return found | {
        'struck': _digest(simulation.vector),
        'ledger': _digest(list(simulation.ledger().values())),
    }


def of_method(name, method, control):
    """Return the digest of states by a method."""
    return {
        'states': _digest(
            Simulation(name, method, **control).states(np.linspace(0.0, 2.0, 50)).vector
        )
    }


def held(name):
    """Return the digest of states under a wrench that turns with the body."""
    simulation = Simulation(name)
    simulation.hold(torque=(2e-3, 1e-3, -3e-3), frame='body')
    return {
        'states': _digest(simulation.advance_through(500).vector),
        'ledger': _digest(list(simulation.ledger().values())),
    }


def main():
    """Print the digests as JSON."""
    found = {name: of_scene(name) for name in scene_names()}
    found |= {
        f'{name} by {method}': of_method(name, method, control)
        for name, method, control in METHODS
    }
    found |= {f'{name} under a held wrench': held(name) for name in ('tennis_racket', 'heavy_top')}
    found['composite'] = of_scene(parse_scene(COMPOSITE))
    print(
        json.dumps(
            {
                'python': platform.python_version(),
                'numba': environment.HAVE_NUMBA and environment.numba.__version__,
                'digests': found,
            }
        )
    )


if __name__ == '__main__':
    main()
