"""Measured execution times, brought down to the laws that they bound."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from cspdiag.base.record import record
from cspdiag.network.ir.network import CoreNetwork, ProcessClass


@record
class Measured:
    """The longest step of a law, of a process with its own laws, or of a thread with everything that is flattened into
    it, in nanoseconds.
    """

    path: str
    longest: int
    what: Literal["law", "process", "thread"]


def times_of_laws(network: CoreNetwork, measured: Iterable[Measured]) -> dict[str, int]:
    """For each law, and each process written by hand, the longest time that it can have taken, as far as that was
    measured.

    A law is given its own time, or that of a step of the process that runs it, or of the thread: what else the step did
    counts as the law's, which is too much rather than too little.
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
