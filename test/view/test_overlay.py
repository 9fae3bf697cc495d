# SPDX-License-Identifier: Apache-2.0
"""Two recordings on one page: the second in grey, in the same world and at the same time."""

import numpy as np
import pytest
from analysis import made

pytest.importorskip('viser')

from rigid_body_sim.errors import BadInput
from rigid_body_sim.view import panel
from rigid_body_sim.view.page import Page
from rigid_body_sim.view.player import Player
from rigid_body_sim.view.subcommand import _player

RATE, TICKS = 100.0, 40
STRUCK = {20: [('cmd_impulse', (0.0, 0.0, 0.5), (0.5, 0.0, 0.0), 'world')]}


@pytest.fixture(scope='module')
def paths(tmp_path_factory):
    """Return the paths of two recordings; the body of the second is struck at 0.2 s."""
    folder = tmp_path_factory.mktemp('overlay')
    for name, acts in (('quiet', {}), ('struck', STRUCK)):
        made.record(folder / name, 'tennis_racket', TICKS, rate=RATE, acts=acts)
    return [str(folder / 'quiet'), str(folder / 'struck')]


def test_the_second_one_is_grey_beside_the_first_and_the_panel_says_how_far_they_are_apart(paths):
    page = Page(_player(paths, paths), port=0)
    try:
        page.panel.requests.put(('run', 'pause'))
        told = {}
        for when in (0.1, 0.4):
            page.panel.requests.put(('seek', when))
            page._numbers_due = 0.0
            page.turn()
            told[when] = page.panel._values.content
            place = [stage._body.position * page._stages[0].unit for stage in page._stages]
            turn = [stage._body.wxyz for stage in page._stages]
        assert '>0 rad<' in told[0.1] and '>0 m<' in told[0.1]
        # 0.2 s after a strike of 0.5 N s on 1 kg, along z
        assert place[1] - place[0] == pytest.approx([0.0, 0.0, 0.1], abs=1e-6)
        assert '>0.1 m<' in told[0.4]
        assert np.abs(turn[1] - turn[0]).max() > 0.01
        assert (page._stages[1]._root.position == page._stages[0]._root.position).all()
        assert page._stages[1].unit == page._stages[0].unit
        assert 'In grey: <b>struck</b>' in page.panel._title.content
    finally:
        page.close()


def test_the_same_motion_at_another_rate_is_nowhere_apart(paths, tmp_path):
    """The slower one was once held from state to state, and said to be a tenth of a radian off."""
    made.record(tmp_path / 'slow', 'tennis_racket', 15, rate=37.0)
    for one, other in ((paths[0], tmp_path / 'slow'), (tmp_path / 'slow', paths[0])):
        shown, beside = Player(one), Player(other)
        for when in (0.0, 0.123, 0.2501, 0.39):
            snapshot = shown.at(when, when)
            angle, distance = panel._apart(snapshot.vector, beside.beside_of(snapshot).vector)
            assert angle < 1e-3 and distance == 0.0


def test_more_than_two_and_a_scene_beside_a_recording_are_refused(paths):
    for names in ([*paths, paths[0]], [paths[0], 'tennis_racket']):
        with pytest.raises(BadInput, match='one recording, or two of them'):
            _player(names, [one for one in names if one in paths])
