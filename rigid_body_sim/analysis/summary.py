# SPDX-License-Identifier: Apache-2.0
"""The results of an analysis, as data (report.json) and as a short report."""

import collections

from rigid_body_sim.analysis.drift import FLOOR

TOLD = 6     # phases named in the short report


def summary(measured, spectrum=None, balance=None):
    """Return all numbers as plain data.

    More than forty lines: one entry for each number of the report.

    Parameters
    ----------
    measured : Measured
    spectrum : Spectrum, optional
    balance : tuple, optional
        What ledger.ledger returned.
    """
    source, motion = measured.source, measured.motion
    segment = source.history.segments[0]
    marks = collections.Counter(mark.kind for mark in source.history.marks)
    events = collections.Counter(
        mark.name for mark in source.history.marks if mark.kind == 'event'
    )
    return {
        'namespace': source.namespace,
        'scene': source.scene.name if source.scene else None,
        'made_by': source.made_by,
        'version': source.version,
        'run': source.run,
        'accuracy_missed': source.accuracy_missed,
        'rate': segment.rate,
        'energy': measured.energy.summary(),
        'angular_momentum_squared': measured.momentum.summary(),
        'round_off_floor': FLOOR,
        'flips': measured.flips.count if measured.flips else None,
        'events': dict(events),
        'strikes': marks['strike'],
        'commands': marks['commands'],
        'resets': marks['reset'],
        'parameter_changes': marks['parameters'],
        'timing': measured.punctuality.summary(),
        'left_out_by_recorder': sum(
            mark.values['ticks'] for mark in source.history.marks if mark.kind == 'gap'
        ),
        'momentum': (
            {'of': motion.conserved.name, **motion.momentum.summary()}
            if motion and motion.momentum
            else None
        ),
        'phases': phases(motion) if motion and motion.slip else None,
        'lines': [
            {
                'name': line.name,
                'axes': line.axes,
                'source': line.source,
                'predicted': line.frequency,
                'measured': found,
            }
            for line, found in (spectrum.lines if spectrum else ())
        ],
        'ledger': (
            {name: float(values[-1]) for name, values in balance[1].items()} if balance else None
        ),
    }


def phases(motion):
    """Return the phases of a sphere on the table as data: ``kind``, ``from``, ``to`` (s)."""
    ends = [begin for _, begin in motion.phases[1:]] + [motion.until]
    return [
        {'kind': kind, 'from': begin, 'to': end}
        for (kind, begin), end in zip(motion.phases, ends, strict=True)
    ]


def title(found):
    """Return one line that names what was recorded."""
    run = found['run']
    how = f'{run["method"]}, {found["rate"]:g} Hz' if run else f'{found["rate"]:.6g} Hz'
    who = f', by {found["made_by"]} {found["version"]}'.rstrip() if found['made_by'] else ''
    where = f' in {found["namespace"]}' if found['namespace'] != '/' else ''
    return f'{found["scene"] or "unknown scene"}{where}: {how}{who}'


def lines(found):
    """Return the short report, a list of lines."""
    timing = found['timing']
    text = [f'{title(found)}; {timing["ticks"]} ticks']
    text += [f'  accuracy {line}' for line in found['accuracy_missed']]
    for name, label, unit in (
        ('energy', 'energy', 'J'),
        ('angular_momentum_squared', 'L^2', '(kg m^2/s)^2'),
    ):
        text.append(f'  {label:9}{_quantity(found[name], unit)}')
    if found['momentum'] and found['momentum']['largest_residual'] is not None:
        parts = found['momentum']['stretches']
        within = f'within each of {parts} stretches ' if parts > 1 else ''
        text.append(f'  {found["momentum"]["of"]:9}{within}{_residual(found["momentum"])}')
    if found['flips'] is not None:
        text.append(f'  flips    {found["flips"]}')
    if found['phases']:
        told = [
            f'{phase["kind"]} {phase["from"]:.6g} to {phase["to"]:.6g} s'
            for phase in found['phases'][:TOLD]
        ]
        more = len(found['phases']) - TOLD
        text.append(f'  phases   {", ".join(told)}{f" and {more} more" if more > 0 else ""}')
    text += [
        f'  {line["name"]}: {_line(line)}'
        for line in found['lines']
        if line['measured'] is not None
    ]
    others = _others(found)
    if others:
        text.append(f'  events   {", ".join(others)}')
    if timing['lateness']:
        text.append(_late(timing))
    text.append(f'  drops    {_drops(found)}')
    return text


def _others(found):
    """Return the counts of all events but flips, as words."""
    others = [f'{count} x {name}' for name, count in found['events'].items() if name != 'flip']
    others += [f'{found["strikes"]} x strike'] if found['strikes'] else []
    return others + [
        counted(found[kind], *names)
        for kind, *names in (
            ('commands', 'tick', ' with commands'),
            ('parameter_changes', 'change', ' of parameters'),
        )
        if found[kind]
    ]


def counted(number, noun, rest=''):
    """Return a number with its noun, in the plural but for one."""
    return f'{number} {noun}{"" if number == 1 else "s"}{rest}'


def _late(timing):
    """Return the line that says how late messages were published."""
    late = {name: value * 1e6 for name, value in timing['lateness'].items()}
    rate = f'; {timing["achieved_rate"]:.3f} Hz achieved' if timing['achieved_rate'] else ''
    stood = f'; stood still {timing["standstills"]} times' if timing['standstills'] else ''
    return (f'  messages were published late by p50 {late["p50"]:.0f}, p99 {late["p99"]:.0f}, '
            f'max {late["max"]:.0f} us{rate}{stood}')


def _quantity(values, unit):
    if values['first'] is None:
        return 'not recorded'
    if values['largest_residual'] is None:
        return f'{values["first"]:.9g} to {values["last"]:.9g} {unit} (not constant in this scene)'
    levels, kept = values['levels'], _residual(values)
    if values['stretches'] == 1 and (levels[0]['from'], levels[0]['until']) == (0.0, None):
        return f'{values["first"]:.9g} {unit}; {kept}'
    told = [f'{level["value"]:.9g} {unit} from {level["from"]:.6g} {_end(level, following)}'
            + (f' ({level["begun_by"]})' if level['begun_by'] else '')
            for level, following in zip(levels[:TOLD], [*levels[1:], None], strict=False)]
    more = values['stretches'] - TOLD
    told += [f'and in {more} more stretches'] if more > 0 else []
    return f'{", ".join(told)}; within each {kept}'


def _end(level, following):
    """Return when a level ends, in words; a wrench that is held may follow it."""
    begins = following and following['from']
    return 's on' if level['until'] in (None, begins) else f'to {level["until"]:.6g} s'


def _residual(values):
    floor = ', round-off' if values['largest_residual'] <= FLOOR else ''
    return (f'drift {values["last_residual"]:+.1e}, '
            f'largest residual {values["largest_residual"]:.1e} (relative{floor})')


def _line(line):
    error = line['measured'] / line['predicted'] - 1.0
    return (f'{line["measured"]:.6g} Hz measured, {line["predicted"]:.6g} Hz predicted '
            f'({error:+.1e} relative; {line["source"]})')


def _drops(found):
    missing, left_out = found['timing']['missing'], found['left_out_by_recorder']
    if not missing and not left_out:
        return 'none'
    return f'{missing} ticks are missing, {left_out} of them left out by the recorder'
