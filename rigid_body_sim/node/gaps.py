# SPDX-License-Identifier: Apache-2.0
"""Lost messages, counted by the publishers' sequence numbers.

A message that arrives at a full subscription queue silently evicts the oldest one (the
middleware's event for lost messages does not report it). But each publisher numbers its messages
from 1 on, and a message carries its number, though not the name of its publisher. So the next
expected number of each publisher is kept. An unexpected number means a gap or a new publisher, and
then the publishers are looked up. If a gap is attributed to the wrong one of several publishers,
the next number of the other one compensates it, so the total is right. Messages lost while a
publisher appears or disappears are not noticed.
"""

NUMBER = 'publication_sequence_number'


class Gaps:
    """Counts the missing messages of a topic.

    Parameters
    ----------
    publishers : callable
        Returns who publishes now, a set.

    Attributes
    ----------
    lost : int
        Messages that are missing so far.
    """

    def __init__(self, publishers):
        self._publishers, self._known = publishers, set()
        self._expected = []
        self.lost = 0

    def look(self, numbers):
        """Take the sequence numbers of some messages, in order.

        A number is None where the middleware gives none.
        """
        expected = self._expected
        for number in numbers:
            if number in expected:
                expected.remove(number)
                expected.append(number + 1)
            elif number is not None:
                self._unexpected(number)

    def _unexpected(self, number):
        publishers, expected = self._publishers(), self._expected
        if publishers != self._known:
            self._known = publishers
            # which number belonged to a publisher that left is unknown
            expected.clear()
        passed = max((one for one in expected if one < number), default=None)
        if len(expected) >= max(len(publishers), 1):
            if passed is not None:
                self.lost += number - passed
            # that of the gap, or of the publisher that was silent for longest
            expected.remove(expected[0] if passed is None else passed)
        expected.append(number + 1)
