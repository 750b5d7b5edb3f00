"""All kinds of diagnostics."""

from __future__ import annotations

from importlib import import_module
from pkgutil import walk_packages

from cspdiag.base import Diagnostic

_LAYERS = ("syntax", "model", "network", "analyses", "proofs")


def kinds_of_diagnostics() -> list[type[Diagnostic]]:
    """Every kind of diagnostic, by code. They are in the folders ``diagnostics`` of the layers."""
    for layer in _LAYERS:
        folder = f"cspdiag.{layer}.diagnostics"
        for module in walk_packages(import_module(folder).__path__, f"{folder}."):
            import_module(module.name)
    return sorted(_with_code(Diagnostic), key=lambda kind: kind.code)


def _with_code(kind: type[Diagnostic]) -> set[type[Diagnostic]]:
    found = {kind} if "code" in kind.__dict__ and kind.__module__.startswith("cspdiag.") else set()
    return found.union(*(_with_code(narrower) for narrower in kind.__subclasses__()))
