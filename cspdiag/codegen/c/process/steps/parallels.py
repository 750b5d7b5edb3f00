"""Parallel compositions: which processes run as branches, as tables for the kernel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cspdiag.codegen.c.process.steps.replicas import Replicas, replicas
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.code import Aggregate, Code, address, call, own, unsigned
from cspdiag.codegen.c.text.numbered import at_first, stride
from cspdiag.codegen.c.text.statements import Blank, Statement, store
from cspdiag.network.elaborate.fewer.rows import rows_from
from cspdiag.network.ir.actions import Action, Group, ParallelSteps, RunInstance
from cspdiag.network.ir.network import ProcessClass


@dataclass
class _Run:
    """Branches at equal distances in memory."""

    member: Code
    stride: Code
    count: int
    level: int
    is_numbered: bool = False
    """Whether they share a class and have numbers."""


def parallel(writer: Writer, step: ParallelSteps) -> list[Statement]:
    """Starts the branches and waits for all of them."""
    runs = _runs(writer, step)
    member = writer.shared_member("parallel", "csp_parallel")
    place = writer.place(step, "in_parallel", "PARALLEL", member)
    table = writer.states.fresh(f"{writer.struct}_{writer.prefixed('branches')}")
    entries = tuple((None, _entry(writer.struct, run)) for run in runs)
    writer.tables += [store(f"static const csp_branches {table}[]", Aggregate(entries)), Blank()]
    begun = call("csp_par", "party", address(own(member)), table, unsigned(len(runs)))
    return [writer.remark(step), writer.wait(begun, call("csp_par_again", "party", address(own(member))), place)]


def _entry(struct: str, run: _Run) -> Aggregate:
    offset = call("offsetof", f"struct {struct}", at_first(run.member))
    count, level = unsigned(run.count), unsigned(run.level)
    found = [(".offset", offset), (".stride", run.stride), (".count", count), (".level", level)]
    between = None if run.is_numbered else stride(struct, run.member)
    if between is not None:
        found.append((".parent_stride", between))
    return Aggregate(tuple(found))


def _runs(writer: Writer, step: ParallelSteps) -> list[_Run]:
    runs: list[_Run] = []
    position = 0
    writer.depth += step.prioritized
    while position < len(step.steps):
        branch = step.steps[position]
        count = _elements(writer, step.steps, position) if not step.prioritized and _is_process(writer, branch) else 1
        alike = _replicas(writer, step, position)
        if alike is not None:
            member = writer.branch(alike.body, _name_of_replicated(writer, branch), alike.count)
            runs.append(_Run(member, call("sizeof", "csp_numbered"), alike.count, 0, is_numbered=True))
            position += alike.count
            continue
        level = writer.levels.below(writer.members.process.name, writer.depth - 1, position) if step.prioritized else 0
        hint = branch.label if isinstance(branch, Group) else _name_of_replicated(writer, branch)
        stride: Code = unsigned(0)
        if count > 1 and isinstance(branch, RunInstance):
            class_ = writer.members.instances[branch.instance].class_name
            stride = call("sizeof", f"struct {writer.names.classes[class_]}")
        runs.append(_Run(writer.branch(branch, hint), stride, count, level))
        position += count
    writer.depth -= step.prioritized
    return runs


def _replicas(writer: Writer, step: ParallelSteps, position: int) -> Replicas | None:
    """Branches that can share a step function; None within a step function that is shared already."""
    if step.prioritized or writer.current.count is not None:
        return None
    return replicas(writer.members, step.steps, position, writer.number)


def _name_of_replicated(writer: Writer, branch: Action) -> str | None:
    """``par_cell`` of ``par i < n : cell[i]``."""
    if not isinstance(branch, ParallelSteps) or _elements(writer, branch.steps, 0) < len(branch.steps):
        return None
    first = branch.steps[0]
    return f"par_{writer.members.arrays.base(first.instance)}" if isinstance(first, RunInstance) else None


def _is_process(writer: Writer, branch: Action) -> bool:
    """Whether the branch is an instance of a process, which has a task of its own in its struct; a law has none."""
    return isinstance(branch, RunInstance) and isinstance(writer.class_of(branch.instance), ProcessClass)


def _elements(writer: Writer, steps: Sequence[Action], start: int) -> int:
    """The number of steps from ``start`` that run consecutive elements of one array."""
    first = steps[start]
    if not isinstance(first, RunInstance):
        return 1
    array, index = writer.members.arrays.place(first.instance)
    if index is None:
        return 1
    count = 1
    known = rows_from(steps, start)
    if known > 1:
        last = steps[start + known - 1]
        if isinstance(last, RunInstance) and writer.members.arrays.place(last.instance) == (array, index + known - 1):
            count = known
    while start + count < len(steps):
        other = steps[start + count]
        if not isinstance(other, RunInstance) or writer.members.arrays.place(other.instance) != (array, index + count):
            break
        count += 1
    return count
