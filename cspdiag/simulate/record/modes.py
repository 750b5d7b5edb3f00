"""The parts of a program that are shown side by side: groups, their ports, and the modes they go through.

The branches of the parallel composition at the top are the groups (the joints of a robot); the processes that a group
runs one after the other are its modes (align, move, home).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from cspdiag.base.record import record
from cspdiag.network.ir import actions as act
from cspdiag.network.ir.network import CoreNetwork, Net, ProcessClass
from cspdiag.network.ir.walk import instances_run, parts


@record
class ModeGroup:
    """A part of the program with the paths of the processes and named groups that are its modes, and the external ports
    it uses.

    ``modes`` maps paths (``Jiwy.horizontal.alignL``) to names (``alignL``), in text order.
    """

    name: str
    modes: dict[str, str]
    ports: tuple[str, ...]

    __hash__ = object.__hash__


def mode_groups(network: CoreNetwork) -> tuple[ModeGroup, ...]:
    """The groups of a program; a program without parallel parts is one group."""
    top = network.class_named(network.top)
    if not isinstance(top, ProcessClass) or top.body is None:
        return ()
    found = _Found(network)
    return tuple(_group(found, top, branch) for branch in _branches(top.body))


class _Found:
    """What is found in a network once, for all its groups."""

    def __init__(self, network: CoreNetwork) -> None:
        self.top = network.top
        self.nets = [net for net in network.nets if net.external is not None]
        self._classes = {class_.name: class_ for class_ in network.classes}
        self._processes: dict[str, dict[str, ProcessClass[act.CoreAction]]] = {}

    def processes(self, enclosing: ProcessClass) -> dict[str, ProcessClass[act.CoreAction]]:
        """The classes of the processes that a process owns."""
        if enclosing.name not in self._processes:
            classes = ((instance.name, self._classes[instance.class_name]) for instance in enclosing.instances)
            self._processes[enclosing.name] = {name: one for name, one in classes if isinstance(one, ProcessClass)}
        return self._processes[enclosing.name]


def _branches(body: act.CoreAction) -> tuple[act.CoreAction, ...]:
    match body:
        case act.ParallelSteps(steps=steps):
            return tuple(part for step in steps for part in (_branches(step) if _is_parallel(step) else (step,)))
        case act.Group(body=inner) if isinstance(inner, act.ParallelSteps):
            return _branches(inner)
        case act.CatchException(body=inner) | act.InterruptOn(body=inner) | act.Repeat(body=inner):
            return _branches(inner)
        case (
            act.RunInstance() | act.ReadValue() | act.WriteValue() | act.AssignValue() | act.SkipStep()
            | act.StopStep() | act.WaitStep() | act.ResetInstance() | act.RaiseException() | act.SequentialSteps()
            | act.Choice() | act.WhileLoop() | act.CountedLoop() | act.IfElse() | act.Group()
        ):  # fmt: skip
            return (body,)
        case _:
            assert_never(body)


def _is_parallel(step: act.CoreAction) -> bool:
    return isinstance(step, act.ParallelSteps)


def _group(found: _Found, top: ProcessClass, branch: act.CoreAction) -> ModeGroup:
    members = tuple(dict.fromkeys(instances_run(branch)))
    name = branch.label if isinstance(branch, act.Group) else _common_name(members, found.top)
    paths = {f"{found.top}.{member}" for member in members}
    ports = tuple(net.path.partition(".")[2] for net in found.nets if _uses(net, paths))
    return ModeGroup(name, dict(_modes(found, top, found.top, branch)), ports)


def _common_name(members: tuple[str, ...], otherwise: str) -> str:
    """The name of a single instance, or of the array that all of them are elements of."""
    names = {member.partition("[")[0] for member in members}
    return members[0] if len(members) == 1 else names.pop() if len(names) == 1 else otherwise


def _uses(net: Net, paths: set[str]) -> bool:
    def inside(path: str) -> bool:
        return any(path == prefix or path.startswith(f"{prefix}.") for prefix in paths)

    return any(inside(path) for path, _ in (*net.readers, *net.writers))


def _modes(found: _Found, enclosing: ProcessClass, path: str, action: act.CoreAction) -> Iterator[tuple[str, str]]:
    """Processes that are run one after the other in ``action``; of a single one, those inside it."""
    classes = found.processes(enclosing)
    processes = [name for name in dict.fromkeys(instances_run(action)) if name in classes]
    groups = [step.label for step in parts(action) if isinstance(step, act.Group) and step is not action]
    if groups:
        yield from ((f"{path}.{label}", label) for label in groups)
    elif len(processes) == 1:
        inner = classes[processes[0]]
        below = list(_modes(found, inner, f"{path}.{processes[0]}", inner.body)) if inner.body is not None else []
        yield from below or [(f"{path}.{processes[0]}", processes[0])]
    else:
        yield from ((f"{path}.{name}", name) for name in processes)
