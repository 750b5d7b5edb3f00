"""Which alternatives and instances may run more than once in a run of a process or program."""

from __future__ import annotations

from collections import Counter

from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.code import Call, Code, Select
from cspdiag.network.ir.actions import Action
from cspdiag.network.ir.network import Network, ProcessClass


def repeated_choices(body: Action) -> frozenset[str]:
    """The names of the alternatives that may choose more than once in a run of a composition."""
    code = flow_of(body)
    return _repeated(code, {n: i.step.name for n, i in enumerate(code.instructions) if isinstance(i, Select)})


def repeated_classes(network: Network) -> frozenset[str]:
    """The process classes of instances that may be run more than once."""
    classes = {entry.name: entry for entry in network.classes if isinstance(entry, ProcessClass)}
    repeated: set[str] = set()
    # Callers first: whatever is run by an instance that runs again runs again, too.
    for entry in reversed(classes.values()):
        found = {instance.name for instance in entry.instances}
        if entry.name not in repeated and entry.body is not None:
            code = flow_of(entry.body)
            calls = {n: i.step.instance for n, i in enumerate(code.instructions) if isinstance(i, Call)}
            found &= _repeated(code, calls)
        elif entry.name not in repeated:
            continue
        repeated.update(instance.class_name for instance in entry.instances if instance.name in found)
    return frozenset(repeated & classes.keys())


def _repeated(code: Code, names: dict[int, str]) -> frozenset[str]:
    """The names of several instructions, or of one between the beginning and the end of a loop."""
    looped = {index for end, start in code.back.items() for index in range(start, end + 1)}
    several = Counter(names.values())
    return frozenset(name for index, name in names.items() if index in looped or several[name] > 1)
