"""Mistakes in single words: misspelled keywords, words of other languages, and numbers without digits on one side of
their point.
"""

from __future__ import annotations

import re

from cspdiag.base.span import Span
from cspdiag.base.spelling import Speller, edits, is_slip
from cspdiag.syntax.diagnostics.structure import UnexpectedText, WrongOperator, WrongPlace
from cspdiag.syntax.diagnostics.tokens import MissingUnitBrackets
from cspdiag.syntax.unexpected.expected import expected_words, found_words
from cspdiag.syntax.unexpected.situation import Finding, Repair, Situation

_SYNONYMS = {
    "variable": "var", "constant": "const", "enumeration": "enum", "structure": "struct", "record": "struct",
    "module": "process", "component": "process", "block": "submodel", "model": "submodel", "function": "submodel",
    "include": "import", "using": "import", "throw": "raise", "delay": "wait", "sleep": "wait", "elif": "else",
}  # fmt: skip
"""Keywords of other languages, for those of this one."""

_BEFORE_A_NAME = {
    "COMMUNICATION": ("var", "channel", "for"),
    "FOR": ("var", "channel", "for"),
    "ENVIRONMENT": ("for",),
    "SUBMODEL": ("let", "state", "next", "der"),
    "PROCESS": ("in", "out"),
    "DRIVER": ("in", "out"),
    "COMPOSITION": ("reset", "raise", "while", "when", "interrupt", "wait", "after", "at"),
}
"""The keywords that are followed by a name, by block."""

_AFTER_A_PERIOD = {
    "offset": "an offset follows the period to which it belongs: `@ 10 ms offset 2 ms`",
    "immediate": "`immediate` follows the period of an output: `@ 10 ms immediate`; "
    "without a period each value is written immediately",
}

_AFTER_A_KEYWORD = frozenset(["NAME", "NUMBER", "QUANTITY", "DURATION", "TRUE", "FALSE", "NOT", "LPAR"])

_NO_FRACTION = re.compile(r"(?<![A-Za-z0-9_.])[0-9]+\.\Z")
_HALVES = re.compile(r"[0-9]*[.,][0-9]*")
_HYPHENATED = re.compile(r"-(?P<word>[a-z]+)\b")
_BARE_UNIT = re.compile(r"[A-Za-z][A-Za-z0-9/*^]*")
_AFTER_NUMBER = re.compile(
    r"(?<![A-Za-z0-9_.])(?P<number>[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?)[ \t]*(?P<unit>[A-Za-z][A-Za-z0-9/*^]*)\Z"
)
_SPACED_UNIT = re.compile(
    r"(?P<number>[0-9][0-9.]*(?:[eE][+-]?[0-9]+)?)(?P<unit><[A-Za-z0-9/*^. -]* [A-Za-z0-9/*^. -]*>)"
)


def without_period(situation: Situation) -> Finding | None:
    """``in x : int offset 2 ms`` and ``out y : int immediate``: words that belong to a period."""
    rule = _AFTER_A_PERIOD.get(situation.text)
    if rule is None or situation.block() not in {"PROCESS", "DRIVER"}:
        return None
    return WrongPlace(situation.span, f"`{situation.text}`", rule), None


def misspelled(situation: Situation) -> Finding | None:
    """A word that resembles a keyword which is allowed here, or in the place of the previous word."""
    keywords = {text for terminal in situation.acceptable() if (text := situation.text_of(terminal)).isalpha()}
    meant = _keyword(situation.text, keywords) if situation.kind == "NAME" else None
    if meant is not None:
        found = UnexpectedText(
            situation.span,
            found_words(situation),
            expected_words(situation),
            f"did you mean `{meant}`?",
            meant if _is_surely(situation.text, meant) else None,
        )
        return found, Repair("replace", situation.terminal(meant))
    before = situation.lexer.before
    meant = _keyword(before.text, _BEFORE_A_NAME.get(situation.block(), ())) if before.kind == "NAME" else None
    if meant is None or situation.kind not in _AFTER_A_KEYWORD:
        return None
    sure = meant if _is_surely(before.text, meant) else None
    return UnexpectedText(situation.previous, f"`{before.text}`", f"`{meant}`", f"did you mean `{meant}`?", sure), None


def run_together(situation: Situation) -> Finding | None:
    """Two keywords written as one word, or with a hyphen between them: ``deadlockfree``, ``deadlock-free``."""
    before, following = situation.lexer.before, _HYPHENATED.match(situation.source.text, situation.lexer.start)
    if following is not None and situation.can(following["word"]) and before.end == situation.lexer.start:
        span = Span(situation.source, before.start, following.end())
        return _one_word(situation, span, f"{before.text} {following['word']}"), Repair("remove")
    if situation.kind != "NAME":
        return None
    actions, pairs = situation.automaton.tables.actions, dict[str, str]()
    for first in situation.acceptable():
        following_state = actions[situation.states[-1]][first]
        one = situation.text_of(first)
        for second in actions[following_state] if following_state >= 0 and one.isalpha() else ():
            other = situation.text_of(second)
            if other.isalpha():
                pairs[one + other] = f"{one} {other}"
    written = situation.text.replace("_", "").lower()
    meant = written if written in pairs else Speller().nearest(written, sorted(pairs))
    return None if meant is None else (_one_word(situation, situation.span, pairs[meant]), None)


def _one_word(situation: Situation, span: Span, meant: str) -> UnexpectedText:
    advice = f"did you mean `{meant}`?"
    return UnexpectedText(span, f"`{span.text}`", expected_words(situation), advice, meant)


def _is_surely(word: str, keyword: str) -> bool:
    """Whether only the keyword can be meant; a word of another language may be followed by more of that language."""
    is_shuffled = sorted(word.lower()) == sorted(keyword)
    return is_shuffled or is_slip(word, keyword) or (len(keyword) > 4 and edits(word.lower(), keyword) == 1)


def _keyword(word: str, keywords: set[str] | tuple[str, ...]) -> str | None:
    known = _SYNONYMS.get(word.lower())
    if known in keywords:
        return known
    return word.lower() if word.lower() in keywords else Speller().nearest(word, sorted(keywords))


def number(situation: Situation) -> Finding | None:
    """A number without digits on one side of its decimal point, or with a decimal comma."""
    before, lexer, text = situation.lexer.before, situation.lexer, situation.source.text
    if before.text == "." and (match := _NO_FRACTION.search(text, max(0, before.start - 40), before.end)) is not None:
        span = Span(situation.source, match.start(), match.end())
        wrong = WrongOperator(span, match.group(), f"{match.group()}0", "a number", replaced=span)
        return wrong, Repair("insert", "NAME")
    start = before.start if before.kind == "NUMBER" and before.end == lexer.start else lexer.start
    if start == lexer.start and situation.text not in {".", ","}:
        return None
    match = _HALVES.match(text, start)
    if match is None or match.end() <= lexer.start or not any(map(str.isdecimal, match.group())):
        return None
    found = match.group()
    whole, _, fraction = found.replace(",", ".").partition(".")
    if "," in found and not (whole and fraction):
        return None
    expected = f"{whole or 0}.{fraction or 0}"
    repair = Repair("remove", end=match.end())
    if start == lexer.start:
        if not situation.can("NUMBER"):
            return None
        repair = Repair("replace", "NUMBER", match.end())
    span = Span(situation.source, start, match.end())
    return WrongOperator(span, found, expected, "a number", replaced=span), repair


def unit(situation: Situation) -> Finding | None:
    """A unit without its brackets, or with spaces in it."""
    before = situation.lexer.before
    source = situation.source
    if before.kind == "NUMBER" and situation.kind == "NAME" and not situation.lexer.first_on_line():
        match = _BARE_UNIT.match(source.text, situation.lexer.start)
        if match is not None:
            span = Span(source, before.start, match.end())
            return MissingUnitBrackets(span, before.text, match.group()), Repair("remove", end=match.end())
    line_start = source.text.rfind("\n", max(0, before.end - 200), before.end) + 1
    match = _AFTER_NUMBER.search(source.text, line_start, before.end) if before.kind == "NAME" else None
    if match is not None:
        # The unit was taken for the name that begins the next declaration.
        span = Span(source, match.start(), match.end())
        return MissingUnitBrackets(span, match["number"], match["unit"]), None
    line_start = source.text.rfind("\n", max(0, situation.lexer.start - 200), situation.lexer.start) + 1
    for match in _SPACED_UNIT.finditer(source.text, line_start, situation.lexer.end + 80):
        if match.start() <= situation.lexer.start < match.end() + 1:
            span = Span(source, match.start(), match.end())
            return MissingUnitBrackets(span, match["number"], match["unit"][1:-1]), None
    return None
