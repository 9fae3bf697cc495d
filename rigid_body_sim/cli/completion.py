# SPDX-License-Identifier: Apache-2.0
"""The completion script of the program: names of subcommands, options, scenes.

The script holds all words, so completion starts no Python. The options are those that the help
of each subcommand shows; a subcommand whose packages are absent completes without them.
"""

import contextlib
import importlib
import io
import re

from rigid_body_sim import command_line
from rigid_body_sim.cli.subcommands import SUBCOMMANDS
from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import scene_names

SHELLS = ('bash', 'zsh')

SCRIPT = """\
# completion of rigid_body_sim; bash: source it, or save it as
# ~/.local/share/bash-completion/completions/rigid_body_sim
_rigid_body_sim() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} words=
    if [ "$COMP_CWORD" -eq 1 ]; then
        words='{subcommands} --help --version --completion'
    elif [ "${{word#-}}" != "$word" ]; then
        case "${{COMP_WORDS[1]}}" in
{options}
        esac
    elif [ "$before" = --scene ] || [ "${{COMP_WORDS[1]}}" = scenes ]; then
        words='{scenes}'
    fi
    COMPREPLY=($(compgen -W "$words" -- "$word"))
}}
complete -o default -F _rigid_body_sim rigid_body_sim
"""


def script(shell):
    """Return the completion script for a shell."""
    options = '\n'.join(f"            {name}) words='{' '.join(options_of(name))}' ;;"
                        for name in SUBCOMMANDS)
    text = SCRIPT.format(subcommands=' '.join(SUBCOMMANDS), scenes=' '.join(scene_names()),
                         options=options)
    return text if shell == 'bash' else f'autoload -U +X bashcompinit && bashcompinit\n{text}'


def options_of(name):
    """Return the options that the help of a subcommand shows."""
    module, _, function = SUBCOMMANDS[name][0].partition(':')
    shown = io.StringIO()
    with contextlib.suppress(ImportError, SystemExit), contextlib.redirect_stdout(shown):
        getattr(importlib.import_module(module), function)(['--help'])
    return sorted(set(re.findall(r'(?<![\w-])--[a-z][a-z-]*', shown.getvalue())))


def main(arguments):
    """Print the script for the shell that the only argument names; return the exit status."""
    return command_line.run(_print, arguments)


def _print(arguments):
    if len(arguments) != 1 or arguments[0] not in SHELLS:
        raise BadInput('--completion', f'got {" ".join(arguments) or "nothing"}',
                       f'one of {", ".join(SHELLS)}')
    print(script(arguments[0]), end='')
    return command_line.GOOD
