# SPDX-License-Identifier: Apache-2.0
"""Draw mutants of the package by a seed, test each, print those that survive, and the rate.

::

    python test/mutants.py                             # 100 of seed 1; make mutants
    python test/mutants.py --seed 7 --count 20 rigid_body_sim/mechanics

A mutant is the package with one small change of its code: a sign, a factor, a comparison, min for
max, `and` for `or`, a number, a neighbouring name (x2 for x3). Each kind is drawn as often as the
others. The change is made in a copy of the tree. Tests run in plain Python: it starts in a second,
where compiling takes minutes. Where covering.py has noted which tests and digests run the line,
these come first, the quickest ones before the others; then the tests next to the file, those of
its room, and wider ones, which run the kernels that are compiled already if the change is in none
of them. The first test that fails finds the mutant, if that test passes on what
is not mutated; so does one that hangs. Mutants that change no answer are named in
equivalent_mutants.yaml, and do not count. Exit status 1 if fewer than 95 % are found.

Why no library: mutmut (3.8) replaces each function by a switch between all its mutants, which
neither numba nor compilation/templates.py, which rewrites sources, can take; Cosmic Ray (8.7) runs
one test command for every mutant, and draws no sample. The drawing below takes fewer lines than it
would take to work around these limits.
"""

import argparse
import ast
import collections
import concurrent.futures
import contextlib
import copy
import functools
import json
import os
import pathlib
import queue
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import typing

import covering
import yaml

from rigid_body_sim.compilation.environment import KERNEL_SOURCES

ROOT = pathlib.Path(__file__).resolve().parents[1]
PACKAGE = 'rigid_body_sim'
EQUIVALENT = pathlib.Path(__file__).with_name('equivalent_mutants.yaml')
ELSEWHERE = ('study/precision/peers/', 'study/hard_cases/contact_engines.py',
             'numerics/make_functions.py', 'study/precision/make_')
"""Not drawn from: other engines, which the tests do not install, and what makes stored tables."""
WANTED = 0.95
PATIENCE = 120      # s, a test; the tests next to a change take seconds
LONGEST = 1800      # s, all tests of a stage
FEW = 12            # files of tests that import what is changed, and are near
IN_VAIN = 200       # draws of a kind in a row that give nothing new: it has no more
AT_FIRST = 15.0     # s, of tests and of digests that run the line, before the others of them

DIGESTS = 'test/test_digests.py::test_without_numba_the_bits_are_the_same'
FIRST_DIGEST = """
import sys
from rigid_body_sim.simulation import arithmetic
from rigid_body_sim.study.machines import cases, digests
table, kept = cases.cases(), arithmetic.digests()
names = sorted(table, key=lambda name: hash(tuple(map(ord, name))))
sys.exit(any({part: digests.digest(of) for part, of in table[name].run().items()} != kept[name]
             for name in names))
"""
"""The same as the test DIGESTS, but it ends at the first digest that differs."""
WIDER = {
    'compilation': (DIGESTS, 'test/numerics', 'test/motions'),
    'numerics': (DIGESTS, 'test/motions', 'test/theory'),
    'scene': (DIGESTS, 'test/simulation', 'test/motions', 'test/hard_cases/test_12_fuzzing.py'),
    'theory': ('test/study/test_check_scenes.py', 'test/analysis'),
    'mechanics': (DIGESTS, 'test/simulation', 'test/motions', 'test/integrators'),
    'motions': (DIGESTS, 'test/simulation'),
    'integrators': (DIGESTS, 'test/simulation', 'test/hard_cases/test_13_stiff.py'),
    'choice': ('test/simulation', 'test/cli'),
    'simulation': (DIGESTS, 'test/analysis', 'test/sweeps'),
    'drawing': ('test/messages', 'test/view'),
    'messages': ('test/recording', 'test/simulation'),
    'recording': ('test/analysis',),
    'study': ('test/hard_cases/test_command.py', 'test/hard_cases/test_questions.py',
              'test/test_digests.py'),
    'realtime': ('test/node',),
    'cli': ('test/test_command_line.py',),
    'command_line': ('test/test_command_line.py',),
    'errors': ('test/test_command_line.py', 'test/scene'),
    'testing': ('test/test_extending.py',),
}
"""Room -> what else runs: first the digests, the rest when its own tests have found nothing."""
SLOW = ('test/choice/test_choose.py', 'test/integrators/marching/test_convex_body.py',
        'test/integrators/methods/test_methods.py', 'test/integrators/methods/test_gauss16.py',
        'test/integrators/methods/test_dop8.py', 'test/integrators/test_smooth_scenes.py',
        'test/recording/test_recover.py', 'test/recording/test_flips.py',
        'test/motions/test_relaxing.py', 'test/study/test_check_scenes.py',
        'test/view/test_page.py', 'test/view/test_push_node.py', 'test/sweeps/test_killed.py')
"""They take minutes in plain Python, or drive a browser: they come after what takes seconds."""
FAR = SLOW[-3:]    # not near anything


# ---------------------------------------------------------------------------- what is mutated

class Mutant(typing.NamedTuple):
    """A change of the code: where it is, the statement before and after, the new source.

    One of the lines `begin` to `end` is run when the changed code is.
    """

    file: str
    line: int
    begin: int
    end: int
    function: str
    kind: str
    before: str
    after: str
    source: str

    def __str__(self):
        place = f'{self.file}:{self.line}' + f' ({self.function})' * bool(self.function)
        return f'{place}\n    - {self.before}\n    + {self.after}'


class Site(typing.NamedTuple):
    """A node that can be changed, what it becomes, and where it stands."""

    kind: str
    node: ast.AST
    becomes: tuple
    statement: ast.AST
    function: str


SIGNS = {ast.Add: ast.Sub, ast.Sub: ast.Add}
FACTORS = {ast.Mult: ast.Div, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult, ast.Mod: ast.Mult,
           ast.Pow: ast.Mult, ast.LShift: ast.RShift, ast.RShift: ast.LShift,
           ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd}
COMPARISONS = {
    ast.Lt: (ast.LtE, ast.Gt), ast.LtE: (ast.Lt, ast.GtE), ast.Gt: (ast.GtE, ast.Lt),
    ast.GtE: (ast.Gt, ast.LtE), ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,), ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,), ast.In: (ast.NotIn,), ast.NotIn: (ast.In,)}
CALLS = {'min': 'max', 'max': 'min', 'any': 'all', 'all': 'any', 'minimum': 'maximum',
         'maximum': 'minimum', 'sin': 'cos', 'cos': 'sin', 'argmin': 'argmax', 'argmax': 'argmin',
         'floor': 'ceil', 'ceil': 'floor', 'bisect_left': 'bisect_right',
         'bisect_right': 'bisect_left'}


def _changed(node, **fields):
    other = copy.copy(node)
    for name, value in fields.items():
        setattr(other, name, value)
    return other


def _operators(node):
    """Return the kind and the nodes that a node with an operator may become."""
    if isinstance(node, (ast.BinOp, ast.AugAssign)):
        if isinstance(node.op, ast.Mod) and isinstance(node.left, ast.Constant):
            return None    # formats a text
        for kind, table in (('sign', SIGNS), ('factor', FACTORS)):
            if type(node.op) in table:
                return kind, [_changed(node, op=table[type(node.op)]())]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.Not)):
        return 'sign' if isinstance(node.op, ast.USub) else 'logic', [node.operand]
    if isinstance(node, ast.BoolOp):
        return 'logic', [_changed(node, op=ast.Or() if isinstance(node.op, ast.And)
                                  else ast.And())]
    if isinstance(node, ast.Compare):
        return 'comparison', [
            _changed(node, ops=[*node.ops[:k], other(), *node.ops[k + 1:]])
            for k, operator in enumerate(node.ops) for other in COMPARISONS[type(operator)]]
    return None


def _values(node, names):
    """Return the kind and the nodes that a name, a call or a number may become."""
    if isinstance(node, ast.Constant) and isinstance(node.value, (bool, int, float)):
        value = node.value
        others = ([not value] if isinstance(value, bool) else [value + 1, value - 1]
                  if isinstance(value, int) else [2.0 * value, 0.5 * value] if value else [1.0])
        return 'number', [ast.Constant(other) for other in others]
    if isinstance(node, ast.Call):
        f = node.func
        name = f.id if isinstance(f, ast.Name) else f.attr if isinstance(f, ast.Attribute) else ''
        if name in CALLS:
            return 'call', [_changed(node, func=_changed(
                f, **{'id' if isinstance(f, ast.Name) else 'attr': CALLS[name]}))]
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
        found = re.fullmatch(r'(.*?)(?:([0-9])|([xyz]))', node.id)
        if found:
            stem, others = found[1], '0123456789' if found[2] else 'xyz'
            kin = [stem + other for other in others
                   if stem + other != node.id and stem + other in names]
            return ('name', [ast.Name(name, ast.Load()) for name in kin]) if kin else None
    return None


def sites(tree):
    """Yield the sites of a module."""
    def names_in(node):
        return {part.id for part in ast.walk(node) if isinstance(part, ast.Name)} | {
            part.arg for part in ast.walk(node) if isinstance(part, ast.arg)}

    def visit(node, statement, function, names):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            function = f'{function}.{node.name}'.lstrip('.')
            if not isinstance(node, ast.ClassDef):
                names = names_in(node)
        if isinstance(node, (ast.stmt, ast.match_case)):
            statement = node
        found = _operators(node) or _values(node, names)
        if found:
            yield Site(found[0], node, tuple(found[1]), statement, function)
        for field, value in ast.iter_fields(node):
            # types say nothing to the machine, places inside of a text are wrong before
            # Python 3.12, and zip's strict=True acts where lengths differ, which they never do
            if (field in ('annotation', 'returns', 'decorator_list')
                    or isinstance(node, ast.JoinedStr)
                    or (isinstance(node, ast.keyword) and node.arg == 'strict')):
                continue
            for part in value if isinstance(value, list) else [value]:
                if isinstance(part, ast.AST):
                    yield from visit(part, statement, function, names)

    for statement in tree.body:
        guard = isinstance(statement, ast.If) and '__main__' in ast.unparse(statement.test)
        if not guard:
            yield from visit(statement, statement, '', set())


def _text(statement):
    """Return the text of a statement; of a compound one its head."""
    empty = {name: [] for name in ('orelse', 'finalbody', 'handlers', 'decorator_list')
             if hasattr(statement, name)}
    if hasattr(statement, 'body') and isinstance(statement.body, list):
        empty['body'] = [ast.Expr(ast.Constant(...))]
    if 'handlers' in empty:
        return 'try'
    return ast.unparse(_changed(statement, **empty)).removesuffix('...').strip()


def _run(site):
    """Return the first and the last line of which one is run when the code of a site is."""
    if isinstance(site.statement, (ast.FunctionDef, ast.ClassDef)):
        return site.statement.lineno, site.statement.end_lineno    # a default value
    return getattr(site.statement, 'lineno', site.node.lineno), site.node.end_lineno


def _put(statement, node, other):
    """Return a copy of a statement with one node replaced."""
    class Put(ast.NodeTransformer):
        def visit(self, part):
            return other if part is node else self.generic_visit(part)

    def shallow(part):
        """Copy a tree, but for the node, so that it is still itself."""
        if part is node:
            return part
        if isinstance(part, list):
            return [shallow(one) for one in part]
        if isinstance(part, ast.AST):
            return _changed(part, **{name: shallow(value)
                                     for name, value in ast.iter_fields(part)})
        return part
    return Put().visit(shallow(statement))


def mutants_of(path, root=ROOT, among=None):
    """Return kind -> list of functions that make the mutants of a file.

    `among` holds texts: only of statements that have one of them.
    """
    text = path.read_text()
    lines = text.splitlines(keepends=True)
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line.encode()))
    data, found = text.encode(), collections.defaultdict(list)

    def make(site, other):
        node = site.node
        begin = starts[node.lineno - 1] + node.col_offset
        end = starts[node.end_lineno - 1] + node.end_col_offset
        new = ast.unparse(other)
        new = new if isinstance(other, (ast.stmt, ast.Name)) else f'({new})'
        source = (data[:begin] + new.encode() + data[end:]).decode()
        return Mutant(str(path.relative_to(root)), node.lineno, *_run(site), site.function,
                      site.kind, _text(site.statement),
                      _text(_put(site.statement, node, other)), source)

    text_of = functools.cache(_text)    # a statement has many sites
    for site in sites(ast.parse(text)):
        if among is not None and not any(one in text_of(site.statement) for one in among):
            continue
        found[site.kind].append(lambda chance, site=site: make(site, chance.choice(site.becomes)))
    return found


def drawn(seed, count, folders):
    """Return `count` mutants, the kinds in turn as long as they have any."""
    chance, kinds = random.Random(seed), collections.defaultdict(list)
    for folder in folders:
        base = ROOT / folder
        for path in sorted(base.rglob('*.py')) if base.is_dir() else [base]:
            inside = str(path.relative_to(ROOT / PACKAGE))
            if not inside.startswith(ELSEWHERE):
                for kind, makers in mutants_of(path).items():
                    kinds[kind] += makers
    names, found, seen = sorted(kinds), [], set()
    total = sum(map(len, kinds.values()))
    print(f'{total} places, ' + ', '.join(f'{len(kinds[name])} of kind {name}' for name in names))
    in_vain = 0
    while names and len(found) < min(count, total):
        name = names[len(found) % len(names)]
        mutant = chance.choice(kinds[name])(chance)
        # some are not even a change of the code: -0.0 for 0.0 in another spelling, a text
        if mutant.source not in seen and mutant.before != mutant.after:
            seen.add(mutant.source)
            found.append(mutant)
            in_vain = 0
        else:
            in_vain += 1
            if in_vain == IN_VAIN:
                names.remove(name)
                in_vain = 0
    return found


def why_equivalent(mutant, table):
    """Return the reason why a mutant changes no answer, or None."""
    for entry in table:
        place = entry['file'], entry.get('function', ''), entry['statement'] in mutant.before
        becomes = entry.get('becomes', [mutant.after])
        if place == (mutant.file, mutant.function, True) and any(
                text in mutant.after and text not in mutant.before for text in becomes):
            return entry['because']
    return None


# ---------------------------------------------------------------------------- what is run

def stages(file, root=ROOT, near=False):
    """Return lists of tests that bear on a file of the package, the nearest first.

    Near are the tests of its name, a few of its room that import it, and the digests; where there
    are no such tests, those of its folder and its room that do not take minutes.
    """
    parts = pathlib.PurePath(file).with_suffix('').parts[1:]
    room, stem, tests = parts[0], parts[-1], root / 'test'
    module = '.'.join((PACKAGE, *parts)).removesuffix('.__init__')
    words = re.compile(rf'{re.escape(module)}\b|from {re.escape(module.rpartition(".")[0])} import'
                       rf'[^\n]*(\([^)]*)?\b{stem}\b')
    of_room = sorted(tests.joinpath(room).rglob('test_*.py'))
    named = [path for path in (of_room if parts[1:] else sorted(tests.glob('test_*.py')))
             if f'{path.stem}_'.startswith(f'test_{stem}_')]
    if parts[:2] == ('study', 'hard_cases'):
        named = sorted(tests.glob('hard_cases/test_[01][0-9]_*.py'))[:10]    # its groups
    importing = [path for path in sorted(tests.rglob('test_*.py'))
                 if path not in named and words.search(path.read_text())
                 and (path.parent.name not in ('node', 'hard_cases') or room == 'node')]
    wider, lists = WIDER.get(room, ()), [
        named, [path for path in importing if path in of_room],
        [path for path in of_room if path not in (*named, *importing)],
        [path for path in importing if path not in of_room]]
    lists = [[str(path.relative_to(root)) for path in paths] for paths in lists]
    quick = [[path for path in paths if path not in SLOW] for paths in lists]
    digests = [test for test in wider if test == DIGESTS]
    if near and file.startswith(f'{PACKAGE}/study/machines/'):
        digests = [DIGESTS]    # what makes them
    if near:
        folder = tests.joinpath(*parts[:-1])
        beside = sorted(quick[2], key=lambda path: root.joinpath(path).parent != folder)
        last = [] if quick[0] or quick[1] else beside
        return [stage for stage in (quick[0], quick[1][:FEW], digests, last) if stage]
    found = [quick[0], digests, *quick[1:],
             [path for paths in lists for path in paths if path in SLOW],
             *([test] for test in wider if test != DIGESTS)]
    return [stage for stage in found if stage]


def in_kernels(file):
    """Return whether a change of the file compiles all kernels anew."""
    return file.removeprefix(f'{PACKAGE}/').startswith(KERNEL_SOURCES)


def attempts(mutant, near=False):
    """Return what is run for a mutant, in turn: chosen tests and digests, then the stages.

    If only what is near is wanted, the quickest of the chosen are followed by the tests of its
    room that are not noted; those of a kernel by the tests that have its name. Where nothing is
    noted, it is the stages that are near.
    """
    noted = covering.covering(mutant.file, mutant.begin, mutant.end)
    noted = dict(sorted(noted.items(), key=lambda item: item[1]))
    parts = pathlib.PurePath(mutant.file).parts
    room, stem = parts[1], pathlib.PurePath(mutant.file).stem
    digests = {name: took for name, took in noted.items() if name.startswith(covering.DIGEST)}
    beside = {name: took for name, took in noted.items() if f'test_{stem}' in name} | {
        name: took for name, took in noted.items() if name.startswith(f'test/{room}/')}
    tests = beside | {name: took for name, took in noted.items() if name not in digests}
    (first, later), (digests, more) = _shared_out(tests), _shared_out(digests)
    found = [first, digests, more, later] if beside else [digests, first, more, later]
    found = [one for one in found if one and not (near and one in (more, later))]
    if not (near and found):
        return found + stages(mutant.file, near=near)
    of_own = stages(mutant.file)[:1] if in_kernels(mutant.file) else [
        stage for stage in stages(mutant.file) if not set(stage) & set(WIDER.get(room, ()))]
    left = [[path for path in stage if path not in (*covering.noted_files(), *FAR)]
            for stage in of_own]
    return found + [stage for stage in left if stage]


def _shared_out(names):
    """Return those of the names that take AT_FIRST together, and the others."""
    first, took = {}, 0.0
    for name, seconds in names.items():
        if took + seconds <= AT_FIRST:
            first[name], took = seconds, took + seconds
    return first, {name: seconds for name, seconds in names.items() if name not in first}


class Tree:
    """A copy of the repository in which a mutant can be tested."""

    def __init__(self, folder):
        self.folder, self._run, self.closed = pathlib.Path(folder) / 'tree', None, False
        shutil.copytree(ROOT, self.folder, symlinks=True, ignore=shutil.ignore_patterns(
            '.venv*', '.git', '.cache', '.*_cache'))
        (self.folder / '.venv').symlink_to(ROOT / '.venv')
        self.environment = {name: value for name, value in os.environ.items()
                            if not name.startswith('PYTEST')}
        self.environment |= {
            'PYTHONPATH': f'{self.folder}:{self.folder}/test', 'OMP_NUM_THREADS': '1',
            'PYTHONDONTWRITEBYTECODE': '1',
            # those of other packages take longer to import than most tests to run
            'PYTEST_DISABLE_PLUGIN_AUTOLOAD': '1', 'PYTEST_PLUGINS': 'pytest_timeout'}
        self._plain = {'NUMBA_DISABLE_JIT': '1',
                       'XDG_CACHE_HOME': str(pathlib.Path(folder) / 'cache')}

    def end(self):
        """Kill the processes that run."""
        if self._run:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self._run.pid, signal.SIGKILL)

    def failing(self, tests, without=(), compiled=False):
        """Return the first test that fails, None if all pass, or 'a hang'.

        Parameters
        ----------
        tests : list or dict
            Files and names of tests, or name -> CPU seconds of those that covering.py chose.
        without : iterable
            Tests of files that do not run.
        compiled : bool
            Whether numba compiles, where it has not done so before.
        """
        if self.closed:
            return None
        chosen = self.folder.parent / 'chosen.json'
        if isinstance(tests, dict):
            chosen.write_text(json.dumps(tests))
        left_out = [part for test in without for part in ('--deselect', test)]
        command = ['-m', 'pytest', '-q', '-x', '-p', 'no:cacheprovider', '--timeout',
                   str(PATIENCE), '--tb', 'no', '-rfE', *left_out, *tests]
        if isinstance(tests, dict):
            command = ['test/covering.py', '--judge', str(chosen)]
        elif tests == [DIGESTS]:
            command = ['-c', FIRST_DIGEST]
        self._run = run = subprocess.Popen(
            [sys.executable, '-W', 'ignore', *command],
            cwd=self.folder, env=self.environment | ({} if compiled else self._plain), text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)
        try:
            output, _ = run.communicate(timeout=LONGEST)
        except subprocess.TimeoutExpired:
            self.end()
            run.communicate()
            return 'a hang'
        finally:
            self.end()    # what a failed test left behind
        if run.returncode in (0, 5):
            return None
        if tests == [DIGESTS]:
            return DIGESTS
        found = re.search(r'^(?:FAILED|ERROR) ((?:digest: .*|\S+?\.py(?:::\w+)*))', output,
                          re.MULTILINE)
        return found[1] if found else f'pytest itself (status {run.returncode})'


class Trial:
    """Tests mutants, each in one of a few trees."""

    def __init__(self, folder, near, processes):
        self._trees, self._sound, self._near, self._ended = queue.Queue(), {}, near, False
        self._all = [Tree(pathlib.Path(folder) / str(number)) for number in range(processes)]
        for tree in self._all:
            self._trees.put(tree)

    def end(self):
        """End what runs, and begin no more."""
        self._ended = True
        for tree in self._all:
            tree.closed = True
            tree.end()

    def found_by(self, mutant):
        """Return (the test that finds a mutant, or None; the s that this took)."""
        tree, begin = self._trees.get(), time.monotonic()
        path = tree.folder / mutant.file
        original, stamp = path.read_text(), path.stat()
        try:
            left = attempts(mutant, self._near)
            while left and not self._ended:
                path.write_text(mutant.source)
                unsound = {test for test, sound in self._sound.items() if not sound}
                if isinstance(left[0], dict):
                    left[0] = {name: took for name, took in left[0].items()
                               if name.partition('[')[0] not in unsound}
                compiled = not (in_kernels(mutant.file) or isinstance(left[0], dict))
                failing = tree.failing(left[0], unsound, compiled) if left[0] else None
                path.write_text(original)
                os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
                if failing is None:
                    left.pop(0)
                elif failing.startswith(covering.DIGEST) or self._passes(
                        failing if '.py' in failing else '\n'.join(left[0]), tree, compiled):
                    return failing, time.monotonic() - begin
                elif left[0] == [failing] or '.py' not in failing:
                    left.pop(0)    # what is left out next time is all of it
            return None, time.monotonic() - begin
        finally:
            path.write_text(original)
            os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
            self._trees.put(tree)

    def _passes(self, test, tree, compiled):
        """Return whether a test, or some that run lines, pass on what is not mutated."""
        if test in covering.short():
            return True
        if test not in self._sound:
            self._sound[test] = tree.failing(test.split('\n'), (), compiled) is None
            if not self._sound[test]:
                print(f'{test} fails on what is not mutated', flush=True)
        return self._sound[test]


def main():
    """Run the command; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('--seed', default='1', help='default: 1')
    parser.add_argument('--count', type=int, default=100, help='default: 100')
    parser.add_argument('--processes', type=int, default=2, help='default: 2')
    parser.add_argument('--near', action='store_true',
                        help='run the nearest tests only, for a lower bound of the rate')
    parser.add_argument('folders', nargs='*', default=[PACKAGE], help='default: all')
    options = parser.parse_args()
    table = yaml.safe_load(EQUIVALENT.read_text()) or []
    mutants = drawn(options.seed, options.count, options.folders)
    survivors, begin = [], time.monotonic()
    counted = [mutant for mutant in mutants if not why_equivalent(mutant, table)]
    for mutant in mutants:
        if mutant not in counted:
            print(f'equivalent: {mutant}\n    {why_equivalent(mutant, table)}', flush=True)
    with (tempfile.TemporaryDirectory() as folder,
          concurrent.futures.ThreadPoolExecutor(options.processes) as pool):
        trial = Trial(folder, options.near, options.processes)
        waiting = {pool.submit(trial.found_by, mutant): mutant for mutant in counted}
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
        try:
            for done in concurrent.futures.as_completed(waiting):
                mutant, (test, took) = waiting[done], done.result()
                if test is None:
                    survivors.append(mutant)
                print(f'{test or "SURVIVES"} ({took:.0f} s): {mutant}', flush=True)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            trial.end()
            raise
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    rate = 1.0 - len(survivors) / len(counted) if counted else 1.0
    for mutant in survivors:
        print(f'survivor: {mutant}')
    print(f'seed {options.seed}: {len(counted) - len(survivors)} of {len(counted)} mutants found, '
          f'{100.0 * rate:.1f} %; {len(mutants) - len(counted)} equivalent ones; '
          f'{time.monotonic() - begin:.0f} s, {used.ru_utime + used.ru_stime:.0f} s of CPU')
    return rate < WANTED


if __name__ == '__main__':
    sys.exit(main())
