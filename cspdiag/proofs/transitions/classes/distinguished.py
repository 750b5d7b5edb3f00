"""How closely the values at the ports of the outermost process are distinguished, where an assertion needs more than
the conditions of the program.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, TypeAlias

from cspdiag.base.record import record

if TYPE_CHECKING:
    from cspdiag.network.ir.expressions import Value


@record
class Distinction:
    """How the values at a port are distinguished.

    Whole numbers of an input are cut before each of the ``cuts``. ``copied``: a specification passes them on, so each
    set of values that are not distinguished gets a representative. ``values``, unless empty, are the only ones that the
    environment gives.
    """

    cuts: frozenset[int] = frozenset()
    copied: bool = False
    values: tuple[Value, ...] = ()


Distinguished: TypeAlias = Mapping[str, Distinction]
"""By port; the values at other ports matter only if conditions depend on them."""


@record
class AsSpecification:
    """Says that a process is a specification; ``free`` are inputs that only the specification has, whose values it
    chooses itself.
    """

    free: frozenset[str] = frozenset()
