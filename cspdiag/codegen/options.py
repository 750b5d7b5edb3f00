"""How a target is asked to generate, and what a target is."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from cspdiag.base.record import EMPTY, record
from cspdiag.codegen.shared.render import Replacement
from cspdiag.network.ir.network import CoreNetwork


@record(kw_only=True)
class Options:
    """How a target generates: ``level`` of optimization, 0 or 1.

    ``traced`` code tells an observer of every communication; at level 1 code that is not tells it of those of external
    ports only. ``observed`` code tells it as well when each process starts and ends, and who communicates. ``probed``
    code keeps variables that have a unit as objects that can be watched. ``templates`` take the places of those of the
    target, by name.
    """

    level: int = 0
    traced: bool = False
    observed: bool = False
    probed: bool = False
    templates: Mapping[str, Replacement] = EMPTY


Generator = Callable[[CoreNetwork, Mapping[str, str], Options], dict[str, str]]
"""From a network, and the texts of the external modules that it names by path, to the files of a package by path."""
