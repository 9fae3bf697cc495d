# SPDX-License-Identifier: Apache-2.0
"""Kernels that are compiled because another kernel calls them: their code is for that one alone.

numba makes machine code of each function that it compiles, and a wrapper that takes arguments from
Python. A caller needs neither: LLVM's code of the callee goes into its own. So a callee has just
this code, until Python calls it itself, which saves up to three tenths of a first run.
"""

import contextlib
import threading

from llvmlite import binding
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, compile_result


class _Thread(threading.local):
    """Of one thread: the number of kernels that it compiles, each because of the one before."""

    depth = 0


_THREAD = _Thread()


def in_a_caller():
    """Tell whether this thread compiles a kernel: what it asks for now is called by that one."""
    return _THREAD.depth > 0


def has_caller():
    """Tell whether the kernel that this thread compiles is called by another one that it does."""
    return _THREAD.depth > 1


@contextlib.contextmanager
def compiling(kernel, signature):
    """Let what is compiled meanwhile be callees; a kernel that was one is compiled anew here."""
    if not in_a_caller() and is_callee(kernel, signature):
        del kernel.overloads[signature]
    _THREAD.depth += 1
    try:
        yield
    finally:
        _THREAD.depth -= 1


def is_callee(kernel, signature):
    """Tell whether what is compiled of a kernel for these types cannot be called from Python."""
    known = kernel.overloads.get(signature)
    return known is not None and isinstance(known.library, CalleeLibrary)


def let_be_callee(kernel):
    """Let numba compile a kernel as a callee where another kernel calls it."""
    add_overload = kernel.add_overload

    def flags_of_callees(flags):
        if has_caller():
            flags.no_compile = flags.no_cpython_wrapper = True
        return flags

    def add(result):
        if not isinstance(result.library, CalleeLibrary):
            add_overload(result)
            return
        if result.entry_point is None:    # compiled now, not read from the cache
            result = result._replace(entry_point=object())
            kernel.targetctx.insert_user_function(
                result.entry_point, result.fndesc, [result.library])
        kernel.overloads[tuple(result.signature.args)] = result
    kernel._compiler._customize_flags = flags_of_callees
    kernel.add_overload = add


class CalleeLibrary(JITCodeLibrary):
    """LLVM's code of a callee and of all that it calls, optimised, and no machine code."""

    def _finalize_final_module(self):
        self._finalize_dynamic_globals()
        self._finalized = True


class KernelCompiler(Compiler):
    """numba's compiler, with a library of their own for callees."""

    def __init__(self, typingctx, targetctx, library, args, return_type, flags, *others):
        if library is None and flags.no_compile:
            library = CalleeLibrary(targetctx.codegen(), 'callee')
        super().__init__(typingctx, targetctx, library, args, return_type, flags, *others)


class _CalleeCacheImpl(CompileResultCacheImpl):

    def get_filename_base(self, fullname, abiflags):
        return f'callee-{super().get_filename_base(fullname, abiflags)}'

    def reduce(self, result):
        described = result.fndesc
        described.typemap = described.calltypes = None    # cannot be pickled, not needed any more
        code = result.library._final_module.as_bitcode()
        return code, described, result.signature, result.reload_init

    def rebuild(self, target_context, reduced):
        code, described, signature, reload_init = reduced
        for start in reload_init:
            start()
        library = CalleeLibrary(target_context.codegen(), 'callee')
        library._final_module = binding.parse_bitcode(code)
        library._finalize_final_module()
        return compile_result(
            typing_context=target_context.typing_context, target_context=target_context,
            entry_point=object(), library=library, signature=signature, objectmode=False,
            lifted=(), fndesc=described, reload_init=reload_init)


class CalleeCache(FunctionCache):
    """numba's cache of one kernel, for its code as a callee."""

    _impl_class = _CalleeCacheImpl
