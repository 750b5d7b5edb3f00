"""Text of the user in generated Python: it is quoted so that it has no effect and keeps its meaning."""

from __future__ import annotations

import re

from cspdiag.codegen.shared.plain_text import one_line


def quoted(text: str) -> str:
    """A string literal in double quotes, in ASCII."""
    escaped = text.encode("unicode_escape").decode("ascii").replace('"', '\\"')
    return f'"{escaped}"'


def remark(text: str) -> str:
    """The text of a comment: Python ends a comment at a carriage return, too."""
    return one_line(text)


def docstring(text: str, indent: str) -> list[str]:
    """The lines of a docstring; if there is more than one, the closing quotes are on a line of their own."""
    opening, written = _docstring(text.strip())
    rows = [row.rstrip() for row in written.split("\n")]
    if len(rows) == 1:
        return [f'{indent}{opening}{rows[0]}"""']
    return [f"{indent}{opening}{rows[0]}", *(f"{indent}{row}" if row else "" for row in rows[1:]), f'{indent}"""']


def _docstring(text: str) -> tuple[str, str]:
    """The opening quotes of a docstring, and its text with as few escapes as possible."""
    is_visible = all(row.isprintable() for row in text.split("\n"))
    if is_visible and '"""' not in text and not text.endswith(('"', "\\")):
        return ('r"""' if "\\" in text else '"""'), text
    escaped = re.sub(r'"(?="|\Z)', r"\"", text.replace("\\", "\\\\"))
    return '"""', "".join(_escaped(character) for character in escaped)


def _escaped(character: str) -> str:
    if character == "\n" or character.isprintable():
        return character
    if "\ud800" <= character <= "\udfff":
        # A string may contain a lone surrogate, the docstring of a class may not.
        return "\N{REPLACEMENT CHARACTER}"
    return character.encode("unicode_escape").decode("ascii")
