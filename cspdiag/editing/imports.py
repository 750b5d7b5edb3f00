"""What can be imported: the programs beside a file."""

from __future__ import annotations

import os
from contextlib import suppress

from cspdiag.base.span import SourceFile


def programs_beside(source: SourceFile) -> list[str]:
    """The names of the other programs in the folder of a file; none for a text that is not on the disk."""
    folder, own = os.path.split(source.name)
    names: list[str] = []
    if os.path.isabs(folder):
        with suppress(OSError):
            names += (name for name in os.listdir(folder) if name.endswith(".csp") and name != own)
    return sorted(names)
