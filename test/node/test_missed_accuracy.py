# SPDX-License-Identifier: Apache-2.0
"""A missed accuracy is said where somebody looks: in the start line and in /diagnostics."""

import types

import pytest
from diagnostic_msgs.msg import DiagnosticStatus

from rigid_body_sim.choice.settling import Settled
from rigid_body_sim.node.diagnostics import Diagnostics
from rigid_body_sim.node.engine import Engine
from rigid_body_sim.simulation.simulation import Simulation

BALANCED = {'energy_residual': 1e-16, 'momentum_residual': 1e-16}
BOUNDS = {f'diagnostics.{name}_{level}': bound for name in BALANCED
          for level, bound in (('warn', 1e-9), ('error', 1e-6))}


def simulation(expected):
    """Return a simulation whose error is expected to be that large."""
    return Simulation('tennis_racket', accuracy=1e-9,
                      settled=Settled('dop8', 1e-9, expected, 12.5))


def ledger_of(simulation):
    """Return the status of the ledger."""
    node = object.__new__(Diagnostics)
    node._session = types.SimpleNamespace(simulation=simulation, balance=BALANCED)
    node._settings, node._name = BOUNDS, 'sim_node'
    return node._ledger()


@pytest.mark.parametrize(('expected', 'level'), [(1.64, b'\x01'), (1e-10, b'\x00')])
def test_the_status_of_the_ledger_warns(expected, level):
    status = ledger_of(simulation(expected))
    assert status.level == level and level in (DiagnosticStatus.OK, DiagnosticStatus.WARN)
    assert ('accuracy asked, 1e-09 rad, is missed' in status.message) == (level == b'\x01')
    assert ('met until 12.5 s' in status.message) == (level == b'\x01')
    assert {value.key: value.value for value in status.values}['method'] == 'dop8'


@pytest.mark.parametrize(('tick', 'level', 'told'), [
    (3000, b'\x00', 'unknown since the command at t = 3 s'),
    (13_000, b'\x01', 'unknown since the command at t = 13 s')])    # missed before the command
def test_after_a_command_the_status_says_that_the_error_is_not_known(tick, level, told):
    commanded = simulation(1.64)
    commanded.watching = False
    commanded.advance(tick)
    commanded.hold(torque=(0.0, 0.1, 0.0))
    status = ledger_of(commanded)
    values = {value.key: value.value for value in status.values}
    assert status.level == level
    assert values['expected_error'] == values['met_until'] == told


def test_the_start_warns_before_anything_is_offered():
    lines, engine = [], object.__new__(Engine)
    logger = types.SimpleNamespace(info=lines.append, warning=lines.append)
    engine._prepare = lambda changes: simulation(1.64)
    with pytest.raises(AttributeError):    # the node here can log, and nothing else
        engine._set_up(types.SimpleNamespace(get_logger=lambda: logger),
                       types.SimpleNamespace(), lambda: None)
    assert any('tennis_racket: the accuracy asked, 1e-09 rad, is missed' in line
               and 'met until 12.5 s' in line for line in lines)
