"""Interrupts: a body that runs as a branch, beside a guard that can end it."""

from __future__ import annotations

from cspdiag.codegen.c.process.alternatives import guard_call, make_guard, prepare_rows, taken_rows
from cspdiag.codegen.c.process.members import SELF
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.rows import Row, block
from cspdiag.network.ir.actions import InterruptOn


def interrupt_rows(writer: Writer, step: InterruptOn) -> list[Row]:
    """Runs the body; the guard's process follows if the guard has ended it. Without the guard, whose condition does not hold, it is just called."""
    body = writer.branch(step.body)
    interrupt = writer.single(f"interrupt_{body.partition('.')[0]}", "csp_interrupt")
    alternative = f"&{SELF}{interrupt}.alternative"
    offset = f"(uint32_t)offsetof(struct {writer.struct}, {body})"
    writer.initial.append(Row(f"csp_interrupt_init(&{SELF}{interrupt}, {offset});"))
    guard = make_guard(writer, step.branch, f"{interrupt}_value")
    prepared = [
        Row(f"csp_interrupt_prepare(&{SELF}{interrupt});"),
        Row(guard_call(writer, guard, alternative, 0, f"{SELF}{interrupt}.timer")),
        *prepare_rows(writer, guard, alternative, 0, always=True),
    ]
    place = writer.place(step, f"interruptible_{body.partition('.')[0]}", "INTERRUPT", interrupt)
    again = f"csp_interruptible_again(party, &{SELF}{interrupt})"
    waited = writer.await_rows(step, f"csp_interruptible(party, &{SELF}{interrupt})", again, place)
    handler = [*taken_rows(writer, guard), *writer.rows(step.branch.body)]
    opening = Row("", comment=writer.comment(step))
    whole = [*prepared, Row(waited[0].text), *waited[1:], *block(f"if ({SELF}{interrupt}.taken)", handler)]
    if step.branch.condition is None:
        return [opening, *whole]
    setup, holds = writer.condition(step.branch.condition, step.branch)
    called = writer.place(step, f"runs_{body.partition('.')[0]}", "CALL", body)
    plain = [Row(f"CSP_CALL(&{SELF}{body}, {called})")]
    return [opening, *setup, *block(f"if ({holds})", whole)[:-1], *block("} else", plain)]
