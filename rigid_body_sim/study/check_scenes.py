# SPDX-License-Identifier: Apache-2.0
"""The subcommand `check_scenes`: it runs every scene of the notes and compares it with theory."""

import concurrent.futures
import contextlib
import functools
import multiprocessing
import time

import numpy as np
from tqdm import tqdm

from rigid_body_sim import command_line
from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.study.scenes.confirm import confirm, confirm_shapes
from rigid_body_sim.study.scenes.systems import SYSTEMS

SHAPES = 'inertia_tensors'


def main(arguments=None):
    """Run the subcommand; return the exit status: 1 if a quantity is not as predicted."""
    parser = command_line.parser(
        'check_scenes',
        'Run every scene by its exact motion and by dop8 on the full equations, measure what the '
        'notes predict, compare.',
        'python -m rigid_body_sim check_scenes --scene heavy_top --set initial.spin=80')
    parser.add_argument('--scene', action='append', metavar='NAME',
                        help=f'only this scene (name or .yaml file), or {SHAPES}; may be repeated')
    parser.add_argument('--set', action='append', default=[], metavar='KEY=VALUE',
                        help='change of the scene, key.path=value; may be repeated')
    parser.add_argument('--json', action='store_true', help='every quantity with 17 digits')
    return command_line.run(_check, parser.parse_args(arguments))


def _check(options):
    if options.set and (options.scene is None or SHAPES in options.scene):
        raise BadInput(
            '--set', f'got {options.set[0]!r}', 'name the scene it changes: --scene NAME')
    names = options.scene or [SHAPES, *SYSTEMS]
    held = {name: name != SHAPES and load_scene(name, options.set).constraint.holds_a_point
            for name in names}
    began, tables = time.perf_counter(), []
    for table in _tables(held, options.set):
        tables.append(table)
        if not options.json:
            _tell(table)
    quantities = [quantity for table in tables for quantity in table['quantities']]
    failed = sum(quantity['verdict'] != CONFIRMED for quantity in quantities)
    if options.json:
        command_line.print_json({'scenes': tables, 'quantities': len(quantities), 'failed': failed,
                                 'seconds': time.perf_counter() - began})
    else:
        print(f'{len(quantities)} quantities of {len(tables)} systems: '
              f'{len(quantities) - failed} confirmed, {failed} not; '
              f'{time.perf_counter() - began:.1f} s')
    return command_line.CHECK_FAILED if failed else command_line.GOOD


def _tables(held, overrides):
    """Yield the tables of the systems in order, with progress on a terminal.

    Several systems are divided between two processes, held bodies in one and the others in the
    other, so that no kernel is compiled twice.
    """
    with contextlib.ExitStack() as stack:
        if len(held) == 1:
            pending = [functools.partial(_table, name, overrides) for name in held]
        else:
            spawn = multiprocessing.get_context('spawn')
            workers = [stack.enter_context(concurrent.futures.ProcessPoolExecutor(1, spawn))
                       for _ in range(2)]
            for worker in workers:
                stack.callback(worker.shutdown, cancel_futures=True)
            # called first, so that an early end does not wait for results that nobody reads
            stack.push(_end_children)
            with command_line.deaf_children():
                futures = [workers[held[name]].submit(_table, name, overrides) for name in held]
            pending = [future.result for future in futures]
        progress = stack.enter_context(tqdm(
            zip(held, pending), total=len(pending), disable=None, leave=False, unit=' systems'))
        for name, result in progress:
            progress.set_postfix_str(name)
            table = result()
            if isinstance(table, tuple):
                raise BadInput(*table)
            progress.clear()
            yield table


def _end_children(kind, *_):
    """End the worker processes where an exception ends the subcommand."""
    if kind is not None:
        for child in multiprocessing.active_children():
            child.terminate()


def _table(name, overrides):
    """Return the table of a system as plain data, or (where, problem, remedy) of an error."""
    with command_line.patience():
        return _confirmed(name, overrides)


def _confirmed(name, overrides):
    scene = None if name == SHAPES else load_scene(name, overrides)
    try:
        rows = confirm(scene) if scene else confirm_shapes()
    except BadInput as error:
        return error.where, error.problem, error.remedy
    about = (scene.about if scene
             else 'Moments of inertia of simple bodies (notes, Some inertia tensors)')
    return {
        'scene': scene.name if scene else name,
        'about': about,
        'notes': scene.notes if scene else [],
        'quantities': [_plain(row) for row in rows],
    }


CONFIRMED, REFUTED = 'confirmed', 'NOT CONFIRMED'


def _plain(row):
    """Return a row, {method: Quantity}, as plain data."""
    first = next(iter(row.values()))
    plain = {
        'quantity': first.name,
        'unit': first.unit,
        'predicted': _number(first.predicted),
        'measured': {way: _number(quantity.measured) for way, quantity in row.items()},
        'error': {way: _finite(quantity.error) for way, quantity in row.items()},
        'tolerance': first.tolerance,
        'kind': ('bound, ' if first.bound else '')
        + ('absolute' if first.absolute else 'relative'),
        'verdict': CONFIRMED if all(quantity.passed for quantity in row.values()) else REFUTED,
    }
    if first.as_written is not None:
        plain |= {'as_written': _number(first.as_written),
                  'error_as_written': _finite(first.error_as_written)}
    return plain | ({'detail': first.detail} if first.detail else {})


def _number(value):
    """Return a float or a list of floats; values that are not finite become names, for JSON."""
    return [_finite(entry) for entry in np.ravel(value)] if np.ndim(value) else _finite(value)


def _finite(value):
    return float(value) if np.isfinite(value) else str(float(value))


def _tell(table):
    """Print the table of a scene as text."""
    print(f'{table["scene"]}: {table["about"]}')
    for note in table['notes']:
        print(f'  note: {note}')
    for row in table['quantities']:
        unit = f' ({row["unit"]})' if row['unit'] else ''
        measured = next(iter(row['measured'].values()))
        errors = ', '.join(f'{way} {_short(error)}' for way, error in row['error'].items())
        print(f'  {row["quantity"]}{unit}')
        print(f'      predicted {_digits(row["predicted"])}  measured {_digits(measured)}  '
              f'{row["kind"]} error: {errors}  '
              f'tolerance {row["tolerance"]:.0e}  {row["verdict"]}')
        if 'as_written' in row:
            print(f'      uncorrected, the notes give {_digits(row["as_written"])}: '
                  f'off by {_short(row["error_as_written"])}')
        if 'detail' in row:
            print(f'      {row["detail"]}')
    print()


def _digits(value):
    """Return a number, or the first of many, with 15 digits."""
    if isinstance(value, list):
        shown = ', '.join(_digits(entry) for entry in value[:3])
        return f'({shown}{", ..." if len(value) > 3 else ""})'
    return value if isinstance(value, str) else f'{value:.15g}'


def _short(error):
    return error if isinstance(error, str) else f'{error:.1e}'
