# SPDX-License-Identifier: Apache-2.0
"""What `make test` leaves to `make soak`, which runs all cases."""

import os

import pytest

SOAK = bool(os.environ.get('RIGID_BODY_SIM_SOAK'))
IN_SOAK = pytest.mark.skipif(not SOAK, reason='takes long: make soak')
"""Mark of a test, or of a case, that is like others which `make test` runs, and dearer."""
