"""Interrupts: a body that runs as a branch, and a guard that can end it."""

from __future__ import annotations

from cspdiag.codegen.c.process.steps.alternatives import branch_beginning, guard_call, make_guard, prepare
from cspdiag.codegen.c.process.struct.members import StructMember
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.code import address, call, cast, own
from cspdiag.codegen.c.text.names import identifier
from cspdiag.codegen.c.text.statements import Statement, choose, run
from cspdiag.codegen.shared.branches import branch_name
from cspdiag.network.ir.actions import InterruptOn, RunInstance


def interrupt(writer: Writer, step: InterruptOn) -> list[Statement]:
    """Runs the body, followed by the process of the guard if the guard has ended it. If the condition of the guard does
    not hold, the body is called like any process.
    """
    body = writer.branch(step.body)
    name = step.body.instance if isinstance(step.body, RunInstance) else branch_name(step.body)
    member = writer.members.names.fresh(writer.prefixed(f"interrupt_{identifier(name)}"))
    writer.members.work.append(StructMember(f"csp_interrupt {member}"))
    whole = own(member)
    alternative = address(whole.field("alternative"))
    offset = cast("uint32_t", call("offsetof", f"struct {writer.struct}", body))
    writer.initial.append(run(call("csp_interrupt_init", address(whole), offset)))
    guard = make_guard(writer, step.branch, f"{member}_value")
    prepared = [
        run(call("csp_interrupt_prepare", address(whole))),
        run(guard_call(writer, guard, alternative, 0, whole.field("timer"))),
        *prepare(writer, guard, alternative, 0, always=True),
    ]
    place = writer.place(step, f"interruptible_{identifier(name)}", "INTERRUPT", whole.member)
    begun = call("csp_interruptible", "party", address(whole))
    waited = writer.wait(begun, call("csp_interruptible_again", "party", address(whole)), place)
    handler = [*branch_beginning(writer, guard), *writer.statements(step.branch.body)]
    guarded = [*prepared, waited, *choose(whole.field("taken"), handler)]
    if step.branch.condition is None:
        return [writer.remark(step), *guarded]
    setup, holds = writer.condition(step.branch.condition, step.branch)
    called = writer.place(step, f"runs_{identifier(name)}", "CALL", body)
    return [writer.remark(step), *setup, *choose(holds, guarded, writer.call_process(own(body), called))]
