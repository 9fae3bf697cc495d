# SPDX-License-Identifier: Apache-2.0
"""The managed node (ROS 2 lifecycle).

configure creates the scene, topics, services and recording; activate lets time pass, deactivate
stops it (commands wait, as in a pause), cleanup closes the recording and removes everything.
Parameters that are fixed while the node runs can change before configure.
"""

from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn

from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.node.answering import Answering
from rigid_body_sim.node.engine import Engine
from rigid_body_sim.node.parameters import Settings

INACTIVE = 'inactive'


class ManagedNode(Answering, LifecycleNode):
    """An engine created by configure, run by activate, paused by deactivate, removed by cleanup.

    Parameters
    ----------
    stop : shutdown.Stop
        Asked to end the process when the duration is over or the simulation fails.
    shared : set of str
        Names of parameters that may be meant for other nodes.
    options : dict
        Those of rclpy.lifecycle.LifecycleNode.
    """

    def __init__(self, stop, shared=frozenset(), **options):
        super().__init__('lifecycle_sim_node', **options)
        self.answer_all()
        stop.last_resort = self.destroy_node
        self._stop = stop
        self.engine = None
        try:
            self.settings = Settings(self, running=False, shared=shared)
        except BaseException:
            self.destroy_node()
            raise

    def on_configure(self, state):
        """Create everything; a wrong parameter gets one line and leaves the node unconfigured."""
        try:
            self.engine = Engine(self, self.settings, self._stop.request)
        except (BadInput, NotConverged) as refusal:
            self.get_logger().error(str(refusal))
            return TransitionCallbackReturn.FAILURE
        self.settings.running = True
        self.engine.ticker.pause(INACTIVE)
        self.engine.start()
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        """Let time pass."""
        self.engine.ticker.resume(INACTIVE)
        return super().on_activate(state)

    def on_deactivate(self, state):
        """Stop time."""
        self.engine.ticker.pause(INACTIVE)
        return super().on_deactivate(state)

    def on_cleanup(self, state):
        """Close the recording and remove everything."""
        self.close()
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state):
        """Close the recording, remove everything, and end the process."""
        self.close()
        self._stop.request()
        return TransitionCallbackReturn.SUCCESS

    def close(self):
        """End ticks and recording, and report; return the exit status."""
        if self.engine is None:
            return 0
        engine, self.engine = self.engine, None
        status = engine.close()
        engine.remove()
        self.settings.running = False
        return status
