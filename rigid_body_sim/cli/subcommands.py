"""The table of commands: `ros2 run rigid_body_sim NAME` and `python -m rigid_body_sim NAME` run the same functions.

It is read by setup.py, so it imports nothing. Each function takes the list of arguments (default: those of the process) and returns the exit
status: 0 good, 1 a check failed, 2 bad input.
"""

COMMANDS = {
    'sim_node': ('rigid_body_sim.node.sim_node:main', 'run a scene as a ROS 2 node: topics, commands, recording'),
    'lifecycle_sim_node': ('rigid_body_sim.node.lifecycle_sim_node:main', 'the node in its managed form: configure, activate, ...'),
    'run': ('rigid_body_sim.cli.run:main', 'run the node for a while, record it, and report: what `make run` does'),
    'simulate': ('rigid_body_sim.cli.simulate:main', 'run a scene to a recording as fast as it goes'),
    'replay': ('rigid_body_sim.node.replay:main', 'a recording back onto its topics, at its pace or another'),
    'analyze': ('rigid_body_sim.analysis.analyze:main', 'recordings to reports: an interactive page, figures, numbers'),
    'resimulate': ('rigid_body_sim.analysis.resimulate:main', "a recording's scene and commands run again: the same bits, or where they part"),
    'recover': ('rigid_body_sim.recording.recover:main', 'make a cut recording whole'),
    'export': ('rigid_body_sim.recording.export:main', 'a recording to CSV, Parquet or NumPy'),
    'work_precision': ('rigid_body_sim.study.precision.work_precision:main', 'error against CPU time: every method, and the peers'),
    'check_scenes': ('rigid_body_sim.study.check_scenes:main', 'run every system of the notes and measure what theory predicts'),
    'hard_cases': ('rigid_body_sim.study.hard_cases.hard_cases:main', 'the table of hard cases, ours and the peers'),
    'scenes': ('rigid_body_sim.cli.scenes:main', 'list the scenes, their effects and the methods that can run them'),
}
