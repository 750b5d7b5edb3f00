"""Compositions as C: control flow, with a state wherever the process can wait."""

from __future__ import annotations

from collections.abc import Sequence
from typing import assert_never

from cspdiag.codegen.c.process.flow import can_complete
from cspdiag.codegen.c.process.steps.alternatives import choice
from cspdiag.codegen.c.process.steps.interrupts import interrupt
from cspdiag.codegen.c.process.steps.laws_in_processes import (
    call_law,
    read_inputs,
    reset,
    reset_law_states,
    run_inlined_law,
    write_outputs,
)
from cspdiag.codegen.c.process.steps.parallels import parallel
from cspdiag.codegen.c.process.steps.plain_steps import assign_value, discard, read_value, stop, wait, write_value
from cspdiag.codegen.c.process.steps.scopes import group, report, scope
from cspdiag.codegen.c.process.steps.turns import Turns, turn_finder
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.code import call, ignored, negated, own, unsigned
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.names import PackageNames
from cspdiag.codegen.c.text.statements import (
    DoWhile,
    For,
    Plain,
    Statement,
    While,
    choose,
    goto,
    has_effect,
    run,
    store,
)
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.network import SubmodelClass

_KERNEL_EXCEPTIONS = {"Fault": "CSP_FAULT_EXCEPTION", "Timeout": "CSP_TIMEOUT_EXCEPTION"}


def exception_number(names: PackageNames, exception: str) -> str:
    """The constant for an exception of the language or of the program."""
    return _KERNEL_EXCEPTIONS.get(exception) or names.exceptions[exception]


class CompositionWriter(Writer):
    """Writes the step functions of one process class."""

    def statements(self, action: ir.Action) -> list[Statement]:
        """An action as statements; control reaches their end only if the action can complete."""
        match action:
            case ir.SkipStep():
                return []
            case ir.SequentialSteps(steps=steps):
                return self._sequence(steps)
            case ir.AssignValue(target=target, value=value):
                return [self.remark(action), *assign_value(self, target, value, self.where(action))]
            case ir.ReadValue():
                return read_value(self, action)
            case ir.WriteValue():
                return write_value(self, action)
            case ir.WaitStep():
                return wait(self, action)
            case ir.StopStep():
                return stop(self, action)
            case ir.RaiseException():
                return self._raise(action)
            case ir.Repeat():
                return self._repeat(action)
            case ir.WhileLoop():
                return self._while(action)
            case Turns():
                return self._turn_by_turn(action)
            case ir.CountedLoop():
                return self._counted_loop(action)
            case ir.IfElse():
                return self._if(action)
            case ir.CatchException():
                return self._catch(action)
            case ir.Group():
                return group(self, action)
            case ir.RunInstance():
                return self._run(action)
            case ir.ParallelSteps():
                return parallel(self, action)
            case ir.Choice():
                return choice(self, action)
            case ir.InterruptOn():
                return interrupt(self, action)
            case ir.ResetInstance():
                return reset(self, action)
            case ir.ReadInputs():
                return read_inputs(self, action)
            case ir.RunLaw():
                return run_inlined_law(self, action)
            case ir.WriteOutputs():
                return write_outputs(self, action)
            case ir.ResetStates():
                return reset_law_states(self, action)
            case ir.ProcessScope():
                return scope(self, action)
            case ir.ReportCommunication():
                return report(self, action)
        assert_never(action)

    def _sequence(self, steps: Sequence[ir.Action]) -> list[Statement]:
        statements: list[Statement] = []
        for step in self._with_turns(steps):
            outer, self.inner = self.inner, _law_of(step) or self.inner
            statements += self.statements(step)
            self.inner = outer
            if not can_complete(step):
                break
        return statements

    def _with_turns(self, steps: Sequence[ir.Action]) -> Sequence[ir.Action]:
        """The steps with loops in place of those that repeat; in branches that share a function they stay as they
        are.
        """
        if self.in_turns or self.current.count is not None:
            return steps
        return turn_finder(self).rolled(steps)

    def _turn_by_turn(self, turns: Turns) -> list[Statement]:
        assert turns.counter is not None
        outer, self.in_turns = self.in_turns, True
        body = tuple(self.statements(turns.body))
        self.in_turns = outer
        begin, end = unsigned(0), unsigned(turns.iterations)
        return [For(turns.counter, end, body, begin, None if turns.waits else "uint32_t")]

    def _raise(self, action: ir.RaiseException) -> list[Statement]:
        number = exception_number(self.names, action.exception)
        raised = run(ignored(call("csp_raise", "party", number, quoted(self.where(action)))))
        inner = [store("csp->error.inner", quoted(self.inner))] if self.inner is not None else []
        return [self.remark(action), raised, *inner, goto(self.failure_label())]

    def _run(self, action: ir.RunInstance) -> list[Statement]:
        class_ = self.class_of(action.instance)
        if isinstance(class_, SubmodelClass):
            return call_law(self, action, class_)
        member = self.members.member(action.instance)
        place = self.place(action, f"runs_{action.instance}", "CALL", member)
        return [self.remark(action), *self.call_process(own(member.field("process")), place)]

    def _repeat(self, action: ir.Repeat) -> list[Statement]:
        body, after = self._body(action)
        if action.until is None:
            return [While(None, tuple(body))]
        if not can_complete(action.body):
            return body
        setup, condition = self.condition(action.until, action, opposite=True)
        if not setup:
            return [DoWhile(tuple(body), condition), *after]
        leaving = choose(negated(condition), [run("break")])
        return [While(None, (*body, *setup, *leaving)), *after]

    def _while(self, action: ir.WhileLoop) -> list[Statement]:
        setup, condition = self.condition(action.condition, action)
        body, after = self._body(action)
        if not setup:
            return [While(condition, tuple(body)), *after]
        return [While(None, (*setup, *choose(negated(condition), [run("break")]), *body)), *after]

    def _body(self, action: ir.Repeat | ir.WhileLoop) -> tuple[list[Statement], list[Statement]]:
        """The body of a loop, and the statements after the loop. A loop in which the process never waits is reported to
        observers, because no state of the process shows it.
        """
        waiting = self._waiting_places()
        body = self.statements(action.body)
        if not body or self._waiting_places() > waiting:
            return body, []
        return [_observed_loop(quoted(self.where(action))), *body], [_observed_loop("NULL")]

    def _waiting_places(self) -> int:
        return sum(place.waiting != "NOTHING" for place in self.current.places)

    def _counted_loop(self, action: ir.CountedLoop) -> list[Statement]:
        body = self.statements(action.body)
        if not body or not can_complete(action.body):
            return body
        turn = self.add_member(self.members.names.fresh("turn"), "uint32_t")
        return [For(own(turn), unsigned(action.iterations), tuple(body), begin=unsigned(0))]

    def _if(self, action: ir.IfElse) -> list[Statement]:
        then, otherwise = self.statements(action.then), self.statements(action.otherwise)
        if not has_effect(then) and not has_effect(otherwise):
            return [*discard(self, action.condition, self.where(action)), *then, *otherwise]
        setup, condition = self.condition(action.condition, action)
        return [*setup, *choose(condition, then, otherwise)]

    def _catch(self, action: ir.CatchException) -> list[Statement]:
        outer = self.handler
        inner = self.handler = self.new_handler(f"CATCHES_{action.exception}".upper())
        body = self.statements(action.body)
        self.handler = outer
        if not (inner.is_jumped_to or inner.is_entered_by_kernel):
            return body
        caught = call("csp_catch", exception_number(self.names, action.exception))
        missed = choose(negated(caught), [goto(self.failure_label())])
        handling = [*missed, *self.statements(action.handler)]
        return self.protected(body, inner, handling, passes=can_complete(action.body), where=self.where(action))


def _observed_loop(where: str) -> Plain:
    return run(call("csp_observe_loop", where))


def _law_of(step: ir.Action) -> str | None:
    """The inlined law whose inputs a step reads or whose outputs it writes, also where nothing is left to compute."""
    match step:
        case ir.ReadInputs(law=law) | ir.WriteOutputs(law=law):
            return law
        case _:  # Only these two steps are separate from their law.
            return None
