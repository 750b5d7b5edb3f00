"""Named constants of the program."""

from __future__ import annotations

# Meals of each philosopher.
meals = 3  # table.csp:4
