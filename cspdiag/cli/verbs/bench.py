"""``cspdiag bench``: run the benchmarks on this machine."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from functools import cache
from typing import Protocol, cast

from cspdiag.base.files.resources import benchmark_folder
from cspdiag.cli.support.files.written import require_file

EXAMPLE = "cspdiag bench --only commstime --rounds 5"


class _Measuring(Protocol):
    """What the module ``measuring`` in the folder of the benchmarks offers."""

    def add_arguments(self, parser: ArgumentParser) -> None:
        """Declare the options."""

    def run(self, given: Namespace) -> int:
        """Run the chosen benchmarks and return the exit code."""


@cache
def _measuring() -> _Measuring:
    """The module, which belongs to no package: the folder of the benchmarks is also a program by itself."""
    from importlib.util import module_from_spec, spec_from_file_location

    spec = spec_from_file_location("measuring", benchmark_folder() / "measuring.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    # A dataclass looks up the module that it is defined in.
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return cast("_Measuring", module)


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    _measuring().add_arguments(parser)


def run(arguments: Namespace) -> int:
    """Run the benchmarks."""
    require_file("--json", arguments.json)
    return _measuring().run(arguments)
