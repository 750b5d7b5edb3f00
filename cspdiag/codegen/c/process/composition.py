"""Compositions as C: control flow with a state wherever the process can wait."""

from __future__ import annotations

from collections.abc import Sequence
from typing import assert_never

from cspdiag.codegen.c.process.alternatives import choice_rows
from cspdiag.codegen.c.process.flow import ends
from cspdiag.codegen.c.process.interrupts import interrupt_rows
from cspdiag.codegen.c.process.laws_in_processes import (
    law_rows,
    read_inputs_rows,
    reset_rows,
    reset_states_rows,
    run_law_rows,
    write_outputs_rows,
)
from cspdiag.codegen.c.process.members import SELF, Member
from cspdiag.codegen.c.process.parallels import parallel_rows
from cspdiag.codegen.c.process.plain_steps import assign_rows, read_rows, stop_rows, wait_rows, write_rows
from cspdiag.codegen.c.process.scopes import group_rows, report_rows, scope_rows
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.names import PackageNames
from cspdiag.codegen.c.text.rows import Row, block, rows
from cspdiag.network.ir.actions import (
    Action,
    AssignValue,
    CatchException,
    Choice,
    CountedLoop,
    Group,
    IfElse,
    InterruptOn,
    ParallelSteps,
    ProcessScope,
    RaiseException,
    ReadInputs,
    ReadValue,
    Repeat,
    ReportCommunication,
    ResetInstance,
    ResetStates,
    RunInstance,
    RunLaw,
    SequentialSteps,
    SkipStep,
    StopStep,
    WaitStep,
    WhileLoop,
    WriteOutputs,
    WriteValue,
)
from cspdiag.network.ir.network import SubmodelClass

_OF_THE_KERNEL = {"Fault": "CSP_FAULT_EXCEPTION", "Timeout": "CSP_TIMEOUT_EXCEPTION"}


def exception_number(names: PackageNames, exception: str) -> str:
    """The constant for an exception of the language or of the program."""
    return _OF_THE_KERNEL.get(exception) or names.exceptions[exception]


class Composition(Writer):
    """Writes the step functions of one process class."""

    def rows(self, action: Action) -> list[Row]:
        """An action as statements; control does not come to their end where it does not come to the end of the action."""
        match action:
            case SkipStep():
                return []
            case SequentialSteps(steps=steps):
                return self._sequence(steps)
            case AssignValue(target=target, value=value):
                assigned = assign_rows(self, target, value, self.where(action))
                return [Row("", comment=self.comment(action)), *assigned]
            case ReadValue():
                return read_rows(self, action)
            case WriteValue():
                return write_rows(self, action)
            case WaitStep():
                return wait_rows(self, action)
            case StopStep():
                return stop_rows(self, action)
            case RaiseException():
                return self._raise(action)
            case Repeat():
                return self._repeat(action)
            case WhileLoop():
                return self._while(action)
            case CountedLoop():
                return self._turns(action)
            case IfElse():
                return self._if(action)
            case CatchException():
                return self._catch(action)
            case Group():
                return group_rows(self, action)
            case RunInstance():
                return self._run(action)
            case ParallelSteps():
                return parallel_rows(self, action)
            case Choice():
                return choice_rows(self, action)
            case InterruptOn():
                return interrupt_rows(self, action)
            case ResetInstance():
                return reset_rows(self, action)
            case ReadInputs():
                return read_inputs_rows(self, action)
            case RunLaw():
                return run_law_rows(self, action)
            case WriteOutputs():
                return write_outputs_rows(self, action)
            case ResetStates():
                return reset_states_rows(self, action)
            case ProcessScope():
                return scope_rows(self, action)
            case ReportCommunication():
                return report_rows(self, action)
        assert_never(action)

    def _sequence(self, steps: Sequence[Action]) -> list[Row]:
        found: list[Row] = []
        for position, step in enumerate(steps):
            outer, self.inner = self.inner, _law_of(steps, position) or self.inner
            found += self.rows(step)
            self.inner = outer
            if not ends(step):
                break
        return found

    def _raise(self, action: RaiseException) -> list[Row]:
        number = exception_number(self.names, action.exception)
        raised = f"(void)csp_raise(party, {number}, {quoted(self.where(action))});"
        inner = rows(f"csp.error.inner = {quoted(self.inner)};") if self.inner is not None else []
        return [Row(raised, comment=self.comment(action)), *inner, Row(f"goto {self.failing()};")]

    def _run(self, action: RunInstance) -> list[Row]:
        class_ = self.class_of(action.instance)
        if isinstance(class_, SubmodelClass):
            return law_rows(self, action, class_)
        member = self.members.member(action.instance)
        place = self.place(action, f"runs_{action.instance}", "CALL", member)
        return [Row(f"CSP_CALL(&{SELF}{member}.process, {place})", comment=self.comment(action))]

    def _repeat(self, action: Repeat) -> list[Row]:
        body, behind = self._body(action)
        if action.until is None:
            return block("for (;;)", body)
        if not ends(action.body):
            return body
        setup, condition = self.condition(action.until, action)
        if not setup:
            return [*block("do", body, f"}} while (!({condition}));"), *behind]
        return [*block("for (;;)", [*body, *setup, *block(f"if ({condition})", rows("break;"))]), *behind]

    def _while(self, action: WhileLoop) -> list[Row]:
        setup, condition = self.condition(action.condition, action)
        body, behind = self._body(action)
        if not setup:
            return [*block(f"while ({condition})", body), *behind]
        return [*block("for (;;)", [*setup, *block(f"if (!{condition})", rows("break;")), *body]), *behind]

    def _body(self, action: Repeat | WhileLoop) -> tuple[list[Row], list[Row]]:
        """The body of a loop and what follows the loop: one in which the process cannot wait is told of, as no state of the process tells of it."""
        waiting = self._waiting_places()
        body = self.rows(action.body)
        if not body or self._waiting_places() > waiting:
            return body, []
        return [*rows(f"csp_observe_loop({quoted(self.where(action))});"), *body], rows("csp_observe_loop(NULL);")

    def _waiting_places(self) -> int:
        return sum(place.waiting != "NOTHING" for place in self.current.places)

    def _turns(self, action: CountedLoop) -> list[Row]:
        body = self.rows(action.body)
        if not body or not ends(action.body):
            return body
        turn = self.members.names.fresh("turn")
        self.members.work.append(Member(f"uint32_t {turn}"))
        turn = f"{SELF}{turn}"
        return block(f"for ({turn} = 0U; {turn} < {action.turns}U; {turn}++)", body)

    def _if(self, action: IfElse) -> list[Row]:
        setup, condition = self.condition(action.condition, action)
        then, otherwise = self.rows(action.then), self.rows(action.otherwise)
        if not otherwise:
            return [*setup, *block(f"if ({condition})", then)]
        if not then:
            return [*setup, *block(f"if (!({condition}))", otherwise)]
        chained = isinstance(action.otherwise, IfElse) and otherwise[0].text.startswith("if (")
        if chained:
            first, *rest = otherwise
            return [
                *setup,
                *block(f"if ({condition})", then)[:-1],
                Row(f"}} else {first.text}", 0, first.comment),
                *rest,
            ]
        return [*setup, *block(f"if ({condition})", then)[:-1], *block("} else", otherwise)]

    def _catch(self, action: CatchException) -> list[Row]:
        outer = self.handler
        inner = self.handler = self.new_handler(f"CATCHES_{action.exception}".upper())
        body = self.rows(action.body)
        self.handler = outer
        if not (inner.reached or inner.needed):
            return body
        missed = block(
            f"if (!csp_catch({exception_number(self.names, action.exception)}))", rows(f"goto {self.failing()};")
        )
        handling = [*missed, *self.rows(action.handler)]
        return self.protected(body, inner, handling, passes=ends(action.body), where=self.where(action))


def _law_of(steps: Sequence[Action], position: int) -> str | None:
    """The inlined law that a step reads the inputs or writes the outputs of."""
    match steps[position]:
        case ReadInputs():
            around: Sequence[Action] = steps[position:]
        case WriteOutputs():
            around = steps[position::-1]
        case _:
            return None
    return next((step.law for step in around if isinstance(step, RunLaw)), None)
