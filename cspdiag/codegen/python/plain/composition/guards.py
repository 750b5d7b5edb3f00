"""The conditions, values and durations that guards need when their alternative begins, evaluated guard by guard in text
order.

Whatever can fault gets a statement of its own, so the first fault is reported at its line; the rest is evaluated where
it is used.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

from cspdiag.base.span import Span
from cspdiag.codegen.python.text.code import (
    NONE,
    OR,
    TRUE,
    Argument,
    Code,
    Conditional,
    Entry,
    Items,
    Name,
    WholeNumber,
    at_least,
    tuple_of,
)
from cspdiag.codegen.python.text.names import PackageNames
from cspdiag.codegen.python.text.statements import Statement, assign
from cspdiag.network.ir.actions import AfterEvent, Branch, OutputEvent, Step
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.faults import is_known_at_start


@dataclass
class GuardNames:
    """The local variables of a process for the values of guards; all alternatives share them, because each uses them
    only when it begins.
    """

    fresh: Callable[[str], str]
    locals: dict[str, str] = field(default_factory=dict)

    def local(self, word: str) -> str:
        """The variable for a word."""
        if word not in self.locals:
            self.locals[word] = self.fresh(word)
        return self.locals[word]


@dataclass
class Guards:
    """The guards of one alternative or interrupt. ``place`` gives the source place of a span."""

    printed: Callable[[Expression], Code]
    can_fault: Callable[[Expression], bool]
    place: Callable[[Span], str]
    names: GuardNames
    always: bool = False
    """Whether a duration is evaluated even if it is known at the start."""
    lines: list[Statement] = field(default_factory=list)
    """The statements before the alternative."""
    conditions: list[Code | None] = field(default_factory=list)
    needed: dict[int, Code] = field(default_factory=dict)
    """Values and durations, by number."""

    def add(self, branch: Branch) -> None:
        """Add the next guard."""
        condition = None
        if branch.condition is not None:
            condition = self.printed(branch.condition)
            if self.can_fault(branch.condition):
                condition = self._kept(
                    f"enabled_{len(self.conditions)}", condition, branch.condition.span or branch.span
                )
        number = len(self.conditions)
        self.conditions.append(condition)
        match branch.event:
            case OutputEvent(value=value):
                self.needed[number] = self._needed(f"value_{number}", value, branch.event, condition, NONE)
            case AfterEvent(duration=duration) if self.always or not is_known_at_start(duration):
                self.needed[number] = self._needed(
                    f"duration_{number}", duration, branch.event, condition, WholeNumber(0)
                )

    def _needed(self, name: str, expression: Expression, step: Step, condition: Code | None, otherwise: Code) -> Code:
        code = self.printed(expression)
        if not self.can_fault(expression):
            return code
        if condition is not None:
            code = Conditional(at_least(code, OR), at_least(condition, OR), otherwise)
        return self._kept(name, code, step.span)

    def _kept(self, name: str, code: Code, span: Span) -> Code:
        local = self.names.local(name)
        self.lines.append(assign(local, code, self.place(span)))
        return Name(local)


def select_arguments(branches: Sequence[Branch], guards: Guards) -> list[Argument]:
    """The arguments of ``select``."""
    found = []
    if any(condition is not None for condition in guards.conditions):
        found.append(Argument(tuple_of(condition or TRUE for condition in guards.conditions), "enabled"))
    for kind, name in ((OutputEvent, "values"), (AfterEvent, "delays")):
        entries = tuple(
            Entry(str(number), code)
            for number, code in guards.needed.items()
            if isinstance(branches[number].event, kind)
        )
        if entries:
            found.append(Argument(Items("{}", entries), name))
    return found


def guards_of(
    branches: Iterable[Branch],
    printed: Callable[[Expression], Code],
    can_fault: Callable[[Expression], bool],
    package: PackageNames,
    names: GuardNames,
    *,
    always: bool,
) -> Guards:
    """The values that the guards of an alternative need, evaluated when it begins."""
    found = Guards(printed, can_fault, lambda span: package.place(span.file, span.line), names, always)
    for branch in branches:
        found.add(branch)
    return found
