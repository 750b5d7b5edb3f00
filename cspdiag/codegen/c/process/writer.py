"""What the writing of a composition has in common: step functions under construction, their states, and values that
outlive a wait.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from cspdiag.codegen.c.process.flow import ends
from cspdiag.codegen.c.process.levels import Levels
from cspdiag.codegen.c.process.routines import Handler, Routine, Waiting, WaitingState
from cspdiag.codegen.c.process.struct.members import Members, StructMember
from cspdiag.codegen.c.process.struct.port_layout import TAKEN
from cspdiag.codegen.c.text.code import Code, address, call, code, own, unsigned
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.names import Names, PackageNames, identifier, snake_case
from cspdiag.codegen.c.text.numbered import Numbered
from cspdiag.codegen.c.text.rolling import VARIABLE
from cspdiag.codegen.c.text.statements import (
    For,
    Function,
    Label,
    Plain,
    Remark,
    Statement,
    Wait,
    define,
    give,
    go,
    in_block,
    jumps_to,
    run,
    store,
)
from cspdiag.codegen.shared.branch_names import branch_name
from cspdiag.model.types import Type
from cspdiag.network.ir.actions import Action, InterruptOn, ParallelSteps, RunInstance, Step
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import ProcessClass, SubmodelClass


@dataclass
class Writer:
    """The step functions of one process class, while they are written.

    ``routines`` collects them, the process itself first.
    """

    members: Members
    printer: Printer
    names: PackageNames
    levels: Levels
    struct: str
    routines: list[Routine] = field(default_factory=list)
    initial: list[Statement] = field(default_factory=list)
    """What the function that initializes the process has to do for the composition besides, in the order of the text.
    """
    tables: list[Statement] = field(default_factory=list)
    """Constant tables that step functions refer to."""
    functions: list[tuple[Statement, ...]] = field(default_factory=list)
    """Other functions, before the step functions."""

    current: Routine = field(init=False)
    handler: Handler = field(init=False)
    """Where the present step goes if it fails."""

    def __post_init__(self) -> None:
        process = self.members.process
        assert process.body is not None
        self.states = Names(self.names.globals)
        inside = self.members.inside
        self.alone = not inside.of(ParallelSteps) and not inside.of(InterruptOn)
        self.number = Names((*TAKEN, *self.names.globals)).fresh("number")
        """What step functions call the number of their branch, where branches share one."""
        self.depth = 0
        """Of prioritized parallels around the present step."""
        self.inner: str | None = None
        """The path of the flattened process, or of the control law in it, that the present step stems from."""
        self.scope: str | None = None
        """The path of the flattened process alone."""
        self.observed: list[tuple[str, str]] = []
        """Groups and scopes so far, which observers know by the numbers behind that of the process: paths below it and
        definitions.
        """
        self._singles: dict[tuple[str, str], str] = {}
        self._laws: dict[tuple[str, tuple[Statement, ...]], str] = {}
        self._sizes: dict[tuple[str, str], str] = {}
        self._slots: dict[tuple[str, str], list[StructMember]] = {}
        self._offers: dict[str, int] = {}
        self._routine("", None, process.body)

    def statements(self, action: Action) -> list[Statement]:
        """An action as statements; control does not reach their end where it does not reach the end of
        the action.
        """
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
            closing.append(run("csp_observe_end(party->number)"))
            routine.body.append(run("csp_observe_begin(party->number)"))
        routine.body += self.statements(action)
        if ends(action):
            routine.body += [*closing, give("csp_end(party)")]
        failing = routine.label(routine.outermost, place)
        unwinding = [run("csp_unwind(party)"), *closing, give("csp_fail(party)")]
        if failing and not routine.outermost.needed and routine.body[-1] == go(routine.outermost.label):
            routine.body.pop()
            reached = jumps_to(routine.outermost.label, routine.body)
            routine.body += [*(failing if reached else []), *unwinding]
        elif failing:
            routine.body += [*failing, *unwinding]
        if outer is not None:
            self.current, self.handler = outer
        return routine

    def prefixed(self, name: str) -> str:
        """A name in the present branch or flattened process, distinguished from equal ones elsewhere in the class."""
        around = self.current.title or (identifier(self.scope) if self.scope else "")
        return f"{around}_{name}" if around and not _begins_with(name, around) else name

    def branch(self, action: Action, hint: str | None = None, count: int | None = None) -> Code:
        """The member of the ``csp_process`` that runs an action beside others; it is made if the action is no process
        of its own. With a ``count``, that is how many run it, each with a number.
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
            self.initial.append(self._made(own(member), name))
            return code(member)
        element = own(member).at(code(VARIABLE))
        body = (self._made(element.field("process"), name), store(element.field("number"), VARIABLE))
        self.initial.append(For(code(VARIABLE), unsigned(count), body, unsigned(0), "uint32_t"))
        return code(member).at(Numbered(self.number)).field("process")

    def _made(self, process: Code, class_: str) -> Plain:
        number = own("process").field("party").field("number")
        return run(call("csp_process_init", address(process), f"&{class_}_class", number))

    def class_of(self, instance: str) -> ProcessClass | SubmodelClass:
        """The class of an instance inside."""
        return self.members.classes[self.members.instances[instance].class_name]

    # Where things happen

    def where(self, step: Step) -> str:
        """``jiwy.csp:68``."""
        return self.names.place(step.span.file, step.span.line)

    def comment(self, step: Step) -> str:
        """The text of a step on one line, with its place."""
        text = " ".join(step.span.text.split())
        shown = text if len(text) <= 60 else f"{text[:57]}..."
        return f"{shown}  ({self.where(step)})"

    def failing(self) -> str:
        """The label to go to when something fails here."""
        self.handler.reached = True
        return self.handler.label

    def place(
        self, step: Step, state: str, waiting: Waiting, member: Code | None = None, *, indirect: bool = False
    ) -> str:
        """A state in which the process waits, and which fails to the present handler."""
        self.handler.needed = True
        name = self.states.fresh(snake_case(self.prefixed(state)).upper())
        self.current.places.append(
            WaitingState(name, waiting, self.handler, self.where(step), member, indirect, self.inner)
        )
        return name

    def wait(self, first: Code, again: Code, state: str) -> Wait:
        """An operation that the process goes on with each time it runs."""
        self.current.progress = True
        return Wait(call("CSP_AWAIT", first, again, state, self.failing()))

    # Members

    def add_function(self, function: Sequence[Statement]) -> None:
        """A function that step functions call, once however often it is added."""
        if function and tuple(function) not in self.functions:
            self.functions.append(tuple(function))

    def law_function(self, law: str, body: Sequence[Statement], result: str, remark: Remark) -> str:
        """The name of the function for the runs of an inlined law that do the same."""
        key = (law, tuple(body))
        if key not in self._laws:
            name = self._laws[key] = self.states.fresh(f"{self.struct}_{identifier(snake_case(law))}_calculate")
            head = f"static {result} {name}"
            self.add_function([remark, Function(head, (f"struct {self.struct} *self",), key[1])])
        return self._laws[key]

    def add_member(self, name: str, type_: str) -> Code:
        """A new member for the present step function: one for each branch that it is the step function of."""
        count = self.current.count
        self.members.work.append(StructMember(f"{type_} {name}{_size(count)}"))
        return self._of_branch(name)

    def _of_branch(self, member: str) -> Code:
        return code(member) if self.current.count is None else code(member).at(Numbered(self.number))

    def single(self, name: str, type_: str) -> Code:
        """A member that the present step function needs one of, whatever it is doing."""
        key = (name, self.current.name)
        if key not in self._singles:
            member = self._singles[key] = self.members.names.fresh(self._of_routine(name))
            self.add_member(member, type_)
        return self._of_branch(self._singles[key])

    def _of_routine(self, name: str) -> str:
        return f"{self.current.title}_{name}" if self.current.title else name

    def offers(self, count: int) -> str:
        """The member for several communications at once of the present step function; at most ``count``."""
        member = str(self.single("offers", "csp_offers"))
        self._offers[member] = max(count, self._offers.get(member, 0))
        return member

    def offer_arrays(self) -> dict[str, int]:
        """The numbers of offers, by the member of the offers they are for."""
        return self._offers

    def slot(self, name: str, type_: Type, hint: str = "sent") -> Code:
        """A member that keeps a value while the present step function waits; those of one ``hint`` share
        their memory.
        """
        key = (hint, self.current.name)
        whole = self._singles.get(key)
        if whole is None:
            whole = self._singles[key] = self.members.names.fresh(self._of_routine(hint))
            self._slots[key] = []
            self._sizes[key] = _size(self.current.count)
        wanted, count = identifier(name), 1
        type_name = self.members.types.type_name(type_)
        while True:
            member = StructMember(f"{type_name} {wanted}")
            other = next((m for m in self._slots[key] if m.declaration.rpartition(" ")[2] == wanted), None)
            if other is None:
                self._slots[key].append(member)
            if other is None or other == member:
                return own(self._of_branch(whole)).field(wanted)
            count += 1
            wanted = f"{identifier(name)}_{count}"

    def unions(self) -> list[tuple[str, Sequence[StructMember]]]:
        """The values that are kept while a step function waits, by the name of the union, or of an array of them."""
        return [(f"{self._singles[key]}{self._sizes[key]}", members) for key, members in self._slots.items()]

    # Expressions

    def evaluated(self, target: Code, expression: Expression, where: str) -> list[Statement]:
        """``target = expression;``, and what follows if it faults."""
        found = self.printer.evaluate(expression)
        stored, fault = store(target, found.code), [self.fault(where)] if found.faults else []
        return in_block([*found.setup, stored, *fault] if found.late else [*found.setup, *fault, stored])

    def stored(self, lvalue: Code, expression: Expression, where: str) -> list[Statement]:
        """``lvalue = expression;``: one that faults leaves the variable as it was."""
        found = self.printer.evaluate(expression)
        if not found.late:
            fault = [self.fault(where)] if found.faults else []
            return in_block([*found.setup, *fault, store(lvalue, found.code)])
        result = define(f"const {self.members.types.type_name(expression.type)}", "csp_result", found.code)
        return in_block([*found.setup, result, self.fault(where), store(lvalue, "csp_result")])

    def may_fault(self, expression: Expression) -> bool:
        """Whether the evaluation of an expression can note a fault."""
        return self.printer.faults(expression)

    def wrote(self, variable: str) -> list[Statement]:
        """Behind a write to a variable of the class."""
        flag = self.members.written(variable)
        return [] if flag is None else [store(flag.field("done"), "true")]

    def fault(self, where: str) -> Plain:
        """Raises the fault that has been noted, if there is one."""
        if self.inner is None:
            return run(call("CSP_FAULT", quoted(where), self.failing()))
        return run(call("CSP_FAULT_INSIDE", quoted(self.inner), quoted(where), self.failing()))

    def condition(self, expression: Expression, step: Step, *, opposite: bool = False) -> tuple[list[Statement], Code]:
        """What must be done first, and the condition, or its ``opposite``."""
        found = (self.printer.opposite if opposite else self.printer.evaluate)(expression)
        if not found.faults:
            return [], found.code
        span = expression.span or step.span
        fault = self.fault(self.names.place(span.file, span.line))
        if not found.late and in_block(found.setup) == list(found.setup):
            return [*found.setup, fault], found.code
        self.current.condition = True
        return in_block([*found.setup, store("condition", found.code), fault]), code("condition")

    def operand(
        self, expression: Expression, where: str, name: str, hint: str = "computed"
    ) -> tuple[list[Statement], Code]:
        """What must be done first, and the value; a value that can fault is kept in a slot of that name until the next
        of that ``hint``.
        """
        found = self.printer.evaluate(expression)
        if not found.faults:
            return [], found.code
        if not found.late and in_block(found.setup) == list(found.setup):
            return [*found.setup, self.fault(where)], found.code
        slot = self.slot(name, expression.type, hint)
        return in_block([*found.setup, store(slot, found.code), self.fault(where)]), slot

    def printed(self, expression: Expression) -> Code:
        """A value that cannot fault."""
        return self.printer.plain(expression)

    def new_handler(self, state: str) -> Handler:
        """A place for exceptions of an extent to go to."""
        return self.current.handler(snake_case(self.prefixed(state)).upper())

    def protected(
        self, body: Sequence[Statement], handler: Handler, handling: Sequence[Statement], *, passes: bool, where: str
    ) -> list[Statement]:
        """A body, what is done where something in it fails, and, if control ``passes`` the end of the body, what
        follows both.
        """
        label = self.current.label(handler, where)
        if not label:
            return list(body)
        found = [*body]
        past = self.states.fresh(f"after_{handler.label}")
        if passes:
            found.append(go(past))
        found += [*label, run("csp_unwind(party)"), *handling]
        if passes:
            found.append(Label(past))
        return found

    def remark(self, step: Step) -> Remark:
        """The comment above what a step becomes."""
        return Remark(self.comment(step))


def _size(count: int | None) -> str:
    return "" if count is None else f"[{count}]"


def _begins_with(name: str, around: str) -> bool:
    return snake_case(name).startswith(f"{snake_case(around)}_")
