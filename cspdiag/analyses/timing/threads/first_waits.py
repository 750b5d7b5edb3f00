"""Which actions wait before they compute anything, so no fault is possible before that wait has ended."""

from __future__ import annotations

from collections.abc import Mapping
from typing import assert_never

from cspdiag.analyses.timing.threads.offers import ChannelEnds
from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.code import Call, Communicate, Delay, Loop, Select, Watch
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.network import CoreClass, ProcessClass, SubmodelClass


class FirstWaits:
    """Examines how the actions of processes begin; ``class_of`` gives the class of an instance by its path."""

    def __init__(self, ends: ChannelEnds, class_of: Mapping[str, CoreClass | SubmodelClass]) -> None:
        self._channel_ends = ends
        self._class_of = class_of

    def begins_by_waiting(self, path: str, action: ir.CoreAction) -> bool:
        """Whether an action of the process at a path begins by waiting; False where that is not certain."""
        for instruction in flow_of(action).instructions:
            match instruction:
                case Loop() | Watch(step=ir.CatchException()):
                    pass
                case Communicate(step=ir.ReadValue() as step):
                    return self._read_waits(path, step)
                case Select(step=choice):
                    return all(one.condition is None and self._read_waits(path, one.event) for one in choice.branches)
                case Delay(step=step):
                    return any(offer.period for offer in self._channel_ends.delay(path, step.duration, 0, step.span))
                case Call(step=step):
                    return self._run_waits(path, step.instance)
                case _:  # Anything else comes before a wait, or may.
                    return False
        return False

    def _read_waits(self, path: str, action: ir.ReadValue | ir.Event) -> bool:
        match action:
            case ir.ReadyEvent(source=source):
                return bool(self._channel_ends.reading(path, source, 0, action))
            case ir.ReadValue(source=source, target=target) | ir.InputEvent(source=source, target=target):
                return not target.indexes and bool(self._channel_ends.reading(path, source, 0, action))
            case ir.OutputEvent() | ir.AfterEvent() | ir.SkipEvent():
                return False
            case _:
                assert_never(action)

    def _run_waits(self, path: str, name: str) -> bool:
        entry = self._class_of[f"{path}.{name}"]
        if isinstance(entry, ProcessClass):
            return entry.body is not None and self.begins_by_waiting(f"{path}.{name}", entry.body)
        owner = self._class_of[path]
        assert isinstance(owner, ProcessClass)
        declared = next(instance for instance in owner.instances if instance.name == name)
        inputs = {port.name for port in entry.ports if port.direction == "in"}
        return any(
            self._channel_ends.reading(
                f"{path}.{name}", ir.PortEnd(c.port, c.index, c.attachment.end), 0, declared, owner=path
            )
            for c in declared.connections
            if c.port in inputs and isinstance(c.attachment, ir.PortEnd | ir.ChannelEnd)
        )
