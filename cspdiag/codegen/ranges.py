"""What can go wrong when an expression is evaluated, as far as generated code is concerned."""

from __future__ import annotations

from cspdiag.network.ranges import cannot_fault, exceeds, needs_check, values_of

__all__ = ["cannot_fault", "exceeds", "needs_check", "values_of"]
