# SPDX-License-Identifier: Apache-2.0
"""The program: ``rigid_body_sim NAME ...``, also ``python -m rigid_body_sim NAME ...``."""

import importlib
import os
import sys

from rigid_body_sim.cli.subcommands import MISSING, SUBCOMMANDS
from rigid_body_sim.command_line import BAD_INPUT, GOOD, interruptible
from rigid_body_sim.errors import nearest

PROGRAM = 'rigid_body_sim'


def main(arguments=None):
    """Run the subcommand that the first argument names; return its exit status."""
    return interruptible(_main, sys.argv[1:] if arguments is None else arguments)


def __getattr__(name):
    """Return the function of a subcommand: what ``ros2 run rigid_body_sim NAME`` calls.

    Its modules are imported when it is called.
    """
    if name not in SUBCOMMANDS:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    return lambda: main([name, *sys.argv[1:]])


def _main(arguments):
    if not arguments or arguments[0] in ('-h', '--help'):
        _show_subcommands()
        return GOOD
    if arguments[0] == '--version':
        from rigid_body_sim.recording.about import version
        print(f'{PROGRAM} {version()}')
        return GOOD
    if arguments[0] == '--completion':
        from rigid_body_sim.cli import completion
        return completion.main(arguments[1:])
    name = arguments[0]
    if name not in SUBCOMMANDS:
        near = nearest(name, SUBCOMMANDS)
        hint = f'did you mean {near}?' if near else f'the subcommands are {", ".join(SUBCOMMANDS)}'
        print(f'{PROGRAM}: no subcommand {name!r}; {hint}', file=sys.stderr)
        return BAD_INPUT
    module, _, function = SUBCOMMANDS[name][0].partition(':')
    sys.argv = [name, *arguments[1:]]
    try:
        return getattr(importlib.import_module(module), function)()
    except ModuleNotFoundError as error:
        package = (error.name or '').partition('.')[0]
        if package not in MISSING:
            raise
        print(f'{PROGRAM} {name}: the package {package} is not installed; {MISSING[package]}',
              file=sys.stderr)
        return BAD_INPUT


def _show_subcommands():
    program = PROGRAM if os.path.basename(sys.argv[0]) == PROGRAM else f'python -m {PROGRAM}'
    print(f'usage: {program} NAME [options]      ({program} NAME --help says more)\n')
    for name, (_, about) in SUBCOMMANDS.items():
        print(f'  {name:20} {about}')
    print('\n  --version            show the version'
          '\n  --completion SHELL   print the completion script for bash or zsh')


if __name__ == '__main__':
    sys.exit(main())
