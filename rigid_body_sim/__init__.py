"""Rigid-body motion, solved exactly where mathematics allows, on ROS 2."""

import importlib

_OFFERED = {'Simulation': 'simulation.simulation', 'load_scene': 'scene.scene', 'parse_scene': 'scene.scene', 'scene_names': 'scene.scene',
            'State': 'scene.state', 'States': 'scene.state', 'ensemble': 'simulation.ensemble', 'BadInput': 'errors', 'NotConverged': 'errors'}
__all__ = sorted(_OFFERED)    # loaded when first asked for, so that the table of commands imports nothing


def __getattr__(name):
    if name not in _OFFERED:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    return getattr(importlib.import_module(f'{__name__}.{_OFFERED[name]}'), name)
