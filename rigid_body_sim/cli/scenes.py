# SPDX-License-Identifier: Apache-2.0
"""The subcommand `scenes`: list the scenes, their effects, and the methods that can run them."""

import sys

from rigid_body_sim import command_line
from rigid_body_sim.choice.choose import methods_for
from rigid_body_sim.scene.json_schema import json_schema
from rigid_body_sim.scene.scene import load_scene, scene_names


def describe(scene):
    """Return name, text, constraint, effects and runnable methods of a scene as plain data."""
    return {'scene': scene.name, 'about': scene.about, 'constraint': scene.constraint.kind,
            'effects': [effect.name for effect in scene.effects], 'methods': methods_for(scene),
            'notes': scene.notes}


def main(arguments=None):
    """Run the subcommand; return the exit status."""
    parser = command_line.parser('scenes', 'List the scenes that ship, or describe one.',
                                 'python -m rigid_body_sim scenes tennis_racket')
    parser.add_argument('scene', nargs='*', help='names or .yaml files; default: all that ship')
    parser.add_argument('--json', action='store_true', help='print the list as JSON')
    parser.add_argument('--schema', action='store_true',
                        help='print the JSON Schema of scene files instead')
    return command_line.run(_list, parser.parse_args(arguments))


def _list(options):
    if options.schema:
        command_line.print_json(json_schema())
        return command_line.GOOD
    described = [describe(load_scene(name)) for name in options.scene or scene_names()]
    if options.json:
        command_line.print_json(described)
        return command_line.GOOD
    for scene in described:
        print(f'{scene["scene"]}: {scene["about"]}')
        effects, methods = (', '.join(scene[key]) for key in ('effects', 'methods'))
        print(f'    {scene["constraint"]}; effects: {effects or "none"}; methods: {methods}')
        for line in scene['notes']:
            print(f'    note: {line}')
    return command_line.GOOD


if __name__ == '__main__':
    sys.exit(main())
