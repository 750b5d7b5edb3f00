"""Signals of control laws that were inlined into a process: which are members of its struct, and which
local variables.
"""

from __future__ import annotations

from collections import Counter

from cspdiag.codegen.c.laws.inlined_laws import run_law_signals
from cspdiag.model.types import Type
from cspdiag.network.ir.actions import Action, ReadInputs, RunLaw
from cspdiag.network.ir.expressions import SignalValue
from cspdiag.network.ir.network import ProcessClass
from cspdiag.network.ir.walk import parts


def made_signals(body: Action | None) -> dict[str, Type]:
    """What reads of inputs and runs of laws make, with the types."""
    found: dict[str, Type] = {}
    for part in parts(body):
        match part:
            case ReadInputs(reads=reads):
                found.update((read.name, read.type) for read in reads)
            case RunLaw():
                found.update(run_law_signals(part))
            case _:
                pass  # Nothing else makes signals.
    return found


def signals_of(process: ProcessClass) -> dict[str, Type]:
    """The types of all signals, states and constants of a process."""
    kept = {item.name: item.type for item in process.constants}
    kept |= {item.name: item.type for item in process.states}
    return kept | made_signals(process.body)


def kept_signals(body: Action | None) -> list[str]:
    """Signals that have to outlive a wait: inputs, and those that are used outside the run that makes them."""
    made = made_signals(body)
    read = {read.name for part in parts(body) if isinstance(part, ReadInputs) for read in part.reads}
    used = _used(body)
    inside: Counter[str] = Counter()
    for part in parts(body):
        if isinstance(part, RunLaw):
            own = {name for name, _ in run_law_signals(part)}
            inside.update({name: count for name, count in _used(part).items() if name in own})
    return [name for name in made if name in read or inside[name] < used[name]]


def _used(item: object) -> Counter[str]:
    return Counter(part.name for part in parts(item) if isinstance(part, SignalValue))
