"""Alternatives and interrupts as the code of a generator function.

A selection is arithmetic on the bits of the guards that are ready: it takes as long for ten guards as for a hundred.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import assert_never

from cspdiag.codegen.python.fast.communications import Statements, text
from cspdiag.codegen.python.fast.expressions import FastPrinter
from cspdiag.codegen.python.fast.values import Values, one_line
from cspdiag.codegen.python.plain.guards import GuardNames, Guards, select_arguments
from cspdiag.codegen.python.text.code import Argument, Atom, Call, Code, call
from cspdiag.codegen.python.text.rolling import LEAST, statements_template
from cspdiag.codegen.python.text.statements import Block, Line, Statement, assign
from cspdiag.network.ir.actions import (
    Action,
    AfterEvent,
    Branch,
    Choice,
    Event,
    InputEvent,
    OutputEvent,
    ReadyEvent,
    RunInstance,
    SkipEvent,
)
from cspdiag.network.ir.faults import is_known_at_start, may_fault

_LONGEST_COMMENT = 70


@dataclass
class Alternatives(Values):
    """Writes the selections of one process class."""

    choices: dict[str, Code] = field(default_factory=dict)
    """How the alternatives are made, by name."""
    choice_names: dict[str, str] = field(default_factory=dict)
    selectors: dict[str, str] = field(default_factory=dict)
    """Local variables for the selectors of alternatives."""
    memories: dict[str, str] = field(default_factory=dict)
    """Local variables that remember what fair alternatives chose last."""

    def __post_init__(self) -> None:
        self.guard_names = GuardNames(self.spelling.names.fresh)

    def branch(self, step: Action) -> Code:
        """A process to run beside others."""
        raise NotImplementedError

    def run_here(self, name: str) -> Statements:
        """Runs an instance in sequence."""
        raise NotImplementedError

    def _choice(self, choice: Choice) -> Statements:
        name = choice.name or self.spelling.names.fresh("choice")
        branches = choice.branches
        guards = [Argument(self._guard(branch.event, self.initial, made=True)) for branch in branches]
        if choice.prioritized and len(branches) > 1:
            guards.append(Argument(Atom("True"), "prioritized"))
        self.choices[name] = Call(self.imports.runtime("Alternative"), tuple(guards))
        attribute = self.choice_names.setdefault(name, self.spelling.names.fresh(name))
        local = self.spelling.local(f"self.{attribute}")
        if self._is_inline(choice):
            return (self.comment(choice), *self._selection(choice, attribute, local))
        return (self.comment(choice), *self._slow_selection(choice, local))

    def _is_inline(self, choice: Choice) -> bool:
        for branch in choice.branches:
            match branch.event:
                case InputEvent(source=source) | ReadyEvent(source=source):
                    if self.spelling.medium(source).guarded_writes:
                        return False
                case SkipEvent():
                    pass
                case AfterEvent(duration=duration):
                    known = self.printer.value(duration)
                    if not isinstance(known, int) or known <= 0:
                        return False
                case OutputEvent():
                    return False
                case _:
                    assert_never(branch.event)
        return True

    def _selection(self, choice: Choice, attribute: str, local: str) -> Iterator[Statement]:
        spelling, branches = self.spelling, choice.branches
        ready, k, first = spelling["ready"], spelling["k"], spelling["first"]
        guards = self._guards(attribute, local)
        yield from self.communications.check()
        mask: str | None = None
        if any(branch.condition is not None for branch in branches):
            needs = self._needs(branches)
            yield from needs.lines
            mask = spelling["mask"]
            yield assign(mask, self._mask(needs.conditions))
        yield self._ready(guards, mask)
        yield from self._parked(choice, local, guards, mask)
        if len(branches) > 1 and not choice.prioritized:
            after = self._memory(attribute, local)
            yield text(f"{first} = {ready} >> {after}")
            begin_again = (text(f"{first} = {ready}"), text(f"{after} = 0"))
            yield Block(text(f"if not {first}:"), begin_again)
            yield text(f"{k} = {after} + ({first} & -{first}).bit_length() - 1")
            yield text(f"{after} = {k} + 1")
        elif len(branches) > 1:
            yield text(f"{k} = ({ready} & -{ready}).bit_length() - 1")
        yield from self._chosen(branches, lambda event, bit: self._taken(event, guards, bit))

    def _ready(self, guards: str, mask: str | None) -> Statement:
        """The guards that are ready now."""
        return text(f"{self.spelling['ready']} = {guards}.ready" + (f" & {mask}" if mask else ""))

    def _guards(self, attribute: str, local: str) -> str:
        """A local variable for the selector of an alternative."""
        if attribute not in self.selectors:
            self.selectors[attribute] = self.spelling.names.fresh(f"{attribute}_guards")
            self.prologue.append(text(f"{self.selectors[attribute]} = {local}.selector"))
        return self.selectors[attribute]

    def _parked(self, choice: Choice, local: str, guards: str, mask: str | None) -> Iterator[Statement]:
        """Waits while no guard is ready."""
        me, ready = self.spelling["me"], self.spelling["ready"]
        if all(self._only_wakes(branch.event) for branch in choice.branches):
            waits = (
                text(f"{local}.park({me}, {mask or -1})"),
                text("yield"),
                text(f"{guards}.waiting = None"),
                *self.communications.check(),
                self._ready(guards, mask),
            )
            yield Block(text(f"while not {ready}:"), waits)
        else:
            waiting = call(f"yield from {local}.wait", Atom(mask or "-1"))
            yield Block(text(f"if not {ready}:"), (*self.known(), assign(ready, waiting)))

    def _only_wakes(self, event: Event) -> bool:
        """Whether the end of a guard need not be told that an alternative waits."""
        if isinstance(event, InputEvent | ReadyEvent):
            return self.spelling.medium(event.source).kind in ("sync", "event", "buffer", "overwrite", "any")
        return isinstance(event, SkipEvent)

    def _memory(self, attribute: str, local: str) -> str:
        if self.spelling.again:
            return f"{local}.after"
        if attribute not in self.memories:
            self.memories[attribute] = self.spelling.names.fresh(f"{attribute}_after")
        return self.memories[attribute]

    def _mask(self, conditions: Sequence[Code | None]) -> Code:
        fixed = 0
        parts = []
        for index, code in enumerate(conditions):
            if code is None:
                fixed |= 1 << index
            else:
                parts.append(f"(({code.flat}) << {index})" if index else f"({code.flat})")
        if not parts:
            return Atom(str(fixed))
        if len(parts) == 1 and not fixed:
            return Atom(parts[0][1:-1])
        return Atom(" | ".join([*parts, *([str(fixed)] if fixed else [])]))

    def _chosen(self, branches: Sequence[Branch], taken: Callable[[Event, int], Statements]) -> Iterator[Statement]:
        bodies = [(*taken(branch.event, index), *self.statements(branch.body)) for index, branch in enumerate(branches)]
        if len(branches) == 1:
            yield from bodies[0]
            return
        k = self.spelling["k"]
        alike = statements_template(bodies, k, 0) if len(bodies) >= LEAST else None
        if alike is not None:
            yield from alike
            return
        for index, (branch, body) in enumerate(zip(branches, bodies, strict=True)):
            head = "if" if index == 0 else "elif"
            test = f"{head} {k} == {index}:" if index < len(bodies) - 1 else "else:"
            yield Block(Line(test, comment=self._what(branch.event)), body)

    def _what(self, event: Event) -> str | None:
        return one_line(event.span) or None

    def _taken(self, event: Event, guards: str, index: int) -> Statements:
        if not isinstance(event, InputEvent):
            return ()
        source = event.source
        return self.read_into(event.target, lambda into: self.communications.take(source, into, guards, index))

    def _slow_selection(self, choice: Choice, local: str) -> Iterator[Statement]:
        k = self.spelling["k"]
        needs = self._needs(choice.branches)
        selected = Call(f"{local}.select", tuple(select_arguments(choice.branches, needs)))
        yield from self.known()
        yield from needs.lines
        chosen = "" if len(choice.branches) == 1 else f"{k} = "
        yield Line(f"{chosen}yield from ", selected)

        def taken(event: Event, index: int) -> Statements:
            if not isinstance(event, InputEvent):
                return ()
            return self.read_into(event.target, lambda into: (text(f"{into} = {local}.value"),))

        yield from self._chosen(choice.branches, taken)

    def _needs(self, branches: Sequence[Branch], *, always: bool = False) -> Guards:
        """What guards need, evaluated where they begin."""
        names = self.imports.names
        found = Guards(
            self.printer.print,
            may_fault,
            lambda span: names.place(span.file, span.line),
            self.guard_names,
            always,
        )
        for branch in branches:
            found.add(branch)
        return found

    def _guard(self, event: Event, printer: FastPrinter, *, made: bool, needed: Code | None = None) -> Code:
        """A guard; ``made`` in the constructor, where values are not known yet."""
        members = self.spelling.members
        match event:
            case ReadyEvent(source=source):
                end = members.source(source)
                return call(self.imports.runtime("Ready"), Atom(end if made else self.spelling.local(end)))
            case InputEvent(source=source):
                end = members.source(source)
                return call(self.imports.runtime("Input"), Atom(end if made else self.spelling.local(end)))
            case OutputEvent(sink=sink, value=value):
                end = members.sink(sink)
                given = () if made else (needed or printer.print(value),)
                return call(self.imports.runtime("Output"), Atom(end if made else self.spelling.local(end)), *given)
            case AfterEvent(duration=duration):
                later = made and not is_known_at_start(duration)
                delay = Atom("0") if later else needed or printer.print(duration)
                return call(self.imports.runtime("After"), delay)
            case SkipEvent():
                return call(self.imports.runtime("Skip"))
        assert_never(event)

    def _interrupt(self, body: Action, branch: Branch) -> Iterator[Statement]:
        function = self.branch(body)
        guard = self.spelling.names.fresh(self.spelling["guard"])
        interrupted = self.imports.runtime("interrupted")
        taken: Statements = ()
        if isinstance(branch.event, InputEvent):
            taken = self.read_into(branch.event.target, lambda into: (text(f"{into} = {guard}.value"),))
        handler = (*taken, *self.statements(branch.body))
        needs = self._needs((branch,), always=True)
        condition = needs.conditions[0]
        run = Line("if (yield from ", call(interrupted, function, Atom(guard)), "):")
        if not handler:
            run = Line("yield from ", call(interrupted, function, Atom(guard)))
        yield from needs.lines
        guarded: Statements = (
            *self.known(),
            assign(guard, self._guard(branch.event, self.printer, made=False, needed=needs.needed.get(0))),
            Block(run, handler) if handler else run,
        )
        if condition is None:
            yield from guarded
            return
        yield Block(Line("if ", condition, ":"), guarded)
        if isinstance(body, RunInstance):
            plainly = self.run_here(body.instance)
        else:
            plainly = (text(f"yield from {function.flat}({self.spelling['me']})"),)
        yield Block(text("else:"), plainly)
