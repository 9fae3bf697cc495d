# SPDX-License-Identifier: Apache-2.0
"""The subcommand `resimulate`: run a recording's scene and commands again, compare bit for bit.

With another method or accuracy it shows what that would have changed in this run.
"""

import json
import pathlib
import sys

import numpy as np
from tqdm import tqdm

from rigid_body_sim import command_line
from rigid_body_sim.analysis.align import aligned
from rigid_body_sim.analysis.analyze import report_folder
from rigid_body_sim.analysis.compare import QUANTITIES, Comparison, within
from rigid_body_sim.analysis.replayed import HAVE_STAMPS, Restamped
from rigid_body_sim.analysis.rerun import Rerun
from rigid_body_sim.analysis.source import journal_of, sources
from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import about
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.simulation import arithmetic

EPS = float(np.finfo(float).eps)


def resimulate(path, method=None, left_out=lambda source: None):
    """Run a recording again; return a list of (Source, Rerun, Comparison), one per body.

    Topics that were remapped into another namespace look like a body without a journal. It is left
    out where another body has one.

    Parameters
    ----------
    path : path-like
    method : dict, optional
        ``integrator``, ``accuracy``: run it by these instead.
    left_out : callable
        Called with the Source of each body that is left out.

    Raises
    ------
    BadInput
        Where there is no recording that can be run again.
    """
    results = []
    with Recording(path) as recording:
        found = sources(recording)
        for source in found:
            if not source.entries and any(other.entries for other in found):
                left_out(source)
                continue
            messages = recording
            with journal_of(recording.path):
                rerun = Rerun(source.entries, method or {}, source.stamps and source.stamps[0])
            topics = {name: source.topics[name] for name in QUANTITIES if name in source.topics}
            if source.stamps:
                paced_by = next(topics[name] for name in HAVE_STAMPS if name in topics)
                messages = Restamped(recording, paced_by)
                topics = {name: topic for name, topic in topics.items() if messages.can(topic)}
            comparison = Comparison(rerun, topics, source)
            total = sum(recording.topics[topic].count for topic in topics.values())
            with tqdm(
                total=total, unit=' messages', unit_scale=True, disable=None, leave=False
            ) as progress:
                for stretch in aligned(messages, list(topics.values()), progress.update):
                    with journal_of(recording.path):
                        comparison.take(stretch)
            results.append((source, rerun, comparison))
    return results


def tolerance(rerun, comparison):
    """Return the difference of attitude (rad) to be expected where bits are not promised.

    It is the accuracy asked, and round-off over all turns.
    """
    exact = rerun.recorded['method'] == 'exact'
    return (
        (0.0 if exact else 10.0 * rerun.recorded['accuracy'])
        + 1e-12
        + 64.0 * EPS * comparison.turned
    )


def broken_promises(rerun):
    """Return the reasons why the bits may differ; an empty list means that the bits are promised.

    A recording promises its bits to every program of the same version of the arithmetic, on any
    machine. SciPy's methods promise theirs on the same machine only, with the same versions.
    """
    recorded, here = rerun.begin.get('arithmetic', 'none'), arithmetic.version()
    if recorded != here:
        return [f'it was made by arithmetic {recorded}, this is {here}']
    methods = {rerun.recorded['method'], rerun.simulation.choice.method}
    before, now = json.loads(rerun.begin['machine']), about.machine()
    differ = [name for name in sorted({*before, *now}) if before.get(name) != now.get(name)]
    return [
        f'{method} is compiled for each machine; these differ: {", ".join(differ)}'
        for method in sorted(methods & set(arithmetic.EXCEPTED))
        if differ
    ]


def verdict(source, rerun, comparison, changed, allowed):
    """Return the outcome as plain data.

    `good` says whether the run was reproduced: to the bit where that is promised, within `allowed`
    (rad) where it is not (see compare.within); always, where the method was `changed` on purpose.
    """
    unpromised = broken_promises(rerun)
    limit = tolerance(rerun, comparison) if allowed is None else allowed
    identical = comparison.parting is None
    return {
        'namespace': source.namespace,
        'identical': identical,
        'messages': comparison.messages,
        'not_compared': [name for name in QUANTITIES if name not in comparison.topics],
        'states': comparison.ticks,
        'parting': comparison.parting,
        'largest': comparison.largest,
        'unpromised': unpromised,
        'tolerance': limit,
        'good': bool(changed or identical or (unpromised and within(comparison.largest, limit))),
        'recorded': rerun.recorded,
        'resimulated': about.run_of(rerun.simulation),
    }


def lines(found, changed):
    """Return the outcome as lines for people."""
    text = []
    where = f'{found["namespace"]}: ' if found['namespace'] != '/' else ''
    if found['identical']:
        compared = len(QUANTITIES) - len(found['not_compared'])
        what = f' in {compared} of {len(QUANTITIES)} topics' if found['not_compared'] else ''
        text.append(f'{where}identical{what}, {found["states"]} states '
                    f'({found["messages"]} messages)')
    else:
        parting = found['parting']
        text.append(
            f'{where}{"as expected, " if changed else ""}differs from tick {parting["tick"]} on '
            f'(t = {parting["time"]!r} s), '
            f'{parting["quantity"].replace("_", " ")}:'
        )
        text += [
            f'  {name:12}{", ".join(map(repr, parting[name]))}'
            for name in ('recorded', 'resimulated')
        ]
        text += [
            f'  largest difference of {name.replace("_", " ")}: {worst["difference"]:.3e}, '
            f'{worst["since_start"]:.9g} s after the start'
            for name, worst in found['largest'].items()
        ]
    if found['not_compared']:
        text.append(f'  not compared: {", ".join(found["not_compared"])} (not recorded under this '
                    f'name, or played again without all of its messages)')
    if found['unpromised'] and not (found['identical'] or changed):
        text.append(f'  bits are not promised: {found["unpromised"][0]}')
        text.append(
            f'  allowed are {found["tolerance"]:.1e} rad: the differences are '
            f'{"less" if found["good"] else "more than that explains"}'
        )
    return text


def main(arguments=None):
    """Run the subcommand; return the exit status."""
    parser = command_line.parser(
        'resimulate',
        "Run a recording's scene and commands again and compare every state, bit for bit.",
        'python -m rigid_body_sim resimulate recordings/racket\n'
        '  python -m rigid_body_sim resimulate recordings/racket --integrator dop8 '
        '--accuracy 1e-6',
    )
    parser.add_argument('recording', help='folder of a recording, or .mcap file')
    parser.add_argument(
        '--integrator', help='another method: what would it have changed in this run'
    )
    parser.add_argument('--accuracy', type=float, help='another accuracy (rad)')
    parser.add_argument(
        '--tolerance',
        type=float,
        help='allowed difference of attitudes (rad) where bits are not promised; default: what '
        'accuracy and round-off explain',
    )
    parser.add_argument(
        '--output',
        metavar='FOLDER',
        help='where the differences go as a figure and CSV, if there are any '
        '(default: the folder of the report, beside the recording)',
    )
    parser.add_argument('--json', action='store_true', help='machine-readable')
    return command_line.run(_run, parser.parse_args(arguments))


def _run(options):
    method = {
        name: value
        for name in ('integrator', 'accuracy')
        if (value := getattr(options, name)) is not None
    }
    folder = pathlib.Path(options.output) if options.output else report_folder(options.recording)
    outcomes, files, left_out = [], [], []
    for source, rerun, comparison in resimulate(options.recording, method, left_out.append):
        outcomes.append(verdict(source, rerun, comparison, bool(method), options.tolerance))
        if comparison.parting:
            files += _write(folder, source, comparison, outcomes[-1])
    if options.json:
        command_line.print_json({'bodies': outcomes, 'files': [str(path) for path in files],
                                 'left_out': [source.namespace for source in left_out]})
    else:
        print(
            '\n'.join(
                [line for found in outcomes for line in lines(found, bool(method))]
                + [f'{source.namespace}: not run again: it has no journal' for source in left_out]
                + [f'  {path}' for path in files]
            )
        )
    return (
        command_line.GOOD
        if all(found['good'] for found in outcomes)
        else command_line.CHECK_FAILED
    )


def _write(folder, source, comparison, found):
    """Write the curves of the differences; return the paths."""
    # matplotlib takes a second to import
    from rigid_body_sim.analysis import panels, plots
    recorded, now = (
        f'{one["method"]} ({one["accuracy"]:g})'
        for one in (found['recorded'], found['resimulated'])
    )
    figure = plots.stack(
        panels.differences(comparison), f'Recorded by {recorded}, run again by {now}', source
    )
    path = folder / '_'.join(filter(None, ('difference', *source.namespace.split('/'))))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        figure.savefig(path.with_suffix('.png'))
        with open(path.with_suffix('.csv'), 'w', encoding='utf-8') as stream:
            stream.write('quantity,seconds_since_start,difference\n')
            for quantity in comparison.largest:
                times, sizes = comparison.curve(quantity)
                stream.writelines(
                    f'{quantity},{time!r},{size!r}\n'
                    for time, size in zip(times.tolist(), sizes.tolist(), strict=True)
                )
    except OSError as error:
        raise BadInput(
            str(folder), f'cannot be written ({error.strerror})', 'another folder: --output FOLDER'
        ) from error
    return [path.with_suffix('.png'), path.with_suffix('.csv')]


if __name__ == '__main__':
    sys.exit(main())
