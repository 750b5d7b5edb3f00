"""Text of the user in the files of a package that are not code: TOML and Markdown."""

from __future__ import annotations

import re

from cspdiag.base.render.snippet import printable
from cspdiag.codegen.shared.plain_text import one_line


def toml_string(text: str) -> str:
    """A basic string of TOML 1.0, on one line and in ASCII; lone surrogates, which TOML does not allow, become the
    replacement character.
    """
    return f'"{"".join(map(_toml_character, text))}"'


def _toml_character(character: str) -> str:
    code = ord(character)
    if character in '"\\':
        return f"\\{character}"
    if 0x20 <= code < 0x7F:
        return character
    if 0xD800 <= code < 0xE000:
        code = 0xFFFD
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def markdown_code(text: str) -> str:
    """A code span of Markdown, also for text that contains backquotes."""
    shown = one_line(text)
    fence = "`" * (max(map(len, re.findall("`+", shown)), default=0) + 1)
    blank = " " if shown.startswith("`") or shown.endswith("`") else ""
    return f"{fence}{blank}{shown}{blank}{fence}"


def markdown(text: str) -> str:
    """Paragraphs of a doc comment in Markdown. Text in backquotes stays code; nothing else becomes markup, HTML, a link
    or a list.
    """
    return "\n\n".join(map(_paragraph, printable(text).split("\n\n")))


_CODE_SPAN = re.compile(r"((?<!`)(`+)(?!`).+?(?<!`)\2(?!`))", re.DOTALL)
_MARKUP = re.compile(r"[\\*<|`~]|\](?=\()|&(?=#?\w)|(?<![A-Za-z0-9])_|_(?![A-Za-z0-9])")
_BLOCK = re.compile(r"^(\s*)(?=[#>+=-])|^(\s*\d+)(?=[.)])", re.MULTILINE)


def _paragraph(text: str) -> str:
    # Each code span gives two parts, itself and its fence, between texts.
    written = "".join(
        part.replace("|", "\\|") if position % 3 == 1 else _MARKUP.sub(r"\\\g<0>", part)
        for position, part in enumerate(_CODE_SPAN.split(text))
        if position % 3 != 2
    )
    return _BLOCK.sub(r"\g<0>\\", written)
