# SPDX-License-Identifier: Apache-2.0
"""Names of the compressions of a recording's chunks."""

from rigid_body_sim.errors import BadInput

NAMES = ('zstd', 'lz4', 'none')
DEFAULT = 'zstd'


def in_format(name):
    """Return a compression's name as the MCAP format has it; BadInput for an unknown one."""
    if name not in NAMES:
        raise BadInput('compression', repr(name), f'one of {", ".join(NAMES)}')
    return '' if name == 'none' else name
