# SPDX-License-Identifier: Apache-2.0
"""The version of the arithmetic, which recordings carry."""

import hashlib

from rigid_body_sim.simulation import arithmetic


def test_the_version_is_the_digest_of_the_file_that_keeps_the_digests():
    kept = arithmetic.FILE.read_bytes()
    assert arithmetic.written(arithmetic.digests()).encode() == kept
    assert arithmetic.version() == hashlib.sha256(kept).hexdigest()[:16]


def test_the_text_of_digests_does_not_depend_on_their_order():
    found = {'b': {'y': '2', 'x': '1'}, 'a': {'z': '3'}}
    assert arithmetic.written(found) == (
        '{\n"a": {\n"z": "3"\n},\n"b": {\n"x": "1",\n"y": "2"\n}\n}\n')
