# SPDX-License-Identifier: Apache-2.0
"""The curves of a report, as plain data for the printed and the interactive figures."""

from dataclasses import dataclass

import numpy as np

from rigid_body_sim.analysis.drift import FLOOR
from rigid_body_sim.analysis.summary import phases

LABELS = {
    'orientation': 'attitude (rad)',
    'angular_velocity': 'ω (rad/s)',
    'position': 'position (m)',
    'energy': 'energy (J)',
    'angular_momentum_squared': 'L² ((kg m²/s)²)',
}
MOST_SPANS = 100
SMALLEST_DIFFERENCE = 1e-18     # what is less, zero included, is drawn as this


@dataclass(frozen=True)
class Line:
    """A named curve; NaN interrupts it."""

    name: str
    x: np.ndarray
    y: np.ndarray


@dataclass(frozen=True)
class Panel:
    """Curves over one another on common axes.

    Attributes
    ----------
    name : str
        A word.
    label : str
        What the y axis shows, with its unit.
    lines : tuple of Line
    log : bool
        Logarithmic y axis.
    limits : tuple of float, optional
        Limits of the y axis.
    steps : bool
        A value holds up to the next x.
    band : float
        A band of plus and minus this is shaded: what round-off explains.
    spans : tuple of (str, float, float)
        Stretches of time with a name, which are shaded.
    """

    name: str
    label: str
    lines: tuple
    log: bool = False
    limits: tuple | None = None
    steps: bool = False
    band: float = 0.0
    spans: tuple = ()


def overview(measured):
    """Return the panels of the short report: omega, residuals, lateness."""
    panels = [
        angular_velocity(measured),
        residual(measured.energy, measured.source, 'energy', 'J'),
        residual(measured.momentum, measured.source, 'L²', '(kg m²/s)²'),
        lateness(measured),
    ]
    return [panel for panel in panels if panel]


def motion(measured):
    """Return the panels of what follows from attitude and omega."""
    follows = measured.motion
    if follows is None:
        return []
    panels = [
        Panel(
            'angular_velocity_world',
            'ω, world axes\n(rad/s)',
            _components(follows.angular_velocity_world, 'xyz', measured.source),
        ),
        *(
            Panel(f'euler_{line.name}', f'{line.name}, z-y-z angle\n(rad)', (_unwound(line),))
            for line in _components(follows.euler, 'αβγ', measured.source)
        ),
    ]
    if follows.momentum and follows.momentum.judged:
        panels.append(
            residual(
                follows.momentum,
                measured.source,
                {'L': 'vector L', 'L_z': 'vertical L'}[follows.conserved.name],
                '',
            )
        )
    if follows.slip:
        spans = tuple(
            (phase['kind'], phase['from'], phase['to'])
            for phase in phases(follows)
            if phase['kind'] == 'slip'
        )
        panels.append(
            Panel(
                'slip',
                'speed of the\ncontact (m/s)',
                (Line('slip', *follows.slip.curve()),),
                spans=spans[:MOST_SPANS],
            )
        )
    return panels


def travel(measured):
    """Return the panels of position and velocity of a body that goes somewhere."""
    follows = measured.motion
    columns = follows.samples.columns() if follows else ()
    if not columns or len(columns[0]) < 3 or not np.ptp(columns[3], axis=0).any():
        return []
    times, position = columns[0], columns[3]
    velocity = np.gradient(position, times, axis=0)
    return [
        Panel(name, label, tuple(Line(axis, times, values[:, k]) for k, axis in enumerate('xyz')))
        for name, label, values in (
            ('position', 'position\n(m)', position),
            ('velocity', 'velocity, from\npositions (m/s)', velocity),
        )
    ]


def energies(balance):
    """Return the panels of a ledger: (times, terms) as from ledger.ledger."""
    times, terms = balance
    joules = tuple(
        Line(name, times, terms[name]) for name in ('kinetic', 'potential', 'dissipated', 'work')
    )
    residuals = tuple(
        Line(name, times, terms[f'{name}_residual']) for name in ('energy', 'momentum')
    )
    return [
        Panel('ledger', 'energy ledger\n(J)', joules),
        Panel('balance', 'residuals of the\nledger (relative)', residuals, band=FLOOR),
    ]


def differences(comparison):
    """Return the panels of a compare.Comparison: how much a rerun differs from the recording."""
    panels = []
    for name, worst in comparison.largest.items():
        if worst['difference'] > 0.0:
            times, sizes = comparison.curve(name)
            line = Line(name, times, np.maximum(sizes, SMALLEST_DIFFERENCE))
            panels.append(
                Panel(f'difference_{name}', f'difference of\n{LABELS[name]}', (line,), log=True)
            )
    return panels


def angular_velocity(measured):
    """Return the panel of omega in body axes, or None."""
    if 'angular_velocity' not in measured.source.topics:
        return None
    return Panel(
        'angular_velocity',
        'ω, body axes\n(rad/s)',
        _components(measured.angular_velocity, 'xyz', measured.source),
    )


def residual(found, source, name, unit):
    """Return the panel of a Residual, else of the quantity itself, or None if there is nothing.

    The residual is shown where the quantity is kept.
    """
    times, values = found.curve()
    if len(times):
        return Panel(
            f'residual_{name}',
            f'residual of {name}\n(relative)',
            (_broken(Line(name, times, values), found.not_kept_from, source),),
            band=FLOOR,
        )
    times, values = found.values.curve()
    return Panel(name, f'{name}\n({unit})', (Line(name, times, values),)) if len(times) else None


def lateness(measured):
    """Return the panel of how late ticks were in each second, or None."""
    late = measured.punctuality.curve()
    if not len(late):
        return None
    edges = (np.append(late[:, 0], late[-1, 1]) - measured.source.start) * 1e-9
    # below a microsecond there is only noise of the clock
    columns = [
        (name, np.maximum(np.append(late[:, k], late[-1, k]) * 1e-3, 1.0))
        for name, k in (('p50', 2), ('p99', 3), ('max', 4))
    ]
    return Panel(
        'lateness',
        'lateness of ticks,\nby seconds (µs)',
        tuple(Line(name, edges, values) for name, values in columns),
        log=True,
        limits=(1.0, max(1e3, 2.0 * float(columns[2][1].max()))),
        steps=True,
    )


def _components(curve, names, source):
    gaps = [mark.stamp for mark in source.history.marks if mark.kind == 'gap']
    return tuple(
        _broken(Line(name, *curve.curve(k)), gaps, source) for k, name in enumerate(names)
    )


def _broken(line, stamps, source):
    """Return a line that is interrupted after some stamps (ns)."""
    places = np.searchsorted(
        line.x, (np.array(stamps, dtype=float) - source.start) * 1e-9, side='right'
    )
    return Line(line.name, np.insert(line.x, places, np.nan), np.insert(line.y, places, np.nan))


def _unwound(line):
    """Return a line of angles that is interrupted where it jumps from pi to -pi."""
    with np.errstate(invalid='ignore'):
        places = np.flatnonzero(np.abs(np.diff(line.y)) > np.pi) + 1
    return Line(line.name, np.insert(line.x, places, np.nan), np.insert(line.y, places, np.nan))
