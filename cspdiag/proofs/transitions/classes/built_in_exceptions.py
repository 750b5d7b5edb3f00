"""The exceptions that no program declares."""

from __future__ import annotations

FAULT = "Fault"
TIMEOUT = "Timeout"
