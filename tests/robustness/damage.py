"""Damages correct programs at random, in the same way for the same seed."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from random import Random

ROOT = Path(__file__).parents[2]
PROGRAMS = sorted(
    path
    for pattern in (
        "models/*/*.csp",
        "cspdiag/std/*.csp",
        "tests/conformance/programs/*.csp",
        "tests/codegen/programs/*.csp",
    )
    for path in ROOT.glob(pattern)
)

_TOKEN = re.compile(r"\s+|//[^\n]*|\w+|\[\]>?|\|\|>?|->|:=|[<>=!]=|.", re.DOTALL)
_WORDS = """
( ) { } [ ] < > ; : , . ? ! @ & = + - * / % ^ " _ 0 1 -1 2.5 1e999 9999999999999999999
|| [] -> []> ||> := == /* */ // <V> <rad/s> [3] [0] [1000000000] 1ms 0Hz 0x1F i 'x' é
process submodel environment driver in out communication composition for import
const type enum struct exception assert var channel state let next der safe immediate
mu while do until if then else par seq alt prialt pripar wait after skip stop when
catch interrupt raise reset broadcast any buffer overwrite sync Fault Timeout
int int8 double float bool time true false sample pi
"""
_SPLINTERS = (*_WORDS.split(), "\n")
_CHARACTERS = "\t\r\x00\x1b\u00a0\u00e9\u2028\u202e\ufeff\U0001f600"


@cache
def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


@cache
def _tokens(path: Path) -> tuple[str, ...]:
    return tuple(_TOKEN.findall(_text(path)))


def _part(random: Random, tokens: tuple[str, ...] | list[str], longest: int) -> list[str]:
    """Some consecutive tokens."""
    at = random.randrange(len(tokens))
    return list(tokens[at : at + random.randint(1, longest)])


def _replaced_name(random: Random, tokens: list[str], at: int) -> None:
    """Write another word of the program in place of the next word."""
    words = [token for token in tokens if token.isidentifier()]
    places = [place for place in range(at, len(tokens)) if tokens[place].isidentifier()]
    if places:
        tokens[places[0]] = random.choice(words)


def _replaced_number(random: Random, tokens: list[str], at: int) -> None:
    """Write another number in place of the next one."""
    places = [place for place in range(at, len(tokens)) if tokens[place].isdigit()]
    if places:
        tokens[places[0]] = random.choice(("0", "1", "2", "3", "7", "128", "65536", "9223372036854775807"))


def _damage_tokens(random: Random, path: Path) -> str:
    tokens = list(_tokens(path))
    for _ in range(random.randint(1, 4)):
        if not tokens:
            break
        at = random.randrange(len(tokens))
        match random.choice(("delete", "repeat", "swap", "splinter", "name", "number", "borrow", "cut")):
            case "delete":
                del tokens[at : at + random.randint(1, 3)]
            case "repeat":
                tokens[at:at] = _part(random, tokens, 20)
            case "swap":
                other = random.randrange(len(tokens))
                tokens[at], tokens[other] = tokens[other], tokens[at]
            case "splinter":
                tokens[at] = random.choice(_SPLINTERS)
            case "name":
                _replaced_name(random, tokens, at)
            case "number":
                _replaced_number(random, tokens, at)
            case "borrow":
                tokens[at:at] = _part(random, _tokens(random.choice(PROGRAMS)), 30)
            case "cut" if random.random() < 0.3:
                del tokens[at:]
    return "".join(tokens)


def _damage_characters(random: Random, path: Path) -> str:
    characters = list(_text(path))
    for _ in range(random.randint(1, 5)):
        at = random.randint(0, len(characters))
        if random.random() < 0.5:
            characters[at:at] = random.choice(_CHARACTERS) if random.random() < 0.3 else chr(random.randint(32, 126))
        else:
            del characters[at : at + random.randint(1, 5)]
    return "".join(characters)


def _damage_lines(random: Random, path: Path) -> str:
    lines = _text(path).splitlines(keepends=True)
    for _ in range(random.randint(1, 3)):
        at = random.randrange(len(lines)) if lines else 0
        match random.choice(("delete", "repeat", "move", "borrow")):
            case "delete":
                del lines[at : at + random.randint(1, 4)]
            case "repeat":
                lines[at:at] = lines[at : at + random.randint(1, 8)]
            case "move":
                other = random.randint(0, len(lines))
                lines[other:other] = lines[at : at + 1]
            case "borrow":
                lines[at : at + random.randint(0, 1)] = [
                    random.choice(_text(random.choice(PROGRAMS)).splitlines(keepends=True))
                ]
    return "".join(lines)


_KINDS = (
    ((";", "||", "||>", "[]", "[]>"), ()),
    (("+", "-", "*", "/", "%", "^"), ()),
    (("==", "!=", "<=", ">="), ()),
    (("sync", "any", "broadcast"), ("overwrite 1", "buffer 2")),
    (("skip", "stop"), ("wait 1 ms", "raise Fault", "(skip || skip)")),
    (("int", "double", "bool"), ("int8", "float", "time")),
    (("true", "false"), ()),
    (("and", "or"), ()),
    (("until",), ("until not",)),
    (("when",), ("when not",)),
    (("mu",), ("mu wait 1 ms ; mu", "")),
)
"""Words that may be exchanged for each other, and other replacements for them."""
_EXCHANGES = {word: words + others for words, others in _KINDS for word in words}


_MISTYPED = (
    "sqrt()", "[3] - 3", "min([1], 2)", "int([3])", "-true", "not 1.5", "convert()", "[1][true]", "true + 1",
    'if "a" < 3 then 1 else 2', "(if 1 then 2 else 3)", "3 ms - [1]", "Missing(a = 1).a", "double(true)",
)  # fmt: skip
"""Expressions that no place accepts, most of them of a type that is accepted there."""
_VALUE = re.compile(r"(?<=[=(] )[^,;={}()\n]+|(?<=\()[^,;={}()\n]+")


def _damage_values(random: Random, path: Path) -> str:
    """Write expressions of wrong types in place of values and arguments."""
    text = _text(path)
    for _ in range(random.randint(1, 2)):
        places = [found.span() for found in _VALUE.finditer(text)]
        if places:
            start, end = random.choice(places)
            text = text[:start] + random.choice(_MISTYPED) + text[end:]
    return text


def _damage_gently(random: Random, path: Path) -> str:
    """Exchange one or two words for others of their kind, so the result is usually still a program."""
    tokens = list(_tokens(path))
    for _ in range(random.randint(1, 2)):
        at = random.randrange(len(tokens))
        if random.random() < 0.2:
            _replaced_number(random, tokens, at)
            continue
        places = [place for place in range(at, len(tokens)) if tokens[place] in _EXCHANGES]
        if places:
            tokens[places[0]] = random.choice(_EXCHANGES[tokens[places[0]]])
    return "".join(tokens)


_DAMAGES: tuple[Callable[[Random, Path], str], ...] = (
    _damage_tokens,
    _damage_tokens,
    _damage_gently,
    _damage_gently,
    _damage_values,
    _damage_characters,
    _damage_lines,
)


def damaged(seed: int) -> tuple[Path, str]:
    """A program of this repository by its path, and its text with a few tokens, characters or lines damaged."""
    random = Random(seed)
    path = random.choice(PROGRAMS)
    return path, random.choice(_DAMAGES)(random, path)
