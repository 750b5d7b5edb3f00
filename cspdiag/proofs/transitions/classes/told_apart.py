"""How closely the values at the ports of the outermost process are told apart, where a question asks for more than
conditions do.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, TypeAlias

from cspdiag.base.record import record

if TYPE_CHECKING:
    from cspdiag.network.ir.expressions import Value


@record
class Apart:
    """How the values at a port are told apart.

    Whole numbers of an input are cut before each of the ``cuts``. ``copied``: a specification hands them on, so that of
    those that are not told apart one is chosen that stands for each. ``values``: the environment gives no others.
    """

    cuts: frozenset[int] = frozenset()
    copied: bool = False
    values: tuple[Value, ...] = ()


ToldApart: TypeAlias = Mapping[str, Apart]
"""By port; those of the others matter only where conditions depend on them."""


@record
class AsSpecification:
    """A process is taken as a specification; ``free`` are inputs that only it has: what comes there is its
    own choice.
    """

    free: frozenset[str] = frozenset()
