"""Diagnostics of imports."""

from __future__ import annotations

import os

from cspdiag.base import Diagnostic, Edit
from cspdiag.base.edits import removing
from cspdiag.base.record import record


@record
class ImportFailure(Diagnostic):
    """An import that failed. Names may be unknown because of it, so no name is reported as unknown afterwards."""


@record
class UnreadableFile(ImportFailure):
    code = "E0120"
    title = "a file that cannot be read"

    path: str | None
    """As it is written in the import; None for a file that nothing imports."""
    file: str
    missing: bool
    """Whether there is no such file."""
    reason: str

    @property
    def message(self) -> str:
        if self.path is None:
            return f"cannot read this file: {self.reason}"
        return f'cannot import "{self.path}": {self.reason}'

    @property
    def help(self) -> str | None:
        if self.path is None:
            return None if self.missing else "programs are files with UTF-8 text"
        if self.missing:
            return f"paths are relative to the importing file; looked for {self.file}"
        return f"the file is {self.file}"


@record
class UnknownLibrary(ImportFailure):
    code = "E0121"
    title = "an unknown library"

    library: str

    @property
    def message(self) -> str:
        return f"there is no library `{self.library}`"

    @property
    def help(self) -> str:
        return f'the bundled library is `std.control`; import a file by its path, such as "{self.library}.csp"'


@record
class ImportCycle(Diagnostic):
    code = "E0122"
    title = "an import cycle"

    cycle: tuple[str, ...]

    @property
    def message(self) -> str:
        names = [self._shown(name) for name in self.cycle]
        if len(names) == 2:
            return f"{names[0]} imports itself"
        return f"these files import each other: {' → '.join(names)}"

    def _shown(self, name: str) -> str:
        """The name of a file, from the folder of this one if it is absolute, as in editors."""
        return os.path.relpath(name, os.path.dirname(self.span.file)) if os.path.isabs(name) else name

    @property
    def help(self) -> str:
        if len(self.cycle) == 2:
            return "remove this import"
        return "move what both need to a third file, and import it from both"

    @property
    def edits(self) -> tuple[Edit, ...]:
        return (removing(self.span),) if len(self.cycle) == 2 else ()
