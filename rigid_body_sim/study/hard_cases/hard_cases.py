# SPDX-License-Identifier: Apache-2.0
"""The subcommand `hard_cases`: the table of hard cases, with the peers beside this package."""

import sys

from tqdm import tqdm

from rigid_body_sim import command_line
from rigid_body_sim.study.hard_cases import beside
from rigid_body_sim.study.hard_cases.case import GROUPS
from rigid_body_sim.study.hard_cases.table import CASES

ABOUT = """Run the hard cases, on which general simulators lose energy, blow up, refuse or lie, \
and print the table: case, ours, bound, verdict.
With --peers the errors of the programs installed here (requirements/peers.txt has them all) \
stand beside ours."""


def main(arguments=None):
    """Run the subcommand; return the exit status: 1 if one of ours fails."""
    parser = command_line.parser(
        'hard_cases', ABOUT, 'python -m rigid_body_sim hard_cases --peers')
    parser.add_argument('--peers', action='store_true', help='run the peers too, some minutes')
    parser.add_argument('--json', action='store_true', help='machine-readable')
    return command_line.run(_run, parser.parse_args(arguments))


def _run(options):
    rows, missing = measure(options.peers, watch=sys.stderr.isatty())
    if options.json:
        command_line.print_json({'cases': rows, 'peers_not_installed': missing})
    else:
        for row in rows:
            print(f'{"good" if row["good"] else "FAILS":5}  {row["group"]:11}  '
                  f'{row["case"]}: {row["error"]:.1e} {row["unit"]}'
                  f' (bound {row["bound"]:.1e}: {row["reason"]})')
            for name, value in row['peers'].items():
                said = value if isinstance(value, str) else f'{value:.1e} {row["peer_unit"]}'
                print(f'           {name} after {row["peer_time"]:g} s: {said or "not asked"}')
        if missing:
            print(f'not installed here: {", ".join(missing)}')
        print(f'{sum(row["good"] for row in rows)} of {len(rows)} cases within their bounds')
    return command_line.GOOD if all(row['good'] for row in rows) else command_line.CHECK_FAILED


def measure(with_peers, watch):
    """Return a row of plain data for each case, and the names of the peers not installed."""
    installed, missing = beside.modules() if with_peers else ({}, [])
    rows = []
    for case in tqdm(CASES, disable=not watch, unit='case'):
        outcome = case.run()
        row = {
            'group': GROUPS[case.group],
            'case': case.name,
            'why': case.why,
            'error': _number(float(outcome.error)),
            'bound': float(outcome.bound),
            'unit': outcome.unit,
            'reason': outcome.reason,
            'good': bool(outcome.good),
            'peers': {},
        }
        if case.asked and installed:
            row |= {
                'peer_time': case.asked.time,
                'peer_unit': case.asked.unit,
                'peers': {
                    name: beside.answer(module, case.asked) for name, module in installed.items()
                },
            }
        rows.append(row)
    return rows, missing


def _number(error):
    """Return the number, or the largest double instead of a NaN or infinity, which JSON lacks."""
    return error if error == error and abs(error) != float('inf') else 1.7e308
