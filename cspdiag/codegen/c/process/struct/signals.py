"""Signals of inlined control laws: which are members of the struct of the process, and which local variables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from cspdiag.codegen.c.laws.inlined_laws import run_law_signals
from cspdiag.model.types import Type
from cspdiag.network.ir.actions import Action, ReadInputs, RunLaw
from cspdiag.network.ir.expressions import SignalValue
from cspdiag.network.ir.network import ProcessClass
from cspdiag.network.ir.walk import PartsByType, all_actions


def made_signals(body: Action, inside: PartsByType) -> dict[str, Type]:
    """The signals that reads of inputs and runs of laws compute, with their types; ``inside`` are the parts of the
    body.
    """
    found: dict[str, Type] = {}
    if not inside.of(ReadInputs) and not inside.of(RunLaw):
        return found
    for action in all_actions(body):
        match action:
            case ReadInputs(reads=reads):
                found.update((read.name, read.type) for read in reads)
            case RunLaw():
                found.update(run_law_signals(action))
            case _:
                pass  # Nothing else computes signals.
    return found


def kept_signals(process: ProcessClass, made: Iterable[str], inside: PartsByType) -> list[str]:
    """The constants and the states, and those signals of the composition that have to be kept while the process waits:
    inputs, and signals that are used outside the run that computes them.
    """
    read = {read.name for step in inside.of(ReadInputs) for read in step.reads}
    used = _used(inside)
    in_laws: Counter[str] = Counter()
    for law in inside.of(RunLaw):
        own = {name for name, _ in run_law_signals(law)}
        in_laws.update({name: count for name, count in _used(PartsByType(law)).items() if name in own})
    lasting = [name for name in made if name in read or in_laws[name] < used[name]]
    return [*(item.name for item in (*process.constants, *process.states)), *lasting]


def _used(inside: PartsByType) -> Counter[str]:
    return Counter(part.name for part in inside.of(SignalValue))
