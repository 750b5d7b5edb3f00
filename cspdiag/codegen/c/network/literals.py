"""Constants of environments with literal values: C compilers know them, because they are not members of the struct."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from cspdiag.base.record import record, replaced
from cspdiag.codegen.c.text.code import Atom
from cspdiag.codegen.c.text.statements import Statement, define
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.codegen.shared.trees import nodes
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expressions import LiteralValue, SignalValue
from cspdiag.network.ir.network import SubmodelClass


@record
class WithLiterals:
    """``system`` without the constants that have literal values. In their places are ``literals`` of their names."""

    system: SubmodelClass
    literals: Mapping[str, LiteralValue]

    def definitions(self, parts: Sequence[Statement], c_names: Mapping[str, str], types: CTypes) -> list[Statement]:
        """The definitions of those that these parts of the file use."""
        used = {node.text for node in nodes(parts) if isinstance(node, Atom)}
        definitions: list[Statement] = []
        for name, literal in self.literals.items():
            if c_names[name] in used:
                type_name = f"static const {types.type_name(literal.type)}"
                place = types.names.place(literal.span.file, literal.span.line) if literal.span else None
                definitions.append(define(type_name, c_names[name], types.initial(literal.value, literal.type), place))
        return definitions


def with_literals(system: SubmodelClass) -> WithLiterals:
    """The system with a named literal in each place of a constant with a literal value."""
    literals = {
        item.name: replaced(item.value, name=item.name, type=item.type, span=item.span)
        for item in system.constants
        if isinstance(item.value, LiteralValue)
    }

    def change(part: Any) -> Any:
        found = literals.get(part.name) if isinstance(part, SignalValue) else None
        return part if found is None else replaced(found, span=part.span)

    constants = tuple(item for item in system.constants if item.name not in literals)
    return WithLiterals(rewritten(replaced(system, constants=constants), change), literals)
