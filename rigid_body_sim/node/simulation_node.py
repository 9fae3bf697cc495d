# SPDX-License-Identifier: Apache-2.0
"""The plain node, which runs from its start to its end."""

from rclpy.node import Node

from rigid_body_sim.node.answering import Answering
from rigid_body_sim.node.engine import Engine
from rigid_body_sim.node.parameters import Settings


class SimulationNode(Answering, Node):
    """Simulates, publishes, records and obeys commands from its construction on.

    Parameters
    ----------
    stop : shutdown.Stop
        Asked to end the process when the duration is over or the simulation fails.
    shared : set of str
        Names of parameters that may be meant for other nodes.
    options : dict
        Those of rclpy.node.Node.

    Raises
    ------
    BadInput
        One line, before anything runs.
    """

    def __init__(self, stop, shared=frozenset(), **options):
        super().__init__('sim_node', **options)
        self.answer_all()
        stop.last_resort = self.destroy_node
        self.engine = None
        try:
            self.engine = Engine(self, Settings(self, shared=shared), stop.request)
            self.engine.start()
        except BaseException:
            self.close()
            self.destroy_node()
            raise

    def close(self):
        """End ticks and recording, and report; return the exit status."""
        if self.engine is None:
            return 0
        return self.engine.close()
