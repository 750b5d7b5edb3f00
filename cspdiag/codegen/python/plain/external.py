"""Bodies written in Python: the modules that are copied into the package, and the calls of their classes."""

from __future__ import annotations

import ast
import os
import posixpath
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from importlib.resources import files as package_files
from typing import Literal

from cspdiag.base.record import record, replaced
from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.text.code import (
    Argument,
    Call,
    Code,
    Comprehension,
    Constant,
    Entry,
    Items,
    Name,
    WholeNumber,
    call,
    own,
    tuple_of,
)
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.literals import quoted
from cspdiag.codegen.python.text.names import Names, identifier
from cspdiag.codegen.python.text.statements import Statement, assign, unpack
from cspdiag.codegen.python.text.types import accepted
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.devices.catalogue import DEVICES, Device
from cspdiag.model.names.described import LANGUAGE
from cspdiag.model.types import Type, has_single
from cspdiag.network.ir.equations import ExternalBody, ExternalCall
from cspdiag.network.ir.external import devices_in_c, external_bodies, file_of_fmu, files_of_body
from cspdiag.network.ir.network import CoreNetwork, Network, Port


@record
class Body:
    """The known facts of an external class: where it is imported from, and which optional parts it has.

    ``folder`` is that of the package in which a copy of its module is; empty for an installed module.
    """

    module: str
    name: str
    folder: Literal["", "external", "devices"]
    has_reset: bool
    takes_time: bool


class ExternalModules:
    """The texts of the modules that a program names, by the paths they were read from."""

    def __init__(self, texts: Mapping[str, str]) -> None:
        self._texts = texts
        names = Names({"__init__"})
        self._modules = {path: names.fresh(posixpath.basename(path).removesuffix(".py")) for path in texts}
        """The module name of each file in the folder ``external``: files of the same name in different folders get
        different ones.
        """

    def describe(self, body: ExternalBody) -> Body:
        """The facts that the text of its module gives about a class; a class of an installed module is assumed to have
        only the required parts.

        Raises TargetError for a body in another language, or a class that its module does not have.
        """
        if body.language == "device":
            device = DEVICES[body.target]
            return Body(device.module, device.class_, folder="devices", has_reset=False, takes_time=False)
        if body.language == LANGUAGE:
            return Body("cspdiag.fmu.running", "Fmu", folder="", has_reset=True, takes_time=True)
        if body.language != "python":
            raise TargetError(f"{body.span}: the Python target cannot run a body in {body.language}")
        file, _, name = body.target.rpartition(":")
        path = source_path(body)
        text = None if path is None else self._texts.get(path)
        if path is None or text is None:
            module = file.removesuffix(".py").replace("/", ".")
            return Body(module, name, folder="", has_reset=False, takes_time=False)
        methods = _methods(text, name)
        if methods is None:
            raise TargetError(f"{body.span}: {file} has no class `{name}`")
        return Body(
            self._modules[path],
            name,
            folder="external",
            has_reset="reset" in methods,
            takes_time="time" in methods.get("calculate", ()),
        )

    def construct(
        self, body: ExternalBody, given: Mapping[str, Code], imports: Imports, outputs: Iterable[str] = ()
    ) -> Code:
        """A call of the constructor, with the parameters as keywords. An FMU is also given its file and its outputs."""
        arguments = tuple(Argument(value, identifier(name)) for name, value in given.items())
        if body.language == LANGUAGE:
            place, interface = os.path.abspath(file_of_fmu(body)), body.target.partition(":")[2]
            integration = () if body.step is None else (Argument(WholeNumber(body.step), "step"),)
            if body.method != "rk4":
                integration = (*integration, Argument(Constant(quoted(body.method)), "method"))
            ports = tuple_of(Constant(quoted(name)) for name in outputs)
            named = Items("{}", tuple(Entry(quoted(name), value) for name, value in given.items()))
            first = (Argument(Constant(quoted(place))), Argument(Constant(quoted(interface))), Argument(ports))
            arguments = (*first, *((Argument(named),) if given else ()), *integration)
        return Call(Name(self.imported(body, imports)), arguments)

    def imported(self, body: ExternalBody, imports: Imports) -> str:
        """The name of the class in a module that imports it."""
        facts = self.describe(body)
        return imports.body(facts.module, facts.name, folder=facts.folder)

    def copies(self, network: Network) -> dict[str, str]:
        """Files of the folder ``external``, adapted to import the runtime of the package."""
        files: dict[str, str] = {}
        for body in bodies(network):
            path = source_path(body)
            if path is not None and path in self._texts:
                files[f"{self._modules[path]}.py"] = _relative_imports(self._texts[path])
        return files


def devices_of(network: Network) -> list[Device]:
    """The devices that a network names, each once."""
    return [DEVICES[name] for name in sorted({body.target for body in bodies(network) if body.language == "device"})]


def device_modules(network: Network) -> dict[str, str]:
    """The modules of the devices that a network names, and those that they import, by path from their folder."""
    wanted = [device.module for device in devices_of(network)]
    found = {"__init__.py": '"""Devices that the program names, copied from cspdiag."""\n'} if wanted else {}
    while wanted:
        module = wanted.pop()
        text = package_files("cspdiag.devices").joinpath(f"{module}.py").read_text(encoding="utf-8")
        found[f"{module}.py"] = text
        imported = re.findall(r"^from \.(\w+) import", text, flags=re.MULTILINE)
        wanted += (name for name in imported if f"{name}.py" not in found)
    return found


def external_call(
    item: ExternalCall, names: Names, printer: Printer, modules: ExternalModules, *, time: Code | None
) -> Iterator[Statement]:
    """``encoder = double(self.pan.calculate(voltage=...))``."""
    arguments = [Argument(printer.print(value), identifier(port)) for port, value in item.inputs]
    if time is not None and modules.describe(item.external).takes_time:
        arguments.append(Argument(time, "time"))
    evaluated = Call(own(names[item.name]).field("calculate"), tuple(arguments))
    yield from taken([(Name(names[local]), type_) for _, local, type_ in item.outputs], evaluated, printer.imports)


def taken(
    outputs: Sequence[tuple[Code, Type]], evaluated: Code, imports: Imports, place: str | None = None
) -> Iterator[Statement]:
    """The outputs of a hand-written law, as values of their types."""
    targets = [target for target, _ in outputs]
    if len(outputs) == 1:
        ((target, type_),) = outputs
        yield assign(target, call(accepted(type_, imports), evaluated), place)
        return
    yield unpack(targets, evaluated, place)
    for target, type_ in outputs:
        yield assign(target, call(accepted(type_, imports), target))


def converting(port: Port, end: Code, imports: Imports) -> Code:
    """The end of a hand-written process for a port: what it writes to an output in single precision is rounded."""
    if port.direction == "in" or not has_single(port.type):
        return end
    class_, accept = Name(imports.runtime("Converting")), accepted(port.type, imports)
    return (
        call(class_, end, accept) if port.size is None else Comprehension(call(class_, Name("end"), accept), "end", end)
    )


def without_devices_in_c(network: CoreNetwork) -> CoreNetwork:
    """The network without environments that need C."""
    kept = tuple(entry for entry in network.environments if not devices_in_c(entry))
    return network if len(kept) == len(network.environments) else replaced(network, environments=kept)


def bodies(network: Network) -> tuple[ExternalBody, ...]:
    """All bodies in Python that a network names, each once."""
    return tuple(dict.fromkeys(external_bodies(network.classes, network.environments)))


def source_path(body: ExternalBody) -> str | None:
    """The path of the module's file, relative to the file that names it; None for an installed module."""
    return next(iter(files_of_body(body)), None) if body.language == "python" else None


def installed_modules(network: Network, modules: ExternalModules) -> list[str]:
    """Modules of bodies that are not part of the package."""
    described = (modules.describe(body) for body in bodies(network))
    return list(dict.fromkeys(body.module for body in described if not body.folder))


def external_paths(network: Network) -> tuple[str, ...]:
    """The files to read for a network."""
    paths = (source_path(body) for body in bodies(network))
    return tuple(dict.fromkeys(path for path in paths if path is not None))


def _methods(text: str, name: str) -> dict[str, list[str]] | None:
    """The methods of a class with the names of their parameters; None if there is no such class."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError):
        return {}  # Python reports the error and its place.
    for node in tree.body:
        if isinstance(node, ast.ClassDef) and node.name == name:
            functions = [item for item in node.body if isinstance(item, ast.FunctionDef)]
            return {item.name: _keywords(item.args) for item in functions}
    imported = any(
        isinstance(node, ast.Import | ast.ImportFrom | ast.Assign) and name in ast.unparse(node) for node in tree.body
    )
    return {} if imported else None


def _keywords(arguments: ast.arguments) -> list[str]:
    named: Iterable[ast.arg] = (*arguments.args, *arguments.kwonlyargs)
    return [argument.arg for argument in named]


def _relative_imports(text: str) -> str:
    text = re.sub(r"^(\s*from )cspdiag(\.runtime[\w.]* import )", r"\1.\2", text, flags=re.MULTILINE)
    text = re.sub(
        r"^(\s*)import cspdiag\.runtime as (\w+)", r"\1from .. import runtime as \2", text, flags=re.MULTILINE
    )
    return re.sub(r"^(\s*)from cspdiag import runtime", r"\1from .. import runtime", text, flags=re.MULTILINE)
