"""Where in the composition the control laws of a program run: which are active together, and their priorities."""

from __future__ import annotations

from cspdiag.base.record import record
from cspdiag.network.elaborate.constant_value import constant_value
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import Value
from cspdiag.network.ir.network import ConstantEnd, CoreNetwork, ProcessClass
from cspdiag.network.ir.walk import actions_inside

Branching = tuple[str, int]
"""A step down the composition: ``parallel``, ``loop`` or ``other``, and the number of the part."""


@record
class Copy:
    """A process reads a port or channel into one of its variables."""

    process: str
    source: ir.End
    variable: str


class Structure:
    """The positions of each leaf process in the composition of the program, and the variables that are filled by
    reading.
    """

    def __init__(self, network: CoreNetwork) -> None:
        self._classes = {entry.name: entry for entry in network.classes}
        self._class_of = {instance.path: instance.class_name for instance in network.instances}
        self.positions: dict[str, list[tuple[Branching, ...]]] = {}
        self.priorities: dict[str, tuple[int, ...]] = {}
        self.copies: list[Copy] = []
        self._run(network.top, (), ())

    def are_active_together(self, one: str, other: str) -> bool:
        """Whether two leaf processes belong to the same mode: they are in parallel, or in the same loop."""
        return any(_are_active_together(a, b) for a in self.positions[one] for b in self.positions[other])

    def _run(self, path: str, position: tuple[Branching, ...], priority: tuple[int, ...]) -> None:
        entry = self._classes[self._class_of[path]]
        if isinstance(entry, ProcessClass) and entry.body is not None:
            self._action(path, entry.body, position, priority)
        else:
            self.positions.setdefault(path, []).append(position)
            self.priorities.setdefault(path, priority)

    def _action(
        self, path: str, action: ir.CoreAction, position: tuple[Branching, ...], priority: tuple[int, ...]
    ) -> None:
        match action:
            case ir.RunInstance():
                self._run(f"{path}.{action.instance}", position, priority)
            case ir.ReadValue():
                self.copies.append(Copy(path, action.source, action.target.channel))
            case _:  # Any other action consists of its parts.
                if isinstance(action, ir.Choice | ir.InterruptOn):
                    branches = action.branches if isinstance(action, ir.Choice) else (action.branch,)
                    self.copies += [
                        Copy(path, branch.event.source, branch.event.target.channel)
                        for branch in branches
                        if isinstance(branch.event, ir.InputEvent)
                    ]
                ranked = isinstance(action, ir.ParallelSteps) and action.prioritized
                for number, part in enumerate(actions_inside(action)):
                    inner = (*priority, number) if ranked else priority
                    self._action(path, part, (*position, (_kind(action), number)), inner)


def _kind(action: ir.CoreAction) -> str:
    match action:
        case ir.ParallelSteps():
            return "parallel"
        case ir.Repeat() | ir.WhileLoop() | ir.CountedLoop():
            return "loop"
        case _:  # Of the parts of any other action one runs at a time.
            return "other"


def _are_active_together(one: tuple[Branching, ...], other: tuple[Branching, ...]) -> bool:
    for (kind, number), (_, other_number) in zip(one, other, strict=False):
        if number != other_number:
            return kind == "parallel"
        if kind == "loop":
            return True
    return True


def end_name(end: ir.End) -> str:
    """The name of a port or channel of a process, as nets have it."""
    match end:
        case ir.ChannelEnd():
            return end.channel
        case ir.PortEnd():
            return end.port if end.index is None else f"{end.port}[{end.index}]"


def initial_inputs(network: CoreNetwork, path: str) -> dict[str, Value]:
    """The initial values of the inputs of a law: defaults, and initial values of variables of the enclosing process."""
    above, _, name = path.rpartition(".")
    arguments = {instance.path: dict(instance.arguments) for instance in network.instances}.get(above, {})
    owner = next((entry for entry in network.instances if entry.path == above), None)
    process = None if owner is None else network.class_named(owner.class_name)
    if not isinstance(process, ProcessClass):
        return {}
    variables = {channel.name: channel.initial for channel in process.channels if channel.kind == "var"}
    declared = next(instance for instance in process.instances if instance.name == name)
    found: dict[str, Value] = {}
    for connection in declared.connections:
        attached = connection.attachment
        first = attached.value if isinstance(attached, ConstantEnd) else None
        if isinstance(attached, ir.ChannelEnd):
            first = variables.get(attached.channel)
        value = None if first is None else constant_value(first, lambda part: arguments.get(part.name))
        if value is not None:
            found[connection.port if connection.index is None else f"{connection.port}[{connection.index}]"] = value
    return found
