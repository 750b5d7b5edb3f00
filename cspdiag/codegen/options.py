"""The options of generating code, and what a target is."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from cspdiag.base.record import EMPTY, record
from cspdiag.codegen.shared.render import Replacement
from cspdiag.network.ir.network import CoreNetwork

FRAMEWORKS = ("zephyr", "esp-idf", "platformio", "arduino")
"""What a package in C can be a library for, instead of a folder with a Makefile and a CMakeLists.txt."""

FMI_VERSIONS = ("2.0", "3.0")
"""Versions of the Functional Mock-up Interface for which FMUs are made."""


@record(kw_only=True)
class Options:
    """How a target generates: ``level`` of optimization, 0 or 1.

    ``traced`` code notifies an observer of every communication; other code, at level 1, of those of external
    ports only. ``observed`` code also notifies it when each process starts and ends, and who communicates. ``probed``
    code keeps variables that have a unit as objects that can be watched. ``templates`` take the places of those of the
    target, by name. ``framework``: the package is a library for it, one of ``FRAMEWORKS``; only in C. ``fmi`` is the
    version of an FMU, one of ``FMI_VERSIONS``, and ``plant`` the environment that it has, instead of the program.
    """

    level: int = 0
    traced: bool = False
    observed: bool = False
    probed: bool = False
    templates: Mapping[str, Replacement] = EMPTY
    framework: str = ""
    fmi: str = "2.0"
    plant: str = ""


Generator = Callable[[CoreNetwork, Mapping[str, str], Options], dict[str, str]]
"""From a network, and the texts of the external modules that it names by path, to the files of a package by path."""
