"""What a whole program has that decides how each of its process classes is written."""

from __future__ import annotations

from cspdiag.base.record import kept_for_same
from cspdiag.codegen.python.fast.storage import rerun_classes
from cspdiag.codegen.python.plain.members import lines_as_arrays
from cspdiag.network.elaborate.fewer.continued import continued
from cspdiag.network.ir.actions import ParallelSteps
from cspdiag.network.ir.expressions import TunableValue
from cspdiag.network.ir.network import Network, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import all_actions, parts


@kept_for_same(1)
def has_parts_by_hand(network: Network) -> bool:
    """Whether the program has processes or laws in Python that communicate themselves."""
    return any(isinstance(entry, SubmodelClass) or entry.external is not None for entry in network.classes)


def keeps_state(process: ProcessClass, network: Network) -> bool:
    """Whether states and variables are attributes: the process may run more than once, or begin with values that
    parameters of the program had when it was made.
    """
    return process.name in rerun_classes(network) or process.name in _begin_with_parameters(network)


@kept_for_same(1)
@continued
def _begin_with_parameters(network: Network) -> tuple[str, ...]:
    """The process classes of which a state or a variable begins with a value that a parameter of the program has."""
    found: list[str] = []
    for entry in network.classes:
        if isinstance(entry, ProcessClass):
            initial = (entry.states, tuple(channel.initial for channel in entry.channels))
            if any(isinstance(part, TunableValue) for part in parts(initial)):
                found.append(entry.name)
    return tuple(found)


@kept_for_same(1)
@continued
def has_levels(network: Network) -> bool:
    """Whether the program has prioritized parallels."""
    bodies = [entry.body for entry in network.classes if isinstance(entry, ProcessClass)]
    return any(isinstance(part, ParallelSteps) and part.prioritized for body in bodies for part in all_actions(body))


@kept_for_same(1)
def classes_of_elements(network: Network) -> frozenset[str]:
    """The process classes of which an array has instances."""
    return frozenset(_classes_of_elements(network))


@continued
def _classes_of_elements(network: Network) -> tuple[str, ...]:
    found: set[str] = set()
    for entry in network.classes:
        if isinstance(entry, ProcessClass):
            lines = {row.name for elements in lines_as_arrays(entry).values() for row in elements}
            found |= {item.class_name for item in entry.instances if item.array is not None or item.name in lines}
    return tuple(sorted(found))
