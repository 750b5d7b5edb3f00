"""Named constants of the program."""

from __future__ import annotations

producers = 3  # buffer.csp:1

# Items that each producer makes.
items = 20  # buffer.csp:3
capacity = 4  # buffer.csp:4
