"""Which exceptions come out of a composition, and handlers of those that never do."""

from __future__ import annotations

from cspdiag.base import Report
from cspdiag.base.record import record
from cspdiag.base.span import Span
from cspdiag.model.program import Program
from cspdiag.network.diagnostics.usage import HandlerNeverRuns
from cspdiag.network.infer.ends import actions_inside
from cspdiag.network.ir.actions import Action, CatchException, RaiseException, RunInstance
from cspdiag.network.shapes import Shape
from cspdiag.network.syntax_walk import nodes
from cspdiag.syntax import ast


@record
class _Catch:
    """A ``catch`` of a declared exception that never comes to it, in one of the shapes of its process."""

    process: ast.ProcessDefinition
    is_caught_inside: bool


@record
class _Ends:
    """The exceptions that may come out of an action (None: anything), and those that are caught inside."""

    raised: frozenset[str] | None = frozenset()
    caught: frozenset[str] = frozenset()


_NONE = _Ends()


class RaisedExceptions:
    """Follows the exceptions of a program, its processes inside out. ``Timeout`` and ``Fault`` may come from nearly any step and are left aside."""

    def __init__(self, program: Program, report: Report) -> None:
        self._program = program
        self._report = report
        self._by_shape: dict[Shape, frozenset[str] | None] = {}
        """What may come out of a process; None: anything."""
        self._idle: dict[Span, _Catch] = {}
        self._useful: set[Span] = set()

    def process(self, shape: Shape) -> None:
        """Look at a process; those of its instances were looked at before."""
        if shape.body is None or shape.incomplete:
            self._by_shape[shape] = None
        else:
            self._by_shape[shape] = self._of(shape, shape.body).raised

    def warn(self) -> None:
        """Report handlers that run in no shape of their process."""
        processes = dict.fromkeys(found.process for found in self._idle.values())
        catches = {node.span: node for node in nodes(*processes) if isinstance(node, ast.Catch)}
        for span, found in self._idle.items():
            name = catches[span].exception
            declared = self._program.definitions.get(name.text)
            if span not in self._useful and isinstance(declared, ast.ExceptionDefinition):
                self._report.add(
                    HandlerNeverRuns(
                        span=name.span,
                        exception=name.text,
                        is_caught_inside=found.is_caught_inside,
                        declared=declared.name.span,
                    )
                )

    def _of(self, shape: Shape, action: Action) -> _Ends:
        match action:
            case RaiseException():
                return _Ends(raised=frozenset({action.exception}))
            case RunInstance():
                inner = shape.instances[action.instance].shape
                return _NONE if inner.is_submodel else _Ends(raised=self._by_shape.get(inner))
            case CatchException():
                body = self._of(shape, action.body)
                self._note(shape, action, body)
                caught = None if body.raised is None else body.raised - {action.exception}
                inside = _Ends(raised=caught, caught=body.caught | {action.exception})
                return _together([inside, self._of(shape, action.handler)])
            case _:
                return _together([self._of(shape, part) for part in actions_inside(action)])

    def _note(self, shape: Shape, catch: CatchException, body: _Ends) -> None:
        if (
            body.raised is None
            or catch.exception in body.raised
            or not isinstance(shape.definition, ast.ProcessDefinition)
        ):
            self._useful.add(catch.span)
        else:
            found = _Catch(process=shape.definition, is_caught_inside=catch.exception in body.caught)
            self._idle.setdefault(catch.span, found)


def _together(parts: list[_Ends]) -> _Ends:
    """How one of several parts may end."""
    if len(parts) < 2:
        return parts[0] if parts else _NONE
    known = [part.raised for part in parts if part.raised is not None]
    raised = frozenset().union(*known) if len(known) == len(parts) else None
    return _Ends(raised=raised, caught=frozenset().union(*(part.caught for part in parts)))
