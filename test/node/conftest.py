# SPDX-License-Identifier: Apache-2.0
"""A client of the node under test: a plain rclpy node here; the simulation runs elsewhere."""

import contextlib
import fcntl
import os
import pathlib
import tempfile
import time

import pytest
import ros

TIMEOUT = 20.0
"""Discovery takes 0.1 or 2.5 s; a loaded machine may take much longer. Seconds."""
START = 60.0
"""A process that imports numba and rclpy on a loaded machine. Seconds."""


@pytest.fixture(scope='session')
def compiled_kernels():
    """Compile what the nodes of these tests need, in one process, so that none of them has to."""
    from rigid_body_sim.messages.state_topics import Frames, chosen, scene_messages
    from rigid_body_sim.node.rehearsal import rehearse
    from rigid_body_sim.simulation.simulation import Simulation
    with open(pathlib.Path(tempfile.gettempdir()) / f'rigid_body_sim-compiling-{os.getuid()}',
              'w') as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        for scene in ('tennis_racket', 'sphere'):
            simulation = Simulation(scene)
            rehearse(simulation, scene_messages(chosen(()), simulation.scene, Frames()))


class Client:
    """Subscribes, publishes and calls services; everything waits with a time limit."""

    def __init__(self, domain):
        import rclpy
        from rclpy.executors import SingleThreadedExecutor
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, domain_id=domain.id)
        self.node = rclpy.create_node('client', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)

    def close(self):
        """Leave the domain."""
        self.node.destroy_node()
        self._executor.shutdown()
        self._context.try_shutdown()

    def until(self, condition, timeout=TIMEOUT, what='a condition'):
        """Serve callbacks until `condition()` is true; return what it returned."""
        deadline = time.monotonic() + timeout
        while not (result := condition()):
            assert time.monotonic() < deadline, f'waited {timeout:g} s for {what}'
            self._executor.spin_once(timeout_sec=0.05)
        return result

    def spin(self, seconds):
        """Serve callbacks for a time."""
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            self._executor.spin_once(timeout_sec=0.02)

    def settle(self, *collected):
        """Serve callbacks until what was sent has come: lists of :meth:`collect` stop growing."""
        idle = 0
        while idle < 10:
            before = sum(map(len, collected))
            self._executor.spin_once(timeout_sec=0.05)
            idle = idle + 1 if sum(map(len, collected)) == before else 0

    def collect(self, message_type, topic, qos=10):
        """Subscribe as users do; return the list of messages, which :meth:`spin` fills."""
        messages = []
        self.node.create_subscription(message_type, topic, messages.append, qos)
        return messages

    def forget(self):
        """Destroy all subscriptions and publishers."""
        for subscription in list(self.node.subscriptions):
            self.node.destroy_subscription(subscription)
        for publisher in [publisher
                          for publisher in self.node.publishers
                          if publisher.topic_name not in ('/rosout', '/parameter_events')]:
            self.node.destroy_publisher(publisher)

    def publisher(self, message_type, topic, qos=10):
        """Return a publisher that is matched by a subscription."""
        publisher = self.node.create_publisher(message_type, topic, qos)
        self.until(publisher.get_subscription_count, what=f'a subscription to {topic}')
        return publisher

    def call(self, service_type, name, timeout=TIMEOUT, **fields):
        """Call a service; return the response."""
        client = self.node.create_client(service_type, name)
        self.until(client.service_is_ready, what=f'the service {name}')
        future = client.call_async(service_type.Request(**fields))
        self.until(future.done, timeout, what=f'an answer from {name}')
        self.node.destroy_client(client)
        return future.result()


@contextlib.contextmanager
def _client(domain):
    client = Client(domain)
    try:
        yield client
    finally:
        client.close()


@pytest.fixture
def new_client():
    """Return the context manager that yields a Client in a domain."""
    return _client


class Running:
    """A node in a process of its own and a client of it."""

    def __init__(self, domain, process, client, folder):
        self.domain, self.process, self.client, self.folder = domain, process, client, folder


@contextlib.contextmanager
def _running(folder, *arguments):
    with ros.held_domain(folder / 'log') as domain, domain.process(
            '-m', 'rigid_body_sim', 'sim_node', '--ros-args', '-p',
            f'recording.directory:={folder / "recordings"}',
            *arguments) as process, _client(domain) as client:
        client.until(lambda: process.poll() is not None or client.node.count_publishers('energy'),
                     timeout=START, what='the node')
        assert process.poll() is None, process.communicate()[1]
        yield Running(domain, process, client, folder)


@pytest.fixture(scope='session')
def run_node_in(compiled_kernels):
    """Return the context manager that runs a node with arguments and yields a Running."""
    return _running


@pytest.fixture
def run_node(tmp_path, compiled_kernels):
    """Return the context manager that runs a node with arguments and yields a Running."""
    return lambda *arguments: _running(tmp_path, *arguments)


@pytest.fixture(scope='module')
def shared_node(request, tmp_path_factory, compiled_kernels):
    """Yield a Running for all tests of a module; its arguments are the module's ARGUMENTS."""
    with _running(tmp_path_factory.mktemp('node'), *request.module.ARGUMENTS) as running:
        yield running
