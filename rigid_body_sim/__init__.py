# SPDX-License-Identifier: Apache-2.0
"""Rigid-body motion on ROS 2: a closed form where one exists, otherwise stepped methods.

::

    from rigid_body_sim import Simulation
    simulation = Simulation('tennis_racket', overrides={'body.mass': 2.0})
    print(simulation.states([10.0, 20.0, 5.0]).orientation)
"""

import importlib
import typing

if typing.TYPE_CHECKING:  # for type checkers and editors
    __version__: str
    from rigid_body_sim.errors import BadInput, NotConverged
    from rigid_body_sim.recording.reader import Recording
    from rigid_body_sim.scene.scene import Scene, load_scene, parse_scene, scene_names
    from rigid_body_sim.scene.state import State, States
    from rigid_body_sim.simulation.ensemble import Ensemble, ensemble
    from rigid_body_sim.simulation.simulation import Simulation
    from rigid_body_sim.simulation.spans import Event
    from rigid_body_sim.sweeps.sweep import sweep

__all__ = ['BadInput', 'Ensemble', 'Event', 'NotConverged', 'Recording', 'Scene', 'Simulation',
           'State', 'States', 'ensemble', 'load_scene', 'parse_scene', 'scene_names', 'sweep']

# A name is imported when it is first used, so the table of commands shows without NumPy.
_HOMES = {
    'BadInput': 'errors', 'NotConverged': 'errors',
    'Recording': 'recording.reader',
    'Scene': 'scene.scene', 'load_scene': 'scene.scene', 'parse_scene': 'scene.scene',
    'scene_names': 'scene.scene',
    'State': 'scene.state', 'States': 'scene.state',
    'Ensemble': 'simulation.ensemble', 'ensemble': 'simulation.ensemble',
    'Simulation': 'simulation.simulation', 'Event': 'simulation.spans', 'sweep': 'sweeps.sweep',
}


def __getattr__(name):
    if name == '__version__':
        return importlib.import_module(f'{__name__}.recording.about').version()
    if name not in _HOMES:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    value = getattr(importlib.import_module(f'{__name__}.{_HOMES[name]}'), name)
    if name in ('Simulation', 'Recording'):
        # These classes lie in rooms below the one that draws, so they get the method here.
        value.view = _view
    globals()[name] = value
    return value


def _view(self, duration: float = 10.0):
    """Return `duration` seconds of motion as a picture that a notebook plays.

    A simulation is shown from now on and stays where it is; a recording from its start on. See
    `view.notebook.View`: ``.save(path)`` writes a page.
    """
    from rigid_body_sim.view.notebook import view
    return view(self, duration)


def __dir__():
    special = (name for name in globals() if name.startswith('__'))
    return sorted({*special, *__all__, '__version__'})
