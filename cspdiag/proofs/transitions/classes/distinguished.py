"""How closely the values at the ports of the outermost process are distinguished, where a question asks for more than
conditions do.
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

    Whole numbers of an input are cut before each of the ``cuts``. ``copied``: a specification hands them on, so that of
    those that are not distinguished one is chosen that stands for each. ``values``: the environment gives no others.
    """

    cuts: frozenset[int] = frozenset()
    copied: bool = False
    values: tuple[Value, ...] = ()


Distinguished: TypeAlias = Mapping[str, Distinction]
"""By port; those of the others matter only where conditions depend on them."""


@record
class AsSpecification:
    """A process is taken as a specification; ``free`` are inputs that only it has: what comes there is its
    own choice.
    """

    free: frozenset[str] = frozenset()
