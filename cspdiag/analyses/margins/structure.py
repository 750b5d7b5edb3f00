"""Where in the composition the control laws of a program run: which are active together, and which is served first."""

from __future__ import annotations

from cspdiag.base.record import record
from cspdiag.network.elaborate.constant_value import constant_value
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import Value
from cspdiag.network.ir.network import ConstantEnd, CoreNetwork, ProcessClass
from cspdiag.network.ir.walk import actions_inside

Branching = tuple[str, int]
"""A step down the composition: ``parallel``, ``loop`` or ``other``, and which part."""


@record
class Copy:
    """A process reads a channel into one of its variables: paths of both nets, as far as they are the process's own
    ends.
    """

    process: str
    source: ir.End
    variable: str


class Structure:
    """The ways from the outermost process down to each leaf, and the variables that are filled by reading."""

    def __init__(self, network: CoreNetwork) -> None:
        self._classes = {entry.name: entry for entry in network.classes}
        self._class_of = {instance.path: instance.class_name for instance in network.instances}
        self.ways: dict[str, list[tuple[Branching, ...]]] = {}
        self.priorities: dict[str, tuple[int, ...]] = {}
        self.copies: list[Copy] = []
        self._run(network.top, (), ())

    def are_active_together(self, one: str, other: str) -> bool:
        """Whether two leaves are parts of one mode: in parallel, or within one loop."""
        return any(_together(a, b) for a in self.ways[one] for b in self.ways[other])

    def _run(self, path: str, way: tuple[Branching, ...], priority: tuple[int, ...]) -> None:
        entry = self._classes[self._class_of[path]]
        if isinstance(entry, ProcessClass) and entry.body is not None:
            self._action(path, entry.body, way, priority)
        else:
            self.ways.setdefault(path, []).append(way)
            self.priorities.setdefault(path, priority)

    def _action(self, path: str, action: ir.CoreAction, way: tuple[Branching, ...], priority: tuple[int, ...]) -> None:
        match action:
            case ir.RunInstance():
                self._run(f"{path}.{action.instance}", way, priority)
            case ir.ReadValue():
                self.copies.append(Copy(path, action.source, action.target.channel))
            case _:  # Anything else consists of its parts.
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
                    self._action(path, part, (*way, (_kind(action), number)), inner)


def _kind(action: ir.CoreAction) -> str:
    match action:
        case ir.ParallelSteps():
            return "parallel"
        case ir.Repeat() | ir.WhileLoop() | ir.CountedLoop():
            return "loop"
        case _:  # Of the parts of anything else one runs at a time.
            return "other"


def _together(one: tuple[Branching, ...], other: tuple[Branching, ...]) -> bool:
    for (kind, number), (_, other_number) in zip(one, other, strict=False):
        if number != other_number:
            return kind == "parallel"
        if kind == "loop":
            return True
    return True


def end_name(end: ir.End) -> str:
    """The port or channel of the process that an end belongs to, as nets name it."""
    match end:
        case ir.ChannelEnd():
            return end.channel
        case ir.PortEnd():
            return end.port if end.index is None else f"{end.port}[{end.index}]"


def standing_inputs(network: CoreNetwork, path: str) -> dict[str, Value]:
    """What the inputs of a law read from the beginning: defaults, and the initial values of variables of the process
    around it.
    """
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
