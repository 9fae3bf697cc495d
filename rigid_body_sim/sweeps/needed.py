# SPDX-License-Identifier: Apache-2.0
"""The packages that sweeps need and that neither ROS nor the rest of the package has."""

import importlib.util

from rigid_body_sim.errors import BadInput


def need(*packages):
    """Raise BadInput where one of these packages is not installed."""
    for name in packages:
        if importlib.util.find_spec(name) is None:
            raise BadInput('sweep', f'the Python package {name} is not installed',
                           'pip install ".[sweep]" in the source tree (docs/install.md)')
