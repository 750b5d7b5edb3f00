"""Records writes to variables for the plot; they are not communications, so not part of a trace."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from cspdiag.model.types import has_unit
from cspdiag.network.ir.network import CoreNetwork

if TYPE_CHECKING:
    from cspdiag.runtime import Network as RunningNetwork
    from cspdiag.runtime import Process, Routine, Variable
    from cspdiag.simulate.record.recorder import Recorder


def probe(running: RunningNetwork, network: CoreNetwork, recorder: Recorder) -> None:
    """Let every variable with a unit report its writes to ``recorder``, from now on."""
    from cspdiag.runtime import Variable

    wanted = {net.path for net in network.nets if net.kind == "var" and has_unit(net.type)}

    class ProbedVariable(Variable[float]):
        """Reports its writes; there is one class for each run, because variables have no room for a recorder."""

        __slots__ = ()

        def __setattr__(self, name: str, value: float) -> None:
            super().__setattr__(name, value)
            recorder.variable_written(running.now, self.name, value)

    for variable in _variables(running.process):
        if variable.name in wanted:
            variable.__class__ = ProbedVariable


def _variables(process: object) -> Iterator[Variable[float]]:
    from cspdiag.runtime import Variable

    return (part for part in parts_of(process) if isinstance(part, Variable))


def parts_of(process: object) -> Iterator[object]:
    """A process of a running network and everything that it consists of, each once."""
    from cspdiag.runtime import Process, Routine

    pending: list[object] = [process]
    seen: set[int] = set()
    while pending:
        item = pending.pop()
        if id(item) in seen:
            continue
        seen.add(id(item))
        yield item
        if isinstance(item, list | tuple):
            pending += item
        elif isinstance(item, Process | Routine):
            pending += _attributes(item)


def _attributes(item: Process | Routine) -> Iterator[object]:
    """The values of all attributes, those in slots too."""
    yield from getattr(item, "__dict__", {}).values()
    names = [name for class_ in type(item).__mro__ for name in getattr(class_, "__slots__", ())]
    yield from (getattr(item, name) for name in names if hasattr(item, name))
