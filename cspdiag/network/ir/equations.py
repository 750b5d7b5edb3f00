"""The equations of control laws, and calls of laws in other languages."""

from __future__ import annotations

from functools import cached_property

from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.model.types import Type
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.expression_walk import signals_read
from cspdiag.network.ir.expressions import Expression


@record(kw_only=True)
class ExternalBody:
    """A body in another language: ``target`` is ``module.py:Class`` or a C file; ``span`` is where it is named."""

    language: str
    target: str
    span: Span


@record(kw_only=True)
class SubmodelEquation(Declared):
    """``name = value``; ``name`` is an output or a local. Nested submodels are inlined: ``pid.error`` is a local."""

    type: Type
    value: Expression

    @cached_property
    def reads(self) -> tuple[str, ...]:
        """The names of the signals that it reads, each once."""
        return tuple(signals_read(self.value))


@record(kw_only=True)
class ExternalCall(Declared):
    """A nested external submodel (its instance is ``name``): one call with all ``inputs`` computes all ``outputs``."""

    external: ExternalBody
    definition: str
    arguments: tuple[tuple[str, Expression], ...]
    inputs: tuple[tuple[str, Expression], ...]
    outputs: tuple[tuple[str, str, Type], ...]
    """Port, local name (``pan.encoder``), type."""

    @cached_property
    def reads(self) -> tuple[str, ...]:
        """The names of the signals that it reads, each once."""
        expressions = (value for _, value in self.arguments + self.inputs)
        return tuple(dict.fromkeys(name for expression in expressions for name in signals_read(expression)))
