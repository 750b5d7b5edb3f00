"""Compositions as the code of a generator function."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import groupby
from typing import assert_never

from cspdiag.codegen.branch_names import branch_name
from cspdiag.codegen.optimized_python.communications import Communications, Statements, text
from cspdiag.codegen.optimized_python.expressions import FastPrinter
from cspdiag.codegen.optimized_python.laws import InlineLaw, external_calls, reset_statements
from cspdiag.codegen.optimized_python.places import Spelling
from cspdiag.codegen.optimized_python.statements import assigned
from cspdiag.codegen.optimized_python.storage import never_ends
from cspdiag.codegen.python_code import Argument, Atom, Call, Code, Comprehension, Starred, call
from cspdiag.codegen.python_external import ExternalModules
from cspdiag.codegen.python_imports import Imports
from cspdiag.codegen.python_rolling import LEAST, statements_template
from cspdiag.codegen.python_statements import Block, Line, Statement, assign, lines
from cspdiag.codegen.python_types import quoted
from cspdiag.diagnostics import Span
from cspdiag.network.actions import (
    Action,
    AfterEvent,
    AssignValue,
    Branch,
    CatchException,
    Choice,
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
from cspdiag.network.expressions import Expression, LiteralValue, ParameterValue, SignalValue, VariableValue
from cspdiag.network.ir import Declared, InstanceOf, ProcessClass
from cspdiag.network.walk import mentions_variable, parts

_LONGEST_COMMENT = 70


@dataclass
class Composition:
    """Writes the code of one process class.

    ``functions`` collects the generator functions of parallel branches and interrupted bodies, ``prologue`` what laws compute once.
    """

    spelling: Spelling
    communications: Communications
    printer: FastPrinter
    initial: FastPrinter
    """For expressions in the constructor."""
    imports: Imports
    modules: ExternalModules
    functions: list[tuple[str, str, Statements]] = field(default_factory=list)
    """Name, further parameters, and body."""
    prepared: list[Statement] = field(default_factory=list)
    """What the code makes once of its functions."""
    prologue: list[Statement] = field(default_factory=list)
    choices: dict[str, Code] = field(default_factory=dict)
    """How the alternatives are made, by name."""
    choice_names: dict[str, str] = field(default_factory=dict)
    selectors: dict[str, str] = field(default_factory=dict)
    """Local variables for the selectors of alternatives."""
    memories: dict[str, str] = field(default_factory=dict)
    """Local variables that remember what fair alternatives chose last."""
    _loops: int = 0
    _process: str = "self"
    """The process or law that is executed at this place."""

    def statements(self, action: Action) -> Statements:
        """An action as statements."""
        match action:
            case SkipStep():
                return ()
            case SequentialSteps(steps=steps):
                return tuple(self._sequence(steps))
            case AssignValue(target=target, value=value):
                return tuple(self._set(target, value, self._place(action)))
            case ReadValue(source=source, target=target):
                return (self._comment(action), *self._read_into(target, lambda into: self._reading(source, into)))
            case WriteValue(sink=sink, value=value):
                before, simple = self._simple(value)
                return (self._comment(action), *before, *self.communications.write(sink, simple))
            case RaiseException(exception=exception):
                return (Line("raise ", Atom(self.imports.exception(exception)), comment=self._place(action)),)
            case RunInstance(instance=instance):
                return (self._comment(action), *self._run_here(instance))
            case ResetInstance(instance=instance):
                return (text(f"{self._instance(instance)}.reset()"),)
            case Repeat(body=body, until=until):
                with self._loop():
                    return (self._repeat(body, until),)
            case WhileLoop(condition=condition, body=body):
                with self._loop():
                    return (Block(Line("while ", self.printer.print(condition), ":"), self.statements(body)),)
            case IfElse():
                return self._if(action)
            case CatchException():
                return self._catch(action)
            case WaitStep(duration=duration):
                return (self._comment(action), *self._delay(duration))
            case StopStep():
                return (self._comment(action), *self._known(), text(f"yield from {self.imports.runtime('stop')}()"))
            case ParallelSteps(steps=steps, prioritized=False) if self._are_functions(steps):
                return (self._comment(action), *self._rounds(steps))
            case ParallelSteps(steps=steps, prioritized=prioritized):
                name = self.imports.runtime("prioritized_parallel" if prioritized else "parallel")
                branches = Call(name, tuple(Argument(branch) for branch in self._branches(steps)))
                return (self._comment(action), *self._known(), Line("yield from ", branches))
            case Choice():
                return self._choice(action)
            case InterruptOn(body=body, branch=branch):
                return (self._comment(action), *self._interrupt(body, branch))
            case Group(label=label, body=body):
                return tuple(self._group(label, body))
            case ReadInputs() | WriteOutputs() | RunLaw():
                return tuple(self._law([action]))
            case ResetStates(states=states):
                return tuple(self._reset(states))
            case ProcessScope():
                return tuple(self._scope(action))
            case ReportCommunication(channel=channel, value=value):
                return tuple(self._reported(action, channel, value))
        assert_never(action)

    def _sequence(self, steps: Sequence[Action]) -> Iterator[Statement]:
        for law, group in groupby(steps, key=_law_of):
            if law:
                yield from self._law(list(group))
            else:
                for step in group:
                    yield from self.statements(step)

    def _known(self) -> Statements:
        return self.communications.known()

    # Places

    def _place(self, action: Step) -> str:
        return self.imports.names.place(action.span.file, action.span.line)

    def place_of(self, item: Declared) -> str:
        """Where something stands in the text."""
        return self.imports.names.place(item.span.file, item.span.line)

    def _comment(self, action: Step, what: str | None = None) -> Statement:
        return text(f"# {self._place(action)}  {_one_line(action.span) if what is None else what}".rstrip())

    # Values

    def _set(self, target: Target, value: Expression, place: str) -> Iterable[Statement]:
        name = self.spelling.variable(target.channel).flat
        if not target.indexes:
            yield from assigned(name, self.printer, value, place)
        else:
            yield self._replaced(target, self.printer.print(value), place)

    def _replaced(self, target: Target, value: Code, place: str | None = None) -> Statement:
        variable = self.spelling.variable(target.channel)
        indexes = [self.printer.print(index) for index in target.indexes]
        return assign(variable.flat, call(self.imports.runtime("replaced"), variable, value, *indexes), place)

    def _read_into(self, target: Target, read: Callable[[str], Statements]) -> Statements:
        if not target.indexes:
            return read(self.spelling.variable(target.channel).flat)
        value = self.spelling["value"]
        return (*read(value), self._replaced(target, Atom(value)))

    def _reading(self, source: object, into: str) -> Statements:
        return self.communications.read(source, into)  # type: ignore[arg-type]

    def _simple(self, value: Expression) -> tuple[Statements, str]:
        """A value as a name or a literal, and what has to be computed before."""
        if isinstance(value, LiteralValue | ParameterValue | SignalValue) or (
            isinstance(value, VariableValue) and self.spelling.is_local(value.channel)
        ):
            code = self.printer.print(value)
            if len(code.flat) < 40:
                return (), code.flat
        name = self.spelling["value"]
        return tuple(assigned(name, self.printer, value, None)), name

    # Control flow

    def _repeat(self, body: Action, until: Expression | None) -> Block:
        statements = self.statements(body)
        if until is not None:
            statements += (Block(Line("if ", self.printer.print(until), ":"), (text("break"),)),)
        return Block(text("while True:"), statements)

    def _if(self, action: IfElse) -> Statements:
        keyword = "if "
        blocks: list[Statement] = []
        rest: Action = action
        while isinstance(rest, IfElse):
            blocks.append(Block(Line(keyword, self.printer.print(rest.condition), ":"), self.statements(rest.then)))
            keyword, rest = "elif ", rest.otherwise
        otherwise = self.statements(rest)
        if otherwise:
            blocks.append(Block(text("else:"), otherwise))
        return tuple(blocks)

    def _catch(self, action: CatchException) -> Statements:
        exception = Atom(self.imports.exception(action.exception))
        body, handler = self.statements(action.body), self.statements(action.handler)
        return (
            Block(text("try:"), body),
            Block(Line("except ", exception, ":"), handler or (text("pass"),)),
        )

    @contextmanager
    def _loop(self) -> Iterator[None]:
        self._loops += 1
        try:
            yield
        finally:
            self._loops -= 1

    def _delay(self, duration: Expression) -> Statements:
        before, simple = self._simple(duration)
        begin = text(f"{self.imports.runtime('begin_delay')}({self.spelling['me']}, {simple})")
        waits: Statements = (begin, text("yield"))
        known = self.printer.value(duration)
        if known is None:
            waits = (Block(text(f"if {simple} > 0:"), waits),)
        elif not isinstance(known, int) or known <= 0:
            waits = ()
        return (*before, *self.communications.check(), *waits)

    # Processes

    def _are_functions(self, steps: Sequence[Action]) -> bool:
        """Whether a parallel in a loop consists of code of this process only, so that its tasks can be kept."""
        return self._loops > 0 and len(steps) < LEAST and not any(isinstance(step, RunInstance) for step in steps)

    def _rounds(self, steps: Sequence[Action]) -> Iterator[Statement]:
        me = self.spelling["me"]
        rounds = self.spelling.names.fresh("rounds")
        functions = ", ".join(self._function(step, rounds) for step in steps)
        self.prepared.append(text(f"{rounds} = {self.imports.runtime('Rounds')}({me}, {functions})"))
        yield from self.communications.check()
        yield text(f"{rounds}.begin()")
        yield text("yield")
        yield Block(text(f"if {rounds}.failed:"), (text(f"{rounds}.conclude()"),))

    def _instance(self, name: str) -> str:
        return self.spelling.local(self.spelling.members.instance(name))

    def _class_of(self, name: str) -> object:
        instance = next(item for item in self.spelling.process.instances if item.name == name)
        assert isinstance(instance, InstanceOf)
        return self.spelling.network.class_named(instance.class_name)

    def _run_here(self, name: str) -> Statements:
        class_, instance = self._class_of(name), self._instance(name)
        if isinstance(class_, ProcessClass) and class_.external is None:
            return (*self.communications.check_early(0), text(f"yield from {instance}.steps({self.spelling['me']})"))
        return (text(f"yield from {instance}.execute().__await__()"),)

    def _scope(self, scope: ProcessScope) -> Iterator[Statement]:
        part, me, error = self.spelling.part(scope.instance), self.spelling["me"], self.spelling["error"]
        yield text(f"# {self._place(scope)}  {scope.instance}")
        yield text(f"{part}.start({me})")
        outer, self._process = self._process, part
        body = self.statements(scope.body)
        self._process = outer
        yield Block(text("try:"), body)
        failed = (text(f"{part}.fail({me}, {error})"), text("raise"))
        yield Block(text(f"except BaseException as {error}:"), failed)
        if not never_ends(scope.body):
            yield text(f"{part}.end({me})")

    def _branches(self, steps: Sequence[Action]) -> Iterator[Code]:
        alike = self._alike(steps)
        if alike is not None:
            yield Starred(alike)
            return
        position = 0
        while position < len(steps):
            step = steps[position]
            array = self._whole_array(steps, position)
            if array is not None:
                yield Atom(f"*{array[0]}")
                position += array[1]
                continue
            yield self._branch(step)
            position += 1

    def _branch(self, step: Action) -> Code:
        if isinstance(step, RunInstance):
            return Atom(self._instance(step.instance))
        return Atom(self._function(step))

    def _whole_array(self, steps: Sequence[Action], start: int) -> tuple[str, int] | None:
        first = steps[start]
        array = self.spelling.members.array_of(first.instance) if isinstance(first, RunInstance) else None
        if array is None:
            return None
        given = [s.instance for s in steps[start : start + len(array.elements)] if isinstance(s, RunInstance)]
        if given != list(array.elements):
            return None
        return self.spelling.local(f"self.{array.name}"), len(array.elements)

    def _function(self, action: Action, rounds: str | None = None) -> str:
        """A generator function for what runs beside others, again and again if it belongs to ``rounds``."""
        name = self.spelling.names.fresh(f"_{branch_name(action)}")
        position = len(self.functions)
        self.functions.append((name, "", ()))
        outer, loops, self._loops = self._process, self._loops, 0
        body = self.statements(action)
        self._process, self._loops = outer, loops
        if rounds is not None:
            body = (*body, text(f"{rounds}.done({self.spelling['me']})"), text("yield"))
            body = (Block(text("while True:"), body),)
        self.functions[position] = (name, "", body)
        return name

    def _alike(self, steps: Sequence[Action]) -> Code | None:
        """Branches that differ only in an index, as one function with that index as its last parameter."""
        if len(steps) < LEAST or not all(map(_is_plain, steps)):
            return None
        k = self.spelling["k"]
        body = statements_template([self.statements(step) for step in steps], k, 0)
        if body is None:
            return None
        name = self.spelling.names.fresh(f"_{branch_name(steps[0])}")
        self.functions.append((name, f", {k}: int", body))
        made = f"{self.imports.standard('functools', 'partial')}({name}, {k}={k})"
        return Comprehension(Atom(made), f"for {k} in range({len(steps)})", "()")

    def _group(self, label: str, body: Action) -> Iterator[Statement]:
        group = self.spelling.names.fresh(self.spelling["group"])
        start, end = self.imports.runtime("start_group"), self.imports.runtime("end_group")
        yield text(f"{group} = {start}({self.spelling['me']}, {quoted(label)})")
        yield Block(text("try:"), self.statements(body))
        yield Block(text("finally:"), (text(f"{end}({group})"),))

    # Alternatives and interrupts

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
            return (self._comment(choice), *self._selection(choice, attribute, local))
        return (self._comment(choice), *self._slow_selection(choice, local))

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
                case _:
                    return False
        return True

    def _selection(self, choice: Choice, attribute: str, local: str) -> Iterator[Statement]:
        spelling, branches = self.spelling, choice.branches
        ready, k, first = spelling["ready"], spelling["k"], spelling["first"]
        guards = self._guards(attribute, local)
        yield from self.communications.check()
        mask: str | None = None
        if any(branch.condition is not None for branch in branches):
            mask = spelling["mask"]
            yield assign(mask, self._mask(branches))
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
            yield Block(text(f"if not {ready}:"), (*self._known(), assign(ready, waiting)))

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

    def _mask(self, branches: Sequence[Branch]) -> Code:
        fixed = 0
        parts = []
        for index, branch in enumerate(branches):
            if branch.condition is None:
                fixed |= 1 << index
            else:
                code = self.printer.print(branch.condition)
                parts.append(f"(({code.flat}) << {index})" if index else f"({code.flat})")
        if not parts:
            return Atom(str(fixed))
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
        return _one_line(event.span) or None

    def _taken(self, event: Event, guards: str, index: int) -> Statements:
        if not isinstance(event, InputEvent):
            return ()
        source = event.source
        return self._read_into(event.target, lambda into: self.communications.take(source, into, guards, index))

    def _slow_selection(self, choice: Choice, local: str) -> Iterator[Statement]:
        k = self.spelling["k"]
        selected = Call(f"{local}.select", tuple(self._select_arguments(choice.branches)))
        yield from self._known()
        chosen = "" if len(choice.branches) == 1 else f"{k} = "
        yield Line(f"{chosen}yield from ", selected)

        def taken(event: Event, index: int) -> Statements:
            if not isinstance(event, InputEvent):
                return ()
            return self._read_into(event.target, lambda into: (text(f"{into} = {local}.value"),))

        yield from self._chosen(choice.branches, taken)

    def _select_arguments(self, branches: Sequence[Branch]) -> Iterator[Argument]:
        if any(branch.condition is not None for branch in branches):
            conditions = ", ".join(
                "True" if branch.condition is None else self.printer.print(branch.condition).flat for branch in branches
            )
            yield Argument(Atom(f"({conditions},)" if len(branches) == 1 else f"({conditions})"), "enabled")
        values = [
            f"{number}: {self._if_enabled(branch, branch.event.value, 'None')}"
            for number, branch in enumerate(branches)
            if isinstance(branch.event, OutputEvent)
        ]
        if values:
            yield Argument(Atom(f"{{{', '.join(values)}}}"), "values")
        delays = [
            f"{number}: {self._if_enabled(branch, branch.event.duration, '0')}"
            for number, branch in enumerate(branches)
            if isinstance(branch.event, AfterEvent) and mentions_variable(branch.event.duration)
        ]
        if delays:
            yield Argument(Atom(f"{{{', '.join(delays)}}}"), "delays")

    def _if_enabled(self, branch: Branch, expression: Expression, otherwise: str) -> str:
        """What an event needs; where the condition does not hold it is not evaluated."""
        code = self.printer.print(expression).flat
        if branch.condition is None or isinstance(expression, LiteralValue | ParameterValue):
            return code
        return f"({code}) if ({self.printer.print(branch.condition).flat}) else {otherwise}"

    def _guard(self, event: Event, printer: FastPrinter, *, made: bool) -> Code:
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
                given = () if made else (printer.print(value),)
                return call(self.imports.runtime("Output"), Atom(end if made else self.spelling.local(end)), *given)
            case AfterEvent(duration=duration):
                later = made and mentions_variable(duration)
                return call(self.imports.runtime("After"), Atom("0") if later else printer.print(duration))
            case SkipEvent():
                return call(self.imports.runtime("Skip"))
        assert_never(event)

    def _interrupt(self, body: Action, branch: Branch) -> Iterator[Statement]:
        function = self._branch(body)
        guard = self.spelling.names.fresh(self.spelling["guard"])
        interrupted = self.imports.runtime("interrupted")
        taken: Statements = ()
        if isinstance(branch.event, InputEvent):
            taken = self._read_into(branch.event.target, lambda into: (text(f"{into} = {guard}.value"),))
        handler = (*taken, *self.statements(branch.body))
        run = Line("if (yield from ", call(interrupted, function, Atom(guard)), "):")
        if not handler:
            run = Line("yield from ", call(interrupted, function, Atom(guard)))
        guarded: Statements = (
            *self._known(),
            assign(guard, self._guard(branch.event, self.printer, made=False)),
            Block(run, handler) if handler else run,
        )
        if branch.condition is None:
            yield from guarded
            return
        yield Block(Line("if ", self.printer.print(branch.condition), ":"), guarded)
        if isinstance(body, RunInstance):
            plainly = self._run_here(body.instance)
        else:
            plainly = (text(f"yield from {function.flat}({self.spelling['me']})"),)
        yield Block(text("else:"), plainly)

    # Laws

    def _law(self, steps: Sequence[Action]) -> Iterator[Statement]:
        """Steps of one law: they are executed, and fail, in its name."""
        me, error = self.spelling["me"], self.spelling["error"]
        law = _law_of(steps[0])
        part = self.spelling.part(law)
        process = "self" if self._process == "self" else self._process
        inner: list[Statement] = []
        for step in steps:
            match step:
                case ReadInputs():
                    inner += self._read_inputs(step)
                case WriteOutputs():
                    inner += self._write_outputs(step)
                case RunLaw():
                    inline = self._inline_law(step)
                    self.prologue += inline.prologue()
                    inner += inline.statements()
        if not inner:
            return
        yield text(f"{me}.process = {part}")
        yield Block(text("try:"), tuple(inner))
        failed = (
            text(f"{me}.process = {process}"),
            text(f"{part}.blame({error})"),
            text("raise"),
        )
        yield Block(text(f"except Exception as {error}:"), failed)
        yield text(f"{me}.process = {process}")

    def _inline_law(self, law: RunLaw) -> InlineLaw:
        return InlineLaw(law, self.spelling.process, self.printer, self.spelling.names, self.place_of, self.modules)

    def _read_inputs(self, action: ReadInputs) -> Iterator[Statement]:
        if action.reads:
            yield self._comment(action, f"inputs of {action.law}")
        yield from self.communications.read_all(
            [(read.source, self.spelling.signal(read.name).flat) for read in action.reads]
        )

    def _write_outputs(self, action: WriteOutputs) -> Iterator[Statement]:
        if action.writes:
            yield self._comment(action, f"outputs of {action.law}")
        pairs = []
        for write in action.writes:
            if isinstance(write.value, SignalValue | LiteralValue | ParameterValue):
                pairs.append((write.sink, self.printer.print(write.value).flat))
            else:
                name = self.spelling.names.fresh(f"{action.law}_output")
                yield from assigned(name, self.printer, write.value, None)
                pairs.append((write.sink, name))
        yield from self.communications.write_all(pairs)

    def _reset(self, states: Sequence[str]) -> Iterator[Statement]:
        yield from reset_statements(states, self.spelling.process, self.printer, self.place_of)
        external = {item.name for item in external_calls(self.spelling.process.body)}
        for name in states:
            if name in external:
                spelled = self.spelling.signal(name).flat
                yield Block(text(f'if hasattr({spelled}, "reset"):'), (text(f"{spelled}.reset()"),))

    def _reported(self, action: Step, channel: str, value: Expression) -> Iterator[Statement]:
        if not self.communications.traced:
            return
        scheduler, me = self.imports.runtime("scheduler"), self.spelling["me"]
        before, simple = self._simple(value)
        yield self._comment(action)
        yield from before
        tell = text(f'{scheduler}.observe(f"{{self.name}}.{channel}", {simple}, {me}, {me})')
        yield Block(text(f"if {scheduler}.observe is not None:"), (tell,))


def _is_plain(action: Action) -> bool:
    """Whether an action needs no alternative and no function of its own."""
    return not any(
        isinstance(p, Choice | ParallelSteps | InterruptOn | Group | RunInstance | RunLaw) for p in parts(action)
    )


def _law_of(action: Action) -> str:
    return action.law if isinstance(action, ReadInputs | WriteOutputs | RunLaw) else ""


def _one_line(span: Span) -> str:
    joined = " ".join(span.text.split())
    return joined if len(joined) <= _LONGEST_COMMENT else f"{joined[:_LONGEST_COMMENT]}..."


def code_lines(statements: Statements, indent: str) -> list[str]:
    """The lines of a body, which is never empty."""
    return lines(statements or (text("pass"),), indent)
