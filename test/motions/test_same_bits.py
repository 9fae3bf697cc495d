# SPDX-License-Identifier: Apache-2.0
"""Closed forms whose other tests run in plain Python: compiled they have the same bits."""

from motions.states_of import SCENES, TIMES, states


def test_compiled_the_bits_are_those_of_plain_python(plain):
    compiled, in_python = states(), plain('motions/states_of.py')
    for name in SCENES:
        assert compiled[name] == in_python[name], name
        half = len(TIMES) * 14    # alone, and side by side
        assert compiled[name][:half] == compiled[name][half:], name
