"""Parallel compositions: which processes run as branches, as tables for the kernel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cspdiag.codegen.c.process.members import SELF
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.rows import Row, block
from cspdiag.network.ir.actions import Action, Group, ParallelSteps, RunInstance


@dataclass
class _Run:
    """Branches that stand one behind the other in memory."""

    member: str
    stride: str
    count: int
    level: int


def parallel_rows(writer: Writer, step: ParallelSteps) -> list[Row]:
    """Starts the branches and waits for all of them."""
    runs = _runs(writer, step)
    parallel = writer.single("parallel", "csp_parallel")
    place = writer.place(step, "in_parallel", "PARALLEL", parallel)
    table = writer.states.fresh(f"{writer.struct}_branches")
    entries = [_entry(writer.struct, run) for run in runs]
    body = [Row(f"{entry},") for entry in entries[:-1]] + [Row(entries[-1])]
    writer.tables += [*block(f"static const csp_branches {table}[] =", body, "};"), Row("")]
    count = f"{len(runs)}U"
    first = f"csp_par(party, &{SELF}{parallel}, {table}, {count})"
    return writer.await_rows(step, first, f"csp_par_again(party, &{SELF}{parallel})", place)


def _entry(struct: str, run: _Run) -> str:
    return (
        f"{{.offset = offsetof(struct {struct}, {run.member}), .stride = {run.stride}, .count = {run.count}U, "
        f".level = {run.level}U}}"
    )


def _runs(writer: Writer, step: ParallelSteps) -> list[_Run]:
    runs: list[_Run] = []
    position = 0
    writer.depth += step.prioritized
    while position < len(step.steps):
        count = 1 if step.prioritized else _elements(writer, step.steps, position)
        branch = step.steps[position]
        level = writer.levels.below(writer.members.process.name, writer.depth - 1, position) if step.prioritized else 0
        hint = branch.label if isinstance(branch, Group) else None
        stride = "0U"
        if count > 1 and isinstance(branch, RunInstance):
            class_ = writer.members.instances[branch.instance].class_name
            stride = f"sizeof(struct {writer.names.classes[class_]})"
        runs.append(_Run(writer.branch(branch, hint), stride, count, level))
        position += count
    writer.depth -= step.prioritized
    return runs


def _elements(writer: Writer, steps: Sequence[Action], start: int) -> int:
    """How many steps from ``start`` run the elements of one array, one after the other."""
    first = steps[start]
    if not isinstance(first, RunInstance):
        return 1
    array, index = writer.members.arrays.place(first.instance)
    if index is None:
        return 1
    count = 1
    while start + count < len(steps):
        other = steps[start + count]
        if not isinstance(other, RunInstance) or writer.members.arrays.place(other.instance) != (array, index + count):
            break
        count += 1
    return count
