# SPDX-License-Identifier: Apache-2.0
"""Classes of messages by the names of their types."""

import importlib

from rigid_body_sim.errors import BadInput


def import_type(output):
    """Return the message class of an Output; BadInput where its package is not installed."""
    package, _, message = output.type.split('/')
    try:
        return getattr(importlib.import_module(f'{package}.msg'), message)
    except ImportError:
        raise BadInput(
            'parameter publish',
            f'got {output.name}, but {package} is not installed here',
            f'install {package}, or leave {output.name} out',
        ) from None
