"""Alternatives and interrupts as Python control flow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import assert_never

from cspdiag.codegen.python.plain.composition.common import CompositionWriter, Method
from cspdiag.codegen.python.plain.composition.guards import GuardNames, Guards, guards_of, select_arguments
from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.text.code import (
    OR,
    TRUE,
    Argument,
    Call,
    Code,
    Comprehension,
    Conditional,
    Name,
    Parenthesized,
    WholeNumber,
    at_least,
    awaited,
    call,
    counted_to,
    mentions,
    own,
)
from cspdiag.codegen.python.text.rolling import template
from cspdiag.codegen.python.text.statements import (
    Block,
    Statements,
    assign,
    run,
)
from cspdiag.codegen.shared.trees import LEAST
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.faults import is_known_at_start
from cspdiag.network.ir.walk import parts


@dataclass
class Alternatives(CompositionWriter):
    """Writes the alternatives and interrupts of one process class."""

    def __post_init__(self) -> None:
        self.guard_names = GuardNames(self.members.names.fresh)

    def statements(self, action: ir.CoreAction) -> Statements:
        """An action as statements of a coroutine."""
        raise NotImplementedError

    def deferred(self, action: ir.CoreAction, hint: str | None = None) -> Code:
        """An action as an expression that can be awaited, for an action that begins later."""
        raise NotImplementedError

    def _single_guard(self, event: ir.Event) -> Statements:
        """The communication that an alternative with a single guard amounts to."""
        match event:
            case ir.InputEvent(source=source, target=target):
                return (self._read(event, source, target),)
            case ir.OutputEvent(sink=sink, value=value):
                written = self.members.sink(sink).call("write", self.printer.print(value))
                return (run(awaited(written), self._place(event)),)
            case ir.AfterEvent(duration=duration):
                waited = call(self.imports.runtime("wait"), self.printer.print(duration))
                return (run(awaited(waited), self._place(event)),)
            case ir.SkipEvent():
                return ()
            case ir.ReadyEvent():
                raise AssertionError("a ready guard needs an alternative")
            case _:
                assert_never(event)

    def _is_single_guard(self, choice: ir.Choice[ir.CoreAction]) -> bool:
        return (
            len(choice.branches) == 1
            and choice.branches[0].condition is None
            and not isinstance(choice.branches[0].event, ir.ReadyEvent)
        )

    def _choice(self, choice: ir.Choice[ir.CoreAction], hint: str) -> Statements:
        branches = choice.branches
        attribute = own(self.members.names.fresh(hint))
        alike = self._choice_alike(choice, attribute)
        if alike is not None:
            return alike
        guards = [Argument(self._guard(branch.event, self.initial)) for branch in branches]
        if choice.prioritized and len(branches) > 1:
            guards.append(Argument(TRUE, "prioritized"))
        self.alternatives.append(assign(attribute, Call(Name(self.imports.runtime("Alternative")), tuple(guards))))

        needs = self._guards(branches)
        selected = awaited(Call(attribute.field("select"), tuple(select_arguments(branches, needs))))
        taken = [(*self._taken(branch.event, attribute), *self.statements(branch.body)) for branch in branches]
        if len(branches) == 1:
            return (*needs.lines, run(selected, self._place(choice)), *taken[0])
        cases = [
            Block("case", WholeNumber(number), body, _one_line(branch.event.span.text) or None)
            for number, (branch, body) in enumerate(zip(branches, taken, strict=True))
        ]
        return (*needs.lines, Block("match", selected, tuple(cases), self._place(choice)))

    def _choice_alike(self, choice: ir.Choice[ir.CoreAction], attribute: Code) -> Statements | None:
        """An alternative whose branches differ only in an index, which is then the number of the chosen branch."""
        branches = choice.branches
        regular = (ir.InputEvent, ir.ReadyEvent)
        if len(branches) < LEAST or not all(isinstance(b.event, regular) and is_plain(b.body) for b in branches):
            return None
        bodies = [(*self._taken(branch.event, attribute), *self.statements(branch.body)) for branch in branches]
        index, count = self.members.index_around(bodies), len(branches)
        guard = template([self._guard(branch.event, self.initial) for branch in branches], index)
        condition = template([self._condition(branch) for branch in branches], index)
        body = template(bodies, index)
        places = {None if b.condition is None else self._place_of_fault(b.condition, b) for b in branches}
        if guard is None or condition is None or body is None or len(places) > 1:
            return None
        place = places.pop()
        guards = [Argument(Comprehension(guard, index, counted_to(count), "()"), starred=True)]
        if choice.prioritized:
            guards.append(Argument(TRUE, "prioritized"))
        self.alternatives.append(assign(attribute, Call(Name(self.imports.runtime("Alternative")), tuple(guards))))
        before: Statements = ()
        enabled = [] if condition == TRUE else [Argument(Comprehension(condition, index, counted_to(count)), "enabled")]
        if place is not None:
            name = self.guard_names.local("enabled")
            before = (assign(name, enabled[0].value, place),)
            enabled = [Argument(Name(name), "enabled")]
        selected = awaited(Call(attribute.field("select"), tuple(enabled)))
        is_used = mentions(body, index)
        select = assign(index, selected, self._place(choice)) if is_used else run(selected, self._place(choice))
        return (*before, select, *body)

    def _guard(self, event: ir.Event, printer: Printer, needed: Code | None = None) -> Code:
        match event:
            case ir.ReadyEvent(source=source):
                return call(self.imports.runtime("Ready"), self.members.source(source))
            case ir.InputEvent(source=source):
                return call(self.imports.runtime("Input"), self.members.source(source))
            case ir.OutputEvent(sink=sink, value=value):
                # The value is passed at each selection; only an interrupt creates a new guard each time.
                given = () if printer is self.initial else (needed or printer.print(value),)
                return call(self.imports.runtime("Output"), self.members.sink(sink), *given)
            case ir.AfterEvent(duration=duration):
                deferred = printer is self.initial and not is_known_at_start(duration)
                delay = WholeNumber(0) if deferred else needed or printer.print(duration)
                return call(self.imports.runtime("After"), delay)
            case ir.SkipEvent():
                return call(self.imports.runtime("Skip"))
        assert_never(event)

    def _guards(self, branches: Sequence[ir.Branch[ir.CoreAction]], *, always: bool = False) -> Guards:
        """The values that guards need, evaluated when the alternative begins."""
        return guards_of(
            branches, self.printer.print, self._may_fault, self.imports.names, self.guard_names, always=always
        )

    def _condition(self, branch: ir.Branch[ir.CoreAction]) -> Code:
        return TRUE if branch.condition is None else self.printer.print(branch.condition)

    def _taken(self, event: ir.Event, attribute: Code) -> Statements:
        if isinstance(event, ir.InputEvent):
            place = self._place(event) if event.target.indexes else None
            return (self._set(event.target, attribute.field("value"), place),)
        return ()

    def _interrupt(self, body: ir.CoreAction, branch: ir.Branch[ir.CoreAction], needs: Guards) -> Code:
        guard = self._guard(branch.event, self.printer, needs.needed.get(0))
        interrupted = self.deferred(body)
        taken: Statements = ()
        if isinstance(branch.event, ir.InputEvent):
            attribute = own(self.members.names.fresh("interruption"))
            self.alternatives.append(assign(attribute, guard))
            guard = attribute
            taken = self._taken(branch.event, attribute)
        handler = (*taken, *self.statements(branch.body))
        name = "_continue"
        if handler or name not in self.members.names:
            name = self.members.names.fresh("_interrupted" if handler else name)
            self.methods.append(Method(name, handler))
        interrupting = call(self.imports.runtime("interrupt"), interrupted, guard, own(name))
        condition = needs.conditions[0]
        if condition is None:
            return interrupting
        if any(interrupted == own(method.name) for method in self.methods):
            interrupted = call(interrupted)
        return Parenthesized(Conditional(interrupting, at_least(condition, OR), interrupted))


def is_plain(action: ir.CoreAction) -> bool:
    """Whether an action needs no alternative and no coroutine of its own."""
    return not any(isinstance(part, ir.Choice | ir.ParallelSteps | ir.InterruptOn | ir.Group) for part in parts(action))


def _one_line(text: str) -> str:
    return " ".join(text.split())
