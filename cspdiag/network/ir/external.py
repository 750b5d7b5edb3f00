"""The bodies in other languages that a network names."""

from __future__ import annotations

import posixpath
from collections.abc import Iterable, Iterator
from typing import assert_never

from cspdiag.base.record import kept_for_same
from cspdiag.network.ir.actions import RunLaw
from cspdiag.network.ir.equations import ExternalBody, ExternalCall
from cspdiag.network.ir.network import DriverInstance, Environment, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import all_actions


@kept_for_same(32)
def external_calls(owner: ProcessClass | SubmodelClass | Environment) -> tuple[ExternalCall, ...]:
    """The bodies in other languages in a control law, in the laws inlined into a process, or in an environment: each
    once, in the order of the text.
    """
    laws: list[SubmodelClass | RunLaw] = []
    match owner:
        case ProcessClass():
            if owner.body is not None:
                laws += (action for action in all_actions(owner.body) if isinstance(action, RunLaw))
        case SubmodelClass():
            laws.append(owner)
        case Environment():
            if owner.system is not None:
                laws.append(owner.system)
        case _:
            assert_never(owner)
    equations = (equation for law in laws for equation in law.equations)
    return tuple({call.name: call for call in equations if isinstance(call, ExternalCall)}.values())


def files_of_body(body: ExternalBody) -> tuple[str, ...]:
    """The paths of the files of a body, relative like that of the file that names it: its own, and in C its header. An
    installed module and a device have none.
    """
    match body.language:
        case "python":
            file = body.target.rpartition(":")[0]
            files: tuple[str, ...] = (file,) if file.endswith(".py") else ()
        case "c":
            files = body.target, f"{body.target.removesuffix('.c')}.h"
        case "fmu":
            files = (body.target.partition(":")[0],)
        case _:  # A device, or a language that is refused.
            files = ()
    return tuple(posixpath.normpath(posixpath.join(posixpath.dirname(body.span.file), file)) for file in files)


def fmu_calls(environment: Environment) -> list[ExternalCall]:
    """The FMUs of an environment."""
    return [item for item in external_calls(environment) if item.external.language == "fmu"]


def file_of_fmu(body: ExternalBody) -> str:
    """The path of an FMU, relative like that of the file that names it."""
    return files_of_body(body)[0]


def devices_in_c(environment: Environment) -> list[DriverInstance]:
    """The drivers of an environment that are written in C, so it runs in native programs only."""
    return [driver for driver in environment.drivers if driver.external.language == "c"]


def external_bodies(
    classes: Iterable[ProcessClass | SubmodelClass], environments: Iterable[Environment]
) -> Iterator[ExternalBody]:
    """The external bodies of processes, control laws and drivers; one that is named several times is repeated."""
    for class_ in classes:
        yield from (call.external for call in external_calls(class_))
        if class_.external is not None:
            yield class_.external
    for environment in environments:
        yield from (call.external for call in external_calls(environment))
        yield from (driver.external for driver in environment.drivers)
