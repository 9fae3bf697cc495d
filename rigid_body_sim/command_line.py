# SPDX-License-Identifier: Apache-2.0
"""What all commands share: the parser, the exit status of bad input, JSON with 17 digits."""

import argparse
import json
import os
import sys

from rigid_body_sim.errors import BadInput, NotConverged

GOOD, CHECK_FAILED, BAD_INPUT = 0, 1, 2


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        print(f'{self.prog}: {message}; {self.prog} --help shows how', file=sys.stderr)
        sys.exit(BAD_INPUT)


def parser(name, about, example):
    """Return an argument parser for a command, whose help ends with an example."""
    return _Parser(prog=name, description=about, epilog=f'example:\n  {example}',
                   formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False)


def run(function, arguments):
    """Run a command's function on its parsed arguments; return the exit status."""
    try:
        return function(arguments)
    except BadInput as error:
        print(error, file=sys.stderr)
        return BAD_INPUT
    except NotConverged as error:
        print(error, file=sys.stderr)
        return CHECK_FAILED
    except KeyboardInterrupt:
        print('interrupted', file=sys.stderr)
        return 130
    except BrokenPipeError:
        # the reader of our output has gone: nothing is left to tell it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return GOOD


def print_json(value):
    """Print a value as JSON; Python's repr of a double has the 17 digits that restore it."""
    print(json.dumps(value, indent=2, allow_nan=False))
