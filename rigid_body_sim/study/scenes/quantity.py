# SPDX-License-Identifier: Apache-2.0
"""A quantity that theory predicts and a motion shows."""

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Quantity:
    """One predicted number (or a few of one kind) and its measurement.

    Attributes
    ----------
    name : str
        Name in the words of the notes; the same for every method.
    predicted, measured : float or array
    tolerance : float
        Bound of |measured - predicted|: relative to the largest |predicted|, or absolute if
        `absolute` is set.
    unit : str
    bound : bool
        The prediction is a bound: the measured value lies at or below it, within the tolerance.
    absolute : bool
        True for predictions that are zero, where nothing passes a relative tolerance.
    as_written : float or array, optional
        Value of the uncorrected formula of the notes.
    detail : str
        Source of the numbers, if it is not one motion.
    """

    name: str
    predicted: object
    measured: object
    tolerance: float
    unit: str = ''
    bound: bool = False
    absolute: bool = False
    as_written: object = None
    detail: str = ''

    def _off(self, value):
        """Return the distance of a value from the measured one, as the tolerance counts it."""
        difference = np.asarray(self.measured, dtype=float) - np.asarray(value, dtype=float)
        off = float(np.max(difference if self.bound else np.abs(difference)))
        scale = 1.0 if self.absolute else float(np.max(np.abs(self.predicted)))
        if self.bound:
            off = max(off, 0.0)
        return off / scale if scale > 0.0 else off and math.inf

    @property
    def error(self):
        """Distance of the measured value from the prediction."""
        return self._off(self.predicted)

    @property
    def passed(self):
        """Whether the error is within the tolerance; a NaN never is."""
        return bool(self.error <= self.tolerance)

    @property
    def error_as_written(self):
        """Distance of the measurement from the uncorrected formula, or None."""
        return None if self.as_written is None else self._off(self.as_written)
