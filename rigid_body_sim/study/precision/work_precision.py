# SPDX-License-Identifier: Apache-2.0
"""The subcommand `work_precision`: error against CPU time of every method, and of peers."""

import contextlib
import json
import os
import pathlib
import platform
import sys
import time

from tqdm import tqdm

from rigid_body_sim import command_line
from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording.about import machine, version
from rigid_body_sim.study.precision import measure, peers, reference, runner, suite, table

QUICK_LIMIT, FULL_LIMIT = 0.03, 0.15
"""Limits of the CPU seconds of one run; a sweep ends at the first run beyond.

On a plane they are suite.PATIENCE times as long.
"""
QUICK_REPEATS, FULL_REPEATS = 5, 7


def main(arguments=None):
    """Run the subcommand; return the exit status."""
    parser = command_line.parser(
        'work_precision',
        'Error against CPU time of every method that can run a scene, and of peers.',
        'python -m rigid_body_sim work_precision --scene heavy_top --duration 20 --output study')
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        '--scene', help='a problem of the suite, the name of a scene that ships, or a .yaml file')
    what.add_argument('--suite', action='store_true',
                      help='all problems of the suite (default: the four of the quick form)')
    parser.add_argument('--set', action='append', default=[], metavar='KEY=VALUE',
                        help='change of the scene, key.path=value; may be repeated')
    parser.add_argument(
        '--duration', type=float, help='simulated seconds of a scene outside the suite (20)')
    parser.add_argument('--peers', action='store_true',
                        help='run the peers that are installed too (requirements/peers.txt)')
    parser.add_argument('--quick', action='store_true',
                        help=f'end sweeps at {QUICK_LIMIT} s a run instead of {FULL_LIMIT} s, '
                        f'{QUICK_REPEATS} samples instead of {FULL_REPEATS}')
    parser.add_argument(
        '--output', metavar='DIR', help='write work_precision.json, .txt and .png there')
    parser.add_argument('--json', action='store_true', help='print everything as JSON')
    return command_line.run(_run, parser.parse_args(arguments))


def _surroundings():
    """Return when and where a study was made."""
    return {
        'made': time.strftime('%Y-%m-%dT%H:%M:%SZ', time.gmtime()),
        'version': version(),
        'machine': machine(),
        'cores': os.cpu_count(),
        'load': os.getloadavg(),
        'interpreter': platform.python_implementation(),
        'clock': 'time.process_time',
    }


def _run(options):
    problems = _problems(options)
    limit, repeats = (QUICK_LIMIT, QUICK_REPEATS) if options.quick else (FULL_LIMIT, FULL_REPEATS)
    folder = pathlib.Path(options.output) if options.output else None
    if folder:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise BadInput('--output', f'{folder} cannot be made ({error.strerror})',
                           'another folder') from None
    results, began, versions, missing = [], time.time(), {}, []
    if options.peers:
        with peers.quiet():
            versions, missing = (
                {module.NAME: module.version() for module in peers.installed()}, peers.missing())
    for problem in problems:
        with peers.quiet() if options.peers else contextlib.nullcontext():
            results.append(study(problem, options.peers, limit, repeats))
        if not options.json:
            print('\n'.join(table.lines(results[-1])), end='\n\n', flush=True)
    found = {
        **_surroundings(),
        'took': time.time() - began,
        'limit': limit,
        'repeats': repeats,
        'sample': measure.SAMPLE,
        'peers': versions,
        'peers_not_installed': missing,
        'results': results,
    }
    if missing and not options.json:
        print(f'not installed: {", ".join(missing)} (requirements/peers.txt)\n')
    if options.json:
        command_line.print_json(found)
    if folder:
        write(folder, found)
        if not options.json:
            print(f'{folder}/work_precision.json, .txt, .png')
    return command_line.GOOD


def _problems(options):
    known = suite.NAMES + suite.ON_A_PLANE
    if options.scene and not (options.scene in known and not options.set
                              and options.duration is None):
        duration = 20.0 if options.duration is None else options.duration
        if not 0.0 < duration <= 1e6:
            raise BadInput(
                '--duration', f'got {duration!r}', 'simulated seconds, above 0, at most 1e6')
        if options.scene in known:
            raise BadInput('--scene', f'{options.scene} is a problem of the suite',
                           'it takes no --set and no --duration')
        return [suite.of_scene(options.scene, options.set, duration)]
    if options.set or options.duration is not None:
        raise BadInput('--set, --duration', 'are for one scene', 'name it: --scene NAME')
    names = [options.scene] if options.scene else known if options.suite else suite.QUICK
    return [suite.problem(name) for name in names]


def study(problem, with_peers, limit, repeats):
    """Return the result of one problem: measurements, the reference's digits and the floors."""
    limit *= problem.patience
    truth = reference.load(problem)
    if truth is None:
        with tqdm(total=100, desc=f'{problem.name}: reference', disable=None, leave=False) as bar:
            def tell(part):
                bar.n = round(100 * part)
                bar.refresh()
            truth = reference.compute(problem.scene, problem.duration, draws=4, progress=tell)
    runners = list(runner.ours(problem, truth))
    if with_peers:
        runners += peers.runners(problem, truth)
    return {
        'problem': problem.name,
        'about': problem.about,
        'scene': problem.scene.text,
        'duration': problem.duration,
        'reference_digits': truth.digits,
        'floor': float(truth.floor[-1]),
        'largest_floor': float(truth.floor.max()),
        'floor_omega': float(truth.floor_omega[-1]),
        'limit': limit,
        **measure.measure(problem, truth, runners, limit, repeats),
    }


def write(folder, found):
    """Write the JSON file, the table and the figure."""
    # matplotlib takes a second to import
    from rigid_body_sim.study.precision.figure import draw
    folder.joinpath('work_precision.json').write_text(json.dumps(found, indent=1) + '\n')
    folder.joinpath('work_precision.txt').write_text('\n\n'.join('\n'.join(table.lines(
        result)) for result in found['results']) + '\n')
    draw(found['results']).savefig(folder / 'work_precision.png')


if __name__ == '__main__':
    sys.exit(main())
