# SPDX-License-Identifier: Apache-2.0
"""The serialisation of ticks: from states to the bytes of every topic.

The node and ``simulate`` both use it, so a topic has the same bytes in both. The numbers of a
tick, for all topics, come from one array of doubles, the *sample* (its places are named below).
They are copied to their places in a buffer that holds the messages of the tick end to end.
"""

import numpy as np

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.messages import cdr, definitions
from rigid_body_sim.messages.layout import Layout
from rigid_body_sim.messages.timeline import NANOSECONDS
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.state import STATE_SIZE

VECTOR = slice(0, STATE_SIZE)
"""The state (scene/state.py)."""
ENERGY, SQUARE = 14, 15
"""Energy (J) and L . L ((kg m^2/s)^2)."""
BODY_VELOCITY = slice(16, 19)
"""Velocity of the body's origin in body axes (m/s)."""
ACCELERATION = slice(19, 22)
"""Proper acceleration of the body's origin in body axes (m/s^2)."""
REACTION = slice(22, 28)
"""Force (N) and torque (N m) of the constraint on the body, world axes."""
HINGE = slice(28, 30)
"""Angle (rad) and rate (rad/s) of a hinged body."""
SHAPE = slice(30, 37)
"""Position (m) and quaternion of what a marker draws."""
SAMPLE_SIZE = 37
STAMPS = ('header.stamp.sec', 'transforms[0].header.stamp.sec', 'clock.sec')
"""Paths of stamps; each is set in every message that has it."""
NO_WRENCH = Wrench()


class TickMessages:
    """The messages of some topics for one scene, made for one tick or for many at once.

    Each message is placed in the buffer so that its doubles are at multiples of eight bytes (CDR
    aligns them, counted after its four bytes of encapsulation).

    Parameters
    ----------
    outputs : sequence of state_topics.Output
    scene : Scene
    frames : state_topics.Frames

    Attributes
    ----------
    sizes : list of int
        Numbers of bytes of the messages, in the order of the outputs.

    Raises
    ------
    BadInput
        If a topic has no meaning for the scene.
    """

    def __init__(self, outputs, scene, frames):
        buffer, targets, sources, seconds, self._parts = bytearray(), [], [], [], []
        for output in outputs:
            blank = cdr.encode(output.type, output.constants(scene, frames))
            buffer += bytes((4 - len(buffer)) % 8)
            start = len(buffer)
            buffer += blank
            self._parts.append(slice(start, start + len(blank)))
            doubles, stamps = _places(output, blank)
            targets += [(start + place) // 8 for place in doubles]
            seconds += [(start + place) // 4 for place in stamps]
            sources += [place for entry in output.places for place in _range(entry)]
        self._blank = np.frombuffer(buffer + bytes(-len(buffer) % 8), dtype=np.float64)
        self._targets, self._sources, self._seconds = (np.array(places, dtype=np.intp)
                                                       for places in (targets, sources, seconds))
        if len(self._targets) != len(self._sources):
            raise TypeError('an Output names more or fewer places than it has doubles')
        self.sizes = [part.stop - part.start for part in self._parts]
        self._derive = [output.derive(scene) for output in outputs if output.derive]

    def messages(self, vectors: np.ndarray, energies, squares, stamps,
                 wrench: Wrench = NO_WRENCH) -> list[list[bytes]]:
        """Return the messages of each tick, a list in the order of the outputs.

        Parameters
        ----------
        vectors : array (n, 14)
            The states (scene/state.py).
        energies, squares : array (n,)
            Energy (J) and L . L ((kg m^2/s)^2).
        stamps : sequence of int
            Stamps, ns.
        wrench : Wrench
            Wrench held at these ticks.
        """
        words = self._words(vectors, energies, squares, stamps, wrench)
        data, size = words.tobytes(), words.itemsize * len(self._blank)
        return [[data[start + part.start : start + part.stop] for part in self._parts]
                for start in range(0, len(words) * size, size)]

    def columns(self, vectors: np.ndarray, energies, squares, stamps,
                wrench: Wrench = NO_WRENCH) -> list[np.ndarray]:
        """Return the messages of each output, uint8 (n, size), for the same parameters."""
        words = self._words(vectors, energies, squares, stamps, wrench)
        data = words.view(np.uint8).reshape(len(words), -1)
        return [data[:, part] for part in self._parts]

    def _words(self, vectors, energies, squares, stamps, wrench):
        """Return the buffers of n ticks as doubles, shape (n, size / 8)."""
        count = len(vectors)
        samples = np.zeros((count, SAMPLE_SIZE))
        samples[:, VECTOR], samples[:, ENERGY], samples[:, SQUARE] = vectors, energies, squares
        for derive in self._derive:
            derive(samples, wrench)
        words = np.empty((count, len(self._blank)))
        words[:] = self._blank
        _fill(samples, self._sources, self._targets, np.array(stamps, dtype=np.int64),
              self._seconds, words, words.view(np.uint32))
        return words


@compiled
def _fill(samples, sources, targets, stamps, seconds, words, halves):
    """Copy the doubles of samples and the stamps (ns) into messages.

    `words` are the messages as doubles, `halves` the same bytes as 32-bit integers. Usually there
    is one tick, for which a few calls of numpy would take longer than everything else.
    """
    for k in range(len(samples)):
        for j in range(len(targets)):
            words[k, targets[j]] = samples[k, sources[j]]
        for j in range(len(seconds)):
            whole = stamps[k] // NANOSECONDS
            halves[k, seconds[j]] = whole
            halves[k, seconds[j] + 1] = stamps[k] - whole * NANOSECONDS


def _range(entry):
    return range(entry.start, entry.stop) if isinstance(entry, slice) else (entry,)


def _places(output, blank):
    """Return the offsets in a message of the doubles that change, and of its stamps."""
    doubles, stamps = [], []
    schema = definitions.schema(output.type)
    for path, code, offset, count in Layout(schema, output.type, blank).leaves:
        below = any(path == name or path.startswith((f'{name}.', f'{name}['))
                    for name in output.variable)
        if code == 'd' and below:
            doubles += range(offset, offset + 8 * count, 8)
        elif path in STAMPS:
            stamps.append(offset)
    return doubles, stamps
