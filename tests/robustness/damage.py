"""Damages good programs at random."""

from __future__ import annotations

import re
from pathlib import Path

from hypothesis import strategies as st

ROOT = Path(__file__).parents[2]
PROGRAMS = sorted((ROOT / "models").glob("*/*.csp"))

_TOKEN = re.compile(r"\s+|//[^\n]*|\w+|\[\]>?|\|\|>?|->|:=|[<>=!]=|.", re.DOTALL)
_CHARACTERS = st.characters(codec="utf-8", exclude_characters="\0")
_SPLINTERS = [
    *[
        "(",
        ")",
        "{",
        "}",
        "[",
        "]",
        "<",
        ">",
        ";",
        ":",
        ",",
        ".",
        "?",
        "!",
        "@",
        "&",
        "=",
        "+",
        "-",
        "*",
        "/",
        "%",
        "^",
        '"',
        "_",
        "0",
        "1",
        "1e999",
        "-1",
        "9999999999999999999",
    ],
    *["||", "[]", "->", "[]>", "||>", ":=", "==", "/*", "*/", "//", "\n"],
    *[
        "process",
        "submodel",
        "environment",
        "driver",
        "in",
        "out",
        "communication",
        "composition",
        "mu",
        "until",
        "skip",
        "stop",
        "wait",
    ],
    *[
        "for",
        "par",
        "alt",
        "if",
        "then",
        "else",
        "catch",
        "interrupt",
        "raise",
        "reset",
        "let",
        "state",
        "next",
        "der",
        "import",
        "const",
        "type",
        "enum",
        "struct",
    ],
    *[
        "int",
        "double",
        "bool",
        "time",
        "true",
        "false",
        "sample",
        "pi",
        "1ms",
        "0Hz",
        "<V>",
        "<rad/s>",
        "[3]",
        "[0]",
        "[1000000000]",
        "i",
        "'x'",
        "é",
    ],
]


def _tokens(text: str) -> list[str]:
    return _TOKEN.findall(text)


@st.composite
def _token_damage(draw: st.DrawFn, text: str) -> str:
    tokens = _tokens(text)
    for _ in range(draw(st.integers(1, 4))):
        if not tokens:
            break
        at = draw(st.integers(0, len(tokens) - 1))
        match draw(st.sampled_from(["delete", "duplicate", "swap", "replace", "borrow", "cut"])):
            case "delete":
                del tokens[at : at + draw(st.integers(1, 3))]
            case "duplicate":
                tokens[at:at] = tokens[at : at + draw(st.integers(1, 20))]
            case "swap":
                other = draw(st.integers(0, len(tokens) - 1))
                tokens[at], tokens[other] = tokens[other], tokens[at]
            case "replace":
                tokens[at] = draw(st.sampled_from(_SPLINTERS))
            case "borrow":
                words = [token for token in tokens if token.isidentifier()]
                tokens[at] = draw(st.sampled_from(words)) if words else ""
            case "cut":
                del tokens[at:]
    return "".join(tokens)


@st.composite
def _character_damage(draw: st.DrawFn, text: str) -> str:
    characters = list(text)
    for _ in range(draw(st.integers(1, 5))):
        at = draw(st.integers(0, len(characters)))
        if draw(st.booleans()):
            characters[at:at] = draw(_CHARACTERS)
        else:
            del characters[at : at + draw(st.integers(1, 5))]
    return "".join(characters)


@st.composite
def damaged(draw: st.DrawFn) -> tuple[Path, str]:
    """A model of this repository by its path, and its text with a few tokens or characters damaged."""
    path = draw(st.sampled_from(PROGRAMS))
    text = path.read_text()
    return path, draw(st.one_of(_token_damage(text), _character_damage(text)))
