"""`python -m rigid_body_sim NAME ...`: run a command of the table."""

import difflib
import importlib
import sys

from rigid_body_sim.cli.subcommands import COMMANDS


def main(arguments=None):
    """Run the command that the first argument names; return its exit status."""
    arguments = sys.argv[1:] if arguments is None else arguments
    if not arguments or arguments[0] in ('-h', '--help'):
        print('usage: python -m rigid_body_sim NAME [options]      (NAME --help says more)\n')
        for name, (_, about) in COMMANDS.items():
            print(f'  {name:20} {about}')
        return 0
    name = arguments[0]
    if name not in COMMANDS:
        near = difflib.get_close_matches(name, COMMANDS, 1)
        print(f'rigid_body_sim: no command {name!r}; {f"did you mean {near[0]}?" if near else "the commands are " + ", ".join(COMMANDS)}',
              file=sys.stderr)
        return 2
    module, _, function = COMMANDS[name][0].partition(':')
    sys.argv = [name, *arguments[1:]]
    return getattr(importlib.import_module(module), function)()


if __name__ == '__main__':
    sys.exit(main())
