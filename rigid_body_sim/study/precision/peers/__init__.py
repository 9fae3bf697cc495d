# SPDX-License-Identifier: Apache-2.0
"""Peers: other programs that simulate rotation, one file each.

They run as their users run them, in the fastest way they offer. A module has NAME, `version()`
(ImportError if it is not installed) and `runners(problem, reference)`, which yields a
runner.Runner for each way to run it or raises RefusedError with the reason.
requirements/peers.txt installs them all.
"""

import contextlib
import importlib
import os
import sys

from rigid_body_sim.study.precision.runner import RefusedError, Runner

MODULES = (
    'heyoka_taylor',
    'numba_rk4',
    'scipy_dop853',
    'mujoco_engine',
    'drake_engine',
    'exudyn_engine',
    'pybullet_engine',
    'pinocchio_engine',
    'basilisk_engine',
    'orekit_engine',
)


@contextlib.contextmanager
def quiet():
    """Send what libraries print on standard output, even from C, to standard error.

    Standard output is for the table or JSON alone.
    """
    sys.stdout.flush()
    kept = os.dup(1)
    os.dup2(2, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(kept, 1)
        os.close(kept)


def installed():
    """Return the modules of the peers that can be imported here."""
    return [module for module in map(_module, MODULES) if _is_here(module)]


def missing():
    """Return the names of the peers that cannot be imported here."""
    return [module.NAME for module in map(_module, MODULES) if not _is_here(module)]


def _module(name):
    return importlib.import_module(f'{__name__}.{name}')


def _is_here(module):
    try:
        module.version()
    except ImportError:
        return False
    return True


def runners(problem, reference):
    """Return the Runners of all installed peers.

    A peer that refuses becomes a Runner that raises the reason when it is made.
    """
    found = []
    for module in installed():
        try:
            found += list(module.runners(problem, reference))
        except RefusedError as error:
            found.append(Runner(module.NAME, 'none', (None,), _refusing(error), True))
    return found


def _refusing(error):
    def make(_):
        raise error
    return make
