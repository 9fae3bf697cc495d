# SPDX-License-Identifier: Apache-2.0
"""Kernel templates: one loop or stepper, bound to the functions of a motion or a kind of scene.

numba cannot cache kernels that are closed over other functions, so the binding is done in source.
A template is an ordinary module in which some names are declared ``NAME = UNBOUND``;
:func:`specialise` writes a module with those lines replaced by imports (or by source text) into
the cache folder, where its kernels are cached like any others. An effect that a scene does not
list is then not in its code at all.
"""

import functools
import hashlib
import importlib
import importlib.util
import inspect
import linecache
import re
import sys
import types
import uuid

from rigid_body_sim.compilation.environment import cache_folder

UNBOUND = None
_DECLARATION = re.compile(r'^(\w+) = UNBOUND\b.*$', re.MULTILINE)


def specialise(template, **bindings):
    """Return the template module with its unbound names bound.

    Parameters
    ----------
    template : module
        A module with lines ``NAME = UNBOUND``.
    bindings : str
        For each such name ``'package.module:function'``, or source text that defines the name
        (it contains a newline).

    Raises
    ------
    TypeError
        If a declared name is left unbound, or a name is given that the template does not
        declare.
    """
    return _bound(template, tuple(sorted(bindings.items())))


def imported(kernel, name):
    """Return the source line that imports a kernel, ``'package.module:function'``, under a name.

    The cache of compiled code knows the sources of this package. For a kernel of another package
    the line ends with a hash of its file, so that an edit there recompiles its callers.
    """
    module, _, function = kernel.partition(':')
    line = f'from {module} import {function} as {name}'
    if module.partition('.')[0] == __package__.partition('.')[0]:
        return line
    source = inspect.getsource(importlib.import_module(module))
    return f'{line}    # {hashlib.sha256(source.encode()).hexdigest()[:16]}'


@functools.cache
def _bound(template, bindings):
    source, bindings = inspect.getsource(template), dict(bindings)
    declared = set(_DECLARATION.findall(source))
    if declared != set(bindings):
        raise TypeError(f'{template.__name__} declares {sorted(declared)}, got {sorted(bindings)}')

    def definition(match):
        name = match.group(1)
        binding = bindings[name]
        if '\n' in binding:
            return binding
        module, _, function = binding.partition(':')
        return f'from {module} import {function} as {name}'

    return module_of(_DECLARATION.sub(definition, source), template.__name__.rpartition('.')[2])


def module_of(source, stem):
    """Import the source as a module.

    The source is written to the cache folder, where there is one, so that its compiled code is
    cached too.
    """
    name = f'{stem}_{hashlib.sha256(source.encode()).hexdigest()[:12]}'
    if name in sys.modules:
        return sys.modules[name]
    folder = cache_folder()
    if folder is None:
        module = types.ModuleType(name)
        module.__file__ = f'<{name}>'
        # lets tracebacks and inspect show the source
        linecache.cache[module.__file__] = (
            len(source), None, source.splitlines(keepends=True), module.__file__)
        exec(compile(source, module.__file__, 'exec'), module.__dict__)
    else:
        path = folder / f'{name}.py'
        if not path.exists():
            # threads and processes may write it at once
            partial = path.with_suffix(f'.{uuid.uuid4().hex}')
            partial.write_text(source)
            partial.replace(path)
        specification = importlib.util.spec_from_file_location(name, path)
        module = importlib.util.module_from_spec(specification)
        specification.loader.exec_module(module)
    return sys.modules.setdefault(name, module)
