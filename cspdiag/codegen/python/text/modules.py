"""The values for the template of a module with one class."""

from __future__ import annotations

from cspdiag.base.record import record
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.types import annotation
from cspdiag.network.ir.network import ClassParameter, Port


@record
class ClassModule:
    """A module: its docstring, imports, and a class with its methods, each as lines."""

    summary: str
    imports: list[str]
    head: str
    docstring: list[str]
    functions: list[list[str]]


def parameter_annotation(parameter: ClassParameter, imports: Imports) -> str:
    """The type of a parameter: ``Parameter[float]`` for one that refers to a parameter of the program."""
    type_ = annotation(parameter.type, imports)
    return f"{imports.runtime('Parameter')}[{type_}]" if parameter.tunable else type_


def port_annotation(port: Port, imports: Imports) -> str:
    """``In[float]``, or a sequence of these for an array of ports."""
    end = imports.runtime("In" if port.direction == "in" else "Out")
    one = f"{end}[{annotation(port.type, imports)}]"
    if port.size is None:
        return one
    return f"{imports.standard('collections.abc', 'Sequence')}[{one}]"
