"""What can be wrong with an import."""

from __future__ import annotations

from cspdiag.base import Diagnostic
from cspdiag.base.record import record


@record
class ImportFailure(Diagnostic):
    """Names may be unknown because of this, so that none is reported as unknown after it."""


@record
class UnreadableImport(ImportFailure):
    """An imported file cannot be read.

    The path of an import is relative to the folder of the file that imports it. The file must exist and be a text in UTF-8:
    a pipe or a device is not waited for. While an import is missing, names that may come from it are not reported as unknown.

    Refused::

        import "missing.csp"

        const T = 1 ms

    Mended::

        const T = 1 ms
    """

    code = "E0120"
    title = "an import that cannot be read"

    path: str
    looked_for: str
    reason: str

    @property
    def message(self) -> str:
        return f'cannot import "{self.path}": {self.reason}'

    @property
    def help(self) -> str:
        return f"paths are relative to the importing file; looked for {self.looked_for}"


@record
class UnknownLibrary(ImportFailure):
    """A library that is not bundled with cspdiag is imported.

    A name without quotes means a bundled library; a file of your own is imported by its path in quotes.

    Refused::

        import std.controls

        const T = 1 ms

    Mended::

        import std.control

        const T = 1 ms
    """

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
    """Files import each other in a circle, or a file imports itself.

    Every definition of an imported file is visible to its importer only, so a circle has no beginning. Move what both files
    need to a third one, and import that from both.

    Refused::

        import "case.csp"

        const T = 1 ms

    Mended::

        const T = 1 ms
    """

    code = "E0122"
    title = "an import cycle"

    cycle: tuple[str, ...]

    @property
    def message(self) -> str:
        if len(self.cycle) == 2:
            return f"{self.cycle[0]} imports itself"
        return f"these files import each other: {' → '.join(self.cycle)}"

    @property
    def help(self) -> str:
        if len(self.cycle) == 2:
            return "remove this import"
        return "move what both need to a third file, and import it from both"
