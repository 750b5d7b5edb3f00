"""Networks as files of a target: a folder of templates and one module each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from cspdiag.codegen.options import Generator, Options

if TYPE_CHECKING:
    from cspdiag.base import SourceFile
    from cspdiag.network.ir.network import CoreNetwork


def _python(network: CoreNetwork, modules: Mapping[str, str], options: Options) -> dict[str, str]:
    from cspdiag.codegen.python.plain.external import without_devices_in_c

    network = without_devices_in_c(network)
    if options.level == 0:
        from cspdiag.codegen.python import package as python
        from cspdiag.optimize import with_all_elements

        return python.generate(with_all_elements(network), modules, templates=options.templates)
    from cspdiag.codegen.python.fast import package

    return package.generate(network, modules, options)


def _c(network: CoreNetwork, modules: Mapping[str, str], options: Options) -> dict[str, str]:
    from cspdiag.codegen.c.package import package

    return package.generate(network, modules, options)


def _fmu(network: CoreNetwork, modules: Mapping[str, str], options: Options) -> dict[str, str]:
    from cspdiag.codegen.fmi import package

    return package.generate(network, modules, options)


def _promela(network: CoreNetwork, modules: Mapping[str, str], options: Options) -> dict[str, str]:
    from cspdiag.codegen.promela import package

    return package.generate(network)


def _cspm(network: CoreNetwork, modules: Mapping[str, str], options: Options) -> dict[str, str]:
    from cspdiag.codegen.cspm import package

    return package.generate(network)


TARGETS: dict[str, Generator] = {"python": _python, "c": _c, "fmu": _fmu, "promela": _promela, "cspm": _cspm}
"""By name. The last two are models for other proof tools, and do not run."""


def target_errors() -> type[ValueError]:
    """The exception, with places and for people, that a target raises for a correct program that it cannot express."""
    from cspdiag.codegen.shared.target_error import TargetError

    return TargetError


def external_modules(network: CoreNetwork, read: Callable[[str], SourceFile], target: str = "python") -> dict[str, str]:
    """The texts of the files of external bodies to hand to a target, by their paths joined to the folder of the file
    that names them; of those in C also what they include. Raises OSError for a file that cannot be read.
    """
    if target in {"promela", "cspm"}:
        return {}
    if target in {"c", "fmu"}:
        from cspdiag.codegen.c.laws.external import external_texts

        return external_texts(network, read)
    from cspdiag.codegen.python.plain.external import external_paths

    return {path: read(path).text for path in external_paths(network)}
