"""A quantity that theory predicts and a motion shows."""

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Quantity:
    """One predicted number (or a few of one kind) beside the measured one.

    Attributes
    ----------
    name : str
        In the words of the notes; the same for every method.
    predicted, measured : float or array
    tolerance : float
        Of |measured - predicted|: relative to the largest |predicted|, or as it stands where `absolute`.
    unit : str
    bound : bool
        The prediction is a bound: the measured value lies at or below it, within the tolerance.
    absolute : bool
        For predictions that are zero: relative to it nothing passes.
    as_written : float or array, optional
        What the uncorrected formula of the notes gives.
    detail : str
        What the numbers were got from, where it is not one motion.
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
        """Return by how much a value misses the measured one, in the measure of the tolerance."""
        difference = np.asarray(self.measured, dtype=float) - np.asarray(value, dtype=float)
        off = float(np.max(difference if self.bound else np.abs(difference)))
        scale = 1.0 if self.absolute else float(np.max(np.abs(self.predicted)))
        if self.bound:
            off = max(off, 0.0)
        return off / scale if scale > 0.0 else off and math.inf

    @property
    def error(self):
        """By how much the measured value misses the prediction."""
        return self._off(self.predicted)

    @property
    def passed(self):
        """Whether the error is within the tolerance; never for what is not a number."""
        return bool(self.error <= self.tolerance)

    @property
    def error_as_written(self):
        """By how much the measured value misses the uncorrected formula; None where the notes are right."""
        return None if self.as_written is None else self._off(self.as_written)
