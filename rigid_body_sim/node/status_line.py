# SPDX-License-Identifier: Apache-2.0
"""One line on the terminal that tells how the node is doing, and the report at its end."""

import contextlib
import sys

from rclpy.clock import Clock, ClockType

PERIOD = 0.2


class StatusLine:
    """Rewrites one line on stderr five times a second; does nothing where that is no terminal."""

    def __init__(self, node, engine):
        self._engine = engine
        self._shown = sys.stderr.isatty()
        self._width = 0
        if self._shown:
            node.create_timer(PERIOD, self._show, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _show(self):
        engine = self._engine
        balance, diagnostics = engine.session.balance, engine.diagnostics
        recorded = engine.journal.status.recorded if engine.journal.status else 'nothing'
        line = (
            f't {balance["time"]:10.3f} s   {diagnostics.rate:8.1f} Hz   '
            f'late p99 {diagnostics.lateness["p99"] * 1e6:5.0f} us   '
            f'energy {balance["energy_residual"]:8.1e}   '
            f'L^2 {balance["momentum_residual"]:8.1e}   recorded {recorded}'
        )
        engine.session.want_balance()
        self._write('\r' + line.ljust(self._width))
        self._width = len(line)

    def close(self):
        """Leave the last line as it is."""
        if self._shown and self._width:
            self._write('\n')

    @staticmethod
    def _write(text):
        # the terminal may be gone
        with contextlib.suppress(OSError, ValueError):
            sys.stderr.write(text)
            sys.stderr.flush()
