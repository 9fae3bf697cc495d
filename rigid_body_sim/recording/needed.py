# SPDX-License-Identifier: Apache-2.0
"""The packages that recordings need and that ROS and Ubuntu do not have."""

import importlib.util

from rigid_body_sim.errors import BadInput

PACKAGES = ('mcap', 'zstandard', 'lz4')     # the last two come with the first


def need_mcap():
    """Raise BadInput where recordings cannot be read and written: modules below mcap/ need these.

    They are imported after this call, so that everything else runs without them.
    """
    missing = [name for name in PACKAGES if importlib.util.find_spec(name) is None]
    if missing:
        raise BadInput('recordings', f'the Python package {missing[0]} is not installed',
                       '"pip install mcap" (docs/install.md), or record:=false for the node')
