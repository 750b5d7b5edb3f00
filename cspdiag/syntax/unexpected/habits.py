"""Habits from other languages: forms that this language writes differently."""

from __future__ import annotations

import re

from cspdiag.base.diagnostic import Edit
from cspdiag.base.span import Span
from cspdiag.syntax.diagnostics.structure import KeywordAsName, UnexpectedText, WrongOperator, WrongPlace
from cspdiag.syntax.unexpected.situation import Finding, Repair, Situation

_REFERENCE = re.compile(r"[A-Za-z_][\w.\[\]]*\Z", re.ASCII)
_LEADS_AN_EXPRESSION = frozenset(
    ["=", ":=", "!", "(", "[", ",", "until", "while", "if", "then", "else", "wait", "after", "at", "when", "safe", "@"]
)
_CHOICE = re.compile(r"\?(?P<one>[^?:\n]+):(?P<other>[^?:;,\n(){}\]/]+(?:\([^()\n]*\))?)")
_CONDITIONAL_EQUATION = re.compile(
    r"if\b\s*(?P<condition>[^\n{}=]*?(?:[=!<>]=[^\n{}=]*?)?)\s*(?:\bthen\b)?\s*\{?\s*(?P<name>[A-Za-z_]\w*)\s*:?=(?P<one>[^=\n{};]+?);?\s*\}?"
    r"\s*\belse\b\s*\{?\s*(?P=name)\s*:?=(?P<other>[^=\n{};/]+);?(?P<brace>[^\S\n]*\})?",
    re.ASCII,
)
_UP_TO_ELSE = re.compile(r"if\b[^{}]*?\n\s*else\b")
_LIBRARY_OF_FUNCTIONS = re.compile(r"(?:[Mm]ath|cmath|np|numpy)\.(?P<function>[A-Za-z_]\w*)\Z", re.ASCII)
_PRINTING = frozenset(["print", "println", "printf", "puts", "log", "echo", "write", "writeln", "fprintf"])
_REPLICATED = frozenset(["SEQ", "PAR", "PRIPAR", "ALT", "PRIALT"])
_REPLICATIONS = {"||": "par", "||>": "pripar", ";": "seq", "[]": "alt", "[]>": "prialt"}
_REPLICATOR = re.compile(r"\s*[A-Za-z_]\w*\s*<[^:;{}\n]*:(?!=)", re.ASCII)
_CONDITION = re.compile(r"until\b(?P<condition>[^;()\n{}|\[\]]*)")
_AMOUNT = re.compile(r"[^\S\n]*[\w.]+(?=\s*[;)}])", re.ASCII)
_OPERATOR_OF_PROCESSES = re.compile(r";|\|\||\[\]")


def conditional_equation(situation: Situation) -> Finding | None:
    """``if x > 0 then y = 1 else y = 2`` instead of an equation."""
    if situation.kind != "IF" or situation.block() != "SUBMODEL" or not situation.can("LET"):
        return None
    text, start = situation.source.text, situation.lexer.start
    rule = "an equation says what its signal is at all times: write `y = if condition then ... else ...`"
    match = _CONDITIONAL_EQUATION.match(text, start)
    if match is None:
        match = _UP_TO_ELSE.match(text, start)
        repair = None if match is None else Repair("remove", end=match.end())
        return WrongPlace(situation.span, "`if`", rule), repair
    condition = _without_parentheses(match["condition"])
    meant = f"{match['name']} = if {condition} then {match['one'].strip()} else {match['other'].strip()}"
    rule = f"an equation says what its signal is at all times: write `{meant}`"
    opened = match.group().count("{") - match.group().count("}")
    end = match.start("brace") if match["brace"] and opened < 0 else match.end()
    return WrongPlace(situation.span, "`if`", rule), Repair("remove", end=end)


def _without_parentheses(condition: str) -> str:
    inner = condition[1:-1] if condition.startswith("(") and condition.endswith(")") else condition
    return condition if "(" in inner or ")" in inner else inner.strip()


def counting(situation: Situation) -> Finding | None:
    """``n++``, ``++n`` and ``n += 2``."""
    if situation.text not in {"+", "-", "*", "/"} or situation.block() != "COMPOSITION":
        return None
    text, start = situation.source.text, situation.lexer.start
    sign = situation.text
    following = text[start + 1 : start + 2]
    variable = _REFERENCE.search(text, max(0, start - 80), start)
    purpose = "a change of a variable"
    if following == "=" and situation.can(":=") and (variable := _before(situation)) is not None:
        span = Span(situation.source, variable.start(), start + 2)
        amount = _AMOUNT.match(text, start + 2)
        by = amount[0].strip() if amount else "..."
        whole = Span(situation.source, variable.start(), amount.end()) if amount else None
        meant = f"{variable[0]} := {variable[0]} {sign} {by}"
        wrong = WrongOperator(span, f"{variable[0]} {sign}=", meant, purpose, replaced=whole)
        return wrong, Repair("replace", situation.terminal(":="), start + 2)
    if following != sign or sign not in "+-":
        return None
    if variable is not None and situation.can(":="):
        span = Span(situation.source, variable.start(), start + 2)
        meant = f"{variable[0]} := {variable[0]} {sign} 1"
        wrong = WrongOperator(span, f"{variable[0]}{sign * 2}", meant, purpose, replaced=span)
        return wrong, Repair("remove", end=start + 2)
    name = re.compile(r"[A-Za-z_]\w*", re.ASCII).match(text, start + 2)
    if name is None or not situation.can("SKIP"):
        return None
    span = Span(situation.source, start, name.end())
    meant = f"{name[0]} := {name[0]} {sign} 1"
    wrong = WrongOperator(span, f"{sign * 2}{name[0]}", meant, purpose, replaced=span)
    return wrong, Repair("remove", end=start + 2)


def _before(situation: Situation) -> re.Match[str] | None:
    """The reference that ends with the previous token."""
    end = situation.lexer.before.end
    return _REFERENCE.search(situation.source.text, max(0, end - 80), end)


def choice(situation: Situation) -> Finding | None:
    """``condition ? one : other``."""
    if situation.text != "?" or not situation.can("+"):
        return None
    text, start = situation.source.text, situation.lexer.start
    match = _CHOICE.match(text, start)
    if match is None:
        return None
    begins = start
    for symbol, at in situation.open_symbols():
        if situation.text_of(symbol) in _LEADS_AN_EXPRESSION:
            break
        begins = at
    condition = text[begins:start].strip()
    if not condition or "\n" in condition:
        condition = "condition"
    span = Span(situation.source, start, start + 1)
    meant = f"if {condition} then {match['one'].strip()} else {match['other'].strip()}"
    return WrongOperator(span, "?", meant, "a choice between two values"), Repair("remove", end=match.end())


def ports_in_a_list(situation: Situation) -> Finding | None:
    """Ports with a type each, separated by commas."""
    if situation.text != "," or situation.block() not in {"PROCESS", "SUBMODEL", "DRIVER"} or not situation.can("IN"):
        return None
    bracket = situation.open_bracket()
    if bracket is None or bracket[0] != "LBRACE":
        return None
    text = situation.source.text
    direction = next((at for symbol, at in situation.since_bracket() if symbol == "direction"), None)
    if direction is None:
        # Complete declarations are one list; the last of them began with the last direction before the comma.
        words = list(re.finditer(r"\b(?:in|out)\b", text[bracket[1].end : situation.lexer.start]))
        direction = bracket[1].end + words[-1].start() if words else None
    if direction is None:
        return None
    word = "out" if text.startswith("out", direction) else "in"
    following = re.compile(r"[^,\n{}/]*").match(text, situation.lexer.end)
    assert following is not None
    rule = (
        f"every declaration begins with its direction: write `{word} {following[0].strip()}`; "
        "only names with the same type and period are listed before one colon"
    )
    line = text[text.rfind("\n", 0, direction) + 1 : direction]
    space = re.compile(r"\s*").match(text, situation.lexer.end)
    assert space is not None
    fix = Edit(Span(situation.source, situation.lexer.start, space.end()), f"\n{line if line.isspace() else ''}{word} ")
    return WrongPlace(situation.span, "`,`", rule, fix), Repair("replace", situation.terminal(word))


def call_of_a_library(situation: Situation) -> Finding | None:
    """``Math.sqrt(x)``."""
    if situation.text != "(" or not situation.can("+"):
        return None
    text, start = situation.source.text, situation.lexer.start
    match = _LIBRARY_OF_FUNCTIONS.search(text, max(0, start - 80), start)
    if match is None:
        return None
    end = _after_parenthesis(text, start)
    arguments = text[start:end] if end else "(...)"
    span = Span(situation.source, match.start(), start)
    wrong = WrongOperator(span, match[0], f"{match['function']}{arguments}", "a function of the language")
    return wrong, Repair("remove", end=end) if end else None


def call_in_a_composition(situation: Situation) -> Finding | None:
    """``print("x")``: a composition runs processes, and does not call functions."""
    before = situation.lexer.before
    adjacent = before.kind == "NAME" and before.end == situation.lexer.start
    if situation.text != "(" or situation.block() != "COMPOSITION" or not adjacent or situation.can("+"):
        return None
    if not situation.can(";") or before.text in {"loop", "repeat", "forever", "for"}:
        return None
    end = _after_parenthesis(situation.source.text, situation.lexer.start)
    if before.text.lower() in _PRINTING:
        advice = "a program does not print: `cspdiag run --trace` shows its communications, `--plot` the values"
    else:
        advice = (
            f"an instance runs by its name alone, `{before.text}`; its arguments belong to its declaration in "
            "`communication`, and functions to expressions"
        )
    wrong = UnexpectedText(Span(situation.source, before.start, end or before.end), "a call", "a process", advice)
    return wrong, Repair("remove", end=end) if end else None


def _after_parenthesis(text: str, start: int) -> int | None:
    """The offset after the parenthesis that closes the one at ``start``; None unless it is on the same line."""
    depth = 0
    for match in re.compile(r"[()\n]").finditer(text, start):
        if match[0] == "\n":
            return None
        depth += 1 if match[0] == "(" else -1
        if not depth:
            return match.end()
    return None


def operator_as_label(situation: Situation) -> Finding | None:
    """``seq : skip``: the keyword of a replicated operator as a label."""
    if situation.text != ":" or situation.lexer.before.kind not in _REPLICATED:
        return None
    return KeywordAsName(situation.previous, situation.lexer.before.text), None


def operator_of_a_replication(situation: Situation) -> Finding | None:
    """``|| i < n : cell[i]``: the operator in place of its keyword."""
    keyword = _REPLICATIONS.get(situation.text)
    if keyword is None or not situation.can(keyword):
        return None
    if _REPLICATOR.match(situation.source.text, situation.lexer.end) is None:
        return None
    wrong = WrongOperator(situation.span, situation.text, keyword, "a replicated composition", replaced=situation.span)
    return wrong, Repair("replace", situation.terminal(keyword))


def until_without_mu(situation: Situation) -> Finding | None:
    """``until`` where no ``mu`` is open, most often after the parentheses around one."""
    if situation.kind != "UNTIL" or situation.block() != "COMPOSITION" or not situation.can(";"):
        return None
    match = _CONDITION.match(situation.source.text, situation.lexer.start)
    condition = match["condition"].strip() if match else ""
    repeated = _in_parentheses_before(situation)
    whole = re.match(r"mu\s+(.*)\Z", repeated) if repeated else None
    if whole is not None and condition and not _OPERATOR_OF_PROCESSES.search(whole[1]):
        rule = (
            f"`until` belongs to a `mu`, and this one ends with its parenthesis: write `(mu {whole[1]} until "
            f"{condition})`"
        )
    else:
        rule = "`until` belongs to a `mu` and follows what it repeats: `mu (...) until condition`"
    return WrongPlace(situation.span, "`until`", rule), Repair(
        "remove", end=match.end()
    ) if condition and match else None


def _in_parentheses_before(situation: Situation) -> str | None:
    """The text in the parentheses that end before the present token, if it is on one line."""
    text, end = situation.source.text, situation.lexer.before.end
    depth = 0
    for at in range(end - 1, max(-1, end - 200), -1):
        depth += (text[at] == ")") - (text[at] == "(")
        if text[at] == "\n" or (depth == 0 and at == end - 1):
            return None
        if not depth:
            return text[at + 1 : end - 1].strip()
    return None
