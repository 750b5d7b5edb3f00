"""The state that the passes of name resolution and typing share."""

from __future__ import annotations

from typing import Literal, TypeAlias

from cspdiag.base import Diagnostic, Report, Span
from cspdiag.base.record import node
from cspdiag.base.spelling import Speller
from cspdiag.model.diagnostics.names import WrongKind
from cspdiag.model.program import Program, Scope, Symbol
from cspdiag.model.symbols import declared_at, described
from cspdiag.syntax import ast

Place: TypeAlias = Literal["constant", "process", "submodel", "environment"]


class Context:
    """The program under construction and the report.

    ``incomplete``: definitions may be missing because an import failed; unknown names are then silent.
    """

    def __init__(self, program: Program, report: Report, *, incomplete: bool) -> None:
        self.program = program
        self.report = report
        self.incomplete = incomplete
        self.speller = Speller()
        self.literals: set[ast.Node] = set()
        """Expressions that consist of numbers only, which take the number type that their surroundings require."""
        self.sizes: dict[ast.Node, int | None] = {}
        """Sizes of dimensions and counts of replicators; None where they depend on parameters."""
        self.repeated: set[ast.Node] = set()
        """Instances declared in a repetition, which has one for each value of its replicator."""
        self.guessing = False
        """Whether types are found by trial, because local values and operators with memory depend on each other."""

    def refuse(self, diagnostic: Diagnostic, *poisoned: ast.Node) -> None:
        """Report a diagnostic, and keep later passes silent about the nodes."""
        self.report.add(diagnostic)
        self.program.poisoned.update(poisoned)

    def refuse_kind(
        self, span: Span, name: str, symbol: Symbol, expected: str, advice: str | None, poisoned: ast.Node
    ) -> None:
        """Report that a name means a different kind of thing than expected."""
        kind, declared = described(symbol), declared_at(symbol)
        self.refuse(
            WrongKind(span, name=name, kind=kind, expected=expected, advice=advice, declared=declared), poisoned
        )

    @property
    def excuses_unknown_names(self) -> bool:
        """Whether a name may be unknown because of a mistake that was already reported."""
        return self.incomplete


@node
class Surroundings:
    """The place of an expression: what names mean there and which of them have a value.

    ``constant``: the expression must be known before the program runs (sizes, periods, arguments, initial values).
    """

    place: Place
    owner: ast.Node
    scope: Scope
    replicators: dict[str, ast.Replicator]
    constant: bool = False

    def within(self, replicator: ast.Replicator) -> Surroundings:
        """The surroundings inside a repetition by ``replicator``."""
        return Surroundings(
            place=self.place,
            owner=self.owner,
            scope=self.scope,
            replicators={**self.replicators, replicator.name.text: replicator},
            constant=self.constant,
        )

    def before_running(self) -> Surroundings:
        """The same place, for expressions that must be known before the program runs."""
        return Surroundings(
            place=self.place, owner=self.owner, scope=self.scope, replicators=self.replicators, constant=True
        )
