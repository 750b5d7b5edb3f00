"""Each pass of the optimizer keeps the traces: what the reference does before and after it is compared."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import pytest
from hypothesis import HealthCheck, given, note, settings
from hypothesis import strategies as st

from cspdiag.base import SourceFile
from cspdiag.network.dump.network import dump
from cspdiag.network.ir.network import Network
from cspdiag.optimize import PASSES, Pass, optimize
from cspdiag.semantics.execute import execute
from cspdiag.semantics.trace import Execution
from tests.conformance.sources import JUST_AFTER, MODELS, PROGRAMS, environments, network_of, read
from tests.conformance.traces import compare
from tests.properties.encounters import encounters
from tests.properties.programs import programs

ALONE: dict[str, tuple[Pass, ...]] = {entry.name: tuple(dict.fromkeys((PASSES[0], entry))) for entry in PASSES}
"""Each pass on the result of the first one, without which no class knows how it is connected."""

SELECTIONS = {**{f"{name} alone": passes for name, passes in ALONE.items()}, "all": PASSES}


@cache
def parsed(name: str) -> Network:
    """The network of a file."""
    return network_of(read(name))


@cache
def before_passes(name: str, environment: str | None, until: int) -> Execution:
    """What the network of a file does without any pass."""
    return execute(parsed(name), environment, until)


def assert_kept(
    before: Execution, network: Network, passes: Sequence[Pass], environment: str | None, until: int
) -> None:
    """After the passes the network does what it did ``before`` them."""
    optimized = optimize(network, passes, debug=True)
    after = execute(optimized, environment, until)
    external = {f"{network.top}.{port.name}" for port in network.external_ports}
    difference = compare(before.trace, after.trace, external)
    assert difference is None, f"left: before, right: after\n{difference}\n{dump(optimized)}"
    assert before.ending == after.ending


def assert_file_kept(name: str, passes: Sequence[Pass], until: int) -> None:
    """The same for the program of a file, in each of its environments."""
    network = parsed(name)
    for environment in environments(network):
        assert_kept(before_passes(name, environment, until), network, passes, environment, until)


@pytest.mark.parametrize("passes", SELECTIONS.values(), ids=SELECTIONS)
@pytest.mark.parametrize("name", MODELS)
def test_model(name: str, passes: Sequence[Pass]) -> None:
    assert_file_kept(name, passes, 120_000_000 + JUST_AFTER)


@pytest.mark.parametrize("passes", SELECTIONS.values(), ids=SELECTIONS)
@pytest.mark.parametrize("name", PROGRAMS)
def test_program(name: str, passes: Sequence[Pass]) -> None:
    assert_file_kept(name, passes, 100_000_000 + JUST_AFTER)


LIMIT = 60_000_000 + JUST_AFTER


def selections() -> st.SearchStrategy[tuple[Pass, ...]]:
    """The first pass and any of the others, in their order; most often all."""
    some = st.sets(st.sampled_from(PASSES)).map(
        lambda chosen: (PASSES[0], *(entry for entry in PASSES[1:] if entry in chosen))
    )
    return st.just(PASSES) | some


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(programs() | encounters(), selections())
def test_random_program(text: str, passes: Sequence[Pass]) -> None:
    note(text)
    note(f"passes: {', '.join(entry.name for entry in passes)}")
    network = network_of(SourceFile(name="random.csp", text=text))
    assert_kept(execute(network, None, LIMIT), network, passes, None, LIMIT)
