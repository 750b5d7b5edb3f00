"""Named constants of the program."""

from __future__ import annotations

from .runtime import ms, us

# Sample period of the current loop, 10 kHz.
Tcurrent = 100 * us  # cascade.csp:2

# Sample period of the speed loop, 1 kHz.
Tspeed = 1 * ms  # cascade.csp:4
