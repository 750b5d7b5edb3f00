"""The tooltips of the elements of a composition diagram."""

from __future__ import annotations

from typing import assert_never

from cspdiag.draw.elements.composition import (
    Activity,
    Case,
    Chain,
    Choice,
    Condition,
    Guard,
    Guarded,
    Handler,
    Inside,
    Loop,
    NamedGroup,
    Operator,
    Part,
    Replication,
    Watched,
)
from cspdiag.draw.elements.texts import place_in_file

_CHAINS: dict[tuple[Operator, bool], str] = {
    ("sequence", False): "sequential: one after the other",
    ("parallel", False): "parallel: starts all, ends when all have ended",
    ("parallel", True): "prioritized parallel: the first has the highest priority",
    ("alternative", False): "alternative: one that is ready, in turn when several are",
    ("alternative", True): "prioritized alternative: the first that is ready",
}


def chain_words(operator: Operator, prioritized: bool) -> str:
    """The meaning of an operator."""
    return _CHAINS[operator, prioritized]


def step_tooltip(element: Part) -> str:
    """What an element is, its doc comment, and its place in the text."""
    place = place_in_file(element.spans[0]) if element.spans else ""
    return "\n".join(part for part in (_words(element), *_docs(element), place) if part)


def _docs(element: Part) -> list[str]:
    docs = [element.doc, element.definition_doc] if isinstance(element, Activity) else [element.doc]
    return [" ".join(doc.split()) for doc in docs if doc]


def _words(element: Part) -> str:
    match element:
        case Activity(form="run"):
            definition = "" if element.definition is None else f" : {element.definition}"
            language = "" if element.language is None else f", hand-written in {element.language}"
            return f"{element.kind} {element.text}{definition}{language}"
        case Activity():
            return element.text
        case Chain():
            return chain_words(element.operator, element.prioritized)
        case Guard():
            return element.text if element.condition is None else f"when {element.condition} & {element.text}"
        case Guarded():
            return "guarded process"
        case Loop():
            if element.condition is None:
                return "repeats forever"
            return f"{'while' if element.form == 'while' else 'repeats until'} {element.condition.text}"
        case Condition():
            return f"condition {element.text}"
        case Case():
            return f"if {element.condition}"
        case Choice():
            return "choice by conditions"
        case Handler():
            return "interrupt" if element.guard is not None else f"catch {element.exception}"
        case Watched():
            return "process with what can end it"
        case Replication():
            return f"for {element.replicator}, {chain_words(element.operator, element.prioritized)}"
        case NamedGroup():
            return f"group {element.label}"
        case Inside():
            return f"process {element.text} : {element.definition}"
        case _:
            assert_never(element)
