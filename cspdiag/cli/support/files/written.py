"""Checks in advance whether an output can be written, and names it in messages as the user did."""

from __future__ import annotations

import os
from argparse import ArgumentTypeError
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from cspdiag.base.render.snippet import on_one_line
from cspdiag.base.sources import STANDARD_INPUT
from cspdiag.cli.support.failure import UsageError, described
from cspdiag.cli.support.terminal import say

if TYPE_CHECKING:
    from pathlib import Path


def file_path(text: str) -> Path:
    """The path of a file, as the value of an option; raises ArgumentTypeError for what can only be a folder, which a
    ``Path`` does not show.
    """
    from pathlib import Path

    if os.path.basename(text) in {"", os.curdir, os.pardir}:
        raise ArgumentTypeError(f"expected the name of a file, not {text!r}")
    return Path(text)


def given_name(text: str) -> str:
    """The name of a file or a folder, as the value of an option; raises ArgumentTypeError for the empty one, which is
    that of a variable that a script has not set, and not the present folder.
    """
    if not text:
        raise ArgumentTypeError("expected the name of a file or a folder, not ''")
    return text


def require_file(option: str, path: str | Path | None, endings: Sequence[str] = (), *, any_case: bool = False) -> None:
    """Refuse a file that could not be written; ``option`` is what named it. An existing file is not changed.

    Its name has one of ``endings``, in capitals too with ``any_case``.
    """
    if path is None:
        return
    name = os.fspath(path)
    ending = os.path.splitext(name)[1]
    if endings and (ending.lower() if any_case else ending) not in endings:
        raise UsageError(
            f"{option} {name}: the name must end in {', '.join(endings[:-1])}{' or ' * (len(endings) > 1)}{endings[-1]}"
        )
    if os.path.isdir(name):
        raise UsageError(f"{option} {name}: is a directory")
    folder = os.path.dirname(name)
    if folder and not os.path.isdir(folder):
        raise UsageError(f"{option} {name}: there is no folder {folder}")
    if os.path.exists(name) and not os.path.isfile(name):
        if not os.access(name, os.W_OK):
            raise UsageError(f"{option} {name}: permission denied")
        return
    _try_folder(option, name, os.path.dirname(os.path.realpath(name)))


def require_different(named: Mapping[str, str | Path | None]) -> None:
    """Refuse two names of one file, by the options that gave them: what is written later would replace what is read or
    written before.
    """
    known: dict[str, str] = {}
    for option, path in named.items():
        if path is None or os.fspath(path) == STANDARD_INPUT or _is_no_file(path):
            continue
        other = known.setdefault(os.path.realpath(path), option)
        if other != option:
            raise UsageError(f"{other} and {option} name one file: {path}")


def say_earlier(paths: Iterable[str | Path | None]) -> None:
    """Say which of the files that a command has not written are there all the same: those of an earlier one."""
    earlier = [on_one_line(path) for path in paths if path is not None and os.path.isfile(path)]
    if earlier:
        say(f"cspdiag: {' and '.join(earlier)} {'are' if len(earlier) > 1 else 'is'} of an earlier run")


def _is_no_file(path: str | Path) -> bool:
    """Whether it is a device or a pipe, which accepts several outputs one after the other."""
    return os.path.exists(path) and not os.path.isfile(path)


def require_folder(option: str, path: str) -> None:
    """Refuse a folder in which no file could be written; neither it nor its parents need to exist."""
    name = path.rstrip(os.sep) or path
    if os.path.islink(name) and not os.path.exists(name):
        raise UsageError(f"{option} {path}: is a symbolic link that leads nowhere")
    there = os.path.realpath(name)
    while not os.path.lexists(there):
        there = os.path.dirname(there)
    if not os.path.isdir(there):
        raise UsageError(f"{option} {path}: {there} is in the way: it is not a folder")
    _try_folder(option, path, there)


def _try_folder(option: str, name: str, folder: str) -> None:
    """Try to create and remove a file: permissions alone do not decide."""
    trial = os.path.join(folder, f".cspdiag-{os.getpid()}.tmp")
    try:
        os.close(os.open(trial, os.O_CREAT | os.O_EXCL | os.O_WRONLY))
    except OSError as problem:
        reason = described(OSError(problem.errno, problem.strerror))
        raise UsageError(f"{option} {name}: no file can be written in {folder} ({reason})") from None
    with suppress(OSError):
        os.unlink(trial)
