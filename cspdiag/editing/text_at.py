"""What a text says around an offset, by its tokens alone: for texts that cannot be read as a whole."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Literal, TypeAlias

from cspdiag.base.record import record
from cspdiag.base.span import SourceFile, Span

_DEFINITION = re.compile(
    r"^[ \t]*(?P<keyword>const|parameter|type|enum|struct|exception|process|submodel|driver|environment|assert|import)"
    r"\b(?:[ \t]+(?P<name>[A-Za-z_]\w*))?",
    re.MULTILINE | re.ASCII,
)
_TOKEN = re.compile(
    r"(?P<comment>//[^\n]*|/\*[\s\S]*?(?:\*/|\Z))|(?P<text>\"[^\"\n]*(?:\"|(?=\n)|\Z))|(?P<word>[A-Za-z_]\w*)"
    r"|(?P<number>\d[\w.]*)|(?P<sign>->|\|\|>?|\[\]>?|:=|[<>=!]=|\S)",
    re.ASCII,
)

TokenKind: TypeAlias = Literal["comment", "text", "word", "number", "sign"]


@record
class Token:
    """A token of a text, without its meaning."""

    kind: TokenKind
    text: str
    start: int

    @property
    def end(self) -> int:
        """The offset after it."""
        return self.start + len(self.text)


@record
class Outlined:
    """A definition as its first line says, up to ``end``, where the next one begins; ``name`` may be missing."""

    keyword: str
    name: str
    start: int
    end: int
    name_start: int


@record
class Declared:
    """A declaration in a definition that was recovered from its tokens: ``kind`` is its keyword, ``instance`` or
    ``label``, and ``type`` what follows its colon.
    """

    kind: str
    name: str
    type: str
    start: int


def tokens(source: SourceFile, start: int, end: int) -> list[Token]:
    """The tokens in a range."""
    found = []
    for match in _TOKEN.finditer(source.text, start, end):
        assert match.lastgroup is not None
        found.append(Token(match.lastgroup, match.group(), match.start()))  # type: ignore[arg-type]
    return found


def definitions(source: SourceFile) -> list[Outlined]:
    """The definitions of a text, each from its keyword to the next definition."""
    text = source.text
    matches = [match for match in _DEFINITION.finditer(text) if not _is_in_comment(text, match)]
    starts = [match.start() for match in matches]
    return [
        Outlined(
            match["keyword"],
            match["name"] or "",
            match.start("keyword"),
            end,
            match.start("name") if match["name"] else match.end("keyword"),
        )
        for match, end in zip(matches, [*starts[1:], len(text)], strict=False)
        if match["keyword"] not in {"import", "assert"}
    ]


def _is_in_comment(text: str, match: re.Match[str]) -> bool:
    opened = text.rfind("/*", 0, match.start())
    return opened >= 0 and text.rfind("*/", opened, match.start()) < 0 and "//" not in text[:opened].rsplit("\n")[-1]


def definition_at(source: SourceFile, offset: int) -> Outlined | None:
    """The definition that an offset is in."""
    found = [each for each in definitions(source) if each.start <= offset]
    return found[-1] if found else None


def declared_in(source: SourceFile, definition: Outlined) -> Iterator[Declared]:
    """The declarations in a definition, as far as its tokens show them."""
    words = [token for token in tokens(source, definition.start, definition.end) if token.kind != "comment"]
    depth = 0
    brackets = 0
    for position, token in enumerate(words):
        after = words[position + 1].text if position + 1 < len(words) else ""
        before = words[position - 1].text if position else ""
        brackets += (token.text in "([") - (token.text in ")]") if token.kind == "sign" else 0
        if token.kind == "sign" and token.text in "{}":
            depth += 1 if token.text == "{" else -1
        elif token.kind != "word" or position < 2:
            continue
        elif before in {"var", "channel", "let", "state"}:
            yield _declared(before, token, words, position)
        elif before in {"in", "out"} and after in {":", ",", "["}:
            yield from _ports(before, words, position)
        elif depth == 0 and brackets == 1 and before in {"(", ","} and after == ":":
            yield _declared("parameter", token, words, position)
        elif depth > 0 and brackets == 0 and before == "->" and after == ":":
            yield _declared("label", token, words, position)
        elif depth > 0 and brackets == 0 and _is_first_on_line(source, token) and after in {":", "["}:
            found = _declared("instance", token, words, position)
            if found.type[:1].isupper():
                yield found


def _is_first_on_line(source: SourceFile, token: Token) -> bool:
    return not source.text[source.text.rfind("\n", 0, token.start) + 1 : token.start].strip()


def _ports(direction: str, words: list[Token], position: int) -> Iterator[Declared]:
    kind = _type_after(words, position)
    while position < len(words) and words[position].kind == "word":
        yield Declared(direction, words[position].text, kind, words[position].start)
        position = _after_brackets(words, position + 1)
        if position >= len(words) or words[position].text != ",":
            return
        position += 1


def _declared(kind: str, token: Token, words: list[Token], position: int) -> Declared:
    return Declared(kind, token.text, _type_after(words, position), token.start)


def _after_brackets(words: list[Token], position: int) -> int:
    while position < len(words) and words[position].text == "[":
        while position < len(words) and words[position].text != "]":
            position += 1
        position += 1
    return position


def _type_after(words: list[Token], position: int) -> str:
    """The name after the next colon, with its unit."""
    for at in range(position, min(position + 12, len(words) - 1)):
        if words[at].text in {"=", "->", "{", "}"}:
            return ""
        if words[at].text == ":" and words[at + 1].kind == "word":
            name = words[at + 1].text
            if at + 2 < len(words) and words[at + 2].text == "<" and words[at + 2].start == words[at + 1].end:
                closing = next((word for word in words[at + 3 : at + 12] if word.text == ">"), None)
                unit = "".join(
                    word.text for word in words[at + 3 : at + 12][: _index(words[at + 3 : at + 12], closing)]
                )
                return f"{name}<{unit}>" if closing is not None else name
            return name
    return ""


def _index(words: list[Token], closing: Token | None) -> int:
    return len(words) if closing is None else words.index(closing)


def word_at(source: SourceFile, offset: int) -> Span:
    """The word around an offset, empty if there is none."""
    text = source.text
    start = end = offset
    while start > 0 and (text[start - 1].isalnum() or text[start - 1] == "_"):
        start -= 1
    while end < len(text) and (text[end].isalnum() or text[end] == "_"):
        end += 1
    return Span(source, start, end)


def written(declared: Declared) -> str:
    """A recovered declaration in the words of the language."""
    keyword = f"{declared.kind} " if declared.kind not in {"instance", "label", "parameter"} else ""
    return f"{keyword}{declared.name}{f' : {declared.type}' if declared.type else ''}"


@record
class Called:
    """An instance or a call whose arguments are being written: its name, the arguments named so far, the number of
    complete arguments, and the name of the present one if it has one.
    """

    name: str
    named: frozenset[str]
    count: int
    present: str | None


def called(before: Sequence[Token]) -> Called | None:
    """The innermost call or instance that is open after some tokens."""
    depth = 0
    for position in range(len(before) - 1, 0, -1):
        text = before[position].text
        if before[position].kind != "sign":
            continue
        if text in ")]":
            depth += 1
        elif text in "([" and depth:
            depth -= 1
        elif text == "(":
            callee = before[position - 1]
            return _called(callee.text, before[position + 1 :]) if callee.kind == "word" else None
        elif text in "{}":
            return None
    return None


def _called(name: str, inside: Sequence[Token]) -> Called:
    depth = count = 0
    named = set()
    present = None
    for position, token in enumerate(inside):
        depth += (token.text in "([") - (token.text in ")]") if token.kind == "sign" else 0
        if depth == 0 and token.text == ",":
            count += 1
            present = None
        if depth == 0 and token.text == "=" and position:
            present = inside[position - 1].text
            named.add(present)
    return Called(name, frozenset(named), count, present)


def is_in_unit(before: Sequence[Token]) -> bool:
    """Whether a unit is being written after some tokens, as in ``double<`` and ``2<V/``: there is no space before it,
    nor in it.
    """
    position = len(before) - 1
    while position > 0 and before[position].text != "<":
        token = before[position]
        if before[position - 1].end != token.start or (
            token.kind not in ("word", "number") and token.text not in "/*^-"
        ):
            return False
        position -= 1
    if position < 1 or before[position].text != "<" or before[position - 1].end != before[position].start:
        return False
    return before[position - 1].kind == "number" or before[position - 1].text in ("double", "float")


def reference_start(before: Sequence[Token], end: int) -> int:
    """The position at which a reference begins whose last token is before ``end``: that of ``cell`` for both
    ``cell[3].pose`` and ``cell[3].pose.``.
    """
    position = end - 1 if end > 0 and before[end - 1].text == "." else end
    while position > 0:
        position = _before_indexes(before, position) - 1
        if position < 0 or before[position].kind != "word" or position < 1 or before[position - 1].text != ".":
            break
        position -= 1
    return max(position, 0)


def _before_indexes(before: Sequence[Token], end: int) -> int:
    while end > 0 and before[end - 1].text == "]":
        while end > 0 and before[end - 1].text != "[":
            end -= 1
        end -= 1
    return end


def path_before(before: Sequence[Token]) -> list[str]:
    """The names that end in a point after some tokens, without indexes: ``["cell", "pose"]`` for ``cell[3].pose.``."""
    depth = 0
    path: list[str] = []
    for token in before[reference_start(before, len(before)) :]:
        depth += (token.text == "[") - (token.text == "]")
        if depth == 0 and token.kind == "word":
            path.append(token.text)
    return path
