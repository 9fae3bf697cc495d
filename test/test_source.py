# SPDX-License-Identifier: Apache-2.0
"""Rules for the source of the package: short functions, named places, nothing asked by its name.

The source is read, not run.
"""

import ast
import collections
import functools
import importlib
import pathlib
import pkgutil
import re
import types

from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators import METHODS
from rigid_body_sim.scene import constraints, effects

PACKAGE = pathlib.Path(__file__).resolve().parent.parent / 'rigid_body_sim'
LINES, ARGUMENTS = 40, 8
WHY_LINES, WHY_ARGUMENTS = 'More than forty lines:', 'More than eight arguments:'
SCALARS = ('scene/effects/',)
"""Where arguments are not counted: kernels of effects take the state as scalars, and their values
behind it (scene/effects/protocol.py), for generated code hands them registers."""
KERNELS = ('mechanics/', 'motions/', 'integrators/', 'simulation/admission.py')
TABLEAUX = ('integrators/marching/contact_step.py',)
"""Where numbers count as places: the stages of a tableau."""
WIDEST = 3
"""The last component of a vector or quaternion: a larger literal is a place in something flat."""


@functools.cache
def sources():
    """Return (path below the package, lines, tree) of each source file."""
    found = []
    for path in sorted(PACKAGE.rglob('*.py')):
        text = path.read_text()
        found.append((path.relative_to(PACKAGE).as_posix(), text.splitlines(), ast.parse(text)))
    return found


def functions(tree, docstrings=()):
    """Yield each function and the docstrings of it and of those around it.

    That of a class counts for what makes it.
    """
    for child in ast.iter_child_nodes(tree):
        around = docstrings
        if isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef)):
            own = [child, tree] if child.name == '__init__' else [child]
            around = (*docstrings, *(' '.join((ast.get_docstring(one) or '').split())
                                     for one in own))
            yield child, around
        yield from functions(child, around)


def code_lines(function, lines):
    """Return how many lines a function has, without its docstring, comments and empty lines."""
    first, skipped = function.body[0], range(0)
    if ast.get_docstring(function) is not None:
        skipped = range(first.lineno, first.end_lineno + 1)
    return sum(1 for number in range(function.lineno, function.end_lineno + 1)
               if number not in skipped and lines[number - 1].strip()
               and not lines[number - 1].strip().startswith('#'))


def test_a_long_function_says_why():
    wrong = []
    for path, lines, tree in sources():
        for function, docstrings in functions(tree):
            count = code_lines(function, lines)
            if count > LINES and not any(WHY_LINES in text for text in docstrings):
                wrong.append(f'{path}:{function.lineno} {function.name}: {count} lines, and no '
                             f'"{WHY_LINES} ..." in its docstring')
    assert wrong == []


def test_a_function_of_many_arguments_says_why():
    wrong = []
    for path, _, tree in sources():
        for function, docstrings in functions(tree):
            given = function.args
            names = [one.arg for one in (*given.posonlyargs, *given.args, *given.kwonlyargs)
                     if one.arg not in ('self', 'cls')]
            if len(names) > ARGUMENTS and not path.startswith(SCALARS) and not any(
                    WHY_ARGUMENTS in text for text in docstrings):
                wrong.append(f'{path}:{function.lineno} {function.name}: {len(names)} arguments, '
                             f'and no "{WHY_ARGUMENTS} ..." in its docstring')
    assert wrong == []


def literals(index):
    """Yield the parts of an index that are places typed by hand.

    They are a whole number beyond a vector, a sum with one (NAME + 2, at + 2), a slice of 2 or
    more ([:3]; 1 is what follows the first), and rows counted by a factor (3 * i + 1).
    """
    for one in index.elts if isinstance(index, ast.Tuple) else [index]:
        ends = [one.lower, one.upper] if isinstance(one, ast.Slice) else [one]
        for end in ends:
            if isinstance(one, ast.Slice) and isinstance(end, ast.Constant) and end.value > 1:
                yield end
            if isinstance(end, ast.BinOp) and any(
                    isinstance(part, ast.BinOp) and isinstance(part.op, ast.Mult)
                    and isinstance(part.left, ast.Constant) and part.left.value > 2
                    for part in ast.walk(end)):
                yield end
            if isinstance(end, ast.BinOp) and isinstance(end.op, ast.Add):
                left, right = end.left, end.right
                if isinstance(left, ast.Constant):    # 4 + i
                    left, right = right, left
                if (isinstance(left, ast.Name) and isinstance(right, ast.Constant)
                        and (left.id.isupper() or right.value > 1)):
                    yield end
            if isinstance(end, ast.Constant) and isinstance(end.value, int) and end.value > WIDEST:
                yield end


def test_places_in_flat_arrays_have_names():
    wrong = []
    for path, _, tree in sources():
        if path.startswith(KERNELS) and path not in TABLEAUX:
            wrong += [f'{path}:{part.lineno} {ast.unparse(part)}' for part in ast.walk(tree)
                      if isinstance(part, ast.Subscript) and any(literals(part.slice))]
    assert wrong == []


@functools.cache
def parts():
    """Return the classes of effects and constraints."""
    found = set()
    for room in (effects, constraints):
        for module in pkgutil.iter_modules(room.__path__):
            made = importlib.import_module(f'{room.__name__}.{module.name}')
            found |= {one for one in vars(made).values() if isinstance(one, type)
                      and isinstance(getattr(one, 'kind', getattr(one, 'name', None)), str)}
    return found


def words():
    """Return the words of effects, constraints and methods."""
    return {*METHODS, *(getattr(one, 'kind', getattr(one, 'name', None)) for one in parts())}


def test_nothing_is_asked_by_the_name_of_a_part():
    """Outside study/, which is about named scenes, no rule compares with the word of a part.

    testing.py checks what an effect books. What an Acting declares has words of its own: it
    `gives` a force, and `books` a potential.
    """
    parts, wrong = words(), []
    assert {'gravity', 'pivot', 'dop8'} <= parts
    for path, _, tree in sources():
        if path.startswith(('study/', 'testing.py')):
            continue
        for part in ast.walk(tree):
            asked = []
            if isinstance(part, ast.Compare) and all(
                    isinstance(one, (ast.Eq, ast.NotEq, ast.In, ast.NotIn)) for one in part.ops):
                asked = [part.left, *part.comparators]
            elif isinstance(part, ast.match_case):
                asked = [one.value for one in ast.walk(part.pattern)
                         if isinstance(one, ast.MatchValue)]
            elif isinstance(part, ast.Call) and isinstance(part.func, ast.Attribute) and (
                    part.func.attr == 'effect'):
                asked = part.args
            if asked and re.search(r'\b(gives|books)\b', ast.unparse(part)):
                continue
            for one in asked:
                named = [each.value for each in ast.walk(one) if isinstance(each, ast.Constant)]
                wrong += [f'{path}:{part.lineno} asks for {name!r}' for name in named
                          if isinstance(name, str) and name in parts]
    assert wrong == []


def calls(tree, function):
    """Yield the calls of a builtin function."""
    for part in ast.walk(tree):
        if isinstance(part, ast.Call) and isinstance(part.func, ast.Name) and (
                part.func.id == function):
            yield part


def test_nothing_is_asked_by_the_class_of_a_part():
    """Outside study/, as for names: a constraint and an effect are asked for what they declare."""
    classes, wrong = {one.__name__ for one in parts()}, []
    assert {'Gravity', 'Pivot', 'Hinge'} <= classes
    for path, _, tree in sources():
        if path.startswith('study/'):
            continue
        for call in (*calls(tree, 'isinstance'), *calls(tree, 'issubclass')):
            asked = {one.id for one in ast.walk(call.args[1]) if isinstance(one, ast.Name)}
            wrong += [f'{path}:{call.lineno} {ast.unparse(call)}' for _ in asked & classes]
    assert wrong == []


FOREIGN = ('compilation/', 'numerics/double_double.py', 'sweeps/engine.py')
"""Where hasattr is asked of Python, numba, a class of tuples and an executor: never of a part."""


def test_nothing_is_found_by_looking_for_an_attribute():
    wrong = [f'{path}:{call.lineno} {ast.unparse(call)}' for path, _, tree in sources()
             if not path.startswith(FOREIGN) for call in calls(tree, 'hasattr')]
    assert wrong == []


DECORATORS = {'compiled', 'compiled_inline', 'compiled_allocating', 'inlined'}
IN_VECTORS = {('integrators/marching/gauss_march.py', 'spread')}
"""Where each constant is worth a version: with its place known the matrix lies apart from the
stages, and the loop is vector code; with a place of run time it is not."""


def constant(argument, names, local):
    """Return the text of an argument that numba types as a literal, else None.

    That is a whole number or a bool, typed there or under a name of the module; in a template it
    may be a name that is bound later.
    """
    if isinstance(argument, ast.UnaryOp):    # -1
        argument = argument.operand
    if isinstance(argument, ast.Constant) and type(argument.value) in (int, bool):
        return ast.unparse(argument)
    if isinstance(argument, ast.Name) and argument.id not in local and (
            type(names.get(argument.id)) in (int, bool)
            or (argument.id.isupper() and names.get(argument.id, ...) is UNBOUND)):
        return argument.id
    return None


def kernels(lines, tree):
    """Yield the kernels of a source file."""
    if any(line.removeprefix('@') in DECORATORS for line in map(str.strip, lines)):
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef) and DECORATORS & {
                    one.id for one in node.decorator_list if isinstance(one, ast.Name)}:
                yield node


def handed_over():
    """Return {(module, kernel): {place of an argument: what kernels hand to it}}.

    What is no constant is None.
    """
    found = collections.defaultdict(lambda: collections.defaultdict(set))
    for path, lines, tree in sources():
        for kernel in kernels(lines, tree):
            names = vars(importlib.import_module(f'rigid_body_sim.{path[:-3].replace("/", ".")}'))
            local = {one.arg for one in kernel.args.args} | {
                one.id for one in ast.walk(kernel)
                if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)}
            for call in ast.walk(kernel):
                if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Name):
                    continue
                called = names.get(call.func.id, ...)
                if called is UNBOUND:
                    key = path, call.func.id
                elif isinstance(called, types.FunctionType) or hasattr(called, 'py_func'):
                    key = called.__module__, called.__name__
                else:
                    continue
                for place, argument in enumerate(call.args):
                    found[key][place].add(constant(argument, names, local))
    return found


def test_no_kernel_is_compiled_once_more_for_a_constant():
    """A literal has a type of its own in numba, which makes a version of the kernel.

    What int() returns has none.

    One version for the same constant at all calls is as good as none.
    """
    found = handed_over()
    assert len(found) > 300
    wrong = [f'{key} takes {sorted(map(str, kinds))} as argument {place}'
             for key, places in found.items() for place, kinds in places.items()
             if len(kinds) > 1 and kinds != {None} and key not in IN_VECTORS]
    assert wrong == []


def test_no_kernel_assigns_to_a_slice():
    """Without numba a slice is that of a memoryview, which takes no numbers."""
    seen, wrong = 0, []
    for path, lines, tree in sources():
        for kernel in kernels(lines, tree):
            seen += 1
            wrong += [f'{path}:{node.lineno}' for node in ast.walk(kernel)
                      if isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store)
                      and any(isinstance(one, ast.Slice) for one in ast.walk(node.slice))]
    assert seen > 300
    assert wrong == []


def test_a_reason_is_a_sentence():
    for path, lines, _ in sources():
        text = ' '.join(' '.join(lines).split())
        for why in (WHY_LINES, WHY_ARGUMENTS):
            for reason in re.findall(re.escape(why) + r' ([^"]*)', text):
                assert len(reason.partition('.')[0]) > 15, path
