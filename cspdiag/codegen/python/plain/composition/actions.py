"""Compositions as Python control flow."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, assert_never

from cspdiag.codegen.python.plain.composition.alternatives import Alternatives, is_plain
from cspdiag.codegen.python.plain.composition.common import Method
from cspdiag.codegen.python.text.code import (
    TRUE,
    Argument,
    Call,
    Code,
    Comprehension,
    Constant,
    Name,
    awaited,
    call,
    counted_to,
    own,
    tuple_of,
)
from cspdiag.codegen.python.text.literals import quoted
from cspdiag.codegen.python.text.rolling import rolled_steps, template
from cspdiag.codegen.python.text.statements import (
    BREAK,
    Block,
    Plain,
    Statement,
    Statements,
    else_,
    repeat,
    run,
    try_,
)
from cspdiag.codegen.shared.branches import branch_name, runs_in_order, runs_instances
from cspdiag.codegen.shared.trees import LEAST
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.faults import variables_in
from cspdiag.network.ir.ranges import cannot_fault


@dataclass
class Composition(Alternatives):
    """Writes the ``run`` of one process class."""

    def statements(self, action: ir.CoreAction) -> Statements:
        """An action as statements of a coroutine."""
        match action:
            case ir.SkipStep():
                return ()
            case ir.SequentialSteps(steps=steps):
                groups = [self.statements(step) for step in steps]
                return rolled_steps(groups, self.members.index_around)
            case ir.AssignValue(target=target, value=value):
                return (self._set(target, self.printer.print(value), self._place(action)),)
            case ir.ReadValue(source=source, target=target):
                return (self._read(action, source, target),)
            case ir.RaiseException(exception=exception):
                return (Plain("raise", Name(self.imports.exception(exception)), self._place(action)),)
            case ir.ResetInstance(instance=instance):
                return (run(self.members.instance(instance).call("reset")),)
            case ir.Repeat(until=until):
                return (self._repeat(action, until),)
            case ir.WhileLoop(condition=condition, body=body):
                place = self._place_of_fault(condition, action)
                return (Block("while", self.printer.print(condition), self.statements(body), place),)
            case ir.CountedLoop(iterations=iterations, body=body):
                inside = self.statements(body)
                return (repeat(iterations, inside),) if inside else ()
            case ir.IfElse():
                return self._if(action)
            case ir.CatchException():
                return self._catch(action)
            case ir.Choice(branches=(ir.Branch(condition=None) as branch,)) if not isinstance(
                branch.event, ir.ReadyEvent
            ):
                return (*self._single_guard(branch.event), *self.statements(branch.body))
            case ir.Choice():
                return self._choice(action, "choice")
            case ir.Group(label=label, body=ir.Choice() as choice) if not self._is_single_guard(choice):
                return (run(awaited(self._group(label, action.body))),)
            case ir.InterruptOn(body=body, branch=branch):
                needs = self._guards((branch,), always=True)
                return (
                    *needs.lines,
                    run(awaited(self._interrupt(body, branch, needs)), self._checked_place(action)),
                )
            case ir.RunInstance() | ir.WriteValue() | ir.WaitStep() | ir.StopStep() | ir.ParallelSteps() | ir.Group():
                return (run(awaited(self.awaitable(action)), self._checked_place(action)),)
        assert_never(action)

    def awaitable(self, action: ir.CoreAction) -> Code:
        """An action as an expression that can be awaited."""
        match action:
            case ir.RunInstance(instance=instance):
                return self.members.instance(instance)
            case ir.WriteValue(sink=sink, value=value):
                return self.members.sink(sink).call("write", self.printer.print(value))
            case ir.WaitStep(duration=duration):
                return call(self.imports.runtime("wait"), self.printer.print(duration))
            case ir.StopStep():
                return call(self.imports.runtime("stop"))
            case ir.ParallelSteps(steps=steps, prioritized=prioritized):
                name = self.imports.runtime("prioritized_parallel" if prioritized else "parallel")
                return Call(Name(name), tuple(self._branches(steps)))
            case ir.InterruptOn(body=body, branch=branch):
                needs = self._guards((branch,), always=True)
                if needs.lines:
                    return call(self._coroutine(action, branch_name(action)))
                return self._interrupt(body, branch, needs)
            case ir.Group(label=label, body=body):
                return self._group(label, body)
            case _:
                raise AssertionError("needs statements")

    def deferred(self, action: ir.CoreAction, hint: str | None = None) -> Code:
        """As ``awaitable``, for an action that begins later: the values that it writes are computed when it runs.

        If it needs a coroutine, this is the method that creates the coroutine, so none exists before the action begins.
        What may wait forever needs one, whose place the report of a deadlock gives.
        """
        match action:
            case ir.WaitStep(duration=duration) if not self._is_known(duration):
                return self._coroutine(action, hint or branch_name(action))
            case ir.InterruptOn(branch=branch) if (
                branch.condition is not None or self._checked_place(action) is not None
            ):
                return self._coroutine(action, hint or branch_name(action))
            case ir.RunInstance() | ir.WaitStep() | ir.ParallelSteps() | ir.InterruptOn() | ir.Group():
                return self.awaitable(action)
            case (
                ir.ReadValue() | ir.WriteValue() | ir.StopStep() | ir.AssignValue() | ir.SkipStep()
                | ir.ResetInstance() | ir.RaiseException() | ir.SequentialSteps() | ir.Choice() | ir.Repeat()
                | ir.WhileLoop() | ir.CountedLoop() | ir.IfElse() | ir.CatchException() | ir.ReadInputs()
                | ir.WriteOutputs() | ir.RunLaw() | ir.ResetStates() | ir.ProcessScope() | ir.ReportCommunication()
            ):  # fmt: skip
                return self._coroutine(action, hint or branch_name(action))
            case _:
                assert_never(action)

    def _is_known(self, value: Expression) -> bool:
        """Whether a value may be computed before the action is reached."""
        return cannot_fault(value) and self.unwritten.isdisjoint(variables_in(value))

    def _branches(self, steps: Sequence[ir.CoreAction]) -> Iterable[Argument]:
        alike = self._alike(steps)
        if alike is not None:
            yield alike
            return
        position = 0
        while position < len(steps):
            whole = self._whole_array(steps, position)
            if whole is None:
                yield Argument(self.deferred(steps[position]))
                position += 1
            else:
                name, count = whole
                yield Argument(name, starred=True)
                position += count

    def _alike(self, steps: Sequence[ir.CoreAction]) -> Argument | None:
        """Branches that differ only in an index, as a loop over parallels of instances, or as one coroutine with that
        index as its parameter.
        """
        if len(steps) < LEAST or isinstance(steps[0], ir.RunInstance):
            return None
        if all(map(runs_instances, steps)):
            parallel = template([self.awaitable(step) for step in steps], self.members.index)
            if parallel is None:
                return None
            return Argument(Comprehension(parallel, self.members.index, counted_to(len(steps)), "()"), starred=True)
        if not all(map(is_plain, steps)):
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

    def _whole_array(self, steps: Sequence[ir.CoreAction], start: int) -> tuple[Code, int] | None:
        first = steps[start]
        if not isinstance(first, ir.RunInstance):
            return None
        array = self.members.array_of(first.instance)
        if array is None:
            return None
        return (own(array.name), len(array.elements)) if runs_in_order(steps, start, array.elements) else None

    def _group(self, label: str, body: ir.CoreAction) -> Code:
        return call(self.imports.runtime("group"), Constant(quoted(label)), self.deferred(body, label))

    def _coroutine(self, action: ir.CoreAction, hint: str) -> Code:
        name = self.members.names.fresh(f"_{hint}")
        position = len(self.methods)
        self.methods.append(Method(name, ()))
        self.methods[position] = Method(name, self.statements(action))
        return own(name)

    def _repeat(self, action: ir.Repeat[ir.CoreAction], until: Expression | None) -> Block:
        statements = self.statements(action.body)
        if until is not None:
            place = self._place_of_fault(until, action)
            statements += (Block("if", self.printer.print(until), (BREAK,), place),)
        return Block("while", TRUE, statements)

    def _if(self, action: ir.IfElse[ir.CoreAction]) -> Statements:
        keyword: Literal["if", "elif"] = "if"
        blocks: list[Statement] = []
        rest: ir.CoreAction = action
        while isinstance(rest, ir.IfElse):
            place = self._place_of_fault(rest.condition, rest)
            blocks.append(Block(keyword, self.printer.print(rest.condition), self.statements(rest.then), place))
            keyword, rest = "elif", rest.otherwise
        otherwise = self.statements(rest)
        return (*blocks, else_(*otherwise)) if otherwise else tuple(blocks)

    def _catch(self, action: ir.CatchException[ir.CoreAction]) -> Statements:
        caught = [Name(name) for name in self.imports.caught(action.exception)]
        body, handler = self.statements(action.body), self.statements(action.handler)
        if not handler:
            suppress = self.imports.standard("contextlib", "suppress")
            return (Block("with", call(suppress, *caught), body),)
        exceptions = caught[0] if len(caught) == 1 else tuple_of(caught)
        return (try_(*body), Block("except", exceptions, handler))

    def _checked_place(self, action: ir.CoreAction) -> str | None:
        """The place of an action that waits in this statement itself, not in a process or coroutine that it runs."""
        match action:
            case ir.WriteValue() | ir.StopStep() | ir.WaitStep():
                return self._place(action)
            case ir.InterruptOn(branch=ir.Branch(event=ir.InputEvent() | ir.OutputEvent() | ir.ReadyEvent())):
                return self._place(action)
            case ir.InterruptOn(branch=branch):
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
            case _:  # Any other action waits in what it runs.
                return None
