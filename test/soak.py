# SPDX-License-Identifier: Apache-2.0
"""What `make test` leaves to `make soak`, which runs all cases."""

import itertools
import os

import pytest

SOAK = bool(os.environ.get('RIGID_BODY_SIM_SOAK'))
IN_SOAK = pytest.mark.skipif(not SOAK, reason='takes long: make soak')
"""Mark of a test, or of a case, that is like others which `make test` runs, and dearer."""


def some_of(*lists):
    """Return the product of lists of values as cases, most of them for the soak.

    `make test` has each value of each list: its k-th case has the k-th of each, and a list that
    ends begins anew.
    """
    few = {tuple(k % len(values) for values in lists) for k in range(max(map(len, lists)))}
    return [pytest.param(*(values[k] for values, k in zip(lists, places, strict=True)),
                         marks=() if places in few else IN_SOAK)
            for places in itertools.product(*(range(len(values)) for values in lists))]
