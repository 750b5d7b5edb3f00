"""Measured execution times, assigned to the laws that they bound."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from cspdiag.base.record import record
from cspdiag.network.ir.network import CoreNetwork, ProcessClass


@record
class Measured:
    """The longest step in nanoseconds of a law, of a process with its own laws, or of a thread with all that is
    flattened into it.
    """

    path: str
    longest: int
    what: Literal["law", "process", "thread"]


def times_of_laws(network: CoreNetwork, measured: Iterable[Measured]) -> dict[str, int]:
    """The longest time that each law, and each process written by hand, can have taken, if that was measured.

    A law gets its own time, or that of a step of the process that runs it, or of the thread. Whatever else the step did
    is then included in the law's time, which can only make it too long.
    """
    given = {entry.path: entry for entry in measured}
    found: dict[str, int] = {}
    for instance in network.instances:
        entry = network.class_named(instance.class_name)
        if isinstance(entry, ProcessClass) and entry.external is None:
            continue
        bound = _bound(instance.path, given)
        if bound is not None:
            found[instance.path] = bound
    return found


def _bound(path: str, given: dict[str, Measured]) -> int | None:
    if path in given:
        return given[path].longest
    above = path
    while "." in above:
        above = above.rpartition(".")[0]
        known = given.get(above)
        if known is not None:
            is_direct = above == path.rpartition(".")[0]
            return known.longest if known.what == "thread" or (known.what == "process" and is_direct) else None
    return None
