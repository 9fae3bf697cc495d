# SPDX-License-Identifier: Apache-2.0
"""docs/extending: the files of its pages are written to a temporary package, registered and run.

One test compiles them; the others run without numba, which is quicker.
"""

import dataclasses
import importlib
import math
import pathlib
import sys
import types
from typing import ClassVar

import numpy as np
import pytest
from near import near
from soak import IN_SOAK

from rigid_body_sim.analysis.lines import predicted_lines
from rigid_body_sim.choice.choose import methods_for
from rigid_body_sim.drawing import setting
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators import METHODS
from rigid_body_sim.integrators.families import collocation, composition
from rigid_body_sim.integrators.protocols import Method
from rigid_body_sim.integrators.registry import Methods
from rigid_body_sim.messages import robot_description
from rigid_body_sim.messages.state_topics import Frames
from rigid_body_sim.motions import MOTIONS, absorbing_motion
from rigid_body_sim.motions.protocol import Motion
from rigid_body_sim.numerics.rotations import angle_between, rotate
from rigid_body_sim.scene import initial
from rigid_body_sim.scene.constraints import CONSTRAINTS, Pivot
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects import EFFECTS as KNOWN
from rigid_body_sim.scene.effects.gravity import Gravity
from rigid_body_sim.scene.effects.protocol import Acting, Effect
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.scene.schema import VECTOR, mapping_of
from rigid_body_sim.scene.state import State
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.testing import check_effect
from rigid_body_sim.theory.prediction import expectation

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / 'docs'))
from figures.more_bodies import FILES

EFFECTS = {'compass': 'more_bodies.compass:Compass', 'paddle': 'more_bodies.paddle:Paddle'}
TOP = """scene: top
body: {mass: 1.0, inertia: [0.03, 0.03, 0.01], inertia_about: origin, center_of_mass: [0, 0, 0.1]}
constraint: pivot
effects: [gravity: {g: 9.81}]
initial: {euler_zyz: [0.0, 0.5, 0.0], angular_velocity: [0, 0, 60]}
"""


@pytest.fixture(scope='module')
def package(tmp_path_factory):
    """Write the files of the pages, install the entry points, add the lines to the tables."""
    folder = tmp_path_factory.mktemp('site')
    for name, text in {'more_bodies/__init__.py': '', **FILES}.items():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    about = folder / 'more_bodies-1.0.dist-info'
    about.mkdir()
    (about / 'METADATA').write_text('Metadata-Version: 2.1\nName: more_bodies\nVersion: 1.0\n')
    lines = [f'{name} = {value}\n' for name, value in EFFECTS.items()]
    broken = 'broken = more_bodies.absent:Effect\nconstant = math:pi\n'
    (about / 'entry_points.txt').write_text(
        f'[rigid_body_sim.effects]\n{"".join(lines)}{broken}')
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(folder))
        importlib.invalidate_caches()
        joint = importlib.import_module('more_bodies.ball_joint').BallJoint
        patch.setitem(CONSTRAINTS, 'ball_joint', joint)
        method = importlib.import_module('more_bodies.ralston3')
        patch.setitem(METHODS, 'ralston3', method)
        patch.setattr('rigid_body_sim.motions.MOTIONS', ('more_bodies.slowing_sphere', *MOTIONS))
        yield folder / 'more_bodies'
    for name in [name for name in sys.modules if name.partition('.')[0] == 'more_bodies']:
        del sys.modules[name]


def of(name):
    """Return a module of the package."""
    return importlib.import_module(f'more_bodies.{name}')


def test_the_pages_have_every_kind_of_file():
    assert {pathlib.PurePath(name).stem for name in FILES} == {
        'compass', 'paddle', 'ball_joint', 'slowing_sphere', 'ralston3', 'compass_needle'}


@IN_SOAK
def test_an_effect_of_another_package_passes_the_check_compiled(package):
    energy, momentum = check_effect(of('compass').Compass((0.0, 0.1, 0.3), (0.0, 0.2, 1.0)))
    assert abs(energy) < 1e-14 and abs(momentum) < 1e-13    # measured 2e-16, 4e-15


@pytest.mark.without_numba
def test_an_effect_that_takes_energy_passes_the_check(package):
    energy, momentum = check_effect(of('paddle').Paddle(0.01))
    assert abs(energy) < 1e-14 and abs(momentum) < 1e-13


@pytest.mark.without_numba
def test_the_check_finds_a_potential_of_the_wrong_sign(package):
    compass = of('compass')

    class Wrong(compass.Compass):
        def potential(self, frame):
            right = super().potential(frame)
            return right._replace(values=tuple(-x for x in right.values[:3])
                                       + right.values[3:])

    class Unbooked(compass.Compass):
        potential = None

    class Turned(compass.Compass):
        def acting(self, frame, time):
            one, = super().acting(frame, time)
            return Acting(one.kernel, one.values, 'torque', 'work'),

    moment, field = (0.0, 0.1, 0.3), (0.0, 0.2, 1.0)
    with pytest.raises(AssertionError, match='energy residual'):
        check_effect(Wrong(moment, field))
    with pytest.raises(AssertionError, match='the view potential is None'):
        check_effect(Unbooked(moment, field))
    with pytest.raises(AssertionError, match='energy residual'):
        check_effect(Turned(moment, field))


@pytest.mark.without_numba
def test_a_force_on_a_held_body_is_refused_and_not_lost(package):
    """A bearing would take it: the effect must give its torque."""
    class Wind(of('paddle').Paddle):
        def acting(self, frame, time):
            one, = super().acting(frame, time)
            return one._replace(gives='force'),

    with pytest.raises(BadInput, match='paddle: gives a force, and a bearing holds the body; the '
                                       'torque'):
        check_effect(Wind(0.01), constraint=Pivot())


@pytest.mark.without_numba
def test_a_compass_moves_like_a_top_under_its_weight(package):
    """M g h along e3 in a field along -z of size 1 is the weight: the closed form is the truth."""
    truth = Simulation(parse_scene(TOP), 'exact')
    magnetic = TOP.replace('gravity: {g: 9.81}',
                           f'compass: {{moment: [0, 0, {9.81 * 0.1}], field: [0, 0, -1]}}')
    simulation = Simulation(parse_scene(magnetic), 'dop8', accuracy=1e-12, rate=10.0)
    simulation.advance(10)
    exact = truth.states([1.0])[0]
    assert angle_between(*simulation.state.orientation, *exact.orientation) < 1e-11
    assert np.abs(simulation.state.angular_velocity - exact.angular_velocity).max() < 1e-9
    ledger, weighed = simulation.ledger(), truth.diagnose(truth.states([1.0]))[0][0]
    assert abs(ledger['energy_residual']) < 1e-14
    assert ledger['kinetic'] + ledger['potential'] == near(weighed, rel=1e-13)


@pytest.mark.without_numba
def test_two_potentials_are_summed(package):
    both = TOP.replace('9.81}]', '9.81}, compass: {moment: [0.2, 0.1, 0.4], field: [0.3, 0, 1]}]')
    simulation = Simulation(parse_scene(both), 'dop8', accuracy=1e-12, rate=10.0)
    simulation.advance(10)
    ledger = simulation.ledger()
    assert abs(ledger['energy_residual']) < 1e-14
    assert abs(ledger['momentum_residual']) < 1e-12


@pytest.mark.without_numba
def test_a_ball_joint_is_a_pivot_of_the_shifted_body(package):
    pivoted = parse_scene("""scene: pivoted
body: {mass: 0.5, inertia: [0.02, 0.03, 0.015], center_of_mass: [0.01, 0.02, 0.1]}
constraint: pivot
effects: [gravity: {g: 9.81}]
initial: {euler_zyz: [0.3, 1.2, 0.4], angular_velocity: [3, -2, 20]}
""")
    jointed = parse_scene(pivoted.text, [
        'body.center_of_mass=[0.11, -0.18, 0.4]',
        'constraint={ball_joint: {at: [0.1, -0.2, 0.3]}}'])
    one, other = (Simulation(scene, 'dop8', accuracy=1e-12, rate=10.0)
                  for scene in (pivoted, jointed))
    for simulation in (one, other):
        simulation.advance(5)
        simulation.impulse(force=(0.01, 0.02, -0.01), torque=(1e-3, 0.0, 2e-3))
        simulation.advance(5)
    assert angle_between(*one.state.orientation, *other.state.orientation) < 1e-11
    assert one.state.angular_velocity == near(other.state.angular_velocity, rel=1e-10)
    assert one.acceleration[1] == near(other.acceleration[1], rel=1e-9)
    force, held = (np.concatenate(one.reactions([0.3, 0.9])[:2]) for one in (one, other))
    assert force == pytest.approx(held, abs=1e-9)
    ledger = other.ledger()
    assert abs(ledger['energy_residual']) < 1e-13
    assert abs(ledger['momentum_residual']) < 1e-12
    # the joint stays where it is: the velocity of the origin is that of a turn about it
    state = other.state
    turn = state.orientation
    arm = np.array(rotate(*turn, 0.1, -0.2, 0.3))
    assert state.position + arm == pytest.approx(np.zeros(3), abs=1e-12)
    spin = np.array(rotate(*turn, *state.angular_velocity))
    assert state.velocity == pytest.approx(np.cross(spin, -arm), abs=1e-9)


def test_a_ball_joint_on_the_axis_makes_a_top_in_closed_form(package):
    """The closed form asks which point is held, not which class holds it."""
    at = 'constraint={ball_joint: {at: [%s, 0, %s]}}'
    assert methods_for(parse_scene(TOP))[0] == 'exact'
    assert methods_for(parse_scene(TOP, [at % (0, 0)]))[0] == 'exact'
    assert methods_for(parse_scene(TOP, [at % (0, 0.05)]))[0] == 'exact'
    assert methods_for(parse_scene(TOP, [at % (0.05, 0)]))[0] != 'exact'
    moving = parse_scene(TOP, ['constraint={pivot: {motion: [0, 0, "0.01*t^2"]}}'])
    assert methods_for(moving)[0] != 'exact'


@dataclasses.dataclass(frozen=True)
class Axle(Constraint):
    """An axle along body axis y: what the contract asks for, and nothing of a hinge's own."""

    at: tuple
    kind: ClassVar[str] = 'axle'
    usage: ClassVar[str] = 'axle: {at: [x, y, z]}'
    SCHEMA: ClassVar[dict] = mapping_of(['at'], at=VECTOR)
    INITIAL: ClassVar[dict] = {**initial.ORIENTATION, **initial.PLACE, 'rate': {'type': 'number'}}
    mechanism: ClassVar[Mechanism] = Mechanism.AXIS
    axis: ClassVar = (0.0, 1.0, 0.0)

    @classmethod
    def from_scene(cls, settings, body, where):
        return cls(tuple(map(float, settings['at'])))

    def initial(self, start, body, where):
        omega = (0.0, float(start.mapping.get('rate', 0.0)), 0.0)
        arm = rotate(*start.orientation, *self.at)
        velocity = np.cross(arm, rotate(*start.orientation, *omega))
        return State.of(0.0, start.orientation, omega, np.subtract(start.position, arm), velocity)

    def point(self, body):
        return self.at


@dataclasses.dataclass(frozen=True)
class Moon(Gravity):
    """A uniform field by another name."""

    name: ClassVar[str] = 'moon'


@pytest.mark.without_numba
def test_an_axle_and_a_field_of_ones_own_get_the_closed_form_and_all_that_is_shown(monkeypatch):
    """Nothing asks for a constraint or an effect by its name."""
    monkeypatch.setitem(CONSTRAINTS, 'axle', Axle)
    monkeypatch.setitem(KNOWN, 'moon', Moon)
    body = 'body: {mass: 1.0, inertia: [0.03, 0.05, 0.04], center_of_mass: [0, 0.01, 0.1]}\n'
    mine = parse_scene(f"""scene: mine
{body}constraint: {{axle: {{at: [0, 0, -0.2]}}}}
effects: [moon: {{g: 1.62}}]
initial: {{euler_zyz: [0, 2.6, 0], rate: 1.0}}
""")
    known = parse_scene(f"""scene: known
{body}constraint: {{hinge: {{axis: [0, 1, 0], through: [0, 0, -0.2]}}}}
effects: [gravity: {{g: 1.62}}]
initial: {{euler_zyz: [0, 2.6, 0], rate: 1.0}}
""")
    one, other = Simulation(mine, rate=10.0), Simulation(known, rate=10.0)
    for simulation in (one, other):
        simulation.advance(5)
        simulation.impulse(torque=(0.0, 1e-3, 0.0))
        simulation.advance(5)
    assert one.choice.method == other.choice.method == 'exact'
    assert np.array_equal(one.state.vector, other.state.vector)
    assert np.array_equal(one.reactions([0.9])[1], other.reactions([0.9])[1])
    frames = Frames()
    assert robot_description.urdf(mine, frames) == robot_description.urdf(known, frames).replace(
        'known', 'mine')
    assert len(setting.holder_of(mine, 1.0)) == 1
    seen = [expectation(scene, scene.initial) for scene in (mine, known)]
    assert seen[0] is not None and seen[0].__class__ is seen[1].__class__
    assert predicted_lines(mine) == predicted_lines(known) != ()


AXLE = """scene: mine
body: {mass: 1.0, inertia: [0.03, 0.05, 0.04], center_of_mass: [0, 0.01, 0.1]}
constraint: {axle: {at: [0, 0, -0.2]}}
effects: []
initial: {euler_zyz: [0.3, 2.6, 0], rate: 1.0, position: [1.0, 2.0, 3.0]}
"""


@pytest.mark.parametrize(('mechanism', 'changes', 'line'), [
    (Mechanism.AXIS, {}, ''),
    (Mechanism.POINT, {}, ''),
    (Mechanism.AXIS, {'position': (1.0, 2.0, 3.0)}, 'held point at .* m; the place'),
    (Mechanism.POINT, {'position': (1.0, 2.0, 3.0)}, 'held point at .* m; the place'),
    (Mechanism.AXIS, {'velocity': (0.0, 0.0, 0.0)}, 'held point at .* m/s; a velocity'),
    (Mechanism.POINT, {'velocity': (0.0, 0.0, 0.0)}, 'held point at .* m/s; a velocity'),
    (Mechanism.POINT, {'angular_velocity': (1.0, 1.0, 0.0)}, 'held point at .* m/s; a velocity'),
    (Mechanism.AXIS, {'angular_velocity': (0.1, 1.0, 0.0)},
     r'the angular velocity \[0.1, 1.0, 0.0\]; one along its axis \[0.0, 1.0, 0.0\]'),
    (Mechanism.AXIS, {'orientation': (0.0, 0.0, 0.0, 2.0)}, 'a quaternion of norm 1'),
    (Mechanism.AXIS, {'axis': None}, 'has the axis None; a unit vector'),
    (Mechanism.AXIS, {'axis': (0.0, 2.0, 0.0)}, r'has the axis \(0.0, 2.0, 0.0\); a unit vector'),
    (Mechanism.TABLE, {'velocity': (1.0, 0.0, 0.1)}, 'the vertical velocity 0.1 m/s; a body that'),
])
def test_a_start_that_a_constraint_of_ones_own_forbids_is_refused(
        monkeypatch, mechanism, changes, line):
    class Wrong(Axle):
        def initial(self, start, body, where):
            state = super().initial(start, body, where)
            for name, value in changes.items():
                if name != 'axis':
                    getattr(state, name)[:] = value
            return state

    Wrong.mechanism = mechanism
    Wrong.axis = changes.get('axis', Axle.axis)
    monkeypatch.setitem(CONSTRAINTS, 'axle', Wrong)
    if line:
        with pytest.raises(BadInput, match=f'line 5: initial: the constraint axle .*{line}'):
            parse_scene(AXLE)
    else:
        assert parse_scene(AXLE).constraint.mechanism is mechanism


@pytest.mark.parametrize('name', ['uniform_field', 'momentum', 'grip', 'notes', 'from_scene'])
def test_a_setting_with_the_name_of_a_view_is_refused(name):
    with pytest.raises(TypeError, match=f'Wind.{name} is a setting with the name of a view'):
        type('Wind', (Effect,), {'__annotations__': {name: tuple}})


SPHERE = """scene: slowing
body: {mass: 2.0, shape: {solid_sphere: {radius: 0.1}}}
constraint: free
effects: [paddle: {coefficient: 0.004}]
initial: {angular_velocity: [1.0, 2.0, -2.0], velocity: [0.1, 0.0, 0.3]}
"""


@pytest.mark.without_numba
def test_a_sphere_under_a_paddle_slows_down_in_closed_form(package):
    scene = parse_scene(SPHERE)
    assert isinstance(of('slowing_sphere'), Motion)
    assert methods_for(scene)[0] == 'exact'
    assert 'taylor' not in methods_for(scene)    # no view `series`
    exact, stepped = (Simulation(scene, method, accuracy=1e-12, rate=1.0)
                      for method in ('exact', 'dop8'))
    for simulation in (exact, stepped):
        simulation.advance(10)
    rate = 3.0 / (1.0 + 0.004 / 0.008 * 3.0 * 10.0)
    assert math.hypot(*exact.state.angular_velocity) == near(rate, rel=1e-15)
    assert stepped.state.angular_velocity == near(exact.state.angular_velocity, rel=1e-11)
    assert angle_between(*exact.state.orientation, *stepped.state.orientation) < 1e-11
    for simulation in (exact, stepped):
        ledger = simulation.ledger()
        assert ledger['dissipated'] > 0.0
        assert abs(ledger['energy_residual']) < 1e-14    # measured 2e-16
        assert abs(ledger['momentum_residual']) < 1e-13


@pytest.mark.without_numba
def test_the_method_has_its_order(package):
    assert isinstance(of('ralston3'), Method)
    scene = parse_scene(TOP)
    truth = Simulation(scene, 'exact').states([0.2])[0]
    errors = []
    for step in (2e-3, 1e-3):
        state = Simulation(scene, 'ralston3', step=step).states([0.2])[0]
        errors.append(angle_between(*state.orientation, *truth.orientation))
    slope = math.log2(errors[0] / errors[1])
    assert of('ralston3').ORDER - 0.2 < slope < of('ralston3').ORDER + 0.5


@pytest.mark.parametrize(('changes', 'line'), [
    ({'TAKES': ('accuracy', 'step')},
     "method mine: lacks E5, E3; its family needs them for 'accuracy'"),
    ({'B': None}, "method mine: lacks B; its family needs them for 'step'"),
    ({'STIFF': None, 'SOURCE': None}, 'method mine: lacks SOURCE, STIFF; every method'),
    ({'FAMILY': collocation}, ''),
    ({'FAMILY': composition}, "mine: lacks DRIFTS, KICKS; its family needs them for 'step'"),
    ({'FAMILY': composition, 'TAKES': ('accuracy',)},
     r"method mine: TAKES: got \('accuracy',\); some of step, what its family"),
    ({'FAMILY': object()}, 'method mine: FAMILY: lacks ASKS, TABLE, TAKES_WRENCH, LANES'),
    ({'TAKES': ()}, r'method mine: TAKES: got \(\); some of accuracy, step'),
    ({'TABLE': True, 'TAKES': ('accuracy',), 'FAMILY': collocation},
     'method mine: TABLE: got True; False, or a Runge-Kutta method'),
    ({'TABLE': True}, 'method mine: TABLE: got True; False, or a Runge-Kutta method'),
    ({'NAME': 'yours'}, "method mine: its page calls itself 'yours'; the same name"),
])
def test_a_method_that_lacks_something_is_refused_in_one_line(package, changes, line):
    page = types.ModuleType('mine')
    page.__dict__.update(vars(of('ralston3')) | {'NAME': 'mine'} | changes)
    for name in [name for name, value in changes.items() if value is None]:
        delattr(page, name)
    table = Methods()
    if line:
        with pytest.raises(BadInput, match=line):
            table['mine'] = page
    else:
        table['mine'] = page
    assert ('mine' in table) == (not line)


def test_a_motion_that_lacks_something_is_refused_in_one_line(package, monkeypatch):
    text = (package / 'slowing_sphere.py').read_text()
    broken = text.replace('next_event = takes = None', 'next_event = None')
    assert broken != text
    (package / 'half_a_motion.py').write_text(broken)
    importlib.invalidate_caches()
    monkeypatch.setattr('rigid_body_sim.motions.MOTIONS', ('more_bodies.half_a_motion',))
    with pytest.raises(BadInput, match=r'motion more_bodies.half_a_motion: lacks takes; declare'):
        absorbing_motion(parse_scene(SPHERE))


@pytest.mark.without_numba
def test_the_scene_runs_with_all_of_them(package):
    scene = load_scene(package / 'compass_needle.yaml')
    simulation = Simulation(scene, accuracy=1e-11, rate=10.0, horizon=0.2)
    simulation.advance(2)
    ledger = simulation.ledger()
    assert ledger['dissipated'] > 0.0
    assert abs(ledger['energy_residual']) < 1e-11    # heat is a quadrature: as accurate as asked
    again = Simulation(parse_scene(scene.text), 'gauss16', accuracy=1e-12, rate=10.0)
    again.advance(2)
    assert angle_between(*again.state.orientation, *simulation.state.orientation) < 1e-9


def test_a_package_that_cannot_be_imported_is_refused_in_one_line(package):
    with pytest.raises(
            BadInput,
            match='effect broken: more_bodies.absent:Effect cannot be'.replace('.', r'\.')):
        parse_scene(SPHERE, ['effects=[broken]'])
    with pytest.raises(BadInput, match='effect constant: math:pi is not an Effect'):
        parse_scene(SPHERE, ['effects=[constant]'])
    with pytest.raises(BadInput, match="did you mean 'drag'"):
        parse_scene(SPHERE, ['effects=[drg: {}]'])
