"""Compositions as Python control flow."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Literal, assert_never

from cspdiag.base.record import record
from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.plain.guards import GuardNames, Guards, select_arguments
from cspdiag.codegen.python.plain.members import Members
from cspdiag.codegen.python.text.code import (
    OR,
    TRUE,
    Argument,
    Call,
    Code,
    Comprehension,
    Conditional,
    Constant,
    Name,
    Parenthesized,
    Whole,
    at_least,
    awaited,
    call,
    counted_to,
    mentions,
    own,
    tuple_of,
)
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.literals import quoted
from cspdiag.codegen.python.text.rolling import rolled_steps, template
from cspdiag.codegen.python.text.statements import (
    BREAK,
    Block,
    Plain,
    Statement,
    Statements,
    assign,
    else_,
    repeat,
    run,
    try_,
)
from cspdiag.codegen.shared.branch_names import branch_name
from cspdiag.codegen.shared.trees import LEAST
from cspdiag.network.ir.actions import (
    AfterEvent,
    AssignValue,
    Branch,
    CatchException,
    Choice,
    CoreAction,
    CountedLoop,
    End,
    Event,
    Group,
    IfElse,
    InputEvent,
    InterruptOn,
    OutputEvent,
    ParallelSteps,
    ProcessScope,
    RaiseException,
    ReadInputs,
    ReadValue,
    ReadyEvent,
    Repeat,
    ReportCommunication,
    ResetInstance,
    ResetStates,
    RunInstance,
    RunLaw,
    SequentialSteps,
    SkipEvent,
    SkipStep,
    Step,
    StopStep,
    Target,
    WaitStep,
    WhileLoop,
    WriteOutputs,
    WriteValue,
)
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.faults import is_known_at_start, may_fault, variables_in
from cspdiag.network.ir.ranges import cannot_fault
from cspdiag.network.ir.walk import parts


@record
class Method:
    """A part of a composition that runs beside others and so needs a coroutine of its own."""

    name: str
    body: Statements
    parameter: str | None = None


@dataclass
class Composition:
    """Writes the ``run`` of one process class.

    ``members`` knows the attributes. ``alternatives`` and ``methods`` collect what the constructor has to make, and the
    coroutines of branches.
    """

    members: Members
    printer: Printer
    """For expressions in ``run``."""
    initial: Printer
    """For expressions in the constructor."""
    imports: Imports
    unwritten: frozenset[str] = frozenset()
    """Variables that may be read before they were written, which is a fault."""
    alternatives: list[Statement] = field(default_factory=list)
    methods: list[Method] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.guard_names = GuardNames(self.members.names.fresh)

    def statements(self, action: CoreAction) -> Statements:
        """An action as statements of a coroutine."""
        match action:
            case SkipStep():
                return ()
            case SequentialSteps(steps=steps):
                groups = [self.statements(step) for step in steps]
                return rolled_steps(groups, self.members.index_around(groups))
            case AssignValue(target=target, value=value):
                return (self._set(target, self.printer.print(value), self._place(action)),)
            case ReadValue(source=source, target=target):
                return (self._read(action, source, target),)
            case RaiseException(exception=exception):
                return (Plain("raise", Name(self.imports.exception(exception)), self._place(action)),)
            case ResetInstance(instance=instance):
                return (run(self.members.instance(instance).call("reset")),)
            case Repeat(until=until):
                return (self._repeat(action, until),)
            case WhileLoop(condition=condition, body=body):
                place = self._place_of_fault(condition, action)
                return (Block("while", self.printer.print(condition), self.statements(body), place),)
            case CountedLoop(turns=turns, body=body):
                inside = self.statements(body)
                return (repeat(turns, inside),) if inside else ()
            case IfElse():
                return self._if(action)
            case CatchException():
                return self._catch(action)
            case Choice(branches=(Branch(condition=None) as branch,)) if not isinstance(branch.event, ReadyEvent):
                return (*self._alone(branch.event), *self.statements(branch.body))
            case Choice():
                return self._choice(action, "choice")
            case Group(label=label, body=Choice() as choice) if not self._alone_suffices(choice):
                return (run(awaited(self._group(label, action.body))),)
            case InterruptOn(body=body, branch=branch):
                needs = self._guards((branch,), always=True)
                return (
                    *needs.lines,
                    run(awaited(self._interrupt(body, branch, needs)), self._checked_place(action)),
                )
            case RunInstance() | WriteValue() | WaitStep() | StopStep() | ParallelSteps() | Group():
                return (run(awaited(self.awaitable(action)), self._checked_place(action)),)
        assert_never(action)

    def awaitable(self, action: CoreAction) -> Code:
        """An action as something that can be awaited."""
        match action:
            case RunInstance(instance=instance):
                return self.members.instance(instance)
            case WriteValue(sink=sink, value=value):
                return self.members.sink(sink).call("write", self.printer.print(value))
            case WaitStep(duration=duration):
                return call(self.imports.runtime("wait"), self.printer.print(duration))
            case StopStep():
                return call(self.imports.runtime("stop"))
            case ParallelSteps(steps=steps, prioritized=prioritized):
                name = self.imports.runtime("prioritized_parallel" if prioritized else "parallel")
                return Call(Name(name), tuple(self._branches(steps)))
            case InterruptOn(body=body, branch=branch):
                needs = self._guards((branch,), always=True)
                if needs.lines:
                    return call(self._coroutine(action, branch_name(action)))
                return self._interrupt(body, branch, needs)
            case Group(label=label, body=body):
                return self._group(label, body)
            case _:
                raise AssertionError("takes statements")

    def _later(self, action: CoreAction, hint: str | None = None) -> Code:
        """As ``awaitable``, for what begins later than it is made: what it writes is then computed when it runs.

        What takes a coroutine is a method that makes it, so that none is there before it begins.
        """
        match action:
            case WriteValue(value=value) | WaitStep(duration=value) if not self._is_known(value):
                return self._coroutine(action, hint or branch_name(action))
            case InterruptOn(branch=branch) if branch.condition is not None or self._checked_place(action) is not None:
                return self._coroutine(action, hint or branch_name(action))
            case RunInstance() | WriteValue() | WaitStep() | StopStep() | ParallelSteps() | InterruptOn() | Group():
                return self.awaitable(action)
            case (
                ReadValue() | AssignValue() | SkipStep() | ResetInstance() | RaiseException()
                | SequentialSteps() | Choice() | Repeat() | WhileLoop() | CountedLoop() | IfElse()
                | CatchException() | ReadInputs() | WriteOutputs() | RunLaw() | ResetStates() | ProcessScope()
                | ReportCommunication()
            ):  # fmt: skip
                return self._coroutine(action, hint or branch_name(action))
            case _:
                assert_never(action)

    def _is_known(self, value: Expression) -> bool:
        """Whether a value may be computed before its place is reached."""
        return cannot_fault(value) and self.unwritten.isdisjoint(variables_in(value))

    def _branches(self, steps: Sequence[CoreAction]) -> Iterable[Argument]:
        alike = self._alike(steps)
        if alike is not None:
            yield alike
            return
        position = 0
        while position < len(steps):
            whole = self._whole_array(steps, position)
            if whole is None:
                yield Argument(self._later(steps[position]))
                position += 1
            else:
                name, count = whole
                yield Argument(name, starred=True)
                position += count

    def _alike(self, steps: Sequence[CoreAction]) -> Argument | None:
        """Branches that differ only in an index, as one coroutine with that index as its parameter."""
        if len(steps) < LEAST or isinstance(steps[0], RunInstance) or not all(map(_is_plain, steps)):
            return None
        groups = [self.statements(step) for step in steps]
        index = self.members.index_around(groups)
        body = template(groups, index)
        if body is None:
            return None
        name = self.members.names.fresh(f"_{branch_name(steps[0])}")
        self.methods.append(Method(name, body, f"{index}: int"))
        made = call(self.imports.standard("functools", "partial"), own(name), Name(index))
        each = Comprehension(made, index, counted_to(len(steps)), "()")
        return Argument(each, starred=True)

    def _whole_array(self, steps: Sequence[CoreAction], start: int) -> tuple[Code, int] | None:
        first = steps[start]
        if not isinstance(first, RunInstance):
            return None
        array = self.members.array_of(first.instance)
        if array is None:
            return None
        wanted = array.elements
        given = [step.instance for step in steps[start : start + len(wanted)] if isinstance(step, RunInstance)]
        return (own(array.name), len(wanted)) if given == list(wanted) else None

    def _group(self, label: str, body: CoreAction) -> Code:
        return call(self.imports.runtime("group"), Constant(quoted(label)), self._later(body, label))

    def _coroutine(self, action: CoreAction, hint: str) -> Code:
        name = self.members.names.fresh(f"_{hint}")
        position = len(self.methods)
        self.methods.append(Method(name, ()))
        self.methods[position] = Method(name, self.statements(action))
        return own(name)

    def _repeat(self, action: Repeat[CoreAction], until: Expression | None) -> Block:
        statements = self.statements(action.body)
        if until is not None:
            place = self._place_of_fault(until, action)
            statements += (Block("if", self.printer.print(until), (BREAK,), place),)
        return Block("while", TRUE, statements)

    def _if(self, action: IfElse[CoreAction]) -> Statements:
        keyword: Literal["if", "elif"] = "if"
        blocks: list[Statement] = []
        rest: CoreAction = action
        while isinstance(rest, IfElse):
            place = self._place_of_fault(rest.condition, rest)
            blocks.append(Block(keyword, self.printer.print(rest.condition), self.statements(rest.then), place))
            keyword, rest = "elif", rest.otherwise
        otherwise = self.statements(rest)
        return (*blocks, else_(*otherwise)) if otherwise else tuple(blocks)

    def _catch(self, action: CatchException[CoreAction]) -> Statements:
        caught = [Name(name) for name in self.imports.caught(action.exception)]
        body, handler = self.statements(action.body), self.statements(action.handler)
        if not handler:
            suppress = self.imports.standard("contextlib", "suppress")
            return (Block("with", call(suppress, *caught), body),)
        exceptions = caught[0] if len(caught) == 1 else tuple_of(caught)
        return (try_(*body), Block("except", exceptions, handler))

    def _alone(self, event: Event) -> Statements:
        """A guard that is waited for by itself is the communication that it stands for."""
        match event:
            case InputEvent(source=source, target=target):
                return (self._read(event, source, target),)
            case OutputEvent(sink=sink, value=value):
                written = self.members.sink(sink).call("write", self.printer.print(value))
                return (run(awaited(written), self._place(event)),)
            case AfterEvent(duration=duration):
                waited = call(self.imports.runtime("wait"), self.printer.print(duration))
                return (run(awaited(waited), self._place(event)),)
            case SkipEvent():
                return ()
            case ReadyEvent():
                raise AssertionError("a ready guard needs an alternative")
            case _:
                assert_never(event)

    def _alone_suffices(self, choice: Choice[CoreAction]) -> bool:
        return (
            len(choice.branches) == 1
            and choice.branches[0].condition is None
            and not isinstance(choice.branches[0].event, ReadyEvent)
        )

    def _choice(self, choice: Choice[CoreAction], hint: str) -> Statements:
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
            Block("case", Whole(number), body, _one_line(branch.event.span.text) or None)
            for number, (branch, body) in enumerate(zip(branches, taken, strict=True))
        ]
        return (*needs.lines, Block("match", selected, tuple(cases), self._place(choice)))

    def _choice_alike(self, choice: Choice[CoreAction], attribute: Code) -> Statements | None:
        """An alternative whose branches differ only in an index, which is then what was chosen."""
        branches = choice.branches
        regular = (InputEvent, ReadyEvent)
        if len(branches) < LEAST or not all(isinstance(b.event, regular) and _is_plain(b.body) for b in branches):
            return None
        bodies = [(*self._taken(branch.event, attribute), *self.statements(branch.body)) for branch in branches]
        index, count = self.members.index_around(bodies), len(branches)
        guard = template([self._guard(branch.event, self.initial) for branch in branches], index)
        condition = template([self._condition(branch) for branch in branches], index)
        body = template(bodies, index)
        if guard is None or condition is None or body is None:
            return None
        guards = [Argument(Comprehension(guard, index, counted_to(count), "()"), starred=True)]
        if choice.prioritized:
            guards.append(Argument(TRUE, "prioritized"))
        self.alternatives.append(assign(attribute, Call(Name(self.imports.runtime("Alternative")), tuple(guards))))
        before: Statements = ()
        enabled = [] if condition == TRUE else [Argument(Comprehension(condition, index, counted_to(count)), "enabled")]
        if any(branch.condition is not None and self._may_fault(branch.condition) for branch in branches):
            name, place = self.guard_names.local("enabled"), self._place_of_condition(branches[0])
            before = (assign(name, enabled[0].value, place),)
            enabled = [Argument(Name(name), "enabled")]
        selected = awaited(Call(attribute.field("select"), tuple(enabled)))
        is_used = mentions(body, index)
        select = assign(index, selected, self._place(choice)) if is_used else run(selected, self._place(choice))
        return (*before, select, *body)

    def _place_of_condition(self, branch: Branch[CoreAction]) -> str:
        span = (branch.condition.span if branch.condition is not None else None) or branch.span
        return self.imports.names.place(span.file, span.line)

    def _guard(self, event: Event, printer: Printer, needed: Code | None = None) -> Code:
        match event:
            case ReadyEvent(source=source):
                return call(self.imports.runtime("Ready"), self.members.source(source))
            case InputEvent(source=source):
                return call(self.imports.runtime("Input"), self.members.source(source))
            case OutputEvent(sink=sink, value=value):
                # The value is given at each selection; only an interrupt makes its guard anew each time.
                given = () if printer is self.initial else (needed or printer.print(value),)
                return call(self.imports.runtime("Output"), self.members.sink(sink), *given)
            case AfterEvent(duration=duration):
                later = printer is self.initial and not is_known_at_start(duration)
                delay = Whole(0) if later else needed or printer.print(duration)
                return call(self.imports.runtime("After"), delay)
            case SkipEvent():
                return call(self.imports.runtime("Skip"))
        assert_never(event)

    def _guards(self, branches: Sequence[Branch[CoreAction]], *, always: bool = False) -> Guards:
        """What guards need, evaluated where they begin."""
        names = self.imports.names
        found = Guards(
            self.printer.print,
            self._may_fault,
            lambda span: names.place(span.file, span.line),
            self.guard_names,
            always,
        )
        for branch in branches:
            found.add(branch)
        return found

    def _condition(self, branch: Branch[CoreAction]) -> Code:
        return TRUE if branch.condition is None else self.printer.print(branch.condition)

    def _taken(self, event: Event, attribute: Code) -> Statements:
        if isinstance(event, InputEvent):
            return (self._set(event.target, attribute.field("value")),)
        return ()

    def _interrupt(self, body: CoreAction, branch: Branch[CoreAction], needs: Guards) -> Code:
        guard = self._guard(branch.event, self.printer, needs.needed.get(0))
        interrupted = self._later(body)
        taken: Statements = ()
        if isinstance(branch.event, InputEvent):
            attribute = own(self.members.names.fresh("interruption"))
            self.alternatives.append(assign(attribute, guard))
            guard = attribute
            taken = self._taken(branch.event, attribute)
        handler = (*taken, *self.statements(branch.body))
        name = "_go_on"
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

    def _read(self, step: Step, source: End, target: Target) -> Statement:
        value = awaited(self.members.source(source).call("read"))
        return self._set(target, value, self._place(step))

    def _set(self, target: Target, value: Code, comment: str | None = None) -> Statement:
        variable = self.members.channel(target.channel).field("value")
        if not target.indexes:
            return assign(variable, value, comment)
        indexes = [self.printer.print(index) for index in target.indexes]
        return assign(variable, call(self.imports.runtime("replaced"), variable, value, *indexes), comment)

    def _place(self, action: Step) -> str:
        return self.imports.names.place(action.span.file, action.span.line)

    def _place_of_fault(self, expression: Expression, action: Step) -> str | None:
        """The place of an expression of an action, if it can fault."""
        if not self._may_fault(expression):
            return None
        span = expression.span or action.span
        return self.imports.names.place(span.file, span.line)

    def _may_fault(self, expression: Expression) -> bool:
        return may_fault(expression) or not self.unwritten.isdisjoint(variables_in(expression))

    def _checked_place(self, action: CoreAction) -> str | None:
        """The place of what waits in this very statement, rather than in a process or coroutine that it runs."""
        match action:
            case WriteValue() | StopStep() | WaitStep():
                return self._place(action)
            case InterruptOn(branch=Branch(event=InputEvent())):
                return self._place(action)
            case InterruptOn(branch=branch):
                values = (
                    branch.condition,
                    getattr(branch.event, "value", None),
                    getattr(branch.event, "duration", None),
                )
                return (
                    self._place(action)
                    if any(value is not None and self._may_fault(value) for value in values)
                    else None
                )
            case ParallelSteps(steps=steps) if any(isinstance(step, WriteValue) for step in steps):
                return self._place(action)
        return None


def _is_plain(action: CoreAction) -> bool:
    """Whether an action needs no alternative and no coroutine of its own."""
    return not any(isinstance(part, Choice | ParallelSteps | InterruptOn | Group) for part in parts(action))


def _one_line(text: str) -> str:
    return " ".join(text.split())
