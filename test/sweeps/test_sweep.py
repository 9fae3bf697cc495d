# SPDX-License-Identifier: Apache-2.0
"""Each run has its own bits on any worker; failures are reported, errors refused."""

import concurrent.futures
import json
import math
import pathlib
import re
import subprocess
import sys
import threading

import numpy as np
import pytest
from soak import IN_SOAK

pytest.importorskip('xarray')

from rigid_body_sim import BadInput, Simulation, parse_scene, sweep
from rigid_body_sim.cli.sweep import main
from rigid_body_sim.compilation.threads import on_all_cores, one_core
from rigid_body_sim.sweeps import spec as specs
from rigid_body_sim.sweeps import stores, work
from rigid_body_sim.sweeps.draws import Sampled
from rigid_body_sim.sweeps.plan import Plan
from rigid_body_sim.sweeps.runs import compute
from rigid_body_sim.sweeps.sweep import forecast, prepared

ROOT = pathlib.Path(__file__).resolve().parents[2]
ON_A_PLANE = 'rattleback', 'tippe_top'    # their kernels take 20 s to compile
TIMES = [0.5, 3.0, 10.0]
KEEP = ['states', 'final', 'residuals', {'first': 'flip'}, {'all': 'flip', 'most': 2},
        {'minimum': 'cos_tilt'}, {'maximum': 'energy'}]
RACKET = {'scene': 'tennis_racket', 'vary': {
    'body.inertia.1': [2.1, 2.5, 7.0], 'initial.angular_velocity.0': {'logspace': [-4, 0, 3]}},
    'sample': {'runs': 5, 'seed': 3, 'initial.orientation': 'rotation',
               'initial.angular_velocity.2': {'normal': [0.0, 0.1]}},
    'times': TIMES, 'keep': KEEP}
TOP = {'scene': {
    'scene': 'leaning', 'body': {'mass': 1.0, 'inertia': [0.05, 0.04, 0.01],
                                 'center_of_mass': [0.01, 0.0, 0.1]},
    'constraint': 'pivot', 'effects': [{'gravity': {'g': 9.81}}],
    'initial': {'euler_zyz': [0.0, 0.5, 0.0], 'angular_velocity': [0.0, 0.0, 30.0]}},
    'vary': {'gravity.g': [1.62, 9.81],
             'initial.angular_velocity.2': {'linspace': [20.0, 60.0, 9]}},
    'times': [0.5, 2.0], 'keep': ['final', {'first': 'turning point'}]}

NEEDLE = {'scene': {
    'scene': 'needle', 'constraint': 'pivot', 'effects': [{'gravity': {'g': 1.0}}],
    'body': {'mass': 0.5, 'inertia': [0.037, math.nextafter(0.037, 1.0), 3.7e-8],
             'center_of_mass': [0, 0, 0.25]},
    'initial': {'orientation': [0.1, 0.5, -0.2, 0.8], 'angular_velocity': [3, -2, 1]}},
    'vary': {'initial.angular_velocity.1': [-2.0, -20.0]}, 'times': [5.0], 'accuracy': 1e-6,
    'keep': ['final']}


def same(ours, theirs):
    """Assert that two results are the same to the bit."""
    assert set(ours.variables) == set(theirs.variables)
    for name in ours.variables:
        a, b = ours[name], theirs[name]
        assert a.dims == b.dims, name
        if a.dtype.kind in 'fi':
            assert a.dtype == b.dtype and a.values.tobytes() == b.values.tobytes(), name
        else:
            assert (a.values == b.values).all(), name


def test_each_run_has_the_bits_of_a_simulation_alone():
    found = sweep(RACKET)
    for i, inertia in enumerate([2.1, 2.5]):
        for k in (0, 4):
            omega = found['initial.angular_velocity.0'].values
            alone = Simulation('tennis_racket', overrides={
                'body.inertia.1': inertia, 'initial.angular_velocity.0': omega[2],
                'initial.orientation': found['initial.orientation'].values[k],
                'initial.angular_velocity.2': found['initial.angular_velocity.2'].values[k]})
            states = alone.states(TIMES)
            run = found.isel({'body.inertia.1': i, 'initial.angular_velocity.0': 2, 'run': k})
            assert run['orientation'].values.tobytes() == states.orientation.tobytes()
            assert run['final_position'].values.tobytes() == states.position[-1].tobytes()
            alone.advance(10_000)
            flips = [event.time for event in alone.events if event.name == 'flip']
            assert run['first_flip'] == (flips or [math.nan])[0] or not flips
            assert run['flip_count'] == len(flips)
            ledger = alone.ledger()
            assert run['energy_residual'] == ledger['energy_residual']
            assert run['momentum_residual'] == ledger['momentum_residual']


def test_runs_in_a_closed_form_of_a_body_nearly_theirs_tell_its_error_from_their_own_starts():
    """I1 - I2 is 7e-18 kg m^2, which the parallel-axis theorem rounds away; it turns a needle.

    Half an ulp of the angle turned is 2e-15 rad.
    """
    found = sweep(NEEDLE)
    told = found['expected_error'].values
    for k, omega in enumerate(found['initial.angular_velocity.1'].values):
        alone = Simulation(parse_scene(json.dumps(NEEDLE['scene']),
                                       {'initial.angular_velocity.1': omega}),
                           accuracy=1e-6, horizon=5.0)
        assert alone.choice.method == 'exact'
        assert told[k] == np.float32(alone.choice.expected_error)
    assert 1e-9 < told[0] < 1e-8 < told[1] < 1e-6    # 5.0e-9, 1.9e-7


@pytest.mark.parametrize('spec', [
    pytest.param(RACKET, id='closed'), pytest.param(TOP, id='auto', marks=IN_SOAK),
    pytest.param(TOP | {'integrator': 'taylor', 'accuracy': 1e-9}, id='lanes'),
    pytest.param(TOP | {'integrator': 'dop8', 'accuracy': 1e-6}, id='dop8')])
def test_bits_depend_on_no_block_and_no_order(spec):
    plan = prepared(spec)
    whole = compute(plan, 0, plan.spec.size)
    for length in (1, 7):
        for first in reversed(range(0, plan.spec.size, length)):
            stop = min(first + length, plan.spec.size)
            part = compute(plan, first, stop)
            for name, values in part.arrays.items():
                assert values.tobytes() == whole.arrays[name][first:stop].tobytes(), name
            assert part.texts == {run: text for run, text in whole.texts.items()
                                  if first <= run < stop}


def test_engines_and_stores_change_no_bit(tmp_path):
    whole = sweep(RACKET)
    with concurrent.futures.ThreadPoolExecutor(3) as threads:
        same(whole, sweep(RACKET, threads))
    pytest.importorskip('zarr', minversion='3.1')
    same(whole, sweep(RACKET, store=tmp_path / 'racket.zarr'))
    table = RACKET | {'keep': [one for one in KEEP if one != 'states']}
    same(sweep(table), sweep(table, store=tmp_path / 'racket.parquet'))
    import pandas
    rows = pandas.read_parquet(tmp_path / 'racket.parquet')
    assert len(rows) == 45 and rows['body.inertia.1'].iloc[-1] == 7.0
    assert rows['status'].iloc[-1] == 2


def test_dask_changes_no_bit(tmp_path):
    distributed = pytest.importorskip('distributed')
    pytest.importorskip('zarr', minversion='3.1')
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=False,
                                  dashboard_address=None) as cluster, \
            distributed.Client(cluster, timeout=60) as client:
        whole = sweep(RACKET)
        same(whole, sweep(RACKET, client))
        same(whole, sweep(RACKET, client, tmp_path / 'racket.zarr'))


def test_result_says_what_it_is():
    found = sweep(RACKET)
    assert dict(found.sizes) == {'body.inertia.1': 3, 'initial.angular_velocity.0': 3, 'run': 5,
                                 'time': 3, 'quaternion': 4, 'axis': 3, 'flip': 2}
    for name, variable in found.data_vars.items():
        assert variable.attrs['long_name'], name
    assert found['body.inertia.1'].attrs['units'] == 'kg m2'
    assert found['angular_velocity'].attrs['units'] == 'rad/s'
    assert found['initial.orientation'].dims == ('run', 'quaternion')
    good = found.isel({'body.inertia.1': 0})
    assert (good['method'] == 0).all() and (good['tolerance'] == 1e-12).all()
    assert ((good['expected_error'] > 0.0) & (good['expected_error'] < 1e-13)).all()
    for name in ('scene', 'spec', 'version of rigid_body_sim', 'version of arithmetic', 'machine'):
        assert found.attrs[name], name
    same(found, sweep(json.loads(found.attrs['spec'])))


def test_refused_run_is_nan_and_the_others_go_on():
    found = sweep(RACKET)
    bad, good = found.isel({'body.inertia.1': 2}), found.isel({'body.inertia.1': slice(2)})
    assert (bad['status'] == 2).all() and (good['status'] == 0).all()
    assert np.isnan(bad['orientation']).all() and np.isfinite(good['orientation']).all()
    assert all('triangle inequality' in text for text in bad['status_text'].values.ravel())
    assert not any(good['status_text'].values.ravel())


@pytest.mark.parametrize('key', ['position', 'velocity'])
def test_a_start_that_a_scene_refuses_is_refused_in_a_sweep_and_the_others_go_on(key):
    starts = [[0.0, 0.0, 0.0], [2e75, 0.0, 0.0], [0.0, 0.0, 1.0]]
    found = sweep({'scene': 'tennis_racket', 'times': [1.0], 'keep': ['final'],
                   'vary': {f'initial.{key}': starts}})
    assert found['status'].values.tolist() == [0, 2, 0]
    assert 'got 2e+75; needs a number from' in str(found['status_text'].values[1])
    assert np.isnan(found['final_orientation'].values[1]).all()
    assert np.isfinite(found['final_orientation'].values[[0, 2]]).all()


def test_run_that_a_method_gives_up_is_nan():
    # a million turns a second: doubles cannot count the radians until the end
    spec = TOP | {'integrator': 'dop8', 'accuracy': 1e-6, 'times': [2.0], 'keep': ['final'],
                  'vary': {'initial.angular_velocity.2': [30.0, 1e17, 31.0]}}
    found = sweep(spec)
    assert found['status'].values.tolist() == [0, 1, 0]
    assert 'rad/s' in str(found['status_text'].values[1])
    assert np.isnan(found['final_orientation'].values[1]).all()
    assert np.isfinite(found['final_orientation'].values[[0, 2]]).all()


def side(run):
    if run.values['initial.angular_velocity.0'] > 0.5:
        raise ZeroDivisionError('too fast')
    [state] = run.at([2.0])
    [alone] = run.simulation.states([2.0])
    return {'height': state.position[2], 'turn': state.orientation,
            'same': float(state.vector.tobytes() == alone.vector.tobytes())}


def test_function_of_the_users_own(tmp_path):
    spec = {'scene': 'tennis_racket', 'keep': [{'function': side}],
            'vary': {'initial.angular_velocity.0': [0.1, 0.4, 0.9]}}
    found = sweep(spec)
    assert found['turn'].shape == (3, 4) and found['same'].values[:2].tolist() == [1.0, 1.0]
    assert found['status'].values.tolist() == [0, 0, 3]
    assert 'ZeroDivisionError: too fast' in str(found['status_text'].values[2])
    assert np.isnan(found['turn'].values[2]).all()
    (tmp_path / 'mine.py').write_text(
        'def speed(run):\n    return run.states.angular_velocity[0]\n')
    (tmp_path / 'spec.yaml').write_text(json.dumps(
        spec | {'keep': [{'function': 'mine.py:speed'}]}))
    assert sweep(tmp_path / 'spec.yaml')['speed'].values[1].tolist() == [0.4, 5.0, 0.01]


@pytest.mark.without_numba
def test_strikes_are_simulated():
    heights = [-0.01, 0.02]
    keep = ['states', {'first': 'rolling began'}, 'residuals']
    found = sweep({'scene': 'billiard_low', 'vary': {'strike.height': heights},
                   'times': [0.1, 1.0], 'keep': keep})
    for k, height in enumerate(heights):
        alone = Simulation('billiard_low', overrides={'strike.height': height}, horizon=1.0)
        assert found['velocity'].values[k].tobytes() == alone.states([0.1, 1.0]).velocity.tobytes()
        alone.advance(1000)
        [rolling] = [event.time for event in alone.events if event.name == 'rolling began']
        assert found['first_rolling_began'].values[k] == rolling
        assert abs(found['energy_residual'].values[k]) < 1e-12


def test_samples_depend_on_seed_key_and_run_alone():
    def of(kind, a=0.0, b=1.0, seed=7, key='initial.x'):
        return Sampled(kind, a, b, seed, key)
    many = of('normal').of_runs(0, 20_000)
    assert many[500:503].tobytes() == of('normal').of_runs(500, 503).tobytes()
    assert abs(many.mean()) < 0.03 and abs(many.std() - 1.0) < 0.03
    assert not (many[:4] == of('normal', seed=8).of_runs(0, 4)).any()
    assert not (many[:4] == of('normal', key='initial.y').of_runs(0, 4)).any()
    # the bits are those of every machine and every version from here on
    assert of('normal', 1.0, 2.0, key='a').of_runs(0, 2).tolist() == NORMALS
    directions = of('direction', 5.0).of_runs(0, 20_000)
    assert np.allclose(np.linalg.norm(directions, axis=1), 5.0, rtol=1e-15)
    assert np.abs(directions.mean(axis=0)).max() < 0.1
    turns = of('rotation').of_runs(0, 20_000)
    assert np.allclose(np.linalg.norm(turns, axis=1), 1.0, rtol=1e-15)
    assert np.abs((turns**2).mean(axis=0) - 0.25).max() < 0.01


@pytest.mark.parametrize(('change', 'line'), [
    ({'varry': {}}, 'varry: is not a word of a sweep; did you mean vary?'),
    ({'keep': ['finale']}, "did you mean 'final'?"),
    ({'keep': [{'first': 'flop'}]}, "got 'flop'; an event: flip"),
    ({'keep': [{'minimum': 'cos_tlt'}]}, 'did you mean cos_tilt?'),
    ({'keep': ['final', 'final']}, 'final is listed twice'),
    ({'keep': [{'function': 'nowhere:nothing'}]}, 'module:name, or file.py:name'),
    ({'vary': {'body.mass': {'linspce': [1, 2, 3]}}}, 'linspace: [first, last, count]'),
    ({'vary': {'body.mass': []}}, 'a list of values'),
    ({'vary': {'body.mas': [1.0]}}, "unknown key 'mas'; did you mean 'mass'"),
    ({'vary': {'body.mass': [-1.0, -2.0]}}, 'body.mass: got -1'),
    ({'sample': {'runs': 0, 'body.mass': {'uniform': [1, 2]}}}, 'a whole number from 1'),
    ({'sample': {'runs': 3, 'body.mass': {'uniform': [2, 1]}}}, '{uniform: [least, largest]}'),
    ({'sample': {'seed': 3}}, "the key 'runs' is missing"),
    ({'times': [3.0, 2.0]}, 'each later than the one before'),
    ({'integrator': 'taylr'}, "did you mean 'taylor'?"),
    ({'vary': {}}, 'neither vary nor sample'),
])
def test_wrong_specs_are_refused(change, line):
    spec = {'scene': 'tennis_racket', 'vary': {'body.mass': [1.0, 2.0]}, 'keep': ['final']}
    spec |= change
    with pytest.raises(BadInput) as told:
        sweep(spec)
    assert line in str(told.value) and '\n' not in str(told.value)


def test_too_much_for_memory_is_said_before_anything_runs():
    with pytest.raises(BadInput, match='or a store'):
        sweep({'scene': 'tennis_racket', 'times': 1.0, 'keep': ['final'],
               'sample': {'runs': 10**11, 'body.mass': {'uniform': [1, 2]}}})


NORMALS = [-2.9331906041134874, 2.371554698457258]
SMALL = {'scene': 'tennis_racket', 'vary': {'initial.angular_velocity.0': [0.1, 0.2, 0.3]},
         'keep': ['final']}


@pytest.mark.parametrize('kind', ['zarr', 'parquet'])
def test_store_of_another_spec_or_version_is_refused(tmp_path, monkeypatch, kind):
    pytest.importorskip('zarr', minversion='3.1')
    store = tmp_path / f'small.{kind}'
    first = sweep(SMALL, store=store)
    same(first, sweep(SMALL, store=store))
    with pytest.raises(BadInput, match=r'holds the sweep of another spec: times differs; give'):
        sweep(SMALL | {'times': 2.0}, store=store)
    monkeypatch.setattr(stores, 'versions', lambda: {'rigid_body_sim': '9', 'arithmetic': 'x'})
    with pytest.raises(BadInput, match=r'was made by version .* of rigid_body_sim, and this is 9'):
        sweep(SMALL, store=store)
    (tmp_path / f'other.{kind}').mkdir()
    with pytest.raises(BadInput, match='is not a store of a sweep'):
        sweep(SMALL, store=tmp_path / f'other.{kind}')
    with pytest.raises(BadInput, match=r'a path that ends in \.zarr'):
        sweep(SMALL, store=tmp_path / 'maps.nc')


def test_store_that_is_being_swept_is_refused(tmp_path):
    pytest.importorskip('zarr', minversion='3.1')
    sweep(SMALL, store=tmp_path / 'small.zarr')
    with stores.store_at(tmp_path / 'small.zarr').alone(), \
            pytest.raises(BadInput, match=r'process \d+ is sweeping it'):
        sweep(SMALL, store=tmp_path / 'small.zarr')


def test_worker_of_another_version_or_without_the_disk_is_refused(tmp_path):
    spec = specs.read(SMALL)
    mine = stores.versions()
    task = work.Task(spec.text, '{}', {}, mine | {'arithmetic': 'other'}, '', None)
    with pytest.raises(BadInput, match=r'worker: has version .* of arithmetic, and the sweep was'):
        work.work(task, 0, 1, 0)
    task = work.Task(spec.text, '{}', {}, mine, str(tmp_path / 'gone.zarr'), None)
    with pytest.raises(BadInput, match='does not see the store'):
        work.work(task, 0, 1, 0)


def command(*arguments, **options):
    return subprocess.run([sys.executable, '-m', 'rigid_body_sim', 'sweep', *map(str, arguments)],
                          cwd=ROOT, capture_output=True, text=True, timeout=120, **options)


def test_full_disk_is_one_line_and_the_sweep_goes_on(tmp_path):
    pytest.importorskip('zarr', minversion='3.1')
    import resource
    spec, store = tmp_path / 'spec.yaml', tmp_path / 'maps.zarr'
    spec.write_text(json.dumps({
        'scene': 'tennis_racket',
        'vary': {'initial.angular_velocity.0': {'linspace': [0, 1, 4000]}},
        'times': 1.0, 'keep': ['final']}))
    # kernels are compiled here: the cache would not take them on a full disk
    in_memory = sweep(spec)
    full = command(spec, '--output', store, preexec_fn=lambda: resource.setrlimit(
        resource.RLIMIT_FSIZE, (20_000, 20_000)))
    assert full.returncode == 1 and full.stderr.count('\n') == 1, full.stderr
    assert 'the disk refuses (File too large)' in full.stderr and 'goes on' in full.stderr
    assert not (tmp_path / 'maps.zarr' / 'progress' / 'done' / 'c' / '0').exists()
    same(in_memory, sweep(spec, store=store))


def test_command_forecasts_runs_and_refuses(tmp_path, capsys):
    pytest.importorskip('zarr', minversion='3.1')
    spec = tmp_path / 'spec.yaml'
    spec.write_text(json.dumps(SMALL))
    assert main([str(spec), '--dry-run', '--json']) == 0
    told = json.loads(capsys.readouterr().out)
    assert told['runs'] == 3 and told['seconds'] > 0.0 and not (tmp_path / 'a.zarr').exists()
    assert told['bytes'] == 3 * (13 * 8 + 1 + 1 + 8 + 4) == forecast(spec).bytes
    done = command(spec, '--output', tmp_path / 'a.zarr')
    assert done.returncode == 0 and '3 runs (initial.angular_velocity.0 3)' in done.stdout
    assert main([str(spec)]) == 2
    assert capsys.readouterr().err.startswith('--output: is missing; NAME.zarr')
    spec.write_text('scene: tennis_racket\nkeep: [final]\n')
    assert main([str(spec), '--output', str(tmp_path / 'b.zarr')]) == 2
    assert capsys.readouterr().err.count('\n') == 1


def test_missing_package_is_one_line(monkeypatch):
    from rigid_body_sim.sweeps import needed
    monkeypatch.setattr(needed.importlib.util, 'find_spec', lambda name: None)
    with pytest.raises(BadInput, match=r'the Python package xarray is not installed; pip install'):
        sweep(SMALL)


def test_plan_finds_a_run_that_is_valid():
    plan = Plan(specs.read({'scene': 'tennis_racket', 'keep': ['final'], 'vary': {
        'body.inertia.1': {'linspace': [0.1, 3.0, 30]}}}))
    assert plan.template.body.about_center.moments[1] >= 2.0


@pytest.mark.parametrize('path', [
    pytest.param(path, id=path.stem, marks=IN_SOAK if path.stem in ON_A_PLANE else ())
    for path in sorted((ROOT / 'config' / 'sweeps').glob('*.yaml'))])
def test_shipped_specs_are_good(path):
    plan = prepared(path)
    first = plan.template_run
    assert compute(plan, first, first + 1).arrays['status'] == 0
    assert f'{path.stem}.yaml' in ''.join(figure.read_text() for figure in
                                          (ROOT / 'docs' / 'figures').glob('*.py'))


def test_links_of_the_page_lead_somewhere():
    page = ROOT / 'docs' / 'sweeps.md'
    for target in re.findall(r'\]\(([^)#:]+)\)', page.read_text()):
        assert (page.parent / target).exists(), target


def test_work_on_one_core_starts_no_thread():
    seen = []
    with one_core():
        on_all_cores(lambda part: seen.append((threading.get_ident(), part)), 1000)
    assert seen == [(threading.get_ident(), slice(0, 1000))]
