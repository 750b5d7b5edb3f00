"""Text from outside in generated C: in string literals, and in comments."""

from __future__ import annotations

import re

from cspdiag.codegen.shared.plain_text import one_line

_PLAIN = re.compile(r"[ !#-\[\]-~]*")
"""Printable ASCII without quotation marks and backslashes."""


def quoted(text: str) -> str:
    """A string literal with the text in UTF-8 and without trigraphs. Bytes of a file name that are not UTF-8 are kept
    as they are.
    """
    if _PLAIN.fullmatch(text) and "??" not in text:
        return f'"{text}"'  # The names of many processes and channels are.
    written = re.sub(r"(?<=\?)\?", r"\?", "".join(map(_character, text)))
    return f'"{written}"'


def _character(character: str) -> str:
    if character in '"\\':
        return f"\\{character}"
    if character.isprintable():
        return character
    is_byte = 0xDC80 <= ord(character) <= 0xDCFF
    encoded = character.encode("utf-8", "surrogateescape" if is_byte else "replace")
    return "".join(f"\\{byte:03o}" for byte in encoded)


def in_comment(text: str) -> str:
    """A text on one line for use in a comment: it neither ends the comment nor seems to begin another."""
    return one_line(text).replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?")
