"""Searching networks: an index has all parts in order, and bodies in other languages are found."""

from __future__ import annotations

import pytest

from cspdiag.base import SourceFile
from cspdiag.network.ir.actions import PortEnd, ReadInputs, RunLaw
from cspdiag.network.ir.expressions import SignalValue
from cspdiag.network.ir.external import external_bodies, external_calls
from cspdiag.network.ir.network import Network, ProcessClass
from cspdiag.network.ir.walk import PartsByType, parts
from cspdiag.optimize import lower_for_targets, optimize
from tests.conformance.sources import network_of

PROGRAM = """
submodel Encoder python "encoder.py:Encoder" {
  in  angle : double
  out count : double
}

submodel Law {
  in  x : double
  out u : double

  encoder : Encoder
  encoder.angle = x
  u = encoder.count * 2
}

process Main {
  in  x : double @ 1 ms
  out u : double @ 1 ms

  communication {
    law : Law
    x -> law.x
    law.u -> u
  }

  composition { law ; mu (law) }
}

submodel Plant {
  in  u : double
  out x : double

  encoder : Encoder
  encoder.angle = u
  x = encoder.count
}

environment Bench for Main {
  plant : Plant
  u -> plant.u
  plant.x -> x
}
"""


@pytest.fixture(scope="module")
def network() -> Network:
    """The control law is inlined into the process, and runs in two places."""
    return optimize(network_of(SourceFile(name="parts.csp", text=PROGRAM)))


def main_of(network: Network) -> ProcessClass:
    (found,) = (entry for entry in network.classes if isinstance(entry, ProcessClass))
    return found


@pytest.mark.parametrize("kind", [SignalValue, PortEnd, ReadInputs, RunLaw])
def test_index_has_the_parts_of_a_type_in_their_order(network: Network, kind: type[object]) -> None:
    body = main_of(network).body
    found = [part for part in parts(body) if type(part) is kind]
    assert found
    assert list(map(id, PartsByType(body).of(kind))) == list(map(id, found))


def test_bodies_of_inlined_laws_are_found_once(network: Network) -> None:
    process = main_of(network)
    assert len(PartsByType(process.body).of(RunLaw)) > 1
    assert [call.definition for call in external_calls(process)] == ["Encoder"]


def test_bodies_of_laws_and_environments_are_found() -> None:
    network = lower_for_targets(network_of(SourceFile(name="parts.csp", text=PROGRAM)))
    (environment,) = network.environments
    assert [call.definition for call in external_calls(environment)] == ["Encoder"]
    assert [body.target for body in external_bodies(network.classes, ())] == ["encoder.py:Encoder"]
    assert [body.target for body in external_bodies((), network.environments)] == ["encoder.py:Encoder"]
