"""Step functions: their states, what each waits for, and where exceptions go."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from cspdiag.base.record import record
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.names import Names
from cspdiag.codegen.c.text.rows import Row, block, lines, rows

Waiting: TypeAlias = Literal[
    "NOTHING", "CALL", "READ", "WRITE", "ALTERNATIVE", "INPUTS", "OUTPUTS", "DELAY", "STOP", "PARALLEL", "INTERRUPT"
]


@dataclass
class Handler:
    """What an exception does that is raised within an extent of the composition: ``state`` and ``label`` are the same place."""

    state: str
    label: str
    reached: bool = False
    """Whether anything can get there by ``goto``."""
    needed: bool = False
    """Whether a place names it, so that the kernel can get there."""


@record
class Place:
    """A state of a step function: what it waits for there, the member with the object, and the line of the program."""

    state: str
    waiting: Waiting
    handler: Handler
    where: str
    member: str | None = None
    indirect: bool = False
    inner: str | None = None
    """The path, below the class's own, of a process that was flattened into it."""


@dataclass
class Routine:
    """A step function. ``member`` is the ``csp_process`` of a branch of the composition; None for the process itself."""

    name: str
    struct: str
    definition: str
    where: str
    member: str | None
    states: Names
    places: list[Place] = field(default_factory=list)
    body: list[Row] = field(default_factory=list)
    progress: bool = False
    condition: bool = False

    def __post_init__(self) -> None:
        self.outermost = Handler(self.states.fresh("FAILS"), "fails")

    def handler(self, state: str) -> Handler:
        """A new place for exceptions to go to."""
        name = self.states.fresh(state)
        return Handler(name, name.lower())

    def label(self, handler: Handler, where: str) -> list[Row]:
        """Where the handler begins."""
        found: list[Row] = []
        if handler.needed:
            self.places.append(Place(handler.state, "NOTHING", handler, where))
            found.append(Row(f"case {handler.state}:", -1))
        if handler.reached:
            found.append(Row(f"{handler.label}:", -1))
        return found

    @property
    def function(self) -> str:
        """The name of the step function."""
        return f"{self.name}_step"

    def table(self) -> list[str]:
        """The table of places and the class."""
        entries = [f"[0] = {{.waiting = CSP_AT_NOTHING, .where = {quoted(self.where)}}}"]
        entries += [f"[{place.state}] = {{{', '.join(self._fields(place))}}}" for place in self.places]
        head = [Row(f"{entry},") for entry in entries[:-1]] + [Row(entries[-1])]
        offset = "0" if self.member is None else f"offsetof(struct {self.struct}, {self.member})"
        fields = [
            f".step = {self.function}",
            f".places = {self.name}_places",
            f".name = {quoted(self.definition)}",
            f".where = {quoted(self.where)}",
            f".offset = {offset}",
        ]
        values = [Row(f"{text},") for text in fields[:-1]] + [Row(fields[-1])]
        return [
            *lines(block(f"static const csp_place {self.name}_places[] =", head, "};")),
            "",
            *lines(block(f"static const csp_class {self.name}_class =", values, "};")),
        ]

    def _fields(self, place: Place) -> list[str]:
        parts = [f".waiting = CSP_AT_{place.waiting}"]
        if place.indirect:
            parts.append(".indirect = true")
        parts.append(f".failed = {place.handler.state}")
        parts.append(f".where = {quoted(place.where)}")
        if place.inner is not None:
            parts.append(f".inner = {quoted(place.inner)}")
        if place.member is not None:
            parts.append(f".offset = offsetof(struct {self.struct}, {place.member})")
        return parts

    def text(self) -> list[str]:
        """The step function."""
        struct, enclosing = self.struct, f"CSP_ENCLOSING(party, struct {self.struct}, {self.member})"
        own = f"(struct {struct} *)(void *)party" if self.member is None else enclosing
        uses_self = any("self->" in row.text for row in self.body)
        inside = rows(f"struct {struct} *const self = {own};") if uses_self else []
        if self.progress:
            inside += rows("csp_progress progress;")
        if self.condition:
            inside += rows("bool condition;")
        if inside:
            inside.append(Row(""))
        inside += [Row("switch (party->state) {"), Row("case 0:"), *indented(self.body)]
        inside += [Row("default:"), Row("return NULL;", 1), Row("}")]
        return lines([Row(f"static csp_party *{self.function}(csp_party *party)"), *block("", inside)])


def indented(body: Sequence[Row]) -> list[Row]:
    """Statements one deeper than labels."""
    return [Row(row.text, row.depth + 1, row.comment) for row in body]
