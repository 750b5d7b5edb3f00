"""Programs that cannot be compiled to C: those with parts that are written in Python."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.model.names.described import LANGUAGE
from cspdiag.model.types import TextType
from cspdiag.network.ir.equations import ExternalBody
from cspdiag.network.ir.external import external_calls
from cspdiag.network.ir.network import DriverInstance, Environment, Network, ProcessClass


def refuse(network: Network, texts: Mapping[str, str] | None = None) -> None:
    """Raises TargetError with every part that cannot be compiled to C, its place, and what to write instead.

    Devices of an environment do not belong to a package in C, where devices are functions that are passed to
    ``network_initialize``.
    """
    found: dict[str, None] = {}
    for kind, definition, body in _bodies(network):
        if body.language != "c":
            found[_refusal(kind, definition, body)] = None
    for class_ in network.classes:
        if class_.external is not None:
            for item in class_.parameters:
                if isinstance(item.type, TextType):
                    found[_text_refusal(class_.definition, item.name, class_.external)] = None
    if found:
        raise TargetError("\n".join(found))


def foreign_devices(environment: Environment) -> list[DriverInstance]:
    """The drivers of an environment that are not written in C."""
    return [driver for driver in environment.drivers if driver.external.language != "c"]


def refuse_devices(environment: Environment) -> None:
    """Raises TargetError for an environment with drivers that are Python classes."""
    drivers = foreign_devices(environment)
    if drivers:
        raise TargetError("\n".join(_device(driver.definition, driver.external) for driver in drivers))


def _bodies(network: Network) -> Iterator[tuple[str, str, ExternalBody]]:
    for class_ in network.classes:
        if class_.external is not None:
            kind = "process" if isinstance(class_, ProcessClass) else "submodel"
            yield kind, class_.definition, class_.external
    environments = (environment for environment in network.environments if not foreign_devices(environment))
    for owner in (*network.classes, *environments):
        for call in external_calls(owner):
            if call.external.language == LANGUAGE and isinstance(owner, Environment):
                continue
            yield "submodel", call.definition, call.external


def _refusal(kind: str, definition: str, body: ExternalBody) -> str:
    stem = body.target.rpartition(":")[0].rpartition("/")[2].removesuffix(".py") or definition.lower()
    what = f"the body of the {kind} `{definition}` is a Python class ({body.target}), which C cannot call"
    help_ = f'write it in the language, or in C: `{kind} {definition} c "{stem}.c"`'
    return f"{body.span}: {what}\n  help: {help_}"


def _text_refusal(definition: str, parameter: str, body: ExternalBody) -> str:
    what = f"`{definition}` is written in C and has the text parameter `{parameter}`"
    return f"{body.span}: {what}\n  help: give it a number or a literal of an enum"


def device_refusal(definition: str, body: ExternalBody) -> str:
    """What is wrong with a driver that is not written in C, and its place."""
    class_ = (
        f'the device "{body.target}", a Python class'
        if body.language == "device"
        else f"a Python class ({body.target})"
    )
    return f"{body.span}: the driver `{definition}` is {class_}, which a native program cannot call"


def _device(definition: str, body: ExternalBody) -> str:
    stem = body.target.rpartition(":")[0].rpartition("/")[2].removesuffix(".py") or body.target
    in_c = f'write it in C: `driver {definition} c "{stem}.c"`'
    help_ = f"{in_c}; or choose another environment with --environment, or leave out --target c"
    return f"{device_refusal(definition, body)}\n  help: {help_}"
