"""Networks as files of a target: a folder of templates and one module each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from cspdiag.base.record import record

if TYPE_CHECKING:
    from cspdiag.network.ir.network import Network


@record(kw_only=True)
class Options:
    """How a target generates: ``level`` of optimization, 0 or 1.

    ``traced`` code tells an observer of every communication; at level 1 code that is not tells it of those of external ports only.
    ``observed`` code tells it as well when each process starts and ends, and who communicates. ``probed`` code keeps variables that have a unit as
    objects that can be watched.
    """

    level: int = 0
    traced: bool = False
    observed: bool = False
    probed: bool = False


Generator = Callable[["Network", Mapping[str, str], Options], dict[str, str]]
"""From a network, and the texts of the external modules that it names by path, to the files of a package by path."""


def _python(network: Network, modules: Mapping[str, str], options: Options) -> dict[str, str]:
    if options.level == 0:
        from cspdiag.codegen.python import package as python

        return python.generate(network, modules)
    from cspdiag.codegen.python.fast import package

    return package.generate(network, modules, options)


def _c(network: Network, modules: Mapping[str, str], options: Options) -> dict[str, str]:
    from cspdiag.codegen.c.package import package

    return package.generate(network, modules, level=options.level, observed=options.observed)


def _promela(network: Network, modules: Mapping[str, str], options: Options) -> dict[str, str]:
    from cspdiag.codegen.promela import package

    return package.generate(network)


def _cspm(network: Network, modules: Mapping[str, str], options: Options) -> dict[str, str]:
    from cspdiag.codegen.cspm import package

    return package.generate(network)


TARGETS: dict[str, Generator] = {"python": _python, "c": _c, "promela": _promela, "cspm": _cspm}
"""By name. The last two are models for other proof tools, and do not run."""


def target_errors() -> type[ValueError]:
    """The exception, with places and for people, that a target raises for a correct program that it cannot express."""
    from cspdiag.codegen.shared.target_error import TargetError

    return TargetError


def external_modules(network: Network, target: str = "python") -> tuple[str, ...]:
    """The files of external bodies to read and hand to a target, as paths joined to the folder of the file that names them."""
    if target in {"promela", "cspm"}:
        return ()
    if target == "c":
        from cspdiag.codegen.c.laws import external

        return external.external_paths(network)
    from cspdiag.codegen.python.plain.external import external_paths

    return external_paths(network)
