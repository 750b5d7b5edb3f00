"""The exceptions that may leave a composition, and handlers of exceptions that are never raised."""

from __future__ import annotations

from cspdiag.base import Report
from cspdiag.base.record import record
from cspdiag.base.span import Span
from cspdiag.model.program import Program
from cspdiag.network.diagnostics.usage import HandlerNeverRuns
from cspdiag.network.flow.raised import NO_EXCEPTIONS, Exceptions, Watched, exceptions_of
from cspdiag.network.shapes import Shape
from cspdiag.syntax import ast
from cspdiag.syntax.walk import nodes


@record
class _Catch:
    """A ``catch`` that a declared exception never reaches, in one of the shapes of its process."""

    process: ast.ProcessDefinition
    is_caught_inside: bool


class RaisedExceptions:
    """Follows the exceptions of a program, through its processes from the inside out.

    ``Timeout`` and ``Fault`` may come from almost any step and are ignored.
    """

    def __init__(self, program: Program, report: Report) -> None:
        self._program = program
        self._report = report
        self._by_shape: dict[Shape, Exceptions] = {}
        """The exceptions that may leave a process; None: any."""
        self._idle: dict[Span, _Catch] = {}
        self._useful: set[Span] = set()

    def process(self, shape: Shape) -> None:
        """Analyse a process; the processes of its instances must have been analysed before."""
        if shape.body is None or shape.incomplete:
            self._by_shape[shape] = None
            return

        def of_instance(name: str) -> Exceptions:
            inner = shape.instances[name].shape
            return NO_EXCEPTIONS if inner.is_submodel else self._by_shape.get(inner)

        self._by_shape[shape], watched = exceptions_of(shape.flow, of_instance)
        for found in watched:
            self._note(shape, found)

    def warn(self) -> None:
        """Report handlers that never run in any shape of their process."""
        idle = {span: found for span, found in self._idle.items() if span not in self._useful}
        processes = dict.fromkeys(found.process for found in idle.values())
        catches = {node.place: node for node in nodes(*processes) if isinstance(node, ast.Catch)}
        for span, found in idle.items():
            name = catches[span].exception
            declared = self._program.definitions.get(name.text)
            if isinstance(declared, ast.ExceptionDefinition):
                self._report.add(
                    HandlerNeverRuns(
                        span=name.span,
                        exception=name.text,
                        is_caught_inside=found.is_caught_inside,
                        declared=declared.name.span,
                    )
                )

    def _note(self, shape: Shape, found: Watched) -> None:
        catch, raised = found.catch, found.raised
        if raised is None or catch.exception in raised or not isinstance(shape.definition, ast.ProcessDefinition):
            self._useful.add(catch.span)
        else:
            idle = _Catch(process=shape.definition, is_caught_inside=catch.exception in found.caught_inside)
            self._idle.setdefault(catch.span, idle)
