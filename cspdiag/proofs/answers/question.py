"""Questions: the assertions of a program, or what is expected of a program that asserts nothing."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar, Literal, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.model.program import Program
from cspdiag.syntax import ast

Property: TypeAlias = Literal["deadlock free", "livelock free", "terminates", "schedulable", "refines"]

EXPECTED: tuple[Property, ...] = ("deadlock free", "livelock free")
"""The properties that a process is expected to have without an assertion."""


@record
class Question:
    """A property that a process may have.

    ``specification``, ``model``, ``hidden`` (ports of the process whose events the specification does not see) and
    ``free`` (inputs that only the specification has, whose values it chooses itself) belong to ``refines``. ``span`` is
    the assertion, or the name of the process where nothing was asserted.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    process: str
    claim: Property
    span: Span
    specification: str | None = None
    model: Literal["traces", "failures"] = "traces"
    hidden: tuple[str, ...] = ()
    free: tuple[str, ...] = ()
    asserted: bool = True

    @property
    def processes(self) -> tuple[str, ...]:
        """The processes that the question is about."""
        return (self.process,) if self.specification is None else (self.process, self.specification)

    @property
    def unseen(self) -> tuple[str, ...]:
        """The ports that are not compared."""
        return (*self.hidden, *self.free)

    @property
    def text(self) -> str:
        """The assertion as the language writes it, without ``assert``."""
        if self.claim != "refines":
            return f"{self.process} {self.claim}"
        model = " in failures" if self.model == "failures" else ""
        hidden = f" hide {', '.join(self.hidden)}" if self.hidden else ""
        return f"{self.process} refines {self.specification}{model}{hidden}"


def questions_of(program: Program, process: str | None = None) -> tuple[Question, ...]:
    """The assertions of the main file, or only those about ``process``."""
    return tuple(
        _asserted(assertion, program)
        for assertion in program.assertions
        if assertion.span.source is program.main.source and process in (None, assertion.process.text)
    )


def expected_of(program: Program, process: str) -> tuple[Question, ...]:
    """The questions about a process without assertions: is it free from deadlock and from livelock?"""
    definition = program.definitions[process]
    assert isinstance(definition, ast.ProcessDefinition)
    return tuple(Question(process, expected, definition.name.span, asserted=False) for expected in EXPECTED)


def schedulability_of(program: Program, process: str) -> Question:
    """The question whether a process is schedulable: the assertion of the program, or an expectation if it has none."""
    asserted = (question for question in questions_of(program, process) if question.claim == "schedulable")
    return next(asserted, Question(process, "schedulable", program.definitions[process].name.span, asserted=False))


def _asserted(assertion: ast.Assertion, program: Program) -> Question:
    return Question(
        process=assertion.process.text,
        claim=assertion.property,
        span=assertion.span,
        specification=None if assertion.specification is None else assertion.specification.text,
        model=assertion.model,
        hidden=tuple(port.text for port in assertion.hidden),
        free=_free(assertion, program),
    )


def _free(assertion: ast.Assertion, program: Program) -> tuple[str, ...]:
    """The inputs that the specification has and the process does not."""
    if assertion.specification is None:
        return ()
    process, specification = (
        program.definitions.get(name.text) for name in (assertion.process, assertion.specification)
    )
    if not isinstance(process, ast.ProcessDefinition) or not isinstance(specification, ast.ProcessDefinition):
        return ()
    own = {name for name, _ in _ports(process)}
    return tuple(name for name, direction in _ports(specification) if direction == "in" and name not in own)


def _ports(definition: ast.ProcessDefinition) -> Iterator[tuple[str, str]]:
    for declared in definition.ports:
        for declarator in declared.names:
            yield declarator.name.text, declared.direction
