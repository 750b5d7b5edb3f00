"""The places of the tasks of a run on the reference semantics, and the origin of an exception, in the words of
generated programs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from posixpath import dirname
from types import TracebackType
from typing import Any

from cspdiag.base import Span
from cspdiag.codegen.shared.laws.equations import changes
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import Network, SubmodelClass
from cspdiag.runtime.kernel.exceptions import Place
from cspdiag.semantics.choice import Interrupt
from cspdiag.semantics.equations.laws import Law
from cspdiag.semantics.instances import ProcessInstance
from cspdiag.semantics.media import Broadcast, Offer
from cspdiag.semantics.requests import Parallel, Request, Task, Wait
from cspdiag.semantics.submodels import SubmodelInstance
from cspdiag.simulate.deadlock.waiting import WaitingRecord, broadcast_readers


class Whereabouts:
    """Finds places in the text of a network from the frames of its interpreter."""

    def __init__(self, network: Network) -> None:
        self._network = network
        self._folder = dirname(network.source)

    def origin(self, error: BaseException) -> tuple[Place | None, str | None]:
        """The process in which an exception was raised, None if in no process, and the source line where that was, if
        it is known.
        """
        found = _Found()
        traceback: TracebackType | None = error.__traceback__
        while traceback is not None:
            found.enter(traceback.tb_frame.f_locals)
            traceback = traceback.tb_next
        line = None if found.span is None else self._line(found.span)
        return (Place(found.path, line) if found.path else None), line

    def waiting(self, main: Task) -> list[WaitingRecord]:
        """All waiting processes, in text order."""
        readers = broadcast_readers(self._network)
        return [self._record(task, task.request, readers) for task in _leaves(main) if task.request is not None]

    def _record(self, task: Task, request: Request, readers: Mapping[str, Sequence[str]]) -> WaitingRecord:
        found = _Found()
        steps: Any = task.steps
        while getattr(steps, "gi_frame", None) is not None:
            found.enter(steps.gi_frame.f_locals)
            steps = steps.gi_yieldfrom
        offers = request.offers_now()
        words = [f"to {'write' if offer.writes else 'read'} {offer.medium.name}" for offer in offers]
        if not words:
            is_stop = isinstance(request, Wait)
            words = ["forever, at stop" if is_stop else "for an alternative of which no guard is enabled"]
        place = "" if found.span is None else self._line(found.span)
        return WaitingRecord(
            path=found.path,
            place=place,
            waits=" or ".join(dict.fromkeys(words)),
            channels=tuple(offer.medium.name for offer in offers),
            missing=tuple(readers[offer.medium.name][end] for offer in offers for end in _missing(offer)),
        )

    def _line(self, span: Span) -> str:
        inside = span.file.removeprefix(f"{self._folder}/") if self._folder else span.file
        return f"{inside}:{span.line}"


class _Found:
    """The innermost process and statement of some frames, entered from outside."""

    def __init__(self) -> None:
        self.path = ""
        self.span: Span | None = None

    def enter(self, local: Mapping[str, Any]) -> None:
        """Enter a frame, given by its local variables."""
        match local.get("self"):
            case ProcessInstance() as process:
                self.path = process.path
                self._at(next((local[name] for name in ("condition", "action", "event") if name in local), None))
            case SubmodelInstance() as law:
                owner = law.owner
                assert isinstance(owner, ProcessInstance)
                name = next(name for name, other in owner.submodels.items() if other is law)
                self.path, self.span = f"{owner.path}.{name}", law.cls.span
            case Law() as law:
                self._at(_part_of(law.cls, local.get("expression")))
                self._at(_change(law.cls, local.get("moved")))
            case _:
                pass  # Frames of the interpreter itself.

    def _at(self, part: Any) -> None:
        if part is not None:
            self.span = part.span


def _part_of(law: SubmodelClass, expression: Expression | None) -> Declared | None:
    """What the expression is the whole right-hand side of."""
    for part in (*law.constants, *law.equations, *law.derivative_equations):
        if isinstance(part, SubmodelEquation) and part.value is expression:
            return part
        if isinstance(part, ExternalCall) and any(value is expression for _, value in part.inputs):
            return part
    for name, value in (*law.next_values, *law.derivatives):
        if value is expression:
            return _change(law, name)
    return next((state for state in law.states if state.initial is expression), None)


def _change(law: SubmodelClass, state: object) -> Declared | None:
    """The state with this name, at the place of its ``next`` or ``der``."""
    return changes(law).get(state) if isinstance(state, str) else None


def _leaves(task: Task) -> Iterator[Task]:
    """The tasks that do not wait for tasks that they run themselves."""
    match task.request:
        case Parallel(tasks=tasks):
            for branch in tasks:
                if not branch.ended:
                    yield from _leaves(branch)
        case Interrupt(body=body) if not body.ended:
            yield from _leaves(body)
        case _:  # Any other request is the task's own.
            yield task


def _missing(offer: Offer) -> tuple[int, ...]:
    """The numbers of the ends of a broadcast for which a writer waits."""
    medium = offer.medium
    if not (isinstance(medium, Broadcast) and offer.writes):
        return ()
    awaited = {other.end for other in medium.offers if not other.writes}
    missing = medium.missing if medium.writing is offer else [end for end in medium.ends if end not in awaited]
    return tuple(index for index, end in enumerate(medium.ends) if end in missing)
