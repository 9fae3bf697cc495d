# SPDX-License-Identifier: Apache-2.0
"""The subcommand `analyze`: recordings to reports; each is read once, however long it is."""

import json
import pathlib
import sys

from tqdm import tqdm

from rigid_body_sim import command_line
from rigid_body_sim.analysis.measure import measure
from rigid_body_sim.analysis.source import sources
from rigid_body_sim.analysis.summary import lines, summary, title
from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording.folders import newest_recording
from rigid_body_sim.recording.reader import Recording


def analyze(path, folder, short=False, shared_page=None):
    """Analyse a recording.

    Return (list of summaries, one per body; paths of what was written, the text first).

    Parameters
    ----------
    path : path-like
        A recording's folder or an .mcap file.
    folder : path-like
        Where the report goes; it is created if it does not exist, and its files are replaced.
    short : bool
        Only numbers and the overview figure.
    shared_page : list, optional
        Receives what page.write_page needs; no page is written then.

    Raises
    ------
    BadInput
        Where there is no recording of a simulation, or the folder cannot be written.
    """
    # the progress bar stays visible from the first moment to the last
    with tqdm(
        desc=f'{path}: opening', unit=' messages', unit_scale=True, disable=None, leave=False
    ) as bar:
        return _analyze(path, pathlib.Path(folder), short, shared_page, bar)


def _analyze(path, folder, short, shared_page, bar):
    with Recording(path) as recording:
        bodies = sources(recording)
        bar.set_description(f'{path}: reading')
        bar.reset(recording.message_count)
        measured = measure(recording, bodies, bar.update)
    bar.set_description(f'{path}: spectrum, ledger, figures')
    more = [(None, None) if short else (_spectrum(one), _ledger(one.source)) for one in measured]
    found = [summary(one, *extra) for one, extra in zip(measured, more, strict=True)]
    written = [folder / 'report.txt', folder / 'report.json']
    try:
        folder.mkdir(parents=True, exist_ok=True)
        written[0].write_text(
            '\n'.join(line for one in found for line in lines(one)) + '\n', encoding='utf-8'
        )
        written[1].write_text(
            json.dumps({'recording': str(path), 'bodies': found}, indent=2, allow_nan=False)
            + '\n',
            encoding='utf-8',
        )
        written += _figures(folder, measured, found, more, short)
        name = pathlib.Path(path).resolve().name
        sections = [
            (name, one, numbers, *extra)
            for one, numbers, extra in zip(measured, found, more, strict=True)
        ]
        if shared_page is not None:
            shared_page += sections
        elif not short:
            written += write_page(folder, sections)
    except OSError as error:
        raise BadInput(str(folder), f'the report cannot be written ({error.strerror})',
                       'another folder: --output FOLDER') from error
    return found, written


def _spectrum(measured):
    from rigid_body_sim.analysis.spectrum import Spectrum
    return Spectrum(measured) if measured.motion else None


def _ledger(source):
    """Return the ledger of a Source, or None.

    A recording by another program has no journal of commands, so its energy cannot be balanced.
    """
    from rigid_body_sim.analysis.ledger import ledger
    return ledger(source) if source.run else None


def _figures(folder, measured, found, more, short):
    """Write figures and page; return their paths."""
    # matplotlib takes a second to import
    from rigid_body_sim.analysis import figures
    if short:
        return [
            figures.draw_overview(folder, one, title(numbers))
            for one, numbers in zip(measured, found, strict=True)
        ]
    written = []
    for one, numbers, extra in zip(measured, found, more, strict=True):
        written += figures.draw_all(folder, one, *extra, title(numbers))
    return written


def write_page(folder, sections):
    """Write report.html if Plotly is there; return its path in a list."""
    from rigid_body_sim.analysis import page
    if not page.available():
        return []
    page.write_page(folder / 'report.html', sections)
    return [folder / 'report.html']


def report_folder(path):
    """Return where the report of a recording goes by default: beside it."""
    path = pathlib.Path(path)
    path = path.resolve() if path.name in ('', '..') else path
    return path.with_name(f'{path.stem if path.is_file() else path.name}_report')


def show(found, written):
    """Print the report's text and the paths."""
    for one in found:
        print('\n'.join(lines(one)))
    for path in written:
        print(f'  {path}')


def main(arguments=None):
    """Run the subcommand; return the exit status."""
    parser = command_line.parser(
        'analyze',
        'Recordings to reports: drift, flips, lateness, drops, figures.',
        'python -m rigid_body_sim analyze recordings/racket',
    )
    parser.add_argument(
        'recording',
        nargs='+',
        help='folder of a recording, or .mcap file; also of `ros2 bag record`; '
        'a folder of recordings: the newest in it',
    )
    parser.add_argument(
        '--output',
        metavar='FOLDER',
        help='where the reports go (default: beside each recording); '
        'of several recordings it gets one page on all, and a folder each',
    )
    parser.add_argument('--json', action='store_true', help='print what report.json holds')
    return command_line.run(_run, parser.parse_args(arguments), kernels='the report')


def _run(options):
    results, shared = [], [] if options.output and len(options.recording) > 1 else None
    for given in options.recording:
        path, others = newest_recording(given)
        if others:
            print(f'{path}: the newest of {others + 1} recordings', file=sys.stderr)
        folder = report_folder(path)
        if options.output:
            folder = pathlib.Path(options.output) / (folder.name if shared is not None else '')
        found, written = analyze(path, folder, shared_page=shared)
        results.append(
            {'recording': str(path), 'bodies': found, 'files': [str(name) for name in written]}
        )
        if not options.json:
            show(found, written)
    if shared is not None:
        _write_shared(pathlib.Path(options.output), shared, results, options.json)
    from rigid_body_sim.analysis import page
    if not page.available():
        print('report.html was not made: it needs plotly (pip install plotly)', file=sys.stderr)
    if options.json:
        command_line.print_json(results)
    return command_line.GOOD


def _write_shared(folder, shared, results, quiet):
    """Write the page on all recordings and all numbers."""
    try:
        (folder / 'report.json').write_text(
            json.dumps(results, indent=2, allow_nan=False) + '\n', encoding='utf-8'
        )
        written = [folder / 'report.json', *write_page(folder, shared)]
    except OSError as error:
        raise BadInput(
            str(folder),
            f'the report cannot be written ({error.strerror})',
            'another folder: --output FOLDER',
        ) from error
    if not quiet:
        show([], written)


if __name__ == '__main__':
    sys.exit(main())
