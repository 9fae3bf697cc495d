# SPDX-License-Identifier: Apache-2.0
"""Spectra of omega over the first ticks, and the lines that theory predicts in them."""

import numpy as np
from scipy.spatial.transform import Rotation

from rigid_body_sim.analysis.lines import predicted_lines

FEWEST = 64
PADDING = 4         # zero padding, as a multiple of the length, for a finer curve
SMALLEST = 1e-9     # smallest amplitude that is shown, relative to the largest
SEARCH = 1.5
"""Distance from its prediction within which a line is looked for, in units of 1/length."""
RISES = 30.0
"""Power of a line over that around it; side lobes of stronger lines have a few times that."""


class Spectrum:
    """Amplitudes of omega in body and world axes.

    Parameters
    ----------
    measured : measure.Measured
        Its first ticks up to the first change from outside are taken (at least a tenth of them, or
        else all).

    Attributes
    ----------
    seconds : float
        How long the stretch is; 0 where there is too little.
    frequencies : array (n,)
        Hz.
    amplitudes : dict
        ``body``, ``world`` -> (n, 3), rad/s: a sine of amplitude A shows as A.
    lines : list of (SpectralLine, measured frequency in Hz or None)
    """

    def __init__(self, measured):
        times, orientation, omega, _ = measured.motion.head.columns()
        stop = _undisturbed(measured.source, times)
        times, orientation, omega = times[:stop], orientation[:stop], omega[:stop]
        self.seconds, self.frequencies, self.amplitudes, self.lines = 0.0, np.empty(0), {}, []
        if len(times) < FEWEST:
            return
        step = (times[-1] - times[0]) / (len(times) - 1)
        self.seconds = float(step * len(times))
        size = PADDING * len(times)
        self.frequencies = np.fft.rfftfreq(size, step)
        window = np.hanning(len(times))
        for axes, values in (
            ('body', omega),
            ('world', Rotation.from_quat(orientation).apply(omega)),
        ):
            weighted = (values - values.mean(axis=0)) * window[:, None]
            self.amplitudes[axes] = (
                2.0 * np.abs(np.fft.rfft(weighted, size, axis=0)) / window.sum()
            )
        self.lines = [
            (line, self._measured(line))
            for line in predicted_lines(measured.source.scene)
            if line.frequency < self.frequencies[-1]
        ]

    def seen(self, axes):
        """Return the amplitudes without the mean, for logarithmic axes.

        None is smaller than SMALLEST of the largest.
        """
        amplitudes = self.amplitudes[axes][1:]
        return np.maximum(
            amplitudes, SMALLEST * max(float(amplitudes.max()), np.finfo(float).tiny / SMALLEST)
        )

    @property
    def top(self):
        """The highest frequency (Hz) that is worth showing.

        Up to it lie the predicted lines and all amplitudes above a thousandth of the largest.
        """
        size = sum(amplitudes.max(axis=1) for amplitudes in self.amplitudes.values())[PADDING:]
        above = np.flatnonzero(size > 1e-3 * size.max()) if len(size) else ()
        highest = self.frequencies[above[-1] + PADDING] if len(above) else 0.0
        predicted = max((line.frequency for line, _ in self.lines), default=0.0)
        return min(1.5 * max(highest, 2.0 * predicted) + 10.0 / self.seconds, self.frequencies[-1])

    def _measured(self, line):
        """Return the frequency of the peak at a line, or None where no line stands out.

        The peak is that of a parabola through the logarithms.
        """
        f, resolution = self.frequencies, 1.0 / self.seconds
        power = (self.amplitudes[line.axes][:, line.components] ** 2).sum(axis=1)
        away = np.abs(f - line.frequency) / resolution
        near = np.flatnonzero(away <= SEARCH)
        near = near[(near > 1) & (near < len(f) - 1)]
        if not len(near) or line.frequency < 3.0 * resolution:
            return None
        peak = near[power[near].argmax()]
        left, top, right = power[peak - 1:peak + 2]
        around = np.median(power[(away > 3.0) & (away < 12.0)])
        if not (
            top > RISES * around
            and top > SMALLEST**2 * power.max()
            and top >= left
            and top >= right
        ):
            return None
        left, top, right = np.log(np.maximum((left, top, right), np.finfo(float).tiny))
        curvature = left - 2.0 * top + right
        return float(
            f[peak] + (0.5 * (left - right) / curvature if curvature < 0.0 else 0.0) * f[1]
        )


def _undisturbed(source, times):
    """Return the number of ticks before the first change from outside and the first hole."""
    stop = len(times)
    if len(source.history.segments) > 1:
        stop = int(
            np.searchsorted(times, (source.history.segments[1].stamp - source.start) * 1e-9)
        )
    stop = stop if stop > 0.1 * len(times) else len(times)
    steps = np.diff(times[:stop])
    holes = np.flatnonzero(steps > 1.5 * np.median(steps)) if len(steps) else ()
    return int(holes[0]) + 1 if len(holes) else stop
