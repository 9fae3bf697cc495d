# SPDX-License-Identifier: Apache-2.0
"""Commands in a recording: messages as ROS packs them, and the journal with every bit."""

import json

import numpy as np
import pytest

from rigid_body_sim.messages import cdr
from rigid_body_sim.messages.definitions import schema
from rigid_body_sim.recording.command_messages import WRENCH_TYPE, CommandMessages, CommandTopics
from rigid_body_sim.simulation.command_rows import BODY, HOLD, IMPULSE, LET_GO, WORLD, rows_of

ROWS = np.concatenate(
    [
        np.array(
            [
                (HOLD, WORLD, 1.1, -0.0, 1e-300, 0.1, 0.2, 0.3),
                (IMPULSE, BODY, 4.2, 5.0, 6.0, 7.0, 8.0, np.pi),
            ]
        ),
        LET_GO,
    ]
)


@pytest.mark.parametrize('frames', [('world', 'body'), ('a/world', 'a/bodies')])
def test_each_is_the_message_it_came_as_and_the_entry_has_all(frames):
    made = CommandMessages(
        CommandTopics(('/x/cmd_impulse', '/x/cmd_wrench'), frames), '/x/journal'
    ).messages(7, 1_700_000_000_123_456_789, ROWS)
    for row, frame, topic, (name, data) in zip(
        ROWS[:2].tolist(), frames, ('/x/cmd_wrench', '/x/cmd_impulse'), made[:2], strict=True
    ):
        assert name == topic
        force, torque = (dict(zip('xyz', part, strict=True)) for part in (row[2:5], row[5:8]))
        assert data == cdr.encode(WRENCH_TYPE, {
            'header': {'stamp': {'sec': 1_700_000_000, 'nanosec': 123_456_789}, 'frame_id': frame},
            'wrench': {'force': force, 'torque': torque}})
    assert made[2] is None      # what lets go came from nobody
    name, data = made[3]
    entry = json.loads(
        cdr.decode(schema('std_msgs/msg/String'), 'std_msgs/msg/String', data)['data']
    )
    assert (name, entry['kind'], entry['tick'], len(made)) == ('/x/journal', 'commands', 7, 4)
    assert rows_of(entry['commands']).tobytes() == ROWS.tobytes()
