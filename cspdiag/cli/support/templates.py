"""Templates of the user, read from a folder: each replaces the one of the same name."""

from __future__ import annotations

import os

from cspdiag.base.render.snippet import on_one_line
from cspdiag.cli.support.failure import UsageError, described
from cspdiag.codegen.shared.render import PART, Replacement, template_names


def read_templates(folder: str, target: str) -> dict[str, Replacement]:
    """The templates by name; files that begin with a dot are ignored. Raises UsageError for a folder or a file that
    cannot be used.
    """
    there = template_names(target)
    if not there:
        raise UsageError(f"--templates {on_one_line(folder)}: the target {target} is made without templates")
    if not os.path.isdir(folder):
        reason = "is not a folder" if os.path.lexists(folder) else "there is no such folder"
        raise UsageError(f"--templates {on_one_line(folder)}: {reason}")
    try:
        names = sorted(name for name in os.listdir(folder) if not name.startswith("."))
    except OSError as problem:
        raise UsageError(f"--templates {described(problem)}") from None
    for name in names:
        if name not in there and not name.startswith(PART):
            path = on_one_line(os.path.join(folder, name))
            raise UsageError(
                f"--templates: {path} is not a template of the target {target}; there are: {', '.join(there)}"
                f" (names of files that these include begin with {PART})"
            )
    return {name: Replacement(*_read(os.path.join(folder, name))) for name in names}


def _read(path: str) -> tuple[str, str]:
    try:
        with open(path, encoding="utf-8") as file:
            return path, file.read()
    except OSError as problem:
        raise UsageError(f"--templates: {described(problem)}") from None
    except UnicodeDecodeError as problem:
        raise UsageError(f"--templates: {on_one_line(path)}: is not in UTF-8 (byte {problem.start})") from None
