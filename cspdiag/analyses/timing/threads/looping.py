"""Which parts of a composition have loops: those branches of a parallel composition are threads."""

from __future__ import annotations

from collections.abc import Callable

from cspdiag.network.ir.actions import CoreAction, Repeat, RunInstance, WhileLoop
from cspdiag.network.ir.network import CoreNetwork, SubmodelClass
from cspdiag.network.ir.walk import all_actions


class Looping:
    """Finds the loops within actions and in the processes that they run."""

    def __init__(self, network: CoreNetwork) -> None:
        self._classes = {entry.name: entry for entry in network.classes}
        self._class_of = {instance.path: instance.class_name for instance in network.instances}
        self._known: dict[str, bool] = {}

    def has_loop(self, action: CoreAction, path: str) -> bool:
        """Whether something in an action of the process at a path is repeated, or written by hand."""
        return self._has_loop(action, lambda name: self._class_of[f"{path}.{name}"])

    def _has_loop(self, action: CoreAction, class_of: Callable[[str], str]) -> bool:
        return any(
            isinstance(part, Repeat | WhileLoop)
            or (isinstance(part, RunInstance) and self._class_has_loop(class_of(part.instance)))
            for part in all_actions(action)
        )

    def _class_has_loop(self, name: str) -> bool:
        if name not in self._known:
            entry = self._classes[name]
            if isinstance(entry, SubmodelClass):
                self._known[name] = False
            elif entry.body is None:
                self._known[name] = True
            else:
                inside = {instance.name: instance.class_name for instance in entry.instances}
                self._known[name] = self._has_loop(entry.body, inside.__getitem__)
        return self._known[name]
