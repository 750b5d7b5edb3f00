"""The elements of a composition diagram: processes, and the relations that compose them.

A composition is a tree, so an element's ``key`` is the path to it: ``1`` is the root, ``1.2`` its second part. Chains
of one operator are one element, and so are a process with all its handlers, and an ``if`` with its ``else if``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal, TypeAlias, TypeVar

from cspdiag.base.record import record, replaced
from cspdiag.draw.elements.diagram import BoxKind, Element

ActivityForm: TypeAlias = Literal["run", "read", "write", "assign", "skip", "stop", "wait", "reset", "raise"]
GuardForm: TypeAlias = Literal["ready", "input", "output", "after", "skip"]
Operator: TypeAlias = Literal["sequence", "parallel", "alternative"]


@record(kw_only=True)
class Activity(Element):
    """A process without parts: an instance that is run, or a primitive; ``text`` is as written.

    ``kind``, ``definition`` and ``language`` (of a hand-written body) are those of the instance.
    """

    form: ActivityForm
    text: str
    kind: BoxKind = "process"
    definition: str | None = None
    language: str | None = None
    definition_doc: str | None = None


@record(kw_only=True)
class Chain(Element):
    """Processes joined by one operator, at least two; the branches of an alternative are guarded or replicated."""

    operator: Operator
    prioritized: bool = False
    parts: tuple[Composition, ...]


@record(kw_only=True)
class Guard(Element):
    """What a branch waits for: ``text`` (``port ? x``, ``after 5 ms``), and ``condition`` if it has a ``when``."""

    form: GuardForm
    text: str
    condition: str | None = None


@record(kw_only=True)
class Guarded(Element):
    """``guard -> process``."""

    guard: Guard
    process: Composition


@record(kw_only=True)
class Condition(Element):
    """What a loop tests: ``text`` is as written."""

    text: str


@record(kw_only=True)
class Loop(Element):
    """The μ-process, which tests ``condition`` after its body (None: never), or ``while``, which tests it before."""

    form: Literal["mu", "while"]
    process: Composition
    condition: Condition | None


@record(kw_only=True)
class Case(Element):
    """``if condition then process``."""

    condition: str
    process: Composition


@record(kw_only=True)
class Choice(Element):
    """``if``, any ``else if``, and ``otherwise`` after a last ``else``."""

    cases: tuple[Case, ...]
    otherwise: Composition | None


@record(kw_only=True)
class Handler(Element):
    """``catch exception -> process`` or ``interrupt guard -> process``: just one of the two is given."""

    exception: str | None = None
    guard: Guard | None = None
    process: Composition


@record(kw_only=True)
class Watched(Element):
    """A process and its handlers, from the inside out: a handler also covers those before it."""

    process: Composition
    handlers: tuple[Handler, ...]


@record(kw_only=True)
class Replication(Element):
    """``par i < n : process`` and the like; ``replicator`` is ``i < n``."""

    operator: Operator
    prioritized: bool = False
    replicator: str
    process: Composition


@record(kw_only=True)
class NamedGroup(Element):
    """``label: process``."""

    label: str
    process: Composition


@record(kw_only=True)
class Inside(Element):
    """An instance that shows its own composition: ``text`` is as written, ``definition`` its process."""

    text: str
    definition: str
    process: Composition


Composition: TypeAlias = Activity | Chain | Guarded | Loop | Choice | Watched | Replication | NamedGroup | Inside
Part: TypeAlias = Composition | Guard | Condition | Case | Handler
"""Everything in a composition diagram that has a key."""

PartT = TypeVar("PartT", bound=Part)


@record(kw_only=True)
class CompositionDiagram(Element):
    """The composition diagram of a process; ``key`` is its name, ``root`` None if it has no composition."""

    root: Composition | None

    def elements(self) -> Iterator[Part]:
        """All elements, each before its parts, in text order."""
        if self.root is not None:
            yield from walk(self.root)


def parts(element: Part) -> tuple[Part, ...]:
    """The parts of an element, in text order except for the condition of a loop, which comes last."""
    match element:
        case Activity() | Guard() | Condition():
            return ()
        case Chain():
            return element.parts
        case Guarded():
            return element.guard, element.process
        case Loop() if element.condition is not None:
            return element.process, element.condition
        case Loop() | Case() | Replication() | NamedGroup() | Inside():
            return (element.process,)
        case Choice():
            return element.cases if element.otherwise is None else (*element.cases, element.otherwise)
        case Handler():
            return (element.process,) if element.guard is None else (element.guard, element.process)
        case Watched():
            return element.process, *element.handlers


def rebuilt(element: PartT, key: str, inner: Sequence[Part]) -> PartT:
    """The element under another key and with other parts, in the order of ``parts``."""
    changes: dict[str, object] = {"key": key}
    match element:
        case Chain():
            changes["parts"] = tuple(inner)
        case Guarded():
            changes["guard"], changes["process"] = inner
        case Loop():
            changes["process"], changes["condition"] = inner[0], inner[1] if len(inner) > 1 else None
        case Case() | Replication() | NamedGroup() | Inside():
            (changes["process"],) = inner
        case Choice():
            changes["cases"] = tuple(part for part in inner if isinstance(part, Case))
            changes["otherwise"] = None if not inner or isinstance(inner[-1], Case) else inner[-1]
        case Handler(guard=None):
            (changes["process"],) = inner
        case Handler():
            changes["guard"], changes["process"] = inner
        case Watched():
            changes["process"], changes["handlers"] = inner[0], tuple(inner[1:])
        case _:  # The other elements have no parts.
            pass
    return replaced(element, **changes)


def walk(element: Part) -> Iterator[Part]:
    """An element and all below it, each before its parts."""
    yield element
    for part in parts(element):
        yield from walk(part)


OPERATORS: dict[tuple[Operator, bool], str] = {
    ("sequence", False): ";",
    ("parallel", False): "||",
    ("parallel", True): "||>",
    ("alternative", False): "[]",
    ("alternative", True): "[]>",
}
"""The symbol of an operator, by its name and whether it is prioritized."""


def sentence(element: Part) -> str:
    """The element in one line, without its parts."""
    match element:
        case Activity(form="run"):
            kind = "" if element.definition is None else f" : {element.definition} ({element.kind})"
            return f"run {element.text}{kind}"
        case Activity():
            return element.text if element.text.startswith(element.form) else f"{element.form} {element.text}"
        case Chain():
            return f"{element.operator} {OPERATORS[element.operator, element.prioritized]}"
        case Guard():
            condition = "" if element.condition is None else f"when {element.condition} & "
            return f"guard {element.form}: {condition}{element.text}"
        case Guarded():
            return "guarded"
        case Loop():
            return "while" if element.form == "while" else "mu" if element.condition is not None else "mu forever"
        case Condition():
            return f"condition {element.text}"
        case Case():
            return f"if {element.condition}"
        case Choice():
            return "choice" if element.otherwise is None else "choice with else"
        case Handler():
            return f"catch {element.exception}" if element.guard is None else "interrupt"
        case Watched():
            return "watched"
        case Replication():
            return f"replicated {OPERATORS[element.operator, element.prioritized]} {element.replicator}"
        case NamedGroup():
            return f"group {element.label}"
        case Inside():
            return f"inside {element.text} : {element.definition}"


def outline(diagram: CompositionDiagram) -> str:
    """All elements, one per line, indented by their depth: the contents of golden files."""
    lines = [f"composition of {diagram.key}"]
    lines += [f"{'  ' * (element.key.count('.') + 1)}{sentence(element)}" for element in diagram.elements()]
    return "\n".join(lines) + "\n"
