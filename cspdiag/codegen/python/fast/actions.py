"""Compositions as the code of a generator function."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import groupby
from typing import Literal, assert_never

from cspdiag.codegen.python.fast.alternatives import Alternatives
from cspdiag.codegen.python.fast.laws.steps import LawSteps, law_of
from cspdiag.codegen.python.plain.instances import path
from cspdiag.codegen.python.text.code import (
    COMPARISON,
    TRUE,
    Code,
    Comprehension,
    Constant,
    Name,
    Starred,
    WholeNumber,
    call,
    counted_to,
    delegated,
    own,
    tuple_of,
)
from cspdiag.codegen.python.text.literals import quoted
from cspdiag.codegen.python.text.operators import infix
from cspdiag.codegen.python.text.rolling import rolled_steps, template
from cspdiag.codegen.python.text.statements import (
    BREAK,
    RAISE,
    YIELD,
    Block,
    Function,
    Plain,
    Remark,
    Statement,
    Statements,
    assign,
    else_,
    if_,
    repeat,
    run,
    try_,
    waits,
)
from cspdiag.codegen.shared.branches import branch_name, runs_in_order, runs_instances
from cspdiag.codegen.shared.trees import LEAST
from cspdiag.network.flow.ends import may_end
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.network import InstanceOf, ProcessClass
from cspdiag.network.ir.walk import parts


@dataclass
class Composition(Alternatives, LawSteps):
    """Writes the code of one process class.

    ``functions`` collects the generator functions of parallel branches and interrupted bodies.
    """

    functions: list[Function] = field(default_factory=list)
    prepared: list[Statement] = field(default_factory=list)
    """Statements that prepare these functions once."""
    _loops: int = 0
    _nested: int = 0
    """The number of loops, and of nested functions, around the present action."""

    def statements(self, action: ir.Action) -> Statements:
        """An action as statements."""
        match action:
            case ir.SkipStep():
                return ()
            case ir.SequentialSteps(steps=steps):
                return tuple(self._sequence(steps))
            case ir.AssignValue(target=target, value=value):
                return tuple(self.set(target, value, self.place(action)))
            case ir.ReadValue(source=source, target=target):
                return (
                    self.comment(action),
                    *self.read_into(action, lambda into: self.communications.read(source, into)),
                )
            case ir.WriteValue(sink=sink, value=value):
                before, simple = self.simple(value)
                return (self.comment(action), *before, *self.communications.write(sink, simple))
            case ir.RaiseException(exception=exception):
                return (Plain("raise", Name(self.imports.exception(exception)), self.place(action)),)
            case ir.RunInstance(instance=instance):
                return (self.comment(action), *self.run_here(instance))
            case ir.ResetInstance(instance=instance):
                return (run(self.spelling.members.instance(instance).call("reset")),)
            case ir.Repeat(until=until):
                with self._loop():
                    return self._repeat(action, until)
            case ir.WhileLoop(condition=condition, body=body):
                with self._loop():
                    return (self._conditional_block("while", condition, action, self.statements(body)),)
            case ir.CountedLoop(iterations=iterations, body=body):
                with self._loop():
                    inside = self.statements(body)
                return (repeat(iterations, inside),) if inside else ()
            case ir.IfElse():
                return self._if(action)
            case ir.CatchException():
                return self._catch(action)
            case ir.WaitStep(duration=duration):
                return (self.comment(action), *self._delay(duration))
            case ir.StopStep():
                return (
                    self.comment(action),
                    *self.set_current_task(),
                    run(delegated(call(self.imports.runtime("stop")))),
                )
            case ir.ParallelSteps(steps=steps, prioritized=False) if self._are_functions(steps):
                return (self.comment(action), *self._rounds(steps))
            case ir.ParallelSteps(steps=steps, prioritized=prioritized):
                name = self.imports.runtime("prioritized_parallel" if prioritized else "parallel")
                branches = call(name, *self._branches(steps))
                return (self.comment(action), *self.set_current_task(), run(delegated(branches)))
            case ir.Choice():
                return self._choice(action)
            case ir.InterruptOn(body=body, branch=branch):
                return (self.comment(action), *self._interrupt(body, branch))
            case ir.Group(label=label, body=body):
                return tuple(self._group(label, body))
            case ir.ReadInputs() | ir.WriteOutputs() | ir.RunLaw():
                return tuple(self._law([action]))
            case ir.ResetStates(states=states):
                return tuple(self._reset(states))
            case ir.ProcessScope():
                return tuple(self._scope(action))
            case ir.ReportCommunication(channel=channel, value=value):
                return tuple(self._reported(action, channel, value))
        assert_never(action)

    def _sequence(self, steps: Sequence[ir.Action]) -> Iterator[Statement]:
        for law, group in groupby(steps, key=law_of):
            if law:
                yield from self._law(list(group))
            else:
                groups = [self.statements(step) for step in group]
                yield from rolled_steps(groups, self.spelling.members.index_around, waits)

    # Control flow

    def _repeat(self, action: ir.Repeat, until: Expression | None) -> Statements:
        body = self.statements(action.body)
        end = () if until is None else (self._conditional_block("if", until, action, (BREAK,)),)
        leave = self.executes(self.process)
        if not self._is_one_law(action.body) or body[-1] != leave:
            return (Block("while", TRUE, (*body, *end)),)
        loop = Block("while", TRUE, (*body[1:-1], *end))  # The task executes the law from one iteration to the next.
        return (body[0], loop, *((leave,) if end else ()))

    @staticmethod
    def _is_one_law(body: ir.Action) -> bool:
        steps = body.steps if isinstance(body, ir.SequentialSteps) else (body,)
        laws = {law_of(step) for step in steps}
        return len(laws) == 1 and "" not in laws

    def _if(self, action: ir.IfElse) -> Statements:
        keyword: Literal["if", "elif"] = "if"
        blocks: list[Statement] = []
        rest: ir.Action = action
        while isinstance(rest, ir.IfElse):
            blocks.append(self._conditional_block(keyword, rest.condition, rest, self.statements(rest.then)))
            keyword, rest = "elif", rest.otherwise
        otherwise = self.statements(rest)
        return (*blocks, else_(*otherwise)) if otherwise else tuple(blocks)

    def _conditional_block(
        self, keyword: Literal["if", "elif", "while"], condition: Expression, action: ir.Step, body: Statements
    ) -> Block:
        """A block with a condition, with a comment of its place if it can fault."""
        span = condition.span or action.span
        place = self.imports.names.place(span.file, span.line) if may_fault(condition) else None
        return Block(keyword, self.printer.print(condition), body, place)

    def _catch(self, action: ir.CatchException) -> Statements:
        caught = [Name(name) for name in self.imports.caught(action.exception)]
        exception = caught[0] if len(caught) == 1 else tuple_of(caught)
        body, handler = self.statements(action.body), self.statements(action.handler)
        return (try_(*body), Block("except", exception, handler))

    @contextmanager
    def _loop(self) -> Iterator[None]:
        self._loops += 1
        try:
            yield
        finally:
            self._loops -= 1

    def _delay(self, duration: Expression) -> Statements:
        before, simple = self.simple(duration)
        begin = run(call(self.imports.runtime("begin_delay"), self.spelling["me"], simple))
        waits: Statements = (begin, YIELD)
        known = self.printer.value(duration)
        if known is None:
            waits = (if_(infix(">", COMPARISON, simple, WholeNumber(0)), *waits),)
        elif not isinstance(known, int) or known <= 0:
            waits = ()
        return (*before, *self.communications.check(), *waits)

    # Processes

    def _are_functions(self, steps: Sequence[ir.Action]) -> bool:
        """Whether a parallel in a loop consists only of code of this process, so its tasks can be reused."""
        plain = self._loops > 0 and self._nested == 0
        return plain and len(steps) < LEAST and not any(isinstance(step, ir.RunInstance) for step in steps)

    def _rounds(self, steps: Sequence[ir.Action]) -> Iterator[Statement]:
        rounds = Name(self.spelling.names.fresh("rounds"))
        functions = [self._function(step, rounds) for step in steps]
        made = call(self.imports.runtime("Rounds"), self.spelling["me"], *functions)
        self.prepared.append(assign(rounds, made))
        yield from self.communications.check()
        yield run(rounds.call("begin"))
        yield YIELD
        yield if_(rounds.field("failed"), run(rounds.call("conclude")))

    def _class_of(self, name: str) -> object:
        instance = next(item for item in self.spelling.process.instances if item.name == name)
        assert isinstance(instance, InstanceOf)
        return self.spelling.network.class_named(instance.class_name)

    def run_here(self, name: str) -> Statements:
        """Run an instance in sequence."""
        class_, instance = self._class_of(name), self.spelling.members.instance(name)
        if isinstance(class_, ProcessClass) and class_.external is None:
            return (run(delegated(instance.call("steps", self.spelling["me"]))),)
        return (run(delegated(instance.call("execute").call("__await__"))),)

    def _scope(self, scope: ir.ProcessScope) -> Iterator[Statement]:
        part, me, error = self.spelling.part(scope.instance), self.spelling["me"], self.spelling["error"]
        yield Remark(f"{self.place(scope)}  {scope.instance}")
        yield run(part.call("start", me))
        outer, self.process = self.process, part
        body = self.statements(scope.body)
        self.process = outer
        yield try_(*body)
        failed = (run(part.call("fail", me, error)), RAISE)
        yield Block("except", Name("BaseException"), failed, bound=error.text)
        if may_end(scope.body):
            yield run(part.call("end", me))

    def _branches(self, steps: Sequence[ir.Action]) -> Iterator[Code]:
        alike = self._alike(steps)
        if alike is not None:
            yield Starred(alike)
            return
        position = 0
        while position < len(steps):
            step = steps[position]
            array = self._whole_array(steps, position)
            if array is not None:
                yield Starred(array[0])
                position += array[1]
                continue
            yield self.branch(step)
            position += 1

    def branch(self, step: ir.Action) -> Code:
        """A process to run in parallel with others.

        It is no local variable: if a nested function uses ``n`` of those, compiling it takes ``n`` squared steps.
        """
        if isinstance(step, ir.RunInstance):
            return self.spelling.members.instance(step.instance)
        return self._function(step)

    def _whole_array(self, steps: Sequence[ir.Action], start: int) -> tuple[Code, int] | None:
        first = steps[start]
        array = self.spelling.members.array_of(first.instance) if isinstance(first, ir.RunInstance) else None
        if array is None or not runs_in_order(steps, start, array.elements):
            return None
        return own(array.name), len(array.elements)

    def _function(self, action: ir.Action, rounds: Code | None = None) -> Code:
        """A generator function for a parallel branch, which runs repeatedly if it belongs to ``rounds``."""
        name = self.spelling.names.fresh(f"_{branch_name(action)}")
        position = len(self.functions)
        self.functions.append(self._generator(name, ()))
        outer, loops, self._loops = self.process, self._loops, 0
        self._nested += 1
        with self.communications.function() as owned:
            body = self.statements(action)
        self._nested -= 1
        self.process, self._loops = outer, loops
        if rounds is not None:
            body = (Block("while", TRUE, (*body, run(rounds.call("done", self.spelling["me"])), YIELD)),)
        self.functions[position] = self._generator(name, (*owned, *body))
        return Name(name)

    def _generator(self, name: str, body: Statements, *parameters: str) -> Function:
        task, steps = self.imports.runtime("Task"), self.imports.runtime("Steps")
        return Function(name, (f"{self.spelling['me'].text}: {task}", *parameters), body, steps)

    def _alike(self, steps: Sequence[ir.Action]) -> Code | None:
        """Branches that differ only in an index, as one function with that index as its last parameter."""
        if len(steps) < LEAST or isinstance(steps[0], ir.RunInstance) or not all(map(_is_plain, steps)):
            return None
        k = self.spelling["k"]
        with self.communications.function() as owned:
            body = template([self.statements(step) for step in steps], k.text)
        if body is None or owned:
            return None
        name = self.spelling.names.fresh(f"_{branch_name(steps[0])}")
        self.functions.append(self._generator(name, body, f"{k.text}: int"))
        made = call(self.imports.standard("functools", "partial"), Name(name), **{k.text: k})
        return Comprehension(made, k.text, counted_to(len(steps)), "()")

    def _group(self, label: str, body: ir.Action) -> Iterator[Statement]:
        group = Name(self.spelling.names.fresh(self.spelling["group"].text))
        begun = call(self.imports.runtime("start_group"), self.spelling["me"], Constant(quoted(label)))
        yield assign(group, begun)
        yield try_(*self.statements(body))
        yield Block("finally", None, (run(call(self.imports.runtime("end_group"), group)),))

    def _reported(self, action: ir.Step, channel: str, value: Expression) -> Iterator[Statement]:
        if not self.communications.traced:
            return
        me = self.spelling["me"]
        before, simple = self.simple(value)
        yield self.comment(action)
        yield from before
        yield self.communications.observed(path(channel, own("name")), simple, me, me)


def _is_plain(action: ir.Action) -> bool:
    """Whether an action contains no alternative and needs no function of its own."""
    return not any(
        isinstance(p, ir.Choice | ir.InterruptOn | ir.Group | ir.RunLaw)
        or (isinstance(p, ir.ParallelSteps) and not runs_instances(p))
        for p in parts(action)
    )
