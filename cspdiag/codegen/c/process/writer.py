"""What the writing of a composition has in common: step functions under construction, their states, and values that outlive a wait."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from cspdiag.codegen.c.process.flow import ends
from cspdiag.codegen.c.process.levels import Levels
from cspdiag.codegen.c.process.members import SELF, Member, Members
from cspdiag.codegen.c.process.routines import Handler, Place, Routine, Waiting
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.names import Names, PackageNames, identifier, snake_case
from cspdiag.codegen.c.text.rows import Row, block, rows
from cspdiag.codegen.shared.branch_names import branch_name
from cspdiag.model.types import Type
from cspdiag.network.ir.actions import Action, InterruptOn, ParallelSteps, RunInstance, Step
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.network import ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import parts


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
    initial: list[Row] = field(default_factory=list)
    """What the function that initializes the process has to do for the composition besides, in the order of the text."""
    tables: list[Row] = field(default_factory=list)
    """Constant tables that step functions refer to."""
    functions: list[list[str]] = field(default_factory=list)
    """Other functions, before the step functions, each with an empty line behind it."""

    current: Routine = field(init=False)
    handler: Handler = field(init=False)
    """Where the present step goes if it fails."""

    def __post_init__(self) -> None:
        process = self.members.process
        assert process.body is not None
        self.states = Names(self.names.globals)
        self.alone = not any(isinstance(part, ParallelSteps | InterruptOn) for part in parts(process.body))
        self.depth = 0
        """Of prioritized parallels around the present step."""
        self.inner: str | None = None
        """The path of the flattened process that the present step stems from."""
        self.observed: list[tuple[str, str]] = []
        """Groups and scopes so far, which observers know by the numbers behind that of the process: paths below it and definitions."""
        self._singles: dict[tuple[str, str], str] = {}
        self._slots: dict[tuple[str, str], list[Member]] = {}
        self._offers: dict[str, int] = {}
        self._routine(self.struct, None, process.body)

    def rows(self, action: Action) -> list[Row]:
        """An action as statements; control does not come to their end where it does not come to the end of the action."""
        raise NotImplementedError

    # Step functions

    def _routine(self, name: str, member: str | None, action: Action) -> None:
        process = self.members.process
        outer = (self.current, self.handler) if self.routines else None
        place = self.names.place(process.span.file, process.span.line)
        routine = Routine(
            name=name,
            struct=self.struct,
            definition=process.definition,
            where=place,
            member=member,
            states=self.states,
        )
        self.routines.append(routine)
        self.current, self.handler = routine, routine.outermost
        whole = member is None
        closing = rows(f"csp_ends_close(&{SELF}samples);") if whole and self.members.has_samples else []
        if whole:
            closing += rows("csp_observe_end(party->number);")
            routine.body += rows("csp_observe_begin(party->number);")
        routine.body += self.rows(action)
        if ends(action):
            routine.body += [*closing, Row("return csp_end(party);")]
        failing = routine.label(routine.outermost, place)
        unwinding = [Row("csp_unwind(party);"), *closing, Row("return csp_fail(party);")]
        if failing and not routine.outermost.needed and routine.body[-1].text == f"goto {routine.outermost.label};":
            routine.body.pop()
            reached = re.compile(rf"\b{routine.outermost.label}\b")
            failing = failing if any(reached.search(row.text) for row in routine.body) else []
            routine.body += [*failing, *unwinding]
        elif failing:
            routine.body += [*failing, *unwinding]
        if outer is not None:
            self.current, self.handler = outer

    def branch(self, action: Action, hint: str | None = None) -> str:
        """The member of the ``csp_process`` that runs an action beside others; it is made if the action is no process of its own."""
        if isinstance(action, RunInstance) and isinstance(self.class_of(action.instance), ProcessClass):
            return f"{self.members.member(action.instance)}.process"
        wanted = hint or branch_name(action)
        member = self.members.names.fresh(wanted if wanted == "branch" else f"{wanted} branch")
        self.members.work.append(Member(f"csp_process {member}"))
        name = self.states.fresh(f"{self.struct}_{identifier(snake_case(wanted))}")
        self._routine(name, member, action)
        self.initial += rows(f"csp_process_init(&{SELF}{member}, &{name}_class, {SELF}process.party.number);")
        return member

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
        self, step: Step, state: str, waiting: Waiting, member: str | None = None, *, indirect: bool = False
    ) -> str:
        """A state in which the process waits, and which fails to the present handler."""
        self.handler.needed = True
        name = self.states.fresh(snake_case(state).upper())
        self.current.places.append(Place(name, waiting, self.handler, self.where(step), member, indirect, self.inner))
        return name

    def await_rows(self, step: Step, first: str, again: str, state: str) -> list[Row]:
        """An operation that the process goes on with each time it runs."""
        self.current.progress = True
        return [Row(f"CSP_AWAIT({first}, {again}, {state}, {self.failing()})", comment=self.comment(step))]

    # Members

    def add_function(self, lines: Sequence[str]) -> None:
        """A function that step functions call, once however often it is added."""
        if lines and [*lines, ""] not in self.functions:
            self.functions.append([*lines, ""])

    def single(self, name: str, type_: str) -> str:
        """A member that the present step function needs one of, whatever it is doing."""
        key = (name, self.current.name)
        if key not in self._singles:
            member = self._singles[key] = self.members.names.fresh(name)
            self.members.work.append(Member(f"{type_} {member}"))
        return self._singles[key]

    def offers(self, count: int) -> str:
        """The member for several communications at once of the present step function; at most ``count``."""
        member = self.single("offers", "csp_offers")
        self._offers[member] = max(count, self._offers.get(member, 0))
        return member

    def offer_arrays(self) -> dict[str, int]:
        """The numbers of offers, by the member of the offers they are for."""
        return self._offers

    def slot(self, name: str, type_: Type, hint: str = "sent") -> str:
        """A member that keeps a value while the present step function waits; those of one ``hint`` share their memory."""
        key = (hint, self.current.name)
        whole = self._singles.get(key)
        if whole is None:
            whole = self._singles[key] = self.members.names.fresh(hint)
            self._slots[key] = []
        wanted, count = identifier(name), 1
        type_name = self.members.types.type_name(type_)
        while True:
            member = Member(f"{type_name} {wanted}")
            other = next((m for m in self._slots[key] if m.declaration.rpartition(" ")[2] == wanted), None)
            if other is None:
                self._slots[key].append(member)
            if other is None or other == member:
                return f"{SELF}{whole}.{wanted}"
            count += 1
            wanted = f"{identifier(name)}_{count}"

    def unions(self) -> list[tuple[str, Sequence[Member]]]:
        """The values that are kept while a step function waits, by the name of the union."""
        return [(self._singles[key], members) for key, members in self._slots.items()]

    # Expressions

    def evaluated(self, before: str, expression: Expression, after: str, where: str) -> list[Row]:
        """``before expression after``, and what follows if it faults."""
        text = f"{before}{self.printer.print(expression)}{after}"
        temporaries = self.printer.take_temporaries()
        found = rows(text)
        if self.may_fault(expression):
            found.append(self.fault(where))
        return block("", [*rows(*temporaries), *found]) if temporaries else found

    def stored(self, lvalue: str, expression: Expression, where: str) -> list[Row]:
        """``lvalue = expression;``: one that faults leaves the variable as it was."""
        if not self.may_fault(expression):
            return self.evaluated(f"{lvalue} = ", expression, ";", where)
        kind = self.members.types.type_name(expression.type)
        text = f"const {kind} csp_result = {self.printer.print(expression)};"
        temporaries = self.printer.take_temporaries()
        return block("", [*rows(*temporaries, text), self.fault(where), *rows(f"{lvalue} = csp_result;")])

    def may_fault(self, expression: Expression) -> bool:
        """Whether the evaluation of an expression can note a fault."""
        return may_fault(expression) or not self.members.is_sure(expression)

    def wrote(self, variable: str) -> list[Row]:
        """Behind a write to a variable of the class."""
        flag = self.members.written(variable)
        return [] if flag is None else rows(f"{SELF}{flag}.done = true;")

    def fault(self, where: str) -> Row:
        """Raises the fault that has been noted, if there is one."""
        inside = "" if self.inner is None else f"_INSIDE({quoted(self.inner)}, "
        return Row(f"CSP_FAULT{inside or '('}{quoted(where)}, {self.failing()});")

    def condition(self, expression: Expression, step: Step) -> tuple[list[Row], str]:
        """What must be done first, and the condition."""
        code = str(self.printer.print(expression))
        temporaries = self.printer.take_temporaries()
        if not temporaries and not self.may_fault(expression):
            return [], code
        self.current.condition = True
        span = expression.span or step.span
        where = self.names.place(span.file, span.line)
        return self.evaluated("condition = ", expression, ";", where), "condition"

    def operand(self, expression: Expression, where: str, name: str, hint: str = "computed") -> tuple[list[Row], str]:
        """What must be done first, and the value; a value that can fault is kept in a slot of that name until the next of that ``hint``."""
        code = str(self.printer.print(expression))
        temporaries = self.printer.take_temporaries()
        if not temporaries and not self.may_fault(expression):
            return [], code
        slot = self.slot(name, expression.type, hint)
        return self.evaluated(f"{slot} = ", expression, ";", where), slot

    def new_handler(self, state: str) -> Handler:
        """A place for exceptions of an extent to go to."""
        return self.current.handler(state)

    def protected(
        self, body: Sequence[Row], handler: Handler, handling: Sequence[Row], *, passes: bool, where: str
    ) -> list[Row]:
        """A body, what is done where something in it fails, and, if control ``passes`` the end of the body, what follows both."""
        label = self.current.label(handler, where)
        if not label:
            return list(body)
        found = [*body]
        past = self.states.fresh(f"after_{handler.label}")
        if passes:
            found.append(Row(f"goto {past};"))
        found += [*label, Row("csp_unwind(party);"), *handling]
        if passes:
            found.append(Row(f"{past}:;", -1))
        return found
