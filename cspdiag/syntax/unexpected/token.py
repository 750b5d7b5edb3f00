"""Explains why a token is not allowed in its place, in terms of the language, and how to continue reading.

Each function recognizes one kind of mistake: here those of single tokens, in ``structure.py`` those of blocks,
brackets and operator chains, in ``words.py`` those of single words, in ``defaults.py`` those of defaults, in
``habits.py`` forms of other languages. The first function that recognizes a situation explains it.
"""

from __future__ import annotations

from cspdiag.base.span import Span
from cspdiag.syntax.diagnostics.structure import KeywordAsName, UnexpectedText, WrongOperator
from cspdiag.syntax.unexpected import defaults as defaults
from cspdiag.syntax.unexpected import habits as habits
from cspdiag.syntax.unexpected import structure as structure
from cspdiag.syntax.unexpected import words as words
from cspdiag.syntax.unexpected.expected import expected_words, found_words
from cspdiag.syntax.unexpected.situation import Finding, Repair, Situation

_NEVER_MEANT_AS_NAMES = frozenset(
    [
        *("UNTIL", "DO", "THEN", "ELSE", "AND", "OR", "NOT", "IF", "MU", "WHILE", "WHEN", "IN", "OUT"),
        *("TRUE", "FALSE", "COMPOSITION", "COMMUNICATION", "FOR", "UNDERSCORE"),
    ]
)

_CALCULATIONS = frozenset("+-*/^")
_NUMBERS = frozenset(["NUMBER", "QUANTITY"])
_BEGIN_PROCESSES = frozenset(["WAIT", "SKIP", "STOP", "MU", "WHILE", "IF", "RESET", "RAISE", "SEQ", "PAR", "ALT"])
_LOOPS = frozenset(["loop", "repeat", "forever", "for"])

_DIRECTIONS = {"input": "in", "inport": "in", "output": "out", "outport": "out"}


def explain(situation: Situation) -> Finding:
    """The diagnostic for a situation, and how to continue."""
    if situation.text in situation.lexer.misused:
        # A keyword that was used as a name once is probably used as one everywhere.
        finding = _keyword_as_name(situation)
        if finding is not None:
            return finding
    for recognize in _MISTAKES:
        finding = recognize(situation)
        if finding is not None:
            return finding
    return UnexpectedText(situation.span, found_words(situation), expected_words(situation), _advice(situation)), None


def _advice(situation: Situation) -> str | None:
    """What was probably meant, if no function recognizes the mistake."""
    block = situation.block()
    if block == "COMPOSITION":
        return _advice_in_composition(situation)
    if block in {"COMMUNICATION", "ENVIRONMENT"} and (situation.text in _CALCULATIONS or situation.kind in _NUMBERS):
        return _advice_about_sources(situation)
    if situation.kind == "NAME" and situation.can(":"):
        return f"a type follows a colon: `: {situation.text}`"
    if situation.text == "<" and situation.can("UNIT"):
        return "a unit is written in angle brackets, without spaces: `<rad/s>`"
    if situation.can("=") and any(symbol == "STATE" for symbol, _ in situation.since_bracket()):
        return "a state has an initial value: `state s : double = 0`"
    if situation.kind == "NAME" and situation.lexer.before.kind == "NAME" and situation.can("("):
        return f"a call has its arguments in parentheses: `{situation.lexer.before.text}({situation.text})`"
    return None


def _advice_in_composition(situation: Situation) -> str | None:
    before = situation.lexer.before
    if before.text in _LOOPS or situation.text in _LOOPS or situation.kind == "DO":
        return "repetition is `mu P`, `mu P until condition` or `while condition do P`"
    if situation.text == "{":
        for word in ("do", "then"):
            if situation.can(word):
                return f"what follows the condition begins with `{word}` and is grouped by parentheses: `{word} (...)`"
        return "parentheses group processes: `mu (a ; b)`"
    if before.text == "?" and situation.kind != "NAME":
        return "what is read goes into a variable, declared in `communication`: `var x : bool`, then `port ? x`"
    if before.text == "+" and situation.text in {"+", "="}:
        return "a variable is counted up by an assignment: `n := n + 1`"
    begins_process = situation.kind in _BEGIN_PROCESSES or (situation.kind == "NAME" and before.kind == "NAME")
    if begins_process and situation.can(";"):
        return "an operator joins two processes: `;` in sequence, `||` in parallel"
    return None


def _advice_about_sources(situation: Situation) -> str | None:
    if situation.kind in _NUMBERS and not situation.can("VAR"):
        return None
    if situation.kind in _NUMBERS:
        return (
            "an arrow begins at a port or a variable: give a variable the value, `var x : double = 1`, and connect it"
        )
    return "arrows only connect: calculations belong in the equations of a submodel"


def _keyword_as_name(situation: Situation) -> Finding | None:
    text, kind = situation.text, situation.kind
    is_keyword = text.isidentifier() and kind != "NAME" and situation.terminal(text) == kind
    if not is_keyword or not situation.can("NAME") or structure.begins_part(situation):
        return None
    other_words_could_stand_here = situation.can("NUMBER") or situation.can("SKIP")
    is_known = text in situation.lexer.misused
    if other_words_could_stand_here and kind in _NEVER_MEANT_AS_NAMES and not is_known:
        return None
    return KeywordAsName(situation.span, text), Repair("replace", "NAME")


def _wrong_operator(situation: Situation) -> Finding | None:
    following = situation.source.text[situation.lexer.end : situation.lexer.end + 1]
    for found, expected, purpose in (
        ("=>", "->", "an arrow"),
        ("=", ":=", "an assignment in a composition"),
        ("=", "==", "a comparison"),
        (":=", "=", "a definition"),
        ("==", "=", "a definition"),
        (":=", "==", "a comparison"),
        ("&&", "and", "the logical operator"),
        ("||", "or", "the logical operator"),
        ("!", "not", "the logical operator"),
    ):
        whole = situation.text == found or (len(found) == 2 and situation.text + following == found)
        if whole and situation.can(expected) and (expected != "==" or defaults.is_comparison(situation)):
            end = situation.lexer.start + len(found)
            span = Span(situation.source, situation.lexer.start, end)
            wrong = WrongOperator(span, found, expected, purpose, replaced=span)
            return wrong, Repair("replace", situation.terminal(expected), end)
    return None


def _direction(situation: Situation) -> Finding | None:
    expected = _DIRECTIONS.get(situation.text)
    if expected is not None and situation.lexer.next_character().isalpha():
        span = situation.span
        repair = Repair("replace", situation.terminal(expected)) if situation.can(expected) else None
        return WrongOperator(span, situation.text, expected, "the direction of a port", replaced=span), repair
    before = situation.lexer.before
    expected = _DIRECTIONS.get(before.text)
    if expected is not None and situation.kind == "NAME" and situation.block() in {"SUBMODEL", "PROCESS", "DRIVER"}:
        span = situation.previous
        return WrongOperator(span, before.text, expected, "the direction of a port", replaced=span), None
    return None


def _chained_comparison(situation: Situation) -> Finding | None:
    if situation.text not in {"==", "!=", "<", "<=", ">", ">="}:
        return None
    if any(symbol == "comparison_operator" for symbol, _ in situation.since_bracket()):
        advice = "comparisons do not chain: write `a < b and b < c`"
        return UnexpectedText(situation.span, found_words(situation), "`and` or `or`", advice), None
    return None


_MISTAKES = (
    habits.conditional_equation,
    habits.ports_in_a_list,
    habits.operator_as_label,
    habits.operator_of_a_replication,
    structure.separator,
    structure.missing_process,
    structure.missing_arrow_end,
    _direction,
    structure.part_out_of_place,
    structure.unclosed,
    structure.closes_nothing,
    structure.operators_without_parentheses,
    words.without_period,
    defaults.default_out_of_place,
    habits.until_without_mu,
    _keyword_as_name,
    habits.counting,
    _wrong_operator,
    habits.choice,
    habits.call_of_a_library,
    habits.call_in_a_composition,
    words.number,
    words.unit,
    _chained_comparison,
    words.misspelled,
    words.run_together,
)
