# SPDX-License-Identifier: Apache-2.0
"""The subcommand `view`: the body in a browser, moving, and pushed with the mouse."""

import pathlib
import sys

from rigid_body_sim import command_line
from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording.needed import need_mcap
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.view.access import LOCAL, Access


def main(arguments=None):
    """Run the subcommand; return the exit status."""
    parser = command_line.parser(
        'view', 'Open a page in which a body moves: a scene, a running node, or a recording. '
        'Drag the body to pull it, click it to strike it.',
        'python -m rigid_body_sim view heavy_top')
    parser.add_argument('what', nargs='*', metavar='SCENE or RECORDING',
                        help='a scene (tennis_racket), or one or two recordings, drawn together')
    parser.add_argument('--node', metavar='NAME', help='show and push a running node: /sim_node')
    parser.add_argument('--set', action='append', default=[], metavar='KEY=VALUE',
                        help='change of the scene, key.path=value; may be repeated')
    parser.add_argument('--rate', type=float, default=1000.0,
                        help='ticks per simulated second: commands act at ticks (1000)')
    parser.add_argument('--integrator', default='auto', help='method (auto)')
    parser.add_argument('--accuracy', type=float, default=1e-12,
                        help='error of the attitude that is asked for, rad (1e-12)')
    parser.add_argument('--output', metavar='FOLDER',
                        help='recording of a scene to make, pushes included; it must not exist '
                        'yet')
    parser.add_argument('--host', default=LOCAL,
                        help=f'address to listen on ({LOCAL}: this machine only); another one '
                        'puts a token into the address')
    parser.add_argument('--port', type=int, default=8080,
                        help='first port to try (8080); 0 is any free one')
    parser.add_argument('--dark', action='store_true', help='begin with a dark page')
    return command_line.run(_run, parser.parse_args(arguments))


def _run(options):
    with command_line.ending_like_ctrl_c():
        return _serve(options)


def _serve(options):
    """Serve the page until Ctrl-C or SIGTERM; return the exit status."""
    source = _source(options)
    try:
        # viser is needed from here on; it takes a second to import
        from rigid_body_sim.view.page import Page
        page = Page(source, Access(options.host), options.port, options.dark)
    except BaseException:
        source.close()
        raise
    page.await_client()
    print(f'{page.address}   (Ctrl-C ends it)', flush=True)
    try:
        page.run()
    except BaseException as end:
        # closed here, where another Ctrl-C is ignored
        page.close()
        if isinstance(end, KeyboardInterrupt):
            return command_line.GOOD
        raise
    page.close()
    return command_line.GOOD


def _source(options):
    """Return where the snapshots come from."""
    _refuse_output(options)
    recordings = [one for one in options.what if _is_recording(one)]
    if options.node:
        if options.what:
            raise BadInput('--node', f'got {options.what[0]!r} beside it',
                           'a node, or something else')
        from rigid_body_sim.view.node_source import NodeSource
        return NodeSource(options.node)
    if recordings:
        return _player(options.what, recordings)
    if len(options.what) > 1:
        raise BadInput('view', f'got {len(options.what)} scenes', 'one scene, or two recordings')
    from rigid_body_sim.view.live import Live
    scene = load_scene(options.what[0] if options.what else 'tennis_racket', options.set)
    settings = {'rate': options.rate, 'integrator': options.integrator,
                'accuracy': options.accuracy}
    return Live(scene.text, settings, options.output)


def _refuse_output(options):
    """Raise BadInput where the recording asked for cannot be made."""
    if options.output is None:
        return
    if options.node or any(map(_is_recording, options.what)):
        raise BadInput('--output', f'got {options.output!r} without a scene to run',
                       'the parameter record of the node, or the recording that is there')
    if pathlib.Path(options.output).exists():
        raise BadInput(options.output, 'exists already',
                       'the name of a recording that does not exist yet')
    need_mcap()


def _is_recording(name):
    path = pathlib.Path(name)
    return path.suffix == '.mcap' or path.is_dir()


def _player(names, recordings):
    if len(names) > 2 or len(recordings) < len(names):
        raise BadInput('view', f'got {", ".join(names)}', 'one recording, or two of them')
    from rigid_body_sim.view.player import Player
    player = Player(recordings[0])
    if len(recordings) == 2:
        player.beside = Player(recordings[1])
    return player


if __name__ == '__main__':
    sys.exit(main())
