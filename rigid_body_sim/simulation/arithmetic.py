# SPDX-License-Identifier: Apache-2.0
"""The version of the arithmetic: two programs of one version make the same bits.

digests.json holds digests of the states of all scenes and methods. `make test` asserts them on
whatever machine it runs, so their own digest identifies everything that leads from a scene to its
states.
"""

import functools
import hashlib
import json
import pathlib

FILE = pathlib.Path(__file__).with_name('digests.json')
EXCEPTED = ('lsoda', 'radau')
"""Methods whose bits are SciPy's: Fortran and LAPACK, as they were compiled for each machine."""


def digests():
    """Return the digests that are kept: case -> part -> digest."""
    return json.loads(FILE.read_text(encoding='utf-8'))


def written(found):
    """Return digests as the text of the file that keeps them."""
    return json.dumps(found, indent=0, sort_keys=True) + '\n'


@functools.cache
def version():
    """Return the version of the arithmetic: the digest of all digests, 16 hexadecimal digits."""
    return hashlib.sha256(written(digests()).encode()).hexdigest()[:16]
