# SPDX-License-Identifier: Apache-2.0
"""Times at which a run is compared with the truth."""

import numpy as np

EARLIER = 0.5    # largest part of the time between two looks by which one is earlier than evenly


def looks(duration, many):
    """Return rising times (s) up to a duration, so uneven that no motion repeats with them.

    They are not those of a trial of `auto`, which are uneven in another way.
    """
    k = np.arange(1, many + 1)
    return duration * (k - EARLIER * ((many - k) * np.sqrt(2.0) % 1.0)) / many
