"""Alternatives and interrupts as the code of a generator function.

A selection is arithmetic on the bits of the guards that are ready, so it takes equally long for ten guards and for a
hundred.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal, assert_never

from cspdiag.codegen.python.fast.expressions import FastPrinter
from cspdiag.codegen.python.fast.values import Values, one_line
from cspdiag.codegen.python.plain.composition.guards import GuardNames, Guards, guards_of, select_arguments
from cspdiag.codegen.python.text.code import (
    BITS_AND,
    BITS_OR,
    COMPARISON,
    NONE,
    SHIFT,
    SUM,
    TRUE,
    Argument,
    Call,
    Code,
    Comprehension,
    Name,
    Parenthesized,
    WholeNumber,
    call,
    counted_from,
    delegated,
    integer,
)
from cspdiag.codegen.python.text.operators import infix, infix_all, minus, negated
from cspdiag.codegen.python.text.rolling import alike_runs
from cspdiag.codegen.python.text.statements import YIELD, Block, Statement, Statements, assign, else_, if_, run
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.faults import is_known_at_start, may_fault


@dataclass
class Alternatives(Values):
    """Writes the selections of one process class."""

    choices: dict[str, Code] = field(default_factory=dict)
    """The constructor calls of the alternatives, by name."""
    choice_names: dict[str, str] = field(default_factory=dict)
    selectors: dict[str, Code] = field(default_factory=dict)
    """Local variables for the selectors of alternatives."""
    memories: dict[str, str] = field(default_factory=dict)
    """Local variables for the last choices of fair alternatives."""

    def __post_init__(self) -> None:
        self.guard_names = GuardNames(self.spelling.names.fresh)

    def branch(self, step: ir.Action) -> Code:
        """A process to run in parallel with others."""
        raise NotImplementedError

    def run_here(self, name: str) -> Statements:
        """Run an instance in sequence."""
        raise NotImplementedError

    def _choice(self, choice: ir.Choice) -> Statements:
        name = choice.name or self.spelling.names.fresh("choice")
        branches = choice.branches
        guards = self._arguments([self._guard(branch.event, self.initial, made=True) for branch in branches])
        if choice.prioritized and len(branches) > 1:
            guards.append(Argument(TRUE, "prioritized"))
        self.choices[name] = Call(Name(self.imports.runtime("Alternative")), tuple(guards))
        attribute = self.choice_names.setdefault(name, self.spelling.names.fresh(name))
        local = self.spelling.bind(attribute)
        if self._is_inline(choice):
            return (self.comment(choice), *self._selection(choice, attribute, local))
        return (self.comment(choice), *self._slow_selection(choice, local))

    def _arguments(self, guards: Sequence[Code]) -> list[Argument]:
        """The guards of an alternative; those that count are a comprehension."""
        index = self.spelling.members.index
        return [
            Argument(Comprehension(guard, index, counted_from(start, turns), "()"), starred=True)
            if turns > 1
            else Argument(guard)
            for start, turns, guard in alike_runs(guards, index)
        ]

    def _is_inline(self, choice: ir.Choice) -> bool:
        for branch in choice.branches:
            match branch.event:
                case ir.InputEvent(source=source) | ir.ReadyEvent(source=source):
                    if self.spelling.medium(source).guarded_writes:
                        return False
                case ir.SkipEvent():
                    pass
                case ir.AfterEvent(duration=duration):
                    known = self.printer.value(duration)
                    if not isinstance(known, int) or known <= 0:
                        return False
                case ir.OutputEvent():
                    return False
                case _:
                    assert_never(branch.event)
        return True

    def _selection(self, choice: ir.Choice, attribute: str, local: Code) -> Iterator[Statement]:
        branches, ready, k = choice.branches, self.spelling["ready"], self.spelling["k"]
        guards = self._guards(attribute, local)
        yield from self.communications.check()
        mask: Code | None = None
        if any(branch.condition is not None for branch in branches):
            needs = self._needs(branches)
            yield from self._evaluated(needs, choice)
            mask = self.spelling["mask"]
            yield assign(mask, self._mask(needs.conditions))
        yield self._ready(guards, mask)
        yield from self._parked(choice, local, guards, mask)
        if len(branches) > 1 and not choice.prioritized:
            yield from self._next_in_turn(self._memory(attribute, local))
        elif len(branches) > 1:
            yield assign(k, infix("-", SUM, _position(ready), WholeNumber(1)))
        yield from self._chosen(branches, lambda event, bit: self._taken(event, guards, bit))

    def _next_in_turn(self, after: Code) -> Iterator[Statement]:
        """Choose the first ready guard from ``after`` on."""
        ready, k, first = (self.spelling[name] for name in ("ready", "k", "first"))
        yield assign(first, infix(">>", SHIFT, ready, after))
        yield if_(negated(first), assign(first, ready), assign(after, WholeNumber(0)))
        yield assign(k, infix("-", SUM, infix("+", SUM, after, _position(first)), WholeNumber(1)))
        yield assign(after, infix("+", SUM, k, WholeNumber(1)))

    def _ready(self, guards: Code, mask: Code | None) -> Statement:
        """The guards that are ready now."""
        ready = guards.field("ready")
        return assign(self.spelling["ready"], infix("&", BITS_AND, ready, mask) if mask else ready)

    def _guards(self, attribute: str, local: Code) -> Code:
        """The local variable for the selector of an alternative."""
        if attribute not in self.selectors:
            self.selectors[attribute] = Name(self.spelling.names.fresh(f"{attribute}_guards"))
            self.prologue.append(assign(self.selectors[attribute], local.field("selector")))
        return self.selectors[attribute]

    def _parked(self, choice: ir.Choice, local: Code, guards: Code, mask: Code | None) -> Iterator[Statement]:
        """Wait until a guard is ready."""
        me, ready, wanted = self.spelling["me"], self.spelling["ready"], mask or integer(-1)
        announced = {self._announced(branch.event) for branch in choice.branches}
        parked = (
            run(local.call("park", me, wanted)),
            YIELD,
            assign(guards.field("waiting"), NONE),
            *self.communications.check(),
            self._ready(guards, mask),
        )
        waiting = (*self.set_current_task(), assign(ready, delegated(local.call("wait", wanted))))
        if "always" in announced:
            yield if_(negated(ready), *waiting)
        elif "at first" in announced:
            attended = infix("&", BITS_AND, guards.field("attend"), mask) if mask else guards.field("attend")
            yield Block("while", negated(ready), (if_(attended, *waiting), else_(*parked)))
        else:
            yield Block("while", negated(ready), parked)

    def _announced(self, event: ir.Event) -> Literal["never", "at first", "always"]:
        """When an alternative that waits is announced to the end of a guard: to that of samples while its session has
        not begun.
        """
        if not isinstance(event, ir.InputEvent | ir.ReadyEvent):
            return "never" if isinstance(event, ir.SkipEvent) else "always"
        kind = self.spelling.medium(event.source).kind
        if kind in ("sync", "event", "buffer", "overwrite", "any"):
            return "never"
        return "at first" if kind == "sampled" else "always"

    def _memory(self, attribute: str, local: Code) -> Code:
        if self.spelling.runs_again:
            return local.field("after")
        if attribute not in self.memories:
            self.memories[attribute] = self.spelling.names.fresh(f"{attribute}_after")
        return Name(self.memories[attribute])

    def _mask(self, conditions: Sequence[Code | None]) -> Code:
        fixed = sum(1 << index for index, code in enumerate(conditions) if code is None)
        parts = [
            infix("<<", SHIFT, Parenthesized(code), WholeNumber(index)) if index else code
            for index, code in enumerate(conditions)
            if code is not None
        ]
        if len(parts) == 1 and not fixed:
            return parts[0]
        parts = [*map(Parenthesized, parts), *([WholeNumber(fixed)] if fixed else [])]
        return infix_all("|", BITS_OR, parts)

    def _chosen(
        self, branches: Sequence[ir.Branch], taken: Callable[[ir.Event, int], Statements]
    ) -> Iterator[Statement]:
        bodies = [(*taken(branch.event, index), *self.statements(branch.body)) for index, branch in enumerate(branches)]
        if len(branches) == 1:
            yield from bodies[0]
            return
        k = self.spelling["k"]
        starts: list[int] = []
        shared: list[Statements] = []
        for start, _, body in alike_runs(bodies, k.text):
            starts.append(start)
            shared.append(body)
        comments = [one_line(branches[start].event.span) or None for start in starts]
        yield from _decision(k, [*starts, len(branches)], shared, comments)

    def _taken(self, event: ir.Event, guards: Code, index: int) -> Statements:
        if not isinstance(event, ir.InputEvent):
            return ()
        source = event.source
        return self.read_into(event, lambda into: self.communications.take(source, into, guards, index))

    def _slow_selection(self, choice: ir.Choice, local: Code) -> Iterator[Statement]:
        needs = self._needs(choice.branches)
        selected = delegated(Call(local.field("select"), tuple(select_arguments(choice.branches, needs))))
        yield from self.set_current_task()
        yield from self._evaluated(needs, choice)
        yield run(selected) if len(choice.branches) == 1 else assign(self.spelling["k"], selected)

        def taken(event: ir.Event, _: int) -> Statements:
            if not isinstance(event, ir.InputEvent):
                return ()
            return self.read_into(event, lambda into: (assign(into, local.field("value")),))

        yield from self._chosen(choice.branches, taken)

    def _evaluated(self, needs: Guards, choice: ir.Choice) -> Iterator[Statement]:
        """The lines that guards need. They have places of their own; an alternative waits at its own place."""
        yield from needs.lines
        if needs.lines:
            yield self.comment(choice, "")

    def _needs(self, branches: Sequence[ir.Branch], *, always: bool = False) -> Guards:
        """The values that guards need, evaluated when the alternative begins."""
        return guards_of(branches, self.printer.print, may_fault, self.imports.names, self.guard_names, always=always)

    def _guard(self, event: ir.Event, printer: FastPrinter, *, made: bool, needed: Code | None = None) -> Code:
        """A guard; ``made`` in the constructor, where values are not known yet."""
        members = self.spelling.members
        match event:
            case ir.ReadyEvent(source=source):
                end = members.source(source)
                return call(self.imports.runtime("Ready"), end if made else self.spelling.local(end))
            case ir.InputEvent(source=source):
                end = members.source(source)
                return call(self.imports.runtime("Input"), end if made else self.spelling.local(end))
            case ir.OutputEvent(sink=sink, value=value):
                end = members.sink(sink)
                given = () if made else (needed or printer.print(value),)
                return call(self.imports.runtime("Output"), end if made else self.spelling.local(end), *given)
            case ir.AfterEvent(duration=duration):
                later = made and not is_known_at_start(duration)
                delay = WholeNumber(0) if later else needed or printer.print(duration)
                return call(self.imports.runtime("After"), delay)
            case ir.SkipEvent():
                return call(self.imports.runtime("Skip"))
        assert_never(event)

    def _interrupt(self, body: ir.Action, branch: ir.Branch) -> Iterator[Statement]:
        function = self.branch(body)
        guard = Name(self.spelling.names.fresh(self.spelling["guard"].text))
        taken: Statements = ()
        if isinstance(branch.event, ir.InputEvent):
            taken = self.read_into(branch.event, lambda into: (assign(into, guard.field("value")),))
        handler = (*taken, *self.statements(branch.body))
        needs = self._needs((branch,), always=True)
        condition = needs.conditions[0]
        interrupted = delegated(call(self.imports.runtime("interrupted"), function, guard))
        yield from needs.lines
        guarded: Statements = (
            *self.set_current_task(),
            assign(guard, self._guard(branch.event, self.printer, made=False, needed=needs.needed.get(0))),
            if_(Parenthesized(interrupted), *handler) if handler else run(interrupted),
        )
        if condition is None:
            yield from guarded
            return
        yield if_(condition, *guarded)
        if isinstance(body, ir.RunInstance):
            plainly = self.run_here(body.instance)
        else:
            plainly = (run(delegated(call(function, self.spelling["me"]))),)
        yield else_(*plainly)


_MOST_TESTED = 16
"""The largest number of bodies that are tested for one after the other; of more, half are excluded by each test."""


def _decision(
    k: Code, starts: Sequence[int], bodies: Sequence[Statements], comments: Sequence[str | None]
) -> Statements:
    """Run the body of branch ``k``: body ``i`` is that of the branches from ``starts[i]`` to before ``starts[i + 1]``.

    A chain of ``elif`` is nested as deep as it is long, for the parser and for the processor.
    """
    if len(bodies) == 1:
        return bodies[0]
    if len(bodies) > _MOST_TESTED:
        half = len(bodies) // 2
        lower = _decision(k, starts[: half + 1], bodies[:half], comments[:half])
        upper = _decision(k, starts[half:], bodies[half:], comments[half:])
        return (if_(_less(k, starts[half]), *lower), else_(*upper))
    found: list[Statement] = []
    for index, (body, comment) in enumerate(zip(bodies, comments, strict=True)):
        start, end = starts[index : index + 2]
        if index == len(bodies) - 1:
            found.append(Block("else", None, body, comment))
        else:
            test = infix("==", COMPARISON, k, WholeNumber(start)) if end == start + 1 else _less(k, end)
            found.append(Block("elif" if index else "if", test, body, comment))
    return tuple(found)


def _less(k: Code, number: int) -> Code:
    return infix("<", COMPARISON, k, WholeNumber(number))


def _position(bits: Code) -> Code:
    """The position of the lowest bit that is set, counted from one."""
    return Parenthesized(infix("&", BITS_AND, bits, minus(bits))).call("bit_length")
