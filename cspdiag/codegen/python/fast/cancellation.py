"""Which processes have to check themselves whether they were cancelled.

A process that is cancelled while it is ready continues to its next communication. In most programs this cannot be
observed, so it is abandoned immediately, and its code needs no test before each communication.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from cspdiag.base.graphs import reached
from cspdiag.base.record import kept_for_same
from cspdiag.network.elaborate.fewer.continued import continued
from cspdiag.network.flow.repetition import repeated_classes
from cspdiag.network.ir.actions import CatchException, InterruptOn, ParallelSteps, RunInstance
from cspdiag.network.ir.network import InstanceOf, Network, ProcessClass
from cspdiag.network.ir.walk import all_actions, instances_run


@kept_for_same(1)
def checked_classes(network: Network) -> frozenset[str]:
    """The process classes whose code checks before each communication whether it was cancelled.

    These are the classes that may be interrupted, because the end of the body determines what follows; those with
    branches inside a handled body, where their effect on variables that remain can be observed afterwards; and all
    classes that these run.
    """
    return frozenset(_checked_classes(network))


@continued
def _checked_classes(network: Network) -> tuple[str, ...]:
    classes = {entry.name: entry for entry in network.classes if isinstance(entry, ProcessClass)}
    again = repeated_classes(network)
    found: set[str] = set()
    for process in classes.values():
        for part in all_actions(process.body):
            if isinstance(part, InterruptOn):
                found.add(process.name)
                found |= _below(process, instances_run(part.body), classes)
            elif isinstance(part, CatchException):
                branches = [item for item in all_actions(part.body) if isinstance(item, ParallelSteps)]
                if any(not isinstance(s, RunInstance | ParallelSteps) for item in branches for s in item.steps):
                    found.add(process.name)
                run = _below(process, instances_run(part.body), classes)
                found |= {name for name in run if name in again or _has_shared_variables(classes[name])}
    for name in list(found):
        process = classes[name]
        found |= _below(process, [instance.name for instance in process.instances], classes)
    return tuple(sorted(found))


def _below(process: ProcessClass, instances: Iterable[str], classes: dict[str, ProcessClass]) -> set[str]:
    """The process classes of some instances of a process, and of all instances inside them."""

    def inside(process: ProcessClass) -> Iterator[InstanceOf]:
        return (instance for instance in process.instances if instance.class_name in classes)

    wanted = set(instances)
    begin = [instance.class_name for instance in inside(process) if instance.name in wanted]
    return set(reached(begin, lambda name: [instance.class_name for instance in inside(classes[name])]))


def _has_shared_variables(process: ProcessClass) -> bool:
    return any(medium.kind == "var" for port in process.ports if port.direction == "out" for medium in port.media)
