"""Removes the classes and instances that are no longer reachable."""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.base.record import replaced
from cspdiag.network.ir.network import Instantiation, Network, ProcessClass, SubmodelClass
from cspdiag.optimize.changes import changed


def reachable(network: Network) -> Network:
    """The network with only the classes that have instances, and only the instances that still exist, with their
    present classes.
    """
    by_name = {entry.name: entry for entry in network.classes}
    used = {network.top}
    for entry in reversed(network.classes):
        if entry.name in used and isinstance(entry, ProcessClass):
            used.update(instance.class_name for instance in entry.instances)
    classes = tuple(entry for entry in network.classes if entry.name in used)
    return changed(network, classes=classes, instances=_instances(network, by_name))


def _instances(network: Network, classes: Mapping[str, ProcessClass | SubmodelClass]) -> tuple[Instantiation, ...]:
    class_of = {network.top: network.top}
    pending = [network.top]
    while pending:
        path = pending.pop()
        entry = classes[class_of[path]]
        if isinstance(entry, ProcessClass):
            for instance in entry.instances:
                inner = f"{path}.{instance.name}"
                class_of[inner] = instance.class_name
                pending.append(inner)
    return tuple(
        [
            item if item.class_name == class_of[item.path] else replaced(item, class_name=class_of[item.path])
            for item in network.instances
            if item.path in class_of
        ]
    )
