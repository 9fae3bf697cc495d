# SPDX-License-Identifier: Apache-2.0
"""Decorators of kernels: numba compiles them if it is installed, else they are plain Python.

Kernels follow five rules, so that they mean the same with and without numba: scalars and small
arrays only; no assignment to a slice (without numba an array is a memoryview, memory.py); no
functions of ``math`` but sqrt, abs, floor, copysign, frexp and ldexp, which are exact or rounded
once everywhere (numerics/functions.py has the others); no division by zero (plain Python would
raise); no ``**`` (its rounding differs between the two).
"""

import functools
import importlib

from rigid_body_sim.compilation.environment import HAVE_NUMBA, numba

if HAVE_NUMBA:
    from numba.extending import register_jitable

    from rigid_body_sim.compilation import callees
    from rigid_body_sim.compilation.cache import DeferredCache


def _jit(function, **options):
    if not HAVE_NUMBA:
        return function
    kernel = numba.njit(
        error_model='numpy', nogil=True, no_cfunc_wrapper=True,
        pipeline_class=callees.KernelCompiler, **options)(function)
    kernel._cache = DeferredCache(function)
    callees.let_be_callee(kernel)
    compile_here = kernel.compile

    def compile_once(signature):
        """Compile for the types of a call, unless another process does: then load that."""
        # each mention of a kernel in another one asks again: what is known needs no lock
        if callees.in_a_caller() and signature in kernel.overloads:
            return compile_here(signature)
        with kernel._cache.alone(), callees.compiling(kernel, signature):
            return compile_here(signature)
    kernel.compile = compile_once
    return kernel


def compiled(function):
    """Compile a kernel at its first call, without reordering its operations (no ``fastmath``).

    The kernel may not make arrays, so numba need not count references to them: with the counting,
    each slice of an array costs up to 40 ns.
    """
    return _jit(function, _nrt=False)


def compiled_allocating(function):
    """Compile a kernel that makes arrays for its own use, at its first call."""
    return _jit(function, _nrt=True)


def inlined(function):
    """Let kernels inline a short function; plain Python calls it as it stands."""
    return register_jitable(forceinline=True, _nrt=False)(function) if HAVE_NUMBA else function


def compiled_inline(function):
    """Compile a short kernel that is copied into its callers."""
    return _jit(function, forceinline=True, _nrt=False)


@functools.cache
def in_python(name):
    """Return the plain function of a kernel, 'module:function'.

    It is for the few calls at the set-up of a scene: compiling would take longer than all of them.
    """
    module, _, function = name.partition(':')
    kernel = getattr(importlib.import_module(module), function)
    return getattr(kernel, 'py_func', kernel)
