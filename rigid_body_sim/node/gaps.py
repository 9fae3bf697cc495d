# SPDX-License-Identifier: Apache-2.0
"""Messages that never came, by the numbers that publishers give to theirs.

What finds the queue of a subscription full drives out the oldest message there, in silence (the
middleware's event for lost messages tells nothing of it). But each publisher numbers its messages
from 1 on, and the number comes along with each; not so the publisher's name. So the numbers that
are expected next are kept, one for each publisher. One that nobody expects is a gap, or a
publisher that is new: who publishes is then looked up. If a gap is put down to the wrong one of
several publishers, the next number of the other one makes up for it: what was lost of all together
is right. What is lost in the moment in which a publisher comes or goes is not noticed.
"""

NUMBER = 'publication_sequence_number'


class Gaps:
    """Counts what is missing between the messages of a topic.

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
        """Look at the numbers of some messages, in their order.

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
            # of those that went nothing is expected, but nobody knows which number that is
            expected.clear()
        passed = max((one for one in expected if one < number), default=None)
        if len(expected) >= max(len(publishers), 1):
            if passed is not None:
                self.lost += number - passed
            # the gap's, or the one that was not heard for the longest time
            expected.remove(expected[0] if passed is None else passed)
        expected.append(number + 1)
