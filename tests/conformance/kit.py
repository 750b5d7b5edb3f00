"""Certifies a target: the same traces and ends as the reference, over a folder of programs."""

from __future__ import annotations

import traceback
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Literal

from cspdiag.model.types import Real
from cspdiag.network.ir import expressions as ex
from cspdiag.network.ir.network import Network
from cspdiag.network.ir.walk import parts
from cspdiag.semantics.trace import Communication, Execution
from tests.conformance.sources import JUST_AFTER, InvalidProgramError, environments, network_of, programs_in, read
from tests.conformance.targets import REFERENCE, EmulatedBoard, RefusedError, Target
from tests.conformance.traces import compare, shown

LIBRARY_FUNCTIONS = frozenset({"sin", "cos", "tan", "asin", "acos", "atan", "atan2", "exp", "log", "^"})
"""The functions for which the C standard leaves the accuracy to the library. A target with another library than this
machine's may be off by one unit in the last place in programs that use them; everything else (``+ - * /``, ``sqrt``,
``fmod``, rounding) is exact everywhere.
"""

Result = Literal["equal", "differs", "crashed", "refused", "invalid"]
"""``crashed``: the implementation failed, not the program; ``invalid``: it is not a correct program."""


@dataclass(frozen=True)
class Verdict:
    """The result for one program in one environment; ``details`` are lines for people."""

    program: str
    environment: str | None
    result: Result
    communications: int = 0
    details: str = ""


def certify(target: Target, folder: Path, limit: int = 1_200_000_000, real: Real = "double") -> Iterator[Verdict]:
    """The verdicts on every program below a folder, in each of its environments, up to ``limit`` nanoseconds."""
    for name in programs_in(folder):
        try:
            network = parsed(name, real)
        except InvalidProgramError as problem:
            yield Verdict(name, None, "invalid", details=str(problem))
            continue
        for environment in environments(network):
            yield judge(target, network, environment, limit + JUST_AFTER, name, real=real)


@lru_cache(maxsize=64)
def _done_by_reference(name: str, environment: str | None, until: int, real: Real) -> Execution:
    return REFERENCE.run(parsed(name, real), environment, until)


@lru_cache(maxsize=64)
def parsed(name: str, real: Real = "double") -> Network:
    """The network of a file, which is the same for all targets."""
    return network_of(read(name), real)


def judge(
    target: Target,
    network: Network,
    environment: str | None,
    until: int,
    name: str = "",
    expected: Execution | None = None,
    real: Real = "double",
) -> Verdict:
    """Run a program, of the file ``name`` if it has one, on a target and on the reference, and compare.

    ``wanted`` is what the reference does, if that is already known.
    """
    try:
        done = target.run(network, environment, until)
    except RefusedError as refusal:
        return Verdict(name, environment, "refused", details=str(refusal))
    except Exception as crash:
        return Verdict(name, environment, "crashed", details="".join(traceback.format_exception(crash)[-6:]))
    if isinstance(target, EmulatedBoard) and network.parameters:
        expected = REFERENCE.run(network, environment, until, changed=False)
    if expected is None:
        expected = (
            _done_by_reference(name, environment, until, real) if name else REFERENCE.run(network, environment, until)
        )
    if not target.inside:
        external = external_channels(network)
        expected, done = (
            side._replace(trace=[passed for passed in side.trace if passed.channel in external])
            for side in (expected, done)
        )
    details = "\n".join(_differences(target, network, environment, until, expected, done))
    return Verdict(name, environment, "differs" if details else "equal", len(expected.trace), details)


def _differences(
    target: Target, network: Network, environment: str | None, until: int, expected: Execution, done: Execution
) -> Iterator[str]:
    difference = compare(expected.trace, done.trace, external_channels(network), tolerance(target, network))
    if difference is not None:
        yield f"left: {REFERENCE.name}, right: {target.name}\n{difference}"
        for side, execution, part in ((REFERENCE, expected, difference.left), (target, done, difference.right)):
            moment = _moment(execution, part, difference.position)
            yield f"  {side.name} before that:"
            yield from (f"    {line}" for line in _state(side, network, environment, until, execution.trace, moment))
    if not expected.ending.agrees_with(done.ending):
        yield f"the end differs\n  {REFERENCE.name}: {expected.ending}\n  {target.name}: {done.ending}"
    if done.released is not None and done.released != expected.released:
        yield f"safe values differ\n  {REFERENCE.name}: {expected.released}\n  {target.name}: {done.released}"


def external_channels(network: Network) -> set[str]:
    """The external ports under the names that traces use."""
    return {f"{network.top}.{port.name}" for port in network.external_ports}


def tolerance(target: Target, network: Network) -> int:
    """By how many units in the last place doubles may differ."""
    return int(target.other_library and bool(LIBRARY_FUNCTIONS & functions_used(network)))


def functions_used(network: Network) -> set[str]:
    """The names of the functions and arithmetic operators with which a program computes doubles."""
    found: set[str] = set()
    for part in parts((network.classes, network.environments)):
        if isinstance(part, ex.FunctionCall):
            found.add(part.function)
        elif isinstance(part, ex.BinaryOperation):
            found.add(part.operator)
    return found


def _moment(execution: Execution, side: Sequence[Communication], position: int) -> int:
    """How many communications had taken place when the one at ``position`` of a side of the difference did."""
    if position >= len(side):
        return len(execution.trace)
    return next(index for index, communication in enumerate(execution.trace) if communication is side[position])


def _state(
    side: Target,
    network: Network,
    environment: str | None,
    until: int,
    trace: Sequence[Communication],
    moment: int,
) -> Iterator[str]:
    """What each process waits for; if that is not available, what it did last."""
    waits = side.waits(network, environment, until, moment) if moment > 0 else ()
    if waits:
        yield from waits
        return
    last: dict[str, Communication] = {}
    for communication in trace[:moment]:
        last[communication.writer or communication.channel] = communication
        last[communication.reader or communication.channel] = communication
    for party, communication in last.items():
        yield f"{party}: last {shown(communication)}"
