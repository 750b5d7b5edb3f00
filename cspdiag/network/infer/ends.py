"""Reading ends: parts of a process that read a port in sequence share an end, parallel ones have ends of their own."""

from __future__ import annotations

from typing import Any, TypeAlias

from cspdiag.base.record import replaced
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.walk import actions_inside
from cspdiag.network.relations import end_key
from cspdiag.network.shapes import Key, PortElement, Shape, attached_key

Path: TypeAlias = "tuple[tuple[int, int], ...]"
"""The parallels around a part, from the outermost inwards, each with the branch that contains the part."""

Reader: TypeAlias = "ir.ReadValue | ir.ReadyEvent | ir.InputEvent | tuple[str, PortElement]"
"""A communication of the process itself, or an input of a submodel instance."""


class ReadingEnds:
    """The end that each reader of a shape uses, and the number of ends of each port and channel in the shape.

    ``of_communication`` is keyed by identity: equal actions at different places are different readers.
    """

    def __init__(self, shape: Shape) -> None:
        self.of_communication: dict[int, int] = {}
        self.of_input: dict[tuple[str, PortElement], int] = {}
        self.count: dict[Key, int] = {}
        self._places: dict[Key, list[tuple[Reader, Path]]] = {}
        self._shape = shape
        self._parallels = 0
        if shape.body is not None:
            self._walk(shape.body, ())
        for key, places in self._places.items():
            self._assign(key, places)

    def _walk(self, action: ir.CoreAction, path: Path) -> None:
        match action:
            case ir.RunInstance():
                self._run(action.instance, path)
            case ir.ReadValue():
                self._add(end_key(action.source), action, path)
            case ir.ParallelSteps():
                self._parallel(action.steps, path)
            case ir.Choice():
                for branch in action.branches:
                    self._event(branch, path)
                    self._walk(branch.body, path)
            case ir.InterruptOn():
                self._parallels += 1
                self._walk(action.body, (*path, (self._parallels, 0)))
                self._event(action.branch, (*path, (self._parallels, 1)))
                self._walk(action.branch.body, path)
            case _:  # Any other action reads what its parts read.
                for inner in actions_inside(action):
                    self._walk(inner, path)

    def _parallel(self, steps: tuple[ir.CoreAction, ...], path: Path) -> None:
        self._parallels += 1
        number = self._parallels
        for branch, step in enumerate(steps):
            self._walk(step, (*path, (number, branch)))

    def _event(self, branch: ir.Branch[ir.CoreAction], path: Path) -> None:
        if isinstance(branch.event, ir.ReadyEvent | ir.InputEvent):
            self._add(end_key(branch.event.source), branch.event, path)

    def _run(self, name: str, path: Path) -> None:
        """Adds the inputs of a submodel, which are read in parallel: two of them on one port have an end each."""
        instance = self._shape.instances[name]
        if not instance.shape.is_submodel:
            return
        self._parallels += 1
        number = self._parallels
        for branch, (element, attached) in enumerate(instance.attachments.items()):
            key = attached_key(attached)
            if key is not None and instance.shape.ports[element[0]].direction == "in":
                self._add(key, (name, element), (*path, (number, branch)))

    def _add(self, key: Key, reader: Reader, path: Path) -> None:
        self._places.setdefault(key, []).append((reader, path))

    def _assign(self, key: Key, places: list[tuple[Reader, Path]]) -> None:
        readers: dict[object, list[Path]] = {}
        for reader, path in places:
            readers.setdefault(_identity(reader), []).append(path)
        if all(len(paths) == 1 for paths in readers.values()):
            ends, self.count[key] = _nested([(identity, paths[0]) for identity, paths in readers.items()])
        else:
            ends = _one_by_one(readers)
            self.count[key] = 1 + max(ends.values())
        for reader, _ in places:
            end = ends[_identity(reader)]
            if isinstance(reader, tuple):
                self.of_input[reader] = end
            else:
                self.of_communication[id(reader)] = end


def _identity(reader: Reader) -> object:
    return reader if isinstance(reader, tuple) else id(reader)


def _nested(readers: list[tuple[object, Path]]) -> tuple[dict[object, int], int]:
    """The ends of readers with one place each, and their number: branches of a parallel get consecutive ends."""
    ends: dict[object, int] = {}

    def assign(group: list[tuple[object, Path]], depth: int, first: int) -> int:
        """Assigns ends from ``first`` on; returns how many were needed."""
        width = 0
        parallels: dict[int, dict[int, list[tuple[object, Path]]]] = {}
        for identity, path in group:
            if len(path) == depth:
                ends[identity] = first
                width = 1
            else:
                number, branch = path[depth]
                parallels.setdefault(number, {}).setdefault(branch, []).append((identity, path))
        for branches in parallels.values():
            total = 0
            for inner in branches.values():
                total += assign(inner, depth + 1, first + total)
            width = max(width, total)
        return width

    return ends, assign(readers, 0, 0)


def _one_by_one(readers: dict[object, list[Path]]) -> dict[object, int]:
    """The ends of readers some of which run at several places: the first end that no parallel reader has.

    Two places are parallel if they are in different branches of a parallel that is around both.
    """
    ends: dict[object, int] = {}
    branch_of: dict[int, dict[int, int | None]] = {}
    """By parallel and end, the branch that has the end; None if several have."""
    for identity, paths in readers.items():
        around = {place for path in paths for place in path}
        taken = {
            end
            for number, branch in around
            for end, other in branch_of.get(number, {}).items()
            if other is None or other != branch
        }
        ends[identity] = mine = next(end for end in range(len(readers)) if end not in taken)
        for number, branch in around:
            known = branch_of.setdefault(number, {})
            known[mine] = branch if known.get(mine, branch) == branch else None
    return ends


def with_ends(action: ir.CoreAction, ends: ReadingEnds) -> ir.CoreAction:
    """The composition with the reading ends filled in."""
    if not any(ends.of_communication.values()):
        return action

    def change(part: Any) -> Any:
        if isinstance(part, ir.ReadValue | ir.ReadyEvent | ir.InputEvent):
            return replaced(part, source=replaced(part.source, end=ends.of_communication[id(part)]))
        return part

    return rewritten(action, change)
