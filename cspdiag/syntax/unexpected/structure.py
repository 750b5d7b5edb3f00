"""Mistakes in the structure of a text: blocks, brackets, arrows and operator chains."""

from __future__ import annotations

from cspdiag.base.edits import removing
from cspdiag.base.span import Span
from cspdiag.syntax.diagnostics.structure import (
    ArrowWithoutEnd,
    ParenthesesNeeded,
    Unclosed,
    UnexpectedText,
    WrongPlace,
)
from cspdiag.syntax.parse import recovery
from cspdiag.syntax.parse.recovery import begins_definition
from cspdiag.syntax.parse.tables import END
from cspdiag.syntax.unexpected.expected import found_words
from cspdiag.syntax.unexpected.situation import CLOSING, Finding, Repair, Situation

_OPERATORS = ("||>", "[]>", "||", "[]", ";")
"""Operators of compositions; none is a prefix of a later one."""

_PREFIXES = frozenset(["MU", "WHILE", "IF", "SEQ", "PAR", "PRIPAR", "ALT", "PRIALT", "WHEN"])
_POSTFIXES = frozenset(["CATCH", "INTERRUPT"])

_PARTS = {
    "IN": ("a port declaration", "ports come first in a process, submodel or driver, before everything else"),
    "OUT": ("a port declaration", "ports come first in a process, submodel or driver, before everything else"),
    "COMMUNICATION": ("`communication`", (
        "a process has at most one communication block, between its ports and its composition"
    )),
    "COMPOSITION": ("`composition`", "a process has at most one composition block, its last part"),
    "LET": ("an equation", "equations belong to submodels, after the ports"),
    "STATE": ("a state", "states belong to submodels, after the ports"),
    "NEXT": ("an equation", "equations belong to submodels, after the ports"),
    "DER": ("an equation", "equations belong to submodels, after the ports"),
    "VAR": ("a variable", (
        "variables are declared in the `communication` block of a process; a submodel has `let` and `state`"
    )),
    "CHANNEL": ("a channel", "channels are declared in the `communication` block of a process"),
    "FOR": ("`for`", "`for` repeats declarations of a `communication` block; a composition has `seq`, `par`, `alt`"),
}  # fmt: skip


def begins_part(situation: Situation) -> bool:
    """Whether the token is the keyword of a part of a definition, or of a definition, on a line of its own."""
    return begins_definition(situation.lexer) or recovery.begins_part(situation.lexer)


def separator(situation: Situation) -> Finding | None:
    """``;`` at the end of a declaration, ``,`` between the fields of a struct."""
    if situation.text not in {";", ","} or situation.block() == "COMPOSITION":
        return None
    bracket = situation.open_bracket()
    if bracket is not None and bracket[0] != "LBRACE":
        return None
    if situation.text == "," and situation.block() != "STRUCT":
        return None
    rule = "remove it: declarations need nothing between them"
    fix = removing(situation.span)
    return WrongPlace(situation.span, f"`{situation.text}`", rule, fix), Repair("remove")


def missing_process(situation: Situation) -> Finding | None:
    """A missing process between braces or parentheses, or after an operator of a composition."""
    if situation.kind not in {"RBRACE", "RPAR", END} or not situation.can("SKIP"):
        return None
    before = situation.lexer.before
    if before.text in _OPERATORS:
        advice = f"`{before.text}` joins two processes: remove it, or write the second one"
    else:
        advice = "`skip` is the process that does nothing"
    return UnexpectedText(situation.span, found_words(situation), "a process", advice), Repair("insert", "SKIP")


def missing_arrow_end(situation: Situation) -> Finding | None:
    """An arrow without a source or a sink."""
    if situation.block() not in {"COMMUNICATION", "ENVIRONMENT", "FOR"}:
        return None
    if situation.lexer.before.text == "->" and (situation.kind != "NAME") and situation.can("_"):
        if situation.kind.isalpha() and situation.text.isidentifier() and not begins_part(situation):
            return None
        if situation.text == "->" and not situation.lexer.first_on_line():
            return ArrowWithoutEnd(situation.previous, "sink"), Repair("remove")
        return ArrowWithoutEnd(situation.previous, "sink"), Repair("insert", situation.terminal("_"))
    if situation.text == "->" and situation.can("VAR"):
        return ArrowWithoutEnd(situation.span, "source"), None
    return None


def part_out_of_place(situation: Situation) -> Finding | None:
    """A declaration, an equation or a block in a place where it is not allowed."""
    if situation.kind == "NAME" and situation.block() == "PROCESS" and situation.lexer.first_on_line():
        begins = situation.automaton.restartable(situation.states[-1]) or situation.can("}")
        if begins and situation.lexer.next_character() in {":", "-", ",", ".", "["}:
            rule = "instances and arrows belong in the block `communication { ... }`"
            return WrongPlace(situation.span, "an instance or an arrow", rule), None
    if situation.kind not in _PARTS or not begins_part(situation) or not situation.can("}"):
        return None
    if situation.block() == "COMMUNICATION" and situation.kind == "COMPOSITION":
        return None
    return WrongPlace(situation.span, *_PARTS[situation.kind]), None


def unclosed(situation: Situation) -> Finding | None:
    """A bracket that is still open at the beginning of something that cannot be inside it."""
    bracket = situation.open_bracket()
    if bracket is None:
        return None
    kind, opening = bracket
    closing = CLOSING[kind]
    if not situation.can(closing):
        return None
    if kind == "LBRACE":
        is_composition_of_process = situation.kind == "COMPOSITION" and situation.block() == "COMMUNICATION"
        if situation.kind != END and not begins_definition(situation.lexer) and not is_composition_of_process:
            return None
    elif situation.kind not in {END, "RBRACE", "LBRACE", "RPAR", "RSQB"} and not situation.lexer.first_on_line():
        return None
    return Unclosed(situation.previous, closing, opening), Repair("insert", situation.terminal(closing))


def closes_nothing(situation: Situation) -> Finding | None:
    """A closing bracket without an opening one."""
    if situation.text not in CLOSING.values():
        return None
    if any(CLOSING.get(symbol) == situation.text for symbol, _ in situation.open_symbols()):
        return None
    return Unclosed(situation.span, situation.text, None), Repair("remove")


def operators_without_parentheses(situation: Situation) -> Finding | None:
    """Two operators in one chain, or a form with a single operand next to an operator."""
    if situation.text in _OPERATORS:
        return _mixed_operators(situation)
    before = situation.lexer.before
    if situation.kind in _PREFIXES and before.kind == "MU":
        advice = f"put what `mu` repeats in parentheses: `mu ({situation.text} ...) until ...`"
        return ParenthesesNeeded(situation.span, situation.text, "mu", situation.previous, advice), None
    for symbol, start in situation.since_bracket():
        word = situation.text_of(symbol)
        other = Span(situation.source, start, start + len(word))
        if symbol in _PREFIXES and situation.kind in _POSTFIXES:
            advice = f"put what comes before in parentheses: `({word} ...) {situation.text} ...`"
            return ParenthesesNeeded(situation.span, situation.text, word, other, advice), None
        if symbol in _POSTFIXES and situation.kind in _PREFIXES and before.text == "->":
            advice = f"put it in parentheses: `-> ({situation.text} ...)`"
            return ParenthesesNeeded(situation.span, situation.text, word, other, advice), None
    return None


def _mixed_operators(situation: Situation) -> Finding | None:
    symbols = list(situation.since_bracket())
    for position, (symbol, start) in enumerate(symbols):
        if not symbol.startswith("__composition") and situation.text_of(symbol) not in _OPERATORS:
            continue
        # The list of a chain starts at its first operator.
        operator = next((text for text in _OPERATORS if situation.source.text.startswith(text, start)), "")
        if not operator or operator == situation.text or position + 1 >= len(symbols):
            return None
        other = Span(situation.source, start, start + len(operator))
        before = situation.source.text[symbols[position + 1][1] : situation.lexer.before.end]
        shown = before if len(before) <= 60 and "\n" not in before else f"... {operator} ..."
        advice = f"put parentheses around one of them, for example `({shown}) {situation.text} ...`"
        return ParenthesesNeeded(situation.span, situation.text, operator, other, advice), None
    return None
