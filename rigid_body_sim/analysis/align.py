# SPDX-License-Identifier: Apache-2.0
"""Several topics of a recording side by side in stamp order, whatever its chunks are."""

import numpy as np

LARGEST = 1_000_000
"""Messages of one topic that may wait for those of another; beyond it they are yielded alone."""


def aligned(recording, topics, progress=None):
    """Yield dicts topic -> columns, in the order of log time.

    Each has all messages up to some log time that were not yielded before.

    Parameters
    ----------
    recording : Recording
    topics : sequence of str
        Complete names; each dict has all of them that have messages in its stretch.
    progress : callable, optional
        Called with numbers of messages done.
    """
    left = {topic: recording.topics[topic].count for topic in topics}
    waiting = {topic: [] for topic in topics}
    for topic, columns in recording.blocks(list(topics), progress=progress):
        waiting[topic].append(columns)
        left[topic] -= len(columns['log_time'])
        if (
            all(blocks or not left[name] for name, blocks in waiting.items())
            or sum(len(part['log_time']) for part in waiting[topic]) > LARGEST
        ):
            # later messages of a topic have at least the log time of its last one
            until = min(
                (
                    waiting[name][-1]['log_time'][-1] - 1
                    for name in topics
                    if left[name] and waiting[name]
                ),
                default=None,
            )
            stretch = {name: _take(waiting, name, until) for name in topics if waiting[name]}
            stretch = {name: part for name, part in stretch.items() if part is not None}
            if stretch:
                yield stretch
    rest = {name: _take(waiting, name, None) for name in topics if waiting[name]}
    if rest:
        yield rest


def _take(waiting, name, until):
    """Return the columns of a topic up to a log time (None: all), and leave the rest waiting.

    The result has the columns that all blocks have; it is None where there are no messages.
    """
    blocks = waiting[name]
    joined = blocks[0] if len(blocks) == 1 else {
        key: np.concatenate([block[key] for block in blocks]) for key, column in blocks[0].items()
        if all(key in block and block[key].shape[1:] == column.shape[1:] for block in blocks)}
    count = (
        len(joined['log_time'])
        if until is None
        else int(np.searchsorted(joined['log_time'], until, side='right'))
    )
    waiting[name] = (
        [{key: column[count:] for key, column in joined.items()}]
        if count < len(joined['log_time'])
        else []
    )
    return {key: column[:count] for key, column in joined.items()} if count else None
