"""Named constants of the program."""

from __future__ import annotations

laps = 5  # ring.csp:2
