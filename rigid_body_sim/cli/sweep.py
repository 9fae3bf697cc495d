# SPDX-License-Identifier: Apache-2.0
"""The subcommand `sweep`: a scene over grids or samples of its keys, to a store that resumes."""

import contextlib
import logging
import sys
import time

from rigid_body_sim import command_line
from rigid_body_sim.errors import BadInput
from rigid_body_sim.sweeps.engine import Stopped
from rigid_body_sim.sweeps.needed import need
from rigid_body_sim.sweeps.plan import DONE
from rigid_body_sim.sweeps.sweep import forecast, sweep

CONNECTING = 10.0    # longest wait for a scheduler, s
SHOWN = 3            # number of error texts of failed runs to print
PART = 2**22         # runs whose status is read at once


def main(arguments=None):
    """Run the subcommand; return the exit status."""
    parser = command_line.parser(
        'sweep', 'Run a scene over grids or samples of its keys, to a Zarr or Parquet store. '
        'Repeat the line to resume a sweep that was cut short.',
        'python -m rigid_body_sim sweep config/sweeps/racket_periods.yaml --output maps.zarr')
    add = parser.add_argument
    add('spec', metavar='SPEC.yaml', help='what to run: scene, vary, sample, times, keep')
    add('--output', metavar='STORE',
        help='folder to make or to go on with: NAME.zarr, or NAME.parquet for one row per run')
    add('--dask', metavar='ADDRESS', help='scheduler of a Dask cluster, tcp://host:8786')
    add('--dry-run', action='store_true',
        help='say how many runs, how long and how large, and run nothing')
    add('--json', action='store_true', help='print the outcome as JSON')
    return command_line.run(_run, parser.parse_args(arguments))


def _run(options):
    need('xarray')
    if not options.output and not options.dry_run:
        raise BadInput('--output', 'is missing', 'NAME.zarr, or NAME.parquet for one row per run')
    with command_line.ending_like_ctrl_c(), _client(options.dask) as client:
        if options.dry_run:
            return _tell_forecast(forecast(options.spec, client), options)
        begin = time.perf_counter()
        try:
            found = sweep(options.spec, client, options.output, progress=sys.stderr.isatty())
        except Stopped as error:
            print(f'sweep: {error}', file=sys.stderr)
            return command_line.CHECK_FAILED
        except KeyboardInterrupt as error:
            print(f'interrupted: {error}' if str(error) else 'interrupted', file=sys.stderr)
            return 130
        return _tell(found, time.perf_counter() - begin, options)


@contextlib.contextmanager
def _client(address):
    """Yield the client of a Dask scheduler, or None without an address."""
    if address is None:
        yield None
        return
    need('distributed')
    import distributed
    # one line of this subcommand reports a lost scheduler; these loggers would add tracebacks
    for name in ('distributed', 'distributed.client', 'asyncio', 'tornado.application'):
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        client = distributed.Client(address, timeout=CONNECTING, set_as_default=False)
    except (OSError, ValueError) as error:
        problem = ' '.join(str(error).split())
        raise BadInput('--dask', f'no scheduler answers at {address!r} ({problem})',
                       'start one: dask scheduler, and dask worker tcp://HOST:8786') from None
    try:
        yield client
    finally:
        with contextlib.suppress(Exception):
            client.close(timeout=1.0)


def _tell_forecast(found, options):
    if options.json:
        command_line.print_json({'runs': found.runs, 'workers': found.workers,
                                 'seconds': found.seconds, 'bytes': found.bytes})
    else:
        print(f'{found.runs} runs, about {_duration(found.seconds)} on {found.workers} workers, '
              f'{_size(found.bytes)} before compression')
    return command_line.GOOD


def _duration(seconds):
    if seconds < 120.0:
        return f'{seconds:.2g} s'
    return f'{seconds / 60.0:.0f} min' if seconds < 7200.0 else f'{seconds / 3600.0:.1f} h'


def _size(count):
    for unit in ('bytes', 'kB', 'MB', 'GB'):
        if count < 1000.0:
            return f'{count:.3g} {unit}'
        count /= 1000.0
    return f'{count:.3g} TB'


def _failed(found):
    """Return how many runs failed and some of their texts, read a part at a time."""
    dim, failed, texts = found['status'].dims[0], 0, {}
    step = max(1, PART * found.sizes[dim] // found['status'].size)
    for first in range(0, found.sizes[dim], step):
        part = found[['status', 'status_text']].isel({dim: slice(first, first + step)})
        bad = (part['status'] != DONE).values
        failed += int(bad.sum())
        if bad.any() and len(texts) < SHOWN:
            texts.update(dict.fromkeys(part['status_text'].values[bad].tolist()))
    return failed, list(texts)[:SHOWN]


def _tell(found, seconds, options):
    """Print the outcome of a sweep."""
    status, dims = found['status'], found['status'].dims
    failed, texts = _failed(found)
    result = {'runs': int(status.size), 'failed': failed, 'seconds': seconds,
              'store': options.output, 'dimensions': dict(found.sizes),
              'variables': [str(name) for name in found.data_vars]}
    if options.json:
        command_line.print_json(result)
        return command_line.GOOD
    grid = ' x '.join(f'{name} {found.sizes[name]}' for name in dims)
    print(f'{found.attrs["title"]}: {result["runs"]} runs ({grid}) in {_duration(seconds)}')
    if failed:
        print(f'  {failed} failed (status, status_text), for example:')
        for text in texts:
            print(f'    {text}')
    print(f'  {", ".join(result["variables"])}: {options.output}')
    return command_line.GOOD


if __name__ == '__main__':
    sys.exit(main())
