# SPDX-License-Identifier: Apache-2.0
"""Parameters: what is refused at the start and by set_parameters; the reference page."""

import math

import pytest
import rclpy
import ros
from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.parameter import Parameter

from rigid_body_sim.errors import BadInput
from rigid_body_sim.node.parameters import TABLE, Settings, table


@pytest.fixture(scope='module')
def context(tmp_path_factory):
    """Yield an rclpy context in a domain of its own."""
    context = rclpy.Context()
    with ros.held_domain(tmp_path_factory.mktemp('log')) as domain:
        rclpy.init(args=[], context=context, domain_id=domain.id)
        yield context
        context.try_shutdown()


@pytest.fixture
def make(context):
    """Return a function that makes a node and its Settings from overrides like ``rate:=20``."""
    nodes = []

    def make(*overrides):
        arguments = ['--ros-args', *(word for override in overrides for word in ('-p', override))]
        nodes.append(rclpy.create_node('node', context=context, cli_args=arguments,
                                       start_parameter_services=False, enable_rosout=False))
        return nodes[-1], Settings(nodes[-1])
    yield make
    for node in nodes:
        node.destroy_node()


def test_defaults_are_those_of_the_table(make):
    node, settings = make()
    for entry in TABLE:
        assert settings[entry.name] == entry.default
        told = node.get_parameter(entry.name).value
        assert (tuple(told) if isinstance(entry.default, tuple) else told) == entry.default
        descriptor = node.describe_parameter(entry.name)
        assert descriptor.description == entry.about
        if isinstance(entry.default, float):
            [limits] = descriptor.floating_point_range
            assert (limits.from_value, limits.to_value) == (entry.low, entry.high)


def test_integer_will_do_for_a_double(make):
    node, settings = make('rate:=20', 'accuracy:=1e-9', 'duration:=3')
    assert (settings.rate, settings.accuracy, settings.duration) == (20.0, 1e-9, 3.0)
    assert type(node.get_parameter('rate').value) is float


def test_empty_list_arrives_as_one(make):
    node, settings = make('publish:=[]')
    assert settings.publish == ()
    assert node.get_parameter('publish').value == []
    assert node.get_parameter('publish').type_ == Parameter.Type.STRING_ARRAY


@pytest.mark.parametrize(('override', 'line'), [
    ('ratee:=5', 'parameter ratee: there is none of that name; did you mean rate?'),
    ('recording.directoy:=x',
     'parameter recording.directoy: there is none of that name; did you mean '
     'recording.directory?'),
    ('rate:=-5', 'parameter rate: got -5; needs a number from 0.001 to 100000'),
    ('rate:=0', 'parameter rate: got 0; needs a number from 0.001 to 100000'),
    ('rate:=abc', "parameter rate: got 'abc'; needs a number from 0.001 to 100000"),
    ('rate:=true', 'parameter rate: got True; needs a number from 0.001 to 100000'),
    ('rate:=.nan', 'parameter rate: got nan; needs a number from 0.001 to 100000'),
    ('rate:=[1.0]', 'parameter rate: got [1.0]; needs a number from 0.001 to 100000'),
    ('record:=1', 'parameter record: got 1; needs true or false'),
    ('scene:=3', 'parameter scene: got 3; needs a text'),
    ('overrun:=skip', "parameter overrun: got 'skip'; needs one of slip, skip_publish"),
    ('publish:=[odo]', "parameter publish: got 'odo'; did you mean 'odom'?"),
    ('publish:=odo', "parameter publish: got 'odo'; did you mean 'odom'?"),
    ('publish:=5', 'parameter publish: got 5; needs a list of words, each one of pose'),
])
def test_wrong_override_is_refused_by_name_and_value(make, override, line):
    with pytest.raises(BadInput) as refusal:
        make(override)
    assert str(refusal.value).startswith(line)
    assert '\n' not in str(refusal.value)


@pytest.mark.parametrize(('name', 'value', 'reason'), [
    ('rate', -5.0, 'Parameter rate out of range Min: 0.001, Max: 100000.0, value: -5.0'),
    ('rate', 'abc', "Wrong parameter type, expected '"),
    ('rate', math.nan, 'Parameter rate out of range'),
    ('rate', None, 'Static parameter cannot be undeclared'),
    ('overrun', 'slipp', "parameter overrun: got 'slipp'; needs one of slip, skip_publish"),
    ('publish', ['odom'],
     'parameter publish: it cannot change while the node runs; give it at the start'),
    ('record', False, 'Trying to set a read-only parameter: record.'),
])
def test_wrong_change_is_refused_with_the_reason(make, name, value, reason):
    node, settings = make()
    before = dict(settings.values)
    [result] = node.set_parameters([Parameter(name, value=value)])
    assert not result.successful
    assert result.reason.startswith(reason)
    assert settings.values == before


def test_one_word_alone_is_a_list_of_one(make):
    node, settings = make('scene_overrides:=strike.height=0.02', 'publish:=odom')
    assert (settings.scene_overrides, settings.publish) == (('strike.height=0.02',), ('odom',))
    assert all(result.successful for result in node.set_parameters([Parameter(
        'scene_overrides', value='strike.height=0.01')]))
    assert settings.scene_overrides == ('strike.height=0.01',)
    assert all(result.successful
               for result in node.set_parameters([Parameter('scene_overrides', value='')]))
    assert settings.scene_overrides == ()


def test_unknown_change_is_refused_with_the_nearest_name(make):
    node, _ = make()
    with pytest.raises(ParameterNotDeclaredException, match=r'ratee; did you mean rate\?'):
        node.set_parameters([Parameter('ratee', value=5.0)])


def test_change_holds_only_if_nobody_objects(make):
    node, settings = make()
    heard = []

    def object_to_heavy(changes):
        if changes.get('scene') == 'heavy_top':
            raise BadInput('scene', 'too heavy', 'a lighter one')
    settings.on_change(object_to_heavy, heard.append)
    [refused] = node.set_parameters([Parameter('scene', value='heavy_top')])
    assert (refused.successful, refused.reason, settings.scene, heard) == (
        False, 'scene: too heavy; a lighter one', 'tennis_racket', [])
    [result] = node.set_parameters([Parameter('rate', value=20)])
    assert (result.successful, settings.rate, heard) == (True, 20.0, [{'rate': 20.0}])
    assert node.set_parameters_atomically([
        Parameter('scene', value='sphere'), Parameter('scene_overrides', value=[])]).successful
    assert heard[-1] == {'scene': 'sphere', 'scene_overrides': ()}


def test_unknown_qos_override_is_refused_once_topics_are_there(make):
    node, settings = make('qos_overrides./pose.publisher.dept:=3')
    node.declare_parameter('qos_overrides./pose.publisher.depth', 10)
    with pytest.raises(BadInput, match=r'did you mean qos_overrides\./pose\.publisher\.depth\?'):
        settings.refuse_unknown_qos()


def test_the_reference_page_has_this_table():
    import ros
    page = ros.ROOT / 'docs' / 'reference' / 'parameters.md'
    assert table() in page.read_text(), 'run: python docs/make_reference.py'
