"""Programs that cannot be made into C: those with parts that are written in Python."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.codegen.target_error import TargetError
from cspdiag.network.ir import ExternalBody, ExternalCall, Network, ProcessClass
from cspdiag.network.walk import parts


def refuse_python_bodies(network: Network) -> None:
    """Raises TargetError with every process, submodel and driver whose body is Python, its place, and what to write instead."""
    found: dict[str, None] = {}
    for kind, definition, body in _bodies(network):
        if body.language != "c":
            found[_refusal(kind, definition, body)] = None
    if found:
        raise TargetError("\n".join(found))


def _bodies(network: Network) -> Iterator[tuple[str, str, ExternalBody]]:
    for class_ in network.classes:
        if class_.external is not None:
            kind = "process" if isinstance(class_, ProcessClass) else "submodel"
            yield kind, class_.definition, class_.external
    for part in parts((network.classes, [environment.system for environment in network.environments])):
        if isinstance(part, ExternalCall):
            yield "submodel", part.definition, part.external
    for environment in network.environments:
        for driver in environment.drivers:
            yield "driver", driver.definition, driver.external


def _refusal(kind: str, definition: str, body: ExternalBody) -> str:
    if kind == "driver":
        what = f"the driver `{definition}` is a Python class ({body.target}), which C cannot call"
        help_ = "choose an environment of submodels with --environment, or write the driver in C and give it to the network as a function"
    else:
        stem = body.target.rpartition(":")[0].rpartition("/")[2].removesuffix(".py") or definition.lower()
        what = f"the body of the {kind} `{definition}` is a Python class ({body.target}), which C cannot call"
        help_ = f'write it in the language, or in C: `{kind} {definition} c "{stem}.c"`'
    return f"{body.span}: {what}\n  help: {help_}"
