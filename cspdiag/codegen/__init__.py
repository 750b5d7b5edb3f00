"""Networks as files of a target: a folder of templates and one module each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cspdiag.network.ir import Network


def _python(network: Network, modules: Mapping[str, str]) -> dict[str, str]:
    from cspdiag.codegen import python

    return python.generate(network, modules)


TARGETS: dict[str, Callable[[Network, Mapping[str, str]], dict[str, str]]] = {"python": _python}
"""By name: from a network, and the texts of the external modules that it names by path, to the files of a package by path."""


def target_errors() -> type[ValueError]:
    """The exception, with places and for people, that a target raises for a correct program that it cannot express."""
    from cspdiag.codegen.target_error import TargetError

    return TargetError


def external_modules(network: Network) -> tuple[str, ...]:
    """The files of external bodies to read and hand to a target, as paths joined to the folder of the file that names them."""
    from cspdiag.codegen.python_external import external_paths

    return external_paths(network)
