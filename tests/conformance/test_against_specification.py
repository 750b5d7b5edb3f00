"""The generated Python does what the language says, by comparison with the specification."""

from __future__ import annotations

from collections.abc import Mapping

import pytest
from hypothesis import HealthCheck, given, note, settings

from cspdiag import pipeline
from cspdiag.diagnostics import SourceFile
from cspdiag.network.ir import Network
from cspdiag.simulate.execute import simulate
from tests.conformance.sources import JUST_AFTER, MODELS, PROGRAMS, environments, network_of, read
from tests.conformance.specification import execute
from tests.conformance.traces import Communication, Ending, Execution, compare
from tests.properties.encounters import encounters
from tests.properties.programs import programs


def build(source: SourceFile) -> tuple[Network, Mapping[str, str]]:
    """The network of a program and its generated Python."""
    network = network_of(source)
    return network, pipeline.generate(network, read)


def generated(network: Network, files: Mapping[str, str], environment: str | None, until: int) -> Execution:
    """What the generated Python does."""
    run = simulate(network, files, environment=environment, until=until)
    error = run.outcome.error
    name = None if error is None else type(error).__name__
    trace = [Communication(time, channel, value) for time, channel, value, _, _ in run.communications]
    return Execution(trace, Ending(run.outcome.ended, run.outcome.time, name))


def assert_conforms(network: Network, files: Mapping[str, str], environment: str | None, until: int) -> None:
    """The generated Python and the specification agree."""
    specified = execute(network, environment, until)
    done = generated(network, files, environment, until)
    external = {f"{network.top}.{port.name}" for port in network.external_ports}
    difference = compare(specified.trace, done.trace, external)
    assert difference is None, f"left: specification, right: generated\n{difference}"
    assert specified.ending == done.ending


@pytest.mark.parametrize("name", MODELS)
def test_model(name: str) -> None:
    network, files = build(read(name))
    for environment in environments(network):
        assert_conforms(network, files, environment, 1_200_000_000 + JUST_AFTER)


@pytest.mark.parametrize("name", PROGRAMS)
def test_program(name: str) -> None:
    """Programs that implementations have disagreed about."""
    network, files = build(read(name))
    for environment in environments(network):
        assert_conforms(network, files, environment, 100_000_000 + JUST_AFTER)


@settings(max_examples=60, derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
@given(programs() | encounters())
def test_random_program(text: str) -> None:
    note(text)
    network, files = build(SourceFile(name="random.csp", text=text))
    assert_conforms(network, files, None, 60_000_000 + JUST_AFTER)
