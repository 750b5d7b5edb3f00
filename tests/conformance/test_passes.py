"""Each pass of the optimizer keeps the traces: what the reference does before and after it is compared."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, lru_cache

import pytest
from hypothesis import HealthCheck, given, note, settings
from hypothesis import strategies as st

from cspdiag.base import SourceFile
from cspdiag.network.dump.network import dump
from cspdiag.network.ir.network import Network
from cspdiag.optimize import PASSES, PASSES_FOR_LOOPS, Pass, optimize
from cspdiag.semantics.execute import execute
from cspdiag.semantics.trace import Execution
from tests.conformance.sources import JUST_AFTER, MODELS, PROGRAMS, environments, network_of, read
from tests.conformance.traces import compare
from tests.properties.encounters import encounters
from tests.properties.programs import programs

ALONE: dict[str, tuple[Pass, ...]] = {entry.name: tuple(dict.fromkeys((PASSES[0], entry))) for entry in PASSES}
"""Each pass on the result of the first one, without which no class knows how it is connected."""

SELECTIONS = {
    **{f"{name} alone": passes for name, passes in ALONE.items()},
    "all": PASSES,
    "all for loops": PASSES_FOR_LOOPS,
}


@cache
def parsed(name: str) -> Network:
    """The network of a file."""
    return network_of(read(name))


@lru_cache(maxsize=8)
def networks_executed(name: str, environment: str | None, until: int) -> list[tuple[Network, Execution]]:
    """The networks that passes have made of a file, the unchanged one first, each with what it does: most passes change
    few programs, and equal networks do the same.
    """
    return [(parsed(name), execute(parsed(name), environment, until))]


def assert_same(before: Execution, after: Execution, network: Network, passes: Sequence[Pass]) -> None:
    """``network``, which does ``after``, does what another one did before these passes."""
    external = {f"{network.top}.{port.name}" for port in network.external_ports}
    difference = compare(before.trace, after.trace, external)
    names = ", ".join(entry.name for entry in passes)
    assert difference is None, f"{names}: left: before, right: after\n{difference}\n{dump(network)}"
    assert before.ending == after.ending, names


def assert_file_kept(name: str, passes: Sequence[Pass], until: int) -> None:
    """The program of a file does the same after the passes, in each of its environments."""
    network = parsed(name)
    optimized = optimize(network, passes, debug=True)
    for environment in environments(network):
        executed = networks_executed(name, environment, until)
        if not any(optimized == known for known, _ in executed):
            after = execute(optimized, environment, until)
            assert_same(executed[0][1], after, optimized, passes)
            executed.append((optimized, after))


@pytest.mark.parametrize("passes", SELECTIONS.values(), ids=SELECTIONS)
@pytest.mark.parametrize("name", MODELS)
def test_model(name: str, passes: Sequence[Pass]) -> None:
    assert_file_kept(name, passes, 120_000_000 + JUST_AFTER)


@pytest.mark.parametrize("name", PROGRAMS)
def test_program(name: str) -> None:
    """After each pass alone, and after all of them."""
    for passes in SELECTIONS.values():
        assert_file_kept(name, passes, 100_000_000 + JUST_AFTER)


LIMIT = 60_000_000 + JUST_AFTER


def selections() -> st.SearchStrategy[tuple[Pass, ...]]:
    """The first pass and any of the others, in their order; most often all."""
    some = st.sets(st.sampled_from(PASSES)).map(
        lambda chosen: (PASSES[0], *(entry for entry in PASSES[1:] if entry in chosen))
    )
    return st.sampled_from([PASSES, PASSES_FOR_LOOPS]) | some


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(programs() | encounters(), selections())
def test_random_program(text: str, passes: Sequence[Pass]) -> None:
    note(text)
    note(f"passes: {', '.join(entry.name for entry in passes)}")
    network = network_of(SourceFile(name="random.csp", text=text))
    optimized = optimize(network, passes, debug=True)
    assert_same(execute(network, None, LIMIT), execute(optimized, None, LIMIT), optimized, passes)
