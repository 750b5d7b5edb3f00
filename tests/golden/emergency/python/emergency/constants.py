"""Named constants of the program."""

from __future__ import annotations

from .runtime import ms

# Sample period of the spindle's speed loop.
T = 2 * ms  # emergency.csp:2
