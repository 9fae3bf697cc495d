# SPDX-License-Identifier: Apache-2.0
"""Sweeps: what they cost over `ensemble`, on workers of Dask, in memory, and beside heyoka.

    .venv/bin/python bench/sweeps.py [--only overhead dask heyoka] [--runs 1e8 --store FOLDER]

`overhead` compares CPU seconds of all threads, which other work on the machine disturbs less than
the clock; both sides make their starts. `--runs` sweeps that many runs of a racket in closed form
into a store and prints the time and the largest memory of this process.
"""

import argparse
import os
import pathlib
import resource
import shutil
import statistics
import tempfile
import time

import numpy as np

from rigid_body_sim import ensemble, load_scene, parse_scene, sweep
from rigid_body_sim.numerics.rotations import angle_between, multiply

GOAL = 1e-9
REPEATS = 9
TURNS, PATIENCE = 41, 3_000_000    # turns at most, and states of all of them
KEYS = ('initial.angular_velocity.0', 'initial.angular_velocity.2')
CASE = 'top 1'
PARTS = ('overhead', 'dask', 'heyoka')


def grid(scene, least, wide, times, keep):
    """Return the spec of a square grid of starts."""
    return {
        'scene': scene,
        'vary': {key: {'linspace': [least, 1.0, wide]} for key in KEYS},
        'times': times,
        'keep': keep,
    }


def closed(scene, count, times, keep):
    """Return the spec of a square grid of starts, and the same by ensemble."""
    wide = round(count**0.5)
    values = np.linspace(0.01, 1.0, wide)
    spec = grid(scene, 0.01, wide, times, keep)

    def by_ensemble():
        starts = np.tile(scene.initial.vector, (wide * wide, 1))
        first, third = np.meshgrid(values, values, indexing='ij')
        starts[:, 5], starts[:, 7] = first.ravel(), third.ravel()
        return ensemble(scene, starts, times)

    return lambda: sweep(spec), by_ensemble


def overhead():
    """Print CPU seconds of sweep over those of ensemble."""
    scene = load_scene('tennis_racket')
    print('in closed form, CPU seconds: sweep, ensemble, ratio of medians (least)')
    for count, times, keep in (
        (100_000, [10.0], ['final']),
        (100_000, np.linspace(0.0, 20.0, 50).tolist(), ['states']),
        (1_000_000, [10.0], ['final']),
    ):
        both = closed(scene, count, times, keep)
        spent = [[], []]
        for act in both:
            act()
        for _ in range(max(REPEATS, min(TURNS, PATIENCE // (count * len(times))))):
            for values, act in zip(spent, both, strict=True):
                begin = time.process_time()
                act()
                values.append(time.process_time() - begin)
        middle = [statistics.median(values) for values in spent]
        print(
            f'  {count:9} runs, {len(times):2} times: {middle[0]:.3f} {middle[1]:.3f} s, '
            f'{middle[0] / middle[1]:.3f} ({min(spent[0]) / min(spent[1]):.3f})'
        )


def dask():
    """Print the time of two workers of Dask beside that of one, and what a block costs."""
    import distributed

    scene = load_scene('tennis_racket')
    wide = 6000
    spec = grid(scene, 0.01, wide, 10.0, [{'minimum': 'cos_tilt'}])
    clock, busy = {}, {}
    for workers in (1, 2):
        with (
            distributed.LocalCluster(
                n_workers=workers, threads_per_worker=1, dashboard_address=None
            ) as cluster,
            distributed.Client(cluster) as client,
            tempfile.TemporaryDirectory() as folder,
        ):
            sweep(spec | {'vary': {KEYS[0]: [0.1, 0.2]}}, client)
            before, own = client.run(time.process_time), time.process_time()
            begin = time.perf_counter()
            sweep(spec, client, pathlib.Path(folder) / 'maps.zarr')
            clock[workers] = time.perf_counter() - begin
            spent = [value - before[name] for name, value in client.run(time.process_time).items()]
            busy[workers] = sum(spent), max(spent), time.process_time() - own
            if workers == 1:
                executor, own = client.get_executor(pure=False), time.process_time()
                for future in [executor.submit(int, k) for k in range(200)]:
                    future.result()
                a_task = (time.process_time() - own) / 200
    for workers, (total, longest, leader) in busy.items():
        print(
            f'{wide * wide} runs into a Zarr store, {workers} workers of Dask: '
            f'{clock[workers]:.1f} s; CPU seconds: workers {total:.2f} (the longest '
            f'{longest:.2f}), leading process and scheduler {leader:.2f}'
        )
    print(
        f'  by the clock {clock[1] / clock[2]:.2f} times faster, by the CPU seconds of the '
        f'longest worker {busy[1][1] / busy[2][1]:.2f}; '
        f'an empty task costs leader and scheduler {1e3 * a_task:.2f} ms'
    )


def beside_heyoka():
    """Print the cost of a scene without a closed form: a sweep, and heyoka's ensemble_propagate.

    Both end with an error of at most GOAL, measured against a finer sweep.
    """
    import heyoka
    from smooth_scenes import CASES, heyoka_system, in_frame

    count, duration = 512, 20.0
    scene = parse_scene(f'scene: bench\n{CASES[CASE]}')
    axes = scene.frame.axes
    rates = float(scene.initial.angular_velocity[2]) * np.linspace(0.9, 1.1, count)
    spec = {
        'scene': scene,
        'vary': {KEYS[1]: rates},
        'times': duration,
        'keep': ['final'],
        'integrator': 'taylor',
    }
    starts = np.tile(scene.initial.vector, (count, 1))
    starts[:, 7] = rates
    in_frames = [in_frame(scene, start) for start in starts]

    def ours(accuracy):
        return sweep(spec | {'accuracy': accuracy})['final_orientation'].values

    def theirs(solver):
        def start(copy, k):
            copy.time = 0.0
            copy.state[:] = in_frames[k]
            return copy

        ends = heyoka.ensemble_propagate_until(solver, duration, count, start)
        return np.array([end[0].state[:4] for end in ends])

    exact = [multiply(*q, *axes) for q in ours(1e-14).tolist()]

    def error(attitudes):
        return max(
            angle_between(*(q / np.linalg.norm(q)), *truth)
            for q, truth in zip(attitudes, exact, strict=True)
        )

    for tolerance in 10.0 ** -np.arange(7.0, 15.0, 0.5):
        accuracy = tolerance
        if error([np.array(multiply(*q, *axes)) for q in ours(accuracy).tolist()]) <= GOAL:
            break
    for tolerance in 10.0 ** -np.arange(7.0, 15.0, 0.5):
        solver = heyoka.taylor_adaptive(heyoka_system(scene), np.zeros(7), tol=tolerance)
        if error(theirs(solver)) <= GOAL:
            break
    spent = {f'sweep, taylor to {accuracy:.0e}': [], f'heyoka to {tolerance:.0e}': []}
    for values, act in zip(
        list(spent.values()) * REPEATS,
        (lambda: ours(accuracy), lambda: theirs(solver)) * REPEATS,
        strict=True,
    ):
        begin, clock = time.process_time(), time.perf_counter()
        act()
        values.append((time.process_time() - begin, time.perf_counter() - clock))
    print(f'{count} runs of {CASE} for {duration:g} s to {GOAL:g} rad')
    for name, values in spent.items():
        cpu, clock = (statistics.median(column) for column in zip(*values, strict=True))
        print(f'  {name:22} {cpu:.3f} CPU s, {clock:.3f} s by the clock')


def many(runs, folder):
    """Sweep a grid of that many runs into a store; print time, memory, size."""
    wide = round(runs**0.5)
    store = pathlib.Path(folder) / 'many.zarr'
    shutil.rmtree(store, ignore_errors=True)
    spec = grid('tennis_racket', 0.001, wide, 20.0, [{'minimum': 'cos_tilt'}])
    begin, cpu = time.perf_counter(), time.process_time()
    sweep(spec, store=store, progress=True)
    size = sum(path.stat().st_size for path in store.rglob('*') if path.is_file())
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(
        f'{wide * wide} runs in closed form: {time.perf_counter() - begin:.0f} s '
        f'({time.process_time() - cpu:.0f} CPU s, {os.cpu_count()} cores), '
        f'at most {memory / 1e6:.2f} GB of memory, '
        f'{size / 1e9:.2f} GB on disk'
    )


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--only', nargs='+', choices=PARTS, default=list(PARTS))
    parser.add_argument('--runs', type=float, default=0.0, help='of one large sweep')
    parser.add_argument('--store', default=tempfile.gettempdir(), help='folder for its store')
    options = parser.parse_args()
    if options.runs:
        many(options.runs, options.store)
        return
    for name in options.only:
        {'overhead': overhead, 'dask': dask, 'heyoka': beside_heyoka}[name]()


if __name__ == '__main__':
    main()
