"""Names for values that an expression uses more than once."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from cspdiag.codegen.python.text.names import Names
from cspdiag.model.types import RealType, Type


@dataclass
class Temporaries:
    """Names of local variables, separate for reals and others, which are reused for each whole expression."""

    names: Names
    """The names of the function that contains the expressions."""
    _made: dict[str, list[str]] = field(default_factory=dict)
    _used: dict[str, int] = field(default_factory=dict)
    _depth: int = 0

    @contextmanager
    def whole_expression(self) -> Iterator[None]:
        """Within the outermost of these contexts every name is given only once."""
        if self._depth == 0:
            self._used.clear()
        self._depth += 1
        try:
            yield
        finally:
            self._depth -= 1

    def fresh(self, type_: Type) -> str:
        """A name that is not used otherwise in the present expression: ``x1``, ``x2`` for reals, ``n1`` for others."""
        kind = "x" if isinstance(type_, RealType) else "n"
        used = self._used.get(kind, 0)
        self._used[kind] = used + 1
        made = self._made.setdefault(kind, [])
        if used == len(made):
            made.append(self.names.fresh(f"{kind}{used + 1}"))
        return made[used]
