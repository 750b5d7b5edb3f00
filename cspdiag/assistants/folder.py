"""The folder whose programs an assistant works with: others cannot be named."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from cspdiag.base.errors import CspdiagError


class OutsideError(CspdiagError):
    """A name that leads out of the folder, or to no program."""


class Folder:
    """A folder with programs."""

    def __init__(self, path: Path) -> None:
        self.path = path.resolve()

    def program(self, name: str) -> str:
        """The path of a program in the folder, relative to it. Raises OutsideError for what is not a program there; a
        symbolic link is followed.
        """
        if "\0" in name:
            raise OutsideError("a name of a file contains no zero byte")
        found = Path(os.path.realpath(self.path / name))
        if not found.is_relative_to(self.path):
            raise OutsideError(f"`{name}` is outside the folder {self.path}")
        if os.path.islink(found):
            raise OutsideError(f"`{name}` is a symbolic link that leads to itself")
        if os.path.isdir(found) or not os.path.exists(found):
            raise OutsideError(f"there is no program `{name}`: {self._known()}")
        if found.suffix != ".csp":
            raise OutsideError(f"`{name}` is not a program: the names of programs end in .csp")
        if not os.path.isfile(found):
            raise OutsideError(f"`{name}` is not a file, but a pipe, a socket or a device")
        return found.relative_to(self.path).as_posix()

    def programs(self) -> Iterator[str]:
        """All programs, in the order of their names; hidden folders, and what ``program`` refuses, are left out."""
        for folder, folders, files in os.walk(self.path):
            folders[:] = sorted(name for name in folders if not name.startswith("."))
            for name in sorted(files):
                path = Path(folder, name)
                if name.endswith(".csp") and os.path.isfile(path) and self._is_inside(path):
                    yield path.relative_to(self.path).as_posix()

    def _is_inside(self, path: Path) -> bool:
        return not path.is_symlink() or Path(os.path.realpath(path)).is_relative_to(self.path)

    def _known(self) -> str:
        found = [name for name, _ in zip(self.programs(), range(20), strict=False)]
        return f"there are {', '.join(found)}" if found else "the folder has none"
