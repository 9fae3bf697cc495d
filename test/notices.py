# SPDX-License-Identifier: Apache-2.0
"""Notices of commands about the machine: numba is missing, kernels are compiled."""

BEGINNINGS = 'numba is not', 'compiling '


def without_notices(error):
    """Return the text of a standard error without such lines, the same warm and cold."""
    return ''.join(line for line in error.splitlines(keepends=True)
                   if not line.startswith(BEGINNINGS))
