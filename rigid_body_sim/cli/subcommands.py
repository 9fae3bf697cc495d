# SPDX-License-Identifier: Apache-2.0
"""The table of subcommands, which `ros2 run`, the program and `python -m` share.

setup.py runs this file alone, so it imports nothing. Each function takes the list of arguments
(default: those of the process) and returns the exit status: 0 good, 1 a check failed, 2 bad input.
"""

SUBCOMMANDS = {
    'sim_node': ('rigid_body_sim.node.sim_node:main',
                 'run a scene as a ROS 2 node: topics, commands, recording'),
    'lifecycle_sim_node': ('rigid_body_sim.node.lifecycle_sim_node:main',
                           'run the node in its managed form: configure, activate, ...'),
    'run': ('rigid_body_sim.cli.run:main',
            'run the node for a while, record it, and report: what `make run` does'),
    'view': ('rigid_body_sim.view.subcommand:main',
             'show the body in a browser: a scene, a node or a recording; push it with the mouse'),
    'simulate': ('rigid_body_sim.cli.simulate:main',
                 'run a scene to a recording as fast as it goes'),
    'replay': ('rigid_body_sim.node.replay:main',
               'publish a recording on its topics again, at its pace or another'),
    'analyze': ('rigid_body_sim.analysis.analyze:main',
                'make a report of recordings: an interactive page, figures, numbers'),
    'resimulate': ('rigid_body_sim.analysis.resimulate:main',
                   'run the scene and commands of a recording again, and compare the bits'),
    'recover': ('rigid_body_sim.recording.recover:main', 'make a cut recording whole'),
    'export': ('rigid_body_sim.recording.export:main',
               'convert a recording to CSV, Parquet or NumPy'),
    'work_precision': ('rigid_body_sim.study.precision.work_precision:main',
                       'measure error against CPU time: every method, and the peers'),
    'check_scenes': ('rigid_body_sim.study.check_scenes:main',
                     'run every system of the notes and measure what theory predicts'),
    'hard_cases': ('rigid_body_sim.study.hard_cases.hard_cases:main',
                   'make the table of hard cases, ours and the peers'),
    'sweep': ('rigid_body_sim.cli.sweep:main',
              'run a scene over grids or samples of its keys, to Zarr or Parquet; resumes'),
    'scenes': ('rigid_body_sim.cli.scenes:main',
               'list the scenes, their effects and the methods that can run them'),
}

MISSING = {
    'rclpy': 'it needs ROS 2: source a ROS 2 Jazzy, or pip install ".[ros]" in the source tree',
    'mcap': 'recordings need it: pip install mcap',
    'matplotlib': 'figures need it: pip install ".[plots]" in the source tree, or pip install '
                  'matplotlib',
    'viser': 'the view needs it: pip install ".[view]" in the source tree, or pip install viser',
    'xarray': 'sweeps need it: pip install ".[sweep]" in the source tree',
}
"""The line printed where a package that a subcommand needs is absent."""
