"""Step functions: their states, what the process waits for in each, and where exceptions are handled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from cspdiag.base.record import record
from cspdiag.codegen.c.text.code import Aggregate, Atom, Code, call, code
from cspdiag.codegen.c.text.kernel import KERNEL
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.names import Names
from cspdiag.codegen.c.text.numbered import at_first, mentions_number, stride
from cspdiag.codegen.c.text.statements import (
    Blank,
    Block,
    Label,
    State,
    Statement,
    Switch,
    Wait,
    define,
    lines,
    mentions_self,
    return_value,
    signature,
    store,
    with_kernel,
)
from cspdiag.codegen.shared.trees import nodes

Waiting: TypeAlias = Literal[
    "NOTHING", "CALL", "READ", "WRITE", "ALTERNATIVE", "INPUTS", "OUTPUTS", "DELAY", "STOP", "PARALLEL", "INTERRUPT"
]


@dataclass
class Handler:
    """Where control goes if an exception is raised in a part of the composition. ``state`` and ``label`` name the same
    place in the step function, for the kernel and for ``goto``.
    """

    state: str
    label: str
    is_jumped_to: bool = False
    """Whether a ``goto`` to the label exists."""
    is_entered_by_kernel: bool = False
    """Whether a waiting state refers to it, so the kernel may continue there."""


@record
class WaitingState:
    """A state of a step function: what the process waits for, the member with that object, and the place in the source
    text.
    """

    state: str
    waiting: Waiting
    handler: Handler
    where: str
    member: Code | None = None
    indirect: bool = False
    inner: str | None = None
    """The path, below the class's own, of a process that was flattened into it."""


@record
class Section:
    """An inlined process: its first and its last statement in the body of a step function."""

    title: str
    where: str
    first: Statement
    last: Statement


@record
class Part:
    """A function with a part of a step function, which begins in ``state``."""

    name: str
    state: str
    body: list[Statement]


@dataclass
class Routine:
    """A step function. ``member`` is the ``csp_process`` of a branch of the composition; None for the process itself.
    ``number`` is the local variable for the number of the branch, if several branches in an array share the function.
    """

    name: str
    title: str
    """The name of the branch, which prefixes the names in it; empty for the process itself."""
    struct: str
    definition: str
    where: str
    member: str | None
    states: Names
    count: int | None = None
    """The number of branches that share the step function; None if they have no numbers."""
    number: str | None = None
    places: list[WaitingState] = field(default_factory=list)
    body: list[Statement] = field(default_factory=list)
    runs_into_failure: bool = False
    """Whether the body ends where the process fails, without a jump."""
    sections: list[Section] = field(default_factory=list)
    parts: list[Part] = field(default_factory=list)
    """Functions that the step function calls, if it is divided, and ..."""
    failing: list[Statement] = field(default_factory=list)
    """... what the process then does when it fails, which is also a function."""

    def __post_init__(self) -> None:
        self.outermost = Handler(self.states.fresh(f"{self.title}_fails".upper().lstrip("_")), "fails")

    def handler(self, state: str) -> Handler:
        """A new handler for exceptions."""
        name = self.states.fresh(state)
        return Handler(name, name.lower())

    def label(self, handler: Handler, where: str) -> list[Statement]:
        """The state and the label at which a handler begins, as far as they are used."""
        statements: list[Statement] = []
        if handler.is_entered_by_kernel:
            self.places.append(WaitingState(handler.state, "NOTHING", handler, where))
            statements.append(State(handler.state))
        if handler.is_jumped_to:
            statements.append(Label(handler.label))
        return statements

    @property
    def function(self) -> str:
        """The name of the step function."""
        return f"{self.name}_step"

    def table(self) -> list[str]:
        """The table of states, and the class."""
        start = Aggregate(((".waiting", code("CSP_AT_NOTHING")), (".where", code(quoted(self.where)))))
        entries = [("[0]", start), *((f"[{place.state}]", self._entry(place)) for place in self.places)]
        offset = code("0") if self.member is None else self._offset(code(f"{self.member}{self._first}"))
        fields = [
            (".step", code(self.function)),
            (".places", code(f"{self.name}_places")),
            (".name", code(quoted(self.definition))),
            (".where", code(quoted(self.where))),
            (".offset", offset),
        ]
        if self.number is not None:
            fields.append((".stride", code("sizeof(csp_numbered)")))
        fields.append((".states", call("CSP_STATES", f"{self.name}_places")))
        places = store(f"static const csp_place {self.name}_places[]", Aggregate(tuple(entries)))
        return lines([places, Blank(), store(f"static const csp_class {self.name}_class", Aggregate(tuple(fields)))])

    @property
    def _first(self) -> str:
        return "" if self.number is None else "[0]"

    def _offset(self, member: Code) -> Code:
        return call("offsetof", f"struct {self.struct}", member)

    def _entry(self, place: WaitingState) -> Aggregate:
        parts: list[tuple[str, Code]] = [(".waiting", code(f"CSP_AT_{place.waiting}"))]
        if place.indirect:
            parts.append((".indirect", code("true")))
        parts += [(".failed", code(place.handler.state)), (".where", code(quoted(place.where)))]
        if place.inner is not None:
            parts.append((".inner", code(quoted(place.inner))))
        if place.member is not None:
            parts.append((".offset", self._offset(at_first(place.member))))
            between = stride(self.struct, place.member)
            if between is not None:
                parts.append((".stride", between))
        return Aggregate(tuple(parts))

    def text(self) -> list[str]:
        """The step function, after its parts if it has any."""
        rows: list[str] = []
        if self.parts:
            failing = Block((*self.locals(self.failing), *self.failing))
            rows += [*self._signature(f"{self.name}_fails"), *lines([failing]), ""]
        for part in self.parts:
            rows += [*self._stepping(part.name, part.state, part.body), ""]
        return [*rows, *self._stepping(self.function, "0", self.body)]

    @staticmethod
    def _signature(name: str) -> list[str]:
        return signature(f"static csp_party *{name}", [KERNEL, "csp_party *party"])

    def _stepping(self, name: str, begin: str, body: list[Statement]) -> list[str]:
        """A function that begins, or continues, in the state of the process."""
        cases = ((f"case {begin}", tuple(body)), ("default", (return_value(call("csp_overwritten", "party")),)))
        switch = Switch(code("party->state"), cases)
        function = Block(with_kernel((*self.locals(body), switch)))
        return [*self._signature(name), *lines([function])]

    def locals(self, body: Sequence[Statement]) -> list[Statement]:
        """The definitions of the variables that statements use, and an empty line after them."""
        inside: list[Statement] = []
        if self.number is not None and (mentions_self(body) or mentions_number(body)):
            inside.append(define("const uint32_t", self.number, "CSP_NUMBER(party)"))
        if mentions_self(body):
            inside.append(define(f"struct {self.struct} *const", "self", self._enclosing()))
        used = {node for node in nodes(tuple(body)) if isinstance(node, Wait | Atom)}
        if any(isinstance(node, Wait) for node in used):
            inside.append(define("csp_progress", "progress"))
        if Atom("condition") in used:
            inside.append(define("bool", "condition"))
        return [*inside, *([Blank()] if inside else [])]

    def _enclosing(self) -> Code:
        struct = f"struct {self.struct}"
        if self.number is None:
            return call("CSP_ENCLOSING", "party", struct, self.member or "process")
        return call("CSP_ENCLOSING_ARRAY", "party", struct, self.member or "process", self.number)
