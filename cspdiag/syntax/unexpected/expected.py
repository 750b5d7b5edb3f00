"""The wording of what is allowed at a place."""

from __future__ import annotations

from cspdiag.syntax.parse.tables import END
from cspdiag.syntax.unexpected.situation import Situation

_CONTINUES_EXPRESSION = frozenset(
    ["+", "-", "*", "/", "%", "^", "==", "!=", "<", "<=", ">", ">=", "and", "or", ".", "["]
)

_NAMED_AFTER = {
    "CONST": "the name of the constant",
    "PARAMETER": "the name of the parameter",
    "TYPE": "the name of the type",
    "ENUM": "the name of the enum",
    "STRUCT": "the name of the struct",
    "EXCEPTION": "the name of the exception",
    "PROCESS": "the name of the process",
    "SUBMODEL": "the name of the submodel",
    "DRIVER": "the name of the driver",
    "ENVIRONMENT": "the name of the environment",
    "ASSERT": "the name of a process",
    "FOR": "a name",
    "REFINES": "the name of a process",
    "CATCH": "the name of an exception",
    "RAISE": "the name of an exception",
    "IN": "the name of a port",
    "OUT": "the name of a port",
    "LET": "a name",
    "STATE": "the name of the state",
    "NEXT": "the name of a state",
    "DER": "the name of a state",
    "VAR": "the name of the variable",
    "CHANNEL": "the name of the channel",
}

_GROUPS: tuple[tuple[set[str], set[str], str], ...] = (
    # terminals that must all be acceptable, terminals that are then not listed, wording
    (
        {"CONST", "PROCESS"},
        {
            "CONST", "PARAMETER", "TYPE", "ENUM", "STRUCT", "EXCEPTION", "PROCESS", "SUBMODEL", "DRIVER", "ENVIRONMENT",
            "ASSERT", "IMPORT",
        },
        "a definition",
    ),
    (
        {"SKIP", "MU"},
        {
            "SKIP", "MU", "WHILE", "IF", "SEQ", "PAR", "PRIPAR", "ALT", "PRIALT", "STOP", "WAIT", "RESET",
            "RAISE", "LPAR", "NAME", "WHEN", "AFTER",
        },
        "a process",
    ),
    ({"SKIP", "NAME", "LPAR"}, {"SKIP", "STOP", "WAIT", "RESET", "RAISE", "LPAR", "NAME"}, "a process"),
    ({"SKIP", "AFTER"}, {"SKIP", "AFTER", "WHEN", "NAME", "STOP"}, "a guard"),
    (
        {"NUMBER", "NAME"},
        {
            "NUMBER", "QUANTITY", "DURATION", "STRING", "TRUE", "FALSE", "NAME", "LPAR", "LSQB", "MINUS",
            "NOT", "IF",
        },
        "an expression",
    ),
    ({"VAR", "NAME"}, {"VAR", "CHANNEL", "FOR", "NAME", "UNDERSCORE"}, "a declaration"),
    ({"LET", "NAME"}, {"LET", "STATE", "NEXT", "DER", "NAME"}, "an equation"),
    ({"IN", "OUT"}, {"IN", "OUT"}, "a port"),
    ({"SYNC"}, {"SYNC", "BROADCAST", "ANY", "BUFFER", "OVERWRITE"}, "a kind of channel"),
    ({"SEMICOLON", "__OR__"}, set(), "an operator"),
)  # fmt: skip


def expected_words(situation: Situation) -> str:
    """What is allowed here: "a port, `communication` or `composition`"."""
    texts = situation.automaton.terminal_texts
    rest = situation.acceptable()
    words: list[str] = []
    for expected, covered, word in _GROUPS:
        if expected <= rest:
            words.append(word)
            rest -= covered
    if "NAME" in rest:
        words.append(_name_words(situation))
    if "STRING" in rest:
        words.append("a text in quotes")
    if "UNIT" in rest:
        words.append("a unit in angle brackets")
    rest -= {"NAME", "STRING", "UNIT", END}
    literal = sorted(texts.get(terminal, terminal) for terminal in rest)
    shown = [text for text in literal if text not in _CONTINUES_EXPRESSION]
    if len(shown) < len(literal) and len(literal) - len(shown) <= 3:
        shown = literal
    elif len(shown) < len(literal):
        words.append("an operator")
    words += [f"`{text}`" for text in shown]
    return _listed(words)


def _name_words(situation: Situation) -> str:
    before = situation.lexer.before.kind
    if before == situation.terminal(":"):
        return "a type" if situation.block() != "COMPOSITION" else "a name"
    return _NAMED_AFTER.get(before, "a name")


def _listed(words: list[str]) -> str:
    if not words:
        return "nothing more"
    *first, last = words
    return f"{', '.join(first)} or {last}" if first else last


def found_words(situation: Situation) -> str:
    """The present token, as it is called in messages."""
    match situation.kind:
        case "$END":
            return "the end of the file"
        case "STRING":
            return "a text in quotes"
        case "NUMBER" | "QUANTITY" | "DURATION":
            return f"the number `{situation.text}`"
        case _:  # Any other token is its own text.
            return f"`{situation.text}`"
