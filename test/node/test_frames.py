# SPDX-License-Identifier: Apache-2.0
"""Names of the frames: a prefix, by default the namespace of the node, and a name each."""

import types

import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.node.publishing import frames_of


def frames(namespace='/', prefix='auto', world='world', body='body'):
    node = types.SimpleNamespace(get_namespace=lambda: namespace)
    return frames_of(node, types.SimpleNamespace(
        frame_prefix=prefix, world_frame=world, body_frame=body))


@pytest.mark.parametrize(('settings', 'names'), [
    ({}, ('world', 'body', '')), ({'namespace': '/left'}, ('left/world', 'left/body', 'left/')),
    ({'namespace': '/a/b'}, ('a/b/world', 'a/b/body', 'a/b/')),
    ({'namespace': '/left', 'prefix': ''}, ('world', 'body', '')),
    ({'prefix': 'one_', 'body': 'top'}, ('one_world', 'one_top', 'one_'))])
def test_frames_are_named_after_the_namespace_or_as_asked(settings, names):
    found = frames(**settings)
    assert (found.world, found.body, found.prefix) == names


@pytest.mark.parametrize('settings', [
    {'world': 'body'}, {'world': ''}, {'body': ''}, {'namespace': '/a', 'world': '', 'body': ''},
    {'prefix': 'ball', 'world': ''}, {'prefix': 'ball', 'body': ''}])
def test_frames_need_two_names_that_differ(settings):
    with pytest.raises(BadInput, match='two names that differ'):
        frames(**settings)
