"""``check --fix`` and ``check --diff``: shows corrections, or writes them to the files that they belong to."""

from __future__ import annotations

import os
import stat
from argparse import Namespace
from collections.abc import Sequence
from difflib import SequenceMatcher

from cspdiag.base.files.whole import replace_files
from cspdiag.base.render.snippet import on_one_line
from cspdiag.base.sources import STANDARD_INPUT, FileStyle, decoded, read_source
from cspdiag.base.span import LINE_END, SourceFile
from cspdiag.cli.support.diagnostic_formats import show_findings
from cspdiag.cli.support.difference import show_difference
from cspdiag.cli.support.failure import FINE, UNSUCCESSFUL, UsageError
from cspdiag.cli.support.terminal import say, write_out
from cspdiag.fix import FixedFile, fix

_FOR_PEOPLE = ("text", "concise")


def require_free_output(arguments: Namespace) -> None:
    """Raise UsageError if a difference or a program would share standard output with diagnostics in a format for
    machines.
    """
    if arguments.format in _FOR_PEOPLE:
        return
    if arguments.diff:
        raise UsageError(
            f"--diff prints the differences on standard output, where --format {arguments.format} writes, too"
        )
    if STANDARD_INPUT in arguments.files:
        raise UsageError(
            f"`check --fix -` prints the program on standard output, where --format {arguments.format} writes, too"
        )


def fix_files(sources: Sequence[SourceFile], arguments: Namespace) -> int:
    """Fix what can be fixed, or show how, and report the rest. The exit code reflects the rest, with ``--diff`` also
    differences.
    """
    fixed = fix(sources, read_source, _identity)
    names = [source.name for source in sources]
    if arguments.diff:
        for file in fixed.files:
            show_difference(file.before, file.text, "fixed")
            say(f"would fix {file.count} in {_shown(file)}")
        left = sum(found.severity == "error" for found in fixed.left)
        if left:
            say(f"{left} {'error is' if left == 1 else 'errors are'} left that only you can fix")
        return UNSUCCESSFUL if fixed.files or left else FINE
    _write(fixed.files)
    if STANDARD_INPUT in names:
        texts = {file.before.name: file.text for file in fixed.files}
        (read,) = (source for source in sources if source.name == STANDARD_INPUT)
        write_out(texts.get(STANDARD_INPUT, read.text))
    for file in fixed.files:
        say(f"fixed {file.count} in {_shown(file)}")
    show_findings(fixed.left, names, arguments)
    return UNSUCCESSFUL if any(found.severity == "error" for found in fixed.left) else FINE


def _shown(file: FixedFile) -> str:
    return "standard input" if file.before.name == STANDARD_INPUT else on_one_line(file.before.name)


def _identity(name: str) -> str:
    return name if name == STANDARD_INPUT else os.path.realpath(name)


def _write(files: Sequence[FixedFile]) -> None:
    """Write all files, or none if one of them cannot be written or has changed since it was read."""
    replace_files({file.before.name: _bytes(file) for file in files if file.before.name != STANDARD_INPUT})


def _bytes(file: FixedFile) -> bytes:
    """The new contents of a file, with the byte order mark and the line ends that it had. Raises UsageError if it
    cannot be replaced, or has changed since it was read.
    """
    name = file.before.name
    if not os.path.isfile(name):
        raise UsageError(f"{name}: is not a file that could be replaced; `check --fix -` reads and prints")
    if not os.access(name, os.W_OK) or not os.stat(name).st_mode & (stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH):
        raise UsageError(
            f"{name}: cannot be fixed, because it is read-only (`check --diff` shows the changes); nothing was written"
        )
    with open(name, "rb") as opened:
        data = opened.read()
    if decoded(data, name) != file.before.text:
        raise UsageError(f"{name}: was changed by another program meanwhile; nothing was written, try again")
    whole = data.decode()
    style = FileStyle.of(whole)
    return f"{style.mark}{_with_ends_of(whole.removeprefix(style.mark), file.text)}".encode()


def _with_ends_of(before: str, text: str) -> str:
    """``text`` with the line ends of ``before``.

    If that has both kinds, unchanged lines keep their own, and changed ones get that of the first line.
    """
    if "\r" not in before:
        return text
    old, old_ends = LINE_END.split(before), LINE_END.findall(before)
    new = text.split("\n")
    ends = [old_ends[0]] * (len(new) - 1)
    for at, start, length in SequenceMatcher(None, old, new, autojunk=False).get_matching_blocks():
        for k in range(min(length, len(ends) - start, len(old_ends) - at)):
            ends[start + k] = old_ends[at + k]
    return "".join(line + end for line, end in zip(new, [*ends, ""], strict=True))
