"""The common part of writers of compositions: step functions under construction, their states, and values that are kept
while the process waits.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from cspdiag.codegen.c.process.flow import can_complete
from cspdiag.codegen.c.process.levels import Levels
from cspdiag.codegen.c.process.routines import Handler, Routine, Waiting, WaitingState
from cspdiag.codegen.c.process.struct.members import Members, StructMember
from cspdiag.codegen.c.text.code import Code, address, call, cast, code, own, unsigned
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.c.text.kernel import KERNEL
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.names import PROCESS_LOCALS, Names, PackageNames, identifier, snake_case
from cspdiag.codegen.c.text.numbered import Numbered
from cspdiag.codegen.c.text.rolling import VARIABLE
from cspdiag.codegen.c.text.statements import (
    For,
    Function,
    If,
    Label,
    Plain,
    Remark,
    State,
    Statement,
    Wait,
    goto,
    goto_if,
    in_block,
    jumps_to,
    mentions_kernel,
    return_value,
    run,
    store,
)
from cspdiag.codegen.shared.branches import branch_name
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.model.types import Type
from cspdiag.network.ir.actions import Action, InterruptOn, ParallelSteps, RunInstance, Step
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import ProcessClass, SubmodelClass

MOST_PLACES = 60_000
"""The kernel numbers the places where a process waits, and those of its handlers, with 16 bits."""


@dataclass
class Writer:
    """The step functions of one process class, while they are being written.

    ``routines`` collects them; that of the process itself is the first.
    """

    members: Members
    printer: Printer
    names: PackageNames
    levels: Levels
    struct: str
    routines: list[Routine] = field(default_factory=list)
    initial: list[Statement] = field(default_factory=list)
    """Further statements of the initialization function that the composition needs, in the order of the source text."""
    tables: list[Statement] = field(default_factory=list)
    """Constant tables that step functions refer to."""
    functions: list[tuple[Statement, ...]] = field(default_factory=list)
    """Other functions, to be defined before the step functions."""
    kept: dict[tuple[str, str], tuple[Code, Mapping[str, Code]]] = field(default_factory=dict)
    """Members that keep what follows from parameters, and those for the change that they follow, by the law and the
    equations that compute them.
    """

    current: Routine = field(init=False)
    handler: Handler = field(init=False)
    """Where control goes if the present step fails."""

    def __post_init__(self) -> None:
        process = self.members.process
        assert process.body is not None
        self.states = Names(self.names.globals)
        inside = self.members.inside
        self.alone = not inside.of(ParallelSteps) and not inside.of(InterruptOn)
        self.number = Names((*PROCESS_LOCALS, *self.names.globals)).fresh("number")
        """The local variable for the number of the branch, in step functions that several branches share."""
        self.in_turns = False
        """Whether the present step is in a loop whose turn chooses elements of arrays."""
        self.depth = 0
        """The number of prioritized parallels around the present step."""
        self.inner: str | None = None
        """The path of the flattened process, or of the control law in it, to which the present step belongs."""
        self.scope: str | None = None
        """The path of the flattened process to which the present step belongs."""
        self.observed: list[tuple[str, str]] = []
        """Path and definition of each group and scope so far. For observers, their numbers follow that of the process.
        """
        self._singles: dict[tuple[str, str], str] = {}
        self._laws: dict[tuple[str, tuple[Statement, ...]], str] = {}
        self._sizes: dict[tuple[str, str], str] = {}
        self._slots: dict[tuple[str, str], list[StructMember]] = {}
        self._offers: dict[str, int] = {}
        self._routine("", None, process.body)

    def statements(self, action: Action) -> list[Statement]:
        """An action as statements; control reaches their end only if the action can complete."""
        raise NotImplementedError

    # Step functions

    def _routine(self, title: str, member: str | None, action: Action, count: int | None = None) -> Routine:
        process = self.members.process
        outer = (self.current, self.handler) if self.routines else None
        place = self.names.place(process.span.file, process.span.line)
        routine = Routine(
            name=self.states.fresh(f"{self.struct}_{title}") if title else self.struct,
            title=title,
            struct=self.struct,
            definition=process.definition,
            where=place,
            member=member,
            states=self.states,
            count=count,
            number=None if count is None else self.number,
        )
        self.routines.append(routine)
        self.current, self.handler = routine, routine.outermost
        whole = member is None
        closing = [run(call("csp_ends_close", address(own("samples"))))] if whole and self.members.has_samples else []
        if whole:
            closing.append(run(call("csp_observe_end", "party->number")))
            routine.body.append(run(call("csp_observe_begin", "party->number")))
        routine.body += self.statements(action)
        if can_complete(action):
            routine.body += [*closing, return_value(call("csp_end", "party"))]
        failing = routine.label(routine.outermost, place)
        unwinding = [run(call("csp_unwind", "party")), *closing, return_value(call("csp_fail", "party"))]
        if failing and not routine.outermost.is_entered_by_kernel and routine.body[-1] == goto(routine.outermost.label):
            routine.body.pop()
            routine.runs_into_failure = True
            reached = jumps_to(routine.outermost.label, routine.body)
            routine.body += [*(failing if reached else []), *unwinding]
        elif failing:
            routine.body += [*failing, *unwinding]
        if outer is not None:
            self.current, self.handler = outer
        return routine

    def prefixed(self, name: str) -> str:
        """A name prefixed by the present branch or flattened process, to distinguish it from others in the class."""
        around = self.current.title or (identifier(self.scope) if self.scope else "")
        return f"{around}_{name}" if around and not _begins_with(name, around) else name

    def branch(self, action: Action, hint: str | None = None, count: int | None = None) -> Code:
        """The member for the ``csp_process`` that runs an action in parallel with others; one is added unless the
        action runs a process. ``count`` is the number of branches that run the action, each with a number.
        """
        if isinstance(action, RunInstance) and isinstance(self.class_of(action.instance), ProcessClass):
            return self.members.member(action.instance).field("process")
        wanted = self.prefixed(hint or branch_name(action))
        member = self.members.names.fresh(wanted if wanted == "branch" else f"{wanted} branch")
        count = count or self.current.count
        struct = "csp_process" if count is None else "csp_numbered"
        self.members.work.append(StructMember(f"{struct} {member}{_size(count)}"))
        name = self._routine(identifier(snake_case(wanted)), member, action, count).name
        if count is None:
            self.initial.append(self._process_initialization(own(member), name))
            return code(member)
        element = own(member).at(code(VARIABLE))
        body = (self._process_initialization(element.field("process"), name), store(element.field("number"), VARIABLE))
        self.initial.append(For(code(VARIABLE), unsigned(count), body, unsigned(0), "uint32_t"))
        return code(member).at(Numbered(((self.number, 1),))).field("process")

    def _process_initialization(self, process: Code, class_: str) -> Plain:
        number = own("process").field("party").field("number")
        return run(call("csp_process_init", address(process), f"&{class_}_class", number))

    def class_of(self, instance: str) -> ProcessClass | SubmodelClass:
        """The class of an instance of this process class."""
        return self.members.classes[self.members.instances[instance].class_name]

    # Places

    def where(self, step: Step) -> str:
        """The place of a step, such as ``jiwy.csp:68``."""
        return self.names.place(step.span.file, step.span.line)

    def comment(self, step: Step) -> str:
        """The source text of a step on one line, with its place."""
        text = " ".join(step.span.text.split())
        shown = text if len(text) <= 60 else f"{text[:57]}..."
        return f"{shown}  ({self.where(step)})"

    def failure_label(self) -> str:
        """The label to jump to if the present step fails."""
        self.handler.is_jumped_to = True
        return self.handler.label

    def place(
        self, step: Step, state: str, waiting: Waiting, member: Code | None = None, *, indirect: bool = False
    ) -> str:
        """The name of a new state in which the process waits; a failure there continues at the present handler."""
        if len(self.current.places) == MOST_PLACES:
            raise TargetError(
                f"{step.span}: the process waits at more than {MOST_PLACES} places: C numbers them with 16 bits\n"
                "  help: divide it into several processes"
            )
        self.handler.is_entered_by_kernel = True
        name = self.states.fresh(snake_case(self.prefixed(state)).upper())
        self.current.places.append(
            WaitingState(name, waiting, self.handler, self.where(step), member, indirect, self.inner)
        )
        return name

    def wait(self, first: Code, again: Code, state: str) -> Wait:
        """An operation that may need several attempts: it is continued each time the process runs."""
        return Wait(call("CSP_AWAIT", first, again, state, self.failure_label()))

    @staticmethod
    def call_process(process: Code, state: str) -> list[Statement]:
        """Runs another process in sequence; the process continues in ``state`` when that has ended."""
        ran = return_value(call("csp_call", "party", address(process)))
        return [store("party->state", cast("uint16_t", code(state))), ran, State(state)]

    # Members

    def add_function(self, function: Sequence[Statement]) -> None:
        """Adds a function that step functions call, unless it has been added already."""
        if function and tuple(function) not in self.functions:
            self.functions.append(tuple(function))

    def law_function(self, law: str, body: Sequence[Statement], remark: Remark) -> str:
        """The name of the function for a run of an inlined law; equal runs share one."""
        key = (law, tuple(body))
        if key not in self._laws:
            name = self._laws[key] = self.states.fresh(f"{self.struct}_{identifier(snake_case(law))}_calculate")
            head = f"static void {name}"
            kernel = (KERNEL,) if mentions_kernel(key[1]) else ()
            self.add_function([remark, Function(head, (*kernel, f"struct {self.struct} *self"), key[1])])
        return self._laws[key]

    def add_member(self, name: str, type_: str) -> Code:
        """A new member for the present step function; an array if several branches share it."""
        count = self.current.count
        space = "" if type_.endswith("*") else " "
        self.members.work.append(StructMember(f"{type_}{space}{name}{_size(count)}"))
        return self._branch_member(name)

    def _branch_member(self, member: str) -> Code:
        return code(member) if self.current.count is None else code(member).at(Numbered(((self.number, 1),)))

    def shared_member(self, name: str, type_: str) -> Code:
        """A member that all steps of the present step function share."""
        key = (name, self.current.name)
        if key not in self._singles:
            member = self._singles[key] = self.members.names.fresh(self._routine_member_name(name))
            self.add_member(member, type_)
        return self._branch_member(self._singles[key])

    def _routine_member_name(self, name: str) -> str:
        return f"{self.current.title}_{name}" if self.current.title else name

    def offers(self, count: int) -> str:
        """The member for up to ``count`` concurrent communications of the present step function."""
        member = str(self.shared_member("offers", "csp_offers"))
        self._offers[member] = max(count, self._offers.get(member, 0))
        return member

    def offer_arrays(self) -> dict[str, int]:
        """The number of offers of each member for concurrent communications."""
        return self._offers

    def slot(self, name: str, type_: Type, hint: str = "sent") -> Code:
        """A member that keeps a value while the present step function waits; members with the same ``hint`` share
        their memory.
        """
        key = (hint, self.current.name)
        whole = self._singles.get(key)
        if whole is None:
            whole = self._singles[key] = self.members.names.fresh(self._routine_member_name(hint))
            self._slots[key] = []
            self._sizes[key] = _size(self.current.count)
        wanted, count = Names(self.names.macros).fresh(name), 1
        type_name = self.members.types.type_name(type_)
        while True:
            member = StructMember(f"{type_name} {wanted}")
            other = next((m for m in self._slots[key] if m.declaration.rpartition(" ")[2] == wanted), None)
            if other is None:
                self._slots[key].append(member)
            if other is None or other == member:
                return own(self._branch_member(whole)).field(wanted)
            count += 1
            wanted = f"{identifier(name)}_{count}"

    def unions(self) -> list[tuple[str, Sequence[StructMember]]]:
        """The members that keep values while a step function waits, by the declarator of their union."""
        return [(f"{self._singles[key]}{self._sizes[key]}", members) for key, members in self._slots.items()]

    # Expressions

    def evaluate_into(self, target: Code, expression: Expression, where: str) -> list[Statement]:
        """``target = expression;`` and a check for faults. ``target`` may have changed after a fault."""
        evaluation = self.printer.evaluate(expression)
        stored, fault = store(target, evaluation.code), [self.raise_noted_fault(where)] if evaluation.faults else []
        return in_block(
            [*evaluation.setup, stored, *fault] if evaluation.faults_inside else [*evaluation.setup, *fault, stored]
        )

    def assign(self, lvalue: Code, expression: Expression, where: str) -> list[Statement]:
        """``lvalue = expression;`` for a variable, which keeps its value if the expression faults."""
        evaluation = self.printer.evaluate(expression)
        check = [self.raise_noted_fault(where)] if evaluation.faults else []
        return evaluation.stored(lvalue, self.members.types.type_name(expression.type), check)

    def may_fault(self, expression: Expression) -> bool:
        """Whether the evaluation of an expression can note a fault."""
        return self.printer.faults(expression)

    def mark_written(self, variable: str) -> list[Statement]:
        """The statements after a write to a variable of the class: they set its flag, if it has one."""
        flag = self.members.written(variable)
        return [] if flag is None else [store(flag.field("done"), "true")]

    def raise_noted_fault(self, where: str) -> If:
        """The statement that raises the fault that has been noted, if there is one."""
        if self.inner is None:
            return goto_if(call("csp_raised", "party", quoted(where)), self.failure_label())
        return goto_if(call("csp_raised_in", "party", quoted(self.inner), quoted(where)), self.failure_label())

    def condition(self, expression: Expression, step: Step, *, opposite: bool = False) -> tuple[list[Statement], Code]:
        """The statements that a condition needs before it, and the condition, or its ``opposite``."""
        evaluation = (self.printer.opposite if opposite else self.printer.evaluate)(expression)
        if not evaluation.faults:
            return [], evaluation.code
        span = expression.span or step.span
        fault = self.raise_noted_fault(self.names.place(span.file, span.line))
        if not evaluation.faults_inside and in_block(evaluation.setup) == list(evaluation.setup):
            return [*evaluation.setup, fault], evaluation.code
        return in_block([*evaluation.setup, store("condition", evaluation.code), fault]), code("condition")

    def operand(
        self, expression: Expression, where: str, name: str, hint: str = "computed"
    ) -> tuple[list[Statement], Code]:
        """The statements that a value needs before it, and the value. If it can fault, it is kept in the slot ``name``
        until the next slot with that ``hint`` is used.
        """
        evaluation = self.printer.evaluate(expression)
        if not evaluation.faults:
            return [], evaluation.code
        if not evaluation.faults_inside and in_block(evaluation.setup) == list(evaluation.setup):
            return [*evaluation.setup, self.raise_noted_fault(where)], evaluation.code
        slot = self.slot(name, expression.type, hint)
        return in_block([*evaluation.setup, store(slot, evaluation.code), self.raise_noted_fault(where)]), slot

    def printed(self, expression: Expression) -> Code:
        """A value that cannot fault."""
        return self.printer.plain(expression)

    def new_handler(self, state: str) -> Handler:
        """A new handler for the exceptions of a part of the composition."""
        return self.current.handler(snake_case(self.prefixed(state)).upper())

    def protected(
        self, body: Sequence[Statement], handler: Handler, handling: Sequence[Statement], *, passes: bool, where: str
    ) -> list[Statement]:
        """A body with the statements that handle failures in it; control ``passes`` them if the body can complete."""
        label = self.current.label(handler, where)
        if not label:
            return list(body)
        statements = [*body]
        if statements[-1:] == [goto(handler.label)] and label == [Label(handler.label)]:
            statements.pop()
            if not jumps_to(handler.label, statements):
                label = []
        after = self.states.fresh(f"after_{handler.label}")
        if passes:
            statements.append(goto(after))
        statements += [*label, run(call("csp_unwind", "party")), *handling]
        if passes:
            statements.append(Label(after))
        return statements

    def remark(self, step: Step) -> Remark:
        """The comment above the statements of a step."""
        return Remark(self.comment(step))


def _size(count: int | None) -> str:
    return "" if count is None else f"[{count}]"


def _begins_with(name: str, around: str) -> bool:
    return snake_case(name).startswith(f"{snake_case(around)}_")
