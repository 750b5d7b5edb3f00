"""Lines of finished C that are too long once the names of a program are in them, broken where a person would."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Sequence

from cspdiag.codegen.c.package.line_document import line_document
from cspdiag.codegen.c.text.code import LINE_LENGTH, STEP
from cspdiag.codegen.c.text.documents import comment
from cspdiag.codegen.shared.document import Fill, Nest, render

_NARROWEST = 40
"""Characters of a line of words, at least, however far a comment is indented."""
_PARAGRAPH = re.compile(r"(\s*)(?:/\*| \*) (\S.*)")
_SAMPLE = re.compile(r"(\s* \* {2,})(\S.*)")
"""A line of code in a comment."""
_WITH_REMARK = re.compile(r"(\s*)(\S.*?)\s*/\* (.*) \*/")


def folded(text: str) -> str:
    """The text, none of whose lines is longer than `LINE_LENGTH` unless a name or another word is."""
    rows = text.split("\n")
    if max(map(len, rows)) <= LINE_LENGTH:
        return text
    return "\n".join(_folded(rows))


def folded_script(text: str) -> str:
    """The same for comments in a file for make, CMake, or another tool in which they begin with `#`."""
    found: list[str] = []
    for row in text.split("\n"):
        if len(row) > LINE_LENGTH and row.startswith("# "):
            found += [f"# {line}" for line in textwrap.wrap(row[2:], LINE_LENGTH - 2, break_long_words=False)]
        else:
            found.append(row)
    return "\n".join(found)


def _folded(rows: Sequence[str]) -> Iterator[str]:
    at, in_comment, before = 0, False, ""
    while at < len(rows):
        found, taken = [rows[at]], 1
        if len(rows[at]) > LINE_LENGTH:
            found, taken = _comment(rows[at:]) if _is_comment(rows[at], in_comment) else (_code(rows[at], before), 1)
        yield from found
        at += taken
        before = found[-1]
        in_comment = before.rfind("/*") > before.rfind("*/") or (in_comment and "*/" not in before)


def _is_comment(row: str, in_comment: bool) -> bool:
    return in_comment or (row.lstrip().startswith("/* ") and "*/" not in row[:-2])


def _comment(rows: Sequence[str]) -> tuple[list[str], int]:
    """The paragraph of a comment that begins with the first row, laid out anew, and the number of its old rows."""
    sample = _SAMPLE.fullmatch(rows[0])
    if sample:
        margin = sample[1]
        document = line_document(sample[2], continues=False)
        return [f"{margin}{line}" for line in render(document, LINE_LENGTH - len(margin))], 1
    first = _PARAGRAPH.fullmatch(rows[0])
    if first is None:
        return [rows[0]], 1
    indent, words, taken = first[1], first[2], 1
    while not words.endswith("*/") and taken < len(rows):
        following = _PARAGRAPH.fullmatch(rows[taken])
        if following is None or following[2] == "/":
            break
        words += f" {following[2]}"
        taken += 1
    laid_out = _wrapped(words.removesuffix(" */"), indent)
    begin = f"{indent}/* " if rows[0].startswith(f"{indent}/*") else f"{indent} * "
    end = [f"{indent} */"] if words.endswith(" */") else []
    return [f"{begin}{laid_out[0]}", *(f"{indent} * {line}" for line in laid_out[1:]), *end], taken


def _wrapped(words: str, indent: str) -> list[str]:
    """Lines for a comment."""
    width = max(LINE_LENGTH - len(indent) - 3, _NARROWEST)
    return textwrap.wrap(words, width, break_long_words=False, break_on_hyphens=False)


def _code(row: str, before: str) -> list[str]:
    """The lines of a statement, a part of one, or a directive; a comment behind it goes above it."""
    if row.startswith("#"):
        *first, last = render(Nest(STEP, Fill(tuple(row.split(" ")))), LINE_LENGTH - 2)
        return [*(f"{line} \\" for line in first), last]
    with_remark = _WITH_REMARK.fullmatch(row)
    if with_remark:
        indent, code, remark = with_remark.groups()
        above = comment(_wrapped(remark, indent), indent)
        return [*above, *(_code(f"{indent}{code}", before) if len(indent + code) > LINE_LENGTH else [indent + code])]
    ended = not before.strip() or before.startswith("#") or before.endswith(("{", "}", ";", ":", "*/"))
    return render(line_document(row.strip(), continues=not ended), LINE_LENGTH, len(row) - len(row.lstrip()))
