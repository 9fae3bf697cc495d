# SPDX-License-Identifier: Apache-2.0
"""Python's conventions for Simulation and States: copies, pickles, slices, tables, plots."""

import copy
import inspect
import math
import pathlib
import pickle
import re
import subprocess
import sys
import typing

import numpy as np
import pytest
from soak import some_of

import rigid_body_sim
from rigid_body_sim import BadInput, NotConverged, Simulation, State, States, load_scene

STEPPED = {'scene': 'tennis_racket', 'integrator': 'dop8', 'accuracy': 1e-9}


def states(count=6):
    return Simulation('heavy_top').states(np.linspace(0.0, 1.0, count))


def test_names_complete_and_are_found_without_numpy():
    code = "import sys, rigid_body_sim as r; print(dir(r), 'numpy' in sys.modules)"
    shown = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True,
                           timeout=60, check=True).stdout
    assert shown.strip().endswith('False')
    for name in rigid_body_sim.__all__:
        assert f"'{name}'" in shown
        assert getattr(rigid_body_sim, name) is not None


def test_editors_and_type_checkers_see_the_same_names():
    source = inspect.getsource(rigid_body_sim)
    block = source[source.index('TYPE_CHECKING:'):source.index('__all__')]
    for name in rigid_body_sim.__all__:
        assert name in block, name
    assert typing.get_type_hints(Simulation.states)['return'] is States
    assert typing.get_type_hints(Simulation.at_event) == \
        {'name': str, 'within': float, 'return': State}


@pytest.mark.parametrize('overrides', [{'body.mass': 2.0, 'initial.tilt': np.float64(0.3)},
                                       ['body.mass=2.0', 'initial.tilt=0.3']])
@pytest.mark.parametrize('given', ['heavy_top', load_scene('heavy_top')], ids=['name', 'scene'])
def test_overrides_change_the_scene(given, overrides):
    simulation = Simulation(given, overrides=overrides)
    assert simulation.scene.body.mass == 2.0
    assert simulation.vector.tobytes() == Simulation(
        load_scene('heavy_top', ['body.mass=2.0', 'initial.tilt=0.3'])).vector.tobytes()


def test_an_override_that_is_wrong_is_one_line():
    with pytest.raises(BadInput, match=r"unknown key 'mas'") as refused:
        Simulation('heavy_top', overrides={'body.mas': 2.0})
    assert '\n' not in str(refused.value)


MADE = {'exact': {'scene': 'heavy_top'}, 'stepped': STEPPED,
        'table': {'scene': 'billiard_follow'}}
TAKEN = {'method': Simulation.copy, 'copy': copy.copy,
         'pickle': lambda one: pickle.loads(pickle.dumps(one)), 'deepcopy': copy.deepcopy}


@pytest.mark.without_numba
@pytest.mark.parametrize(('made', 'taken'), some_of([*MADE], [*TAKEN]))
def test_a_copy_goes_on_with_the_same_bits_and_leaves_the_original_alone(made, taken):
    one, untouched = (Simulation(**MADE[made]) for _ in range(2))
    for simulation in (one, untouched):
        simulation.advance(300)
        simulation.impulse(force=(0.01, 0.0, 0.0), torque=(0.0, 0.01, 0.02))
        simulation.hold(torque=(0.0, 0.0, 0.01), frame='body')
    other = TAKEN[taken](one)
    assert (other.tick, other.time) == (300, 0.3)
    assert other.vector.tobytes() == one.vector.tobytes()
    assert other.ledger() == one.ledger()
    other.advance(200)
    other.release()
    other.advance(50)
    assert one.tick == 300
    for simulation in (one, untouched):
        simulation.advance(200)
        simulation.release()
        simulation.advance(50)
        assert simulation.vector.tobytes() == other.vector.tobytes()
        assert simulation.events == other.events
        assert simulation.ledger() == other.ledger()


def test_commands_of_the_same_tick_go_on_in_a_copy():
    one = Simulation('tennis_racket')
    one.impulse(torque=(0.5, 0.0, 0.0))
    other = one.copy()
    for simulation in (one, other):
        simulation.impulse(torque=(-0.5, 0.0, 0.0))
        simulation.advance(100)
    # opposite impulses of one tick cancel to the last bit, also across the copy
    alone = Simulation('tennis_racket')
    alone.advance(100)
    assert one.vector.tobytes() == other.vector.tobytes() == alone.vector.tobytes()


def test_at_event_is_the_state_at_the_next_one():
    simulation = Simulation('tennis_racket')
    flip = simulation.at_event('flip')
    assert simulation.tick == 0
    simulation.advance(20_000)
    first, second, *_ = (event for event in simulation.events if event.name == 'flip')
    assert flip.time == first.time
    assert flip.vector.tobytes() == simulation.states([first.time])[0].vector.tobytes()
    again = Simulation('tennis_racket')
    again.advance(int(np.ceil(first.time * 1000.0)))
    assert again.at_event('flip').time == second.time
    again.advance(20_000 - again.tick)
    assert again.events == simulation.events      # a look ahead takes none away


@pytest.mark.parametrize('within', [12.0, 2048.0])
def test_at_event_looks_as_far_as_it_is_told(within):
    """At first it looks through a 1024th of that time; the body flips later than that."""
    simulation = Simulation('tennis_racket')
    flip = simulation.at_event('flip', within=within)
    assert flip.time > within / 1024.0
    assert flip.time == simulation.at_event('flip', within=1.001 * flip.time).time
    with pytest.raises(BadInput, match='no event comes in that time'):
        simulation.at_event('flip', within=0.999 * flip.time)


def test_an_event_that_does_not_come_is_said():
    with pytest.raises(BadInput, match=r"no 'rolling' within 30 s; in that time come: flip"):
        Simulation('tennis_racket').at_event('rolling', within=30.0)


def test_states_slice_and_iterate():
    some = states()
    assert isinstance(some[1:4], States) and len(some[1:4]) == 3
    assert isinstance(some[-1], State) and not isinstance(some[-1], States)
    assert [one.time for one in some] == some.time.tolist()
    assert some[some.time > 0.5].time.tolist() == [time for time in some.time if time > 0.5]
    assert some[[0, 2]].vector.tobytes() == some.vector[[0, 2]].tobytes()
    with pytest.raises(TypeError, match='one index'):
        some[0, 1]
    assert repr(some[:0]) == 'States(none)' and '6 states from 0.0 s to 1.0 s' in repr(some)


def test_states_are_arrays():
    some = states()
    assert np.asarray(some).base is some.vector or np.asarray(some) is some.vector
    assert np.asarray(some, dtype=np.float32).dtype == np.float32
    assert np.asarray(some[0]).shape == (14,)
    assert not np.shares_memory(np.array(some), some.vector)


def test_states_convert_to_pandas():
    pytest.importorskip('pandas')
    some = states()
    table = some.to_pandas()
    assert table.index.name == 'time' and table.index.tolist() == some.time.tolist()
    assert table['orientation_w'].tolist() == some.orientation[:, 3].tolist()
    assert table['velocity_x'].tolist() == some.velocity[:, 0].tolist()
    assert table.shape == (6, 13)


def test_states_convert_to_xarray():
    pytest.importorskip('xarray')
    some = states()
    data = some.to_xarray()
    assert data['angular_velocity'].sel(axis='y').values.tolist() == \
        some.angular_velocity[:, 1].tolist()
    assert data['orientation'].sel(quaternion='w').dims == ('time',)
    assert data['position'].attrs['units'] == 'm' and data['time'].attrs['units'] == 's'


def test_states_plot():
    matplotlib = pytest.importorskip('matplotlib')
    matplotlib.use('Agg')
    from matplotlib import pyplot
    some = states()
    axes = some.plot('angular_velocity', 'position')
    assert [one.get_ylabel() for one in axes] == ['angular velocity (rad/s)', 'position (m)']
    assert axes[0].lines[2].get_ydata().tolist() == some.angular_velocity[:, 2].tolist()
    assert len(some.plot()) == 2
    pyplot.close('all')
    with pytest.raises(ValueError, match=r"no part 'speed'; the parts are orientation"):
        some.plot('speed')


@pytest.mark.parametrize(('take', 'package'), [
    ('to_pandas', 'pandas'), ('to_xarray', 'xarray'), ('plot', 'matplotlib')])
def test_a_package_that_is_not_installed_is_one_line(take, package, monkeypatch):
    for name in (package, f'{package}.pyplot'):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(BadInput, match=f'^{package}: is not installed; pip install {package}$'):
        getattr(states(), take)()


def test_the_code_of_the_readme_runs():
    matplotlib = pytest.importorskip('matplotlib')
    matplotlib.use('Agg')
    from matplotlib import pyplot
    text = (pathlib.Path(__file__).resolve().parents[2] / 'README.md').read_text()
    [code] = re.findall(r'```python\n(.*?)```', text, re.DOTALL)
    names = {}
    exec(code, names)
    assert names['other'].vector.tobytes() == names['simulation'].vector.tobytes()
    assert len(names['speeds']) == 3
    pyplot.close('all')


def test_notebooks_show_tables():
    simulation = Simulation('heavy_top')
    assert '<td>' in simulation.state._repr_html_()
    long = states(50)._repr_html_()
    assert long.count('<tr>') == 2 + 10 and '50 states' in long
    shown = simulation._repr_html_()
    assert 'heavy_top' in shown and 'energy residual' in shown
    assert repr(simulation) == '<Simulation of heavy_top by exact: tick 0, t = 0.0 s>'


NO_TICKS = [-1, -50, 10.5, 3.0, np.float64(4.0), math.nan, math.inf, '3', None, True, [1], 10**400]


@pytest.mark.parametrize('ticks', NO_TICKS, ids=lambda ticks: str(ticks)[:10])
@pytest.mark.parametrize('go', ['advance', 'advance_through', 'foresee'])
@pytest.mark.parametrize('made', [{'scene': 'tennis_racket'}, STEPPED], ids=['exact', 'stepped'])
def test_what_is_no_number_of_ticks_is_refused_and_changes_nothing(made, go, ticks):
    one = Simulation(**made)
    one.advance(100)
    before = one.vector.tobytes()
    with pytest.raises(BadInput, match=f'^{go}: got .*a number of ticks'):
        getattr(one, go)(ticks)
    assert (one.tick, one.vector.tobytes()) == (100, before)
    one.advance(np.int64(3))
    assert (one.tick, type(one.tick)) == (103, int)


def test_a_strike_that_the_body_cannot_take_ends_the_run_at_the_tick_before():
    one = Simulation('baseball_bat', overrides=[
        'strike.impulse=[0, 1e75, 0]', 'strike.distance=1e75', 'strike.time=0.5'])
    one.advance(400)
    for _ in range(2):
        with pytest.raises(NotConverged, match=r'strike: at 0\.5 s'):
            one.advance(500)
        assert (one.tick, one.time, one.vector[0]) == (499, 0.499, 0.499)
        assert [(event.tick, event.time, event.name) for event in one.events] == [
            (499, 0.5, 'end')]


@pytest.mark.parametrize(('act', 'line'), [
    (lambda one: one.impulse(force=3), 'impulse: got force 3'),
    (lambda one: one.hold(torque='abc'), r"got force \[0.0, 0.0, 0.0\], torque 'abc'"),
    (lambda one: one.impulse(force=(1.0, None, 0.0)), 'three finite numbers each'),
    (lambda one: one.command(np.zeros((1, 3))), r'command: got an array of shape \(1, 3\)'),
    (lambda one: one.command(np.zeros(8)), r'command: got an array of shape \(8,\)'),
    (lambda one: one.at_event('flip', within=math.nan), 'within: got nan'),
    (lambda one: one.at_event('flip', within=-1), 'within: got -1'),
    (lambda one: one.at_event('flip', within='a'), "within: got 'a'"),
    (lambda one: one.states([math.nan]), 'got times from nan to nan s'),
    (lambda one: Simulation(one.scene, rate='a'), "rate: got 'a'"),
    (lambda one: Simulation(one.scene, accuracy=None), 'accuracy: got None'),
    (lambda one: Simulation(one.scene, horizon=True), 'horizon: got True'),
    (lambda one: Simulation(one.scene, 'rk4', step='1'), "step: got '1'"),
])
def test_what_is_no_number_is_refused_in_one_line(act, line):
    with pytest.raises(BadInput, match=line):
        act(Simulation('tennis_racket'))


def test_no_states_at_all_are_states_too():
    none = Simulation('tennis_racket').states([])
    assert (len(none), repr(none), list(none)) == (0, 'States(none)', [])
    assert repr(none[0:2]) == 'States(none)'
    assert none._repr_html_().startswith('<table>')
    pytest.importorskip('pandas')
    assert len(none.to_pandas()) == 0
