# SPDX-License-Identifier: Apache-2.0
"""A status line of the node."""

import contextlib
import os
import sys

from rclpy.clock import Clock, ClockType

from rigid_body_sim.realtime.shutdown import tell

DRAWN_EVERY = 0.2
"""Time between two updates of the line on a terminal, s."""
WRITTEN_EVERY = 10.0
"""Time between two lines where nothing can be redrawn, s."""


class StatusLine:
    """Draws one line on a terminal again and again; elsewhere writes one every ten seconds.

    Under ``ros2 launch`` and in a file a line is shown only once it is complete, and it stays.
    There it goes to stdout like the report; on a terminal it goes to stderr.
    """

    def __init__(self, node, engine):
        self._engine, self._name = engine, node.get_name()
        self._drawn = draws(sys.stderr)
        self._width, self._tick_told = 0, None
        show, period = (self._draw, DRAWN_EVERY) if self._drawn else (self._write, WRITTEN_EVERY)
        node.create_timer(period, show, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _text(self):
        engine = self._engine
        balance, diagnostics = engine.session.balance, engine.diagnostics
        recorded = engine.journal.status.recorded if engine.journal.status else 'nothing'
        engine.session.want_balance()
        return (
            f't {balance["time"]:10.3f} s   {diagnostics.rate:8.1f} Hz   '
            f'late p99 {diagnostics.lateness["p99"] * 1e6:5.0f} us   '
            f'energy {balance["energy_residual"]:8.1e}   '
            f'L^2 {balance["momentum_residual"]:8.1e}   recorded {recorded}'
        )

    def _draw(self):
        with contextlib.suppress(OSError, ValueError):    # the terminal may be gone
            # a wider line would wrap, and \r could not return to its start
            line = self._text()[: os.get_terminal_size(sys.stderr.fileno()).columns - 1]
            sys.stderr.write('\r' + line.ljust(self._width))
            sys.stderr.flush()
            self._width = len(line)

    def _write(self):
        tick = self._engine.session.next_tick
        if tick != self._tick_told:    # a paused node has nothing to report
            self._tick_told = tick
            tell(f'{self._name}: {self._text()}')

    def close(self):
        """Keep the last line on the terminal."""
        if self._width:
            with contextlib.suppress(OSError, ValueError):
                sys.stderr.write('\n')
                sys.stderr.flush()


def draws(stream):
    """Return whether a stream is an interactive terminal, on which a line can be redrawn.

    ``ros2 launch`` with ``emulate_tty`` gives its nodes a terminal that has no size, and is not
    the one that controls them.
    """
    try:
        os.tcgetpgrp(stream.fileno())
        return os.get_terminal_size(stream.fileno()).columns > 0
    except (OSError, ValueError, AttributeError):
        return False
