"""The changes of a file, as a unified difference."""

from __future__ import annotations

import re
import sys

from cspdiag.base.render.snippet import on_one_line, printable
from cspdiag.base.span import SourceFile
from cspdiag.cli.support.terminal import write_out


def show_difference(source: SourceFile, text: str, what: str) -> None:
    """Print the difference between a file and ``text``, which is the file ``what``, such as ``formatted``."""
    from difflib import unified_diff

    name = on_one_line(source.name)
    lines = unified_diff(_lines(source.text), _lines(text), name, f"{name} ({what})")
    difference = "".join(line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines)
    write_out(printable(difference) if sys.stdout.isatty() else difference)


def _lines(text: str) -> list[str]:
    """The lines with their ends, which are line feeds: comments may contain other characters that Python considers ends
    of lines.
    """
    return [line for line in re.split(r"(?<=\n)", text) if line]
