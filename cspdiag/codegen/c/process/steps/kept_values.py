"""What an inlined law computes from parameters of the program alone: kept, and computed again after a change of one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from cspdiag.base.record import record
from cspdiag.codegen.c.laws.equations import EquationWriter, LocalVariable, Target
from cspdiag.codegen.c.process.struct.members import StructMember
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.code import CHANGES, EQUALITY, Code, code, ignored, infix, own
from cspdiag.codegen.c.text.statements import Remark, Statement, choose, run, store
from cspdiag.codegen.shared.laws.following import following_apart, is_looked_up
from cspdiag.model.types import Type
from cspdiag.network.ir.actions import RunLaw
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.expressions import SignalValue
from cspdiag.network.ir.walk import parts


@record
class KeptValues:
    """``equations`` compute what follows from parameters; ``law``, the rest of the law, reads ``members``."""

    law: RunLaw
    looked_up: tuple[SubmodelEquation, ...]
    """Parameters under the names that they have in the law."""
    equations: tuple[SubmodelEquation, ...]
    members: Mapping[str, Code]
    """The lvalues of signals that are kept."""
    changes: Code
    """Which change of parameters the members follow."""

    @property
    def types(self) -> dict[str, Type]:
        """Of the signals that ``law`` reads instead of computing them."""
        return {item.name: item.type for item in (*self.looked_up, *self.equations)}

    def statements(self, writer: EquationWriter, target: Callable[[str], Target]) -> list[Statement]:
        """The statements that compute again what has to be; ``target`` is for the signals that are not kept."""

        def lvalue(name: str) -> Target:
            return self.members[name] if name in self.members else target(name)

        def unread(equations: Sequence[SubmodelEquation]) -> list[Statement]:
            targets = (lvalue(item.name) for item in equations if item.name not in self._read)
            return [run(ignored(code(found.name))) for found in targets if isinstance(found, LocalVariable)]

        return [
            *writer.equations(self.looked_up, target),
            *unread(self.looked_up),
            Remark("What follows from parameters, again after a change of one."),
            *choose(
                infix("!=", EQUALITY, self.changes, CHANGES),
                [
                    *writer.equations(self.equations, lvalue),
                    *unread(self.equations),
                    store(self.changes, CHANGES),
                ],
            ),
        ]

    @property
    def _read(self) -> set[str]:
        """The signals that are read at all; others are computed because that can fault."""
        values = (item.value for item in (*self.looked_up, *self.equations))
        return {part.name for item in (self.law, *values) for part in parts(item) if isinstance(part, SignalValue)}


def kept_values(writer: Writer, step: RunLaw) -> KeptValues | None:
    """What a run of a law keeps; None if nothing is worth it. Equal runs of a law keep the same."""
    members = writer.members
    if writer.current.count is not None:  # Several branches share the members.
        return None
    constants = frozenset(item.name for item in members.process.constants)
    found = following_apart(step, constants, lambda value: not is_looked_up(value))
    looked_up = tuple(item for item in found.equations if is_looked_up(item.value))
    equations = (*(item for item in found.equations if not is_looked_up(item.value)), *found.terms)
    if not equations:
        return None
    key = (step.law, repr(equations))
    known = writer.kept.get(key)
    if known is None:
        read = {part.name for part in parts(found.law) if isinstance(part, SignalValue)}
        changes = members.names.fresh(f"{step.law} changes")
        members.work.append(StructMember(f"uint32_t {changes}", "of parameters, which these values follow:"))
        known = writer.kept[key] = (
            own(changes),
            {item.name: _member(writer, item) for item in equations if item.name in read or _is_member(writer, item)},
        )
    return KeptValues(found.law, looked_up, equations, known[1], known[0])


def _is_member(writer: Writer, item: SubmodelEquation) -> bool:
    """Whether a signal is a member anyway, because it is used outside the run."""
    return item.name in writer.members.signal_members


def _member(writer: Writer, item: SubmodelEquation) -> Code:
    members = writer.members
    if _is_member(writer, item):
        return members.signal(item.name)
    name, _, number = item.name.rpartition(" ")
    member = members.names.fresh(name if number.isdigit() else item.name)
    members.work.append(StructMember(f"{members.types.type_name(item.type)} {member}"))
    return own(member)
