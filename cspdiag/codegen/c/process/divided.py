"""Long step functions in parts: each process that was inlined at the top of one gets a function of its own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cspdiag.base.record import record
from cspdiag.codegen.c.process.routines import Part, Routine, Section, WaitingState
from cspdiag.codegen.c.text.code import CSP, Atom, Call, Code, cast, code
from cspdiag.codegen.c.text.names import identifier, snake_case
from cspdiag.codegen.c.text.statements import (
    Goto,
    Label,
    State,
    Statement,
    Wait,
    goto,
    jumps_to,
    return_value,
    store,
)
from cspdiag.codegen.shared.trees import nodes

LONGEST = 120
"""The largest number of lines of a step function that stays whole."""


@record
class _Piece:
    """What the function of a section consists of: its statements, and those up to the next section."""

    section: Section
    body: tuple[Statement, ...]


def divide(routine: Routine) -> None:
    """Divides a step function that is too long; one that has no inlined processes, or jumps between them, stays as it
    is. A part ends by returning its own process, which the kernel then runs on in the state in which the next one
    begins.
    """
    if len(routine.sections) < 2 or routine.number is not None or len(routine.text()) <= LONGEST:
        return
    found = _pieces(routine)
    if found is None:
        return
    before, pieces, failing = found
    outermost = routine.outermost
    failed = f"{routine.name}_fails"
    routine.failing = failing
    begins = [routine.states.fresh(f"{snake_case(identifier(piece.section.title))}_begins".upper()) for piece in pieces]
    ends = routine.states.fresh(f"{routine.title or routine.name}_ends".upper())
    last = pieces[-1]
    tail = [*last.body[_after(last) :], *([goto(outermost.label)] if routine.runs_into_failure else [])]
    cases: list[Statement] = []
    for position, piece in enumerate(pieces):
        name = f"{routine.name}_{snake_case(identifier(piece.section.title))}"
        inside = piece.body if piece is not last else piece.body[: _after(last)]
        following = begins[position + 1] if piece is not last else ends
        body = [*inside, *_continue_in(following)]
        if jumps_to(outermost.label, body):
            body += [Label(outermost.label), return_value(_called(failed))]
        routine.parts.append(Part(routine.states.fresh(name), begins[position], body))
        routine.places.append(WaitingState(begins[position], "NOTHING", outermost, piece.section.where))
        cases += [*map(State, [begins[position], *_states(inside)]), return_value(_called(routine.parts[-1].name))]
    routine.places.append(WaitingState(ends, "NOTHING", outermost, routine.where))
    if not outermost.is_entered_by_kernel:
        outermost.is_entered_by_kernel = True
        routine.places.append(WaitingState(outermost.state, "NOTHING", outermost, routine.where))
    whole = [*before, *_continue_in(begins[0]), *cases, State(ends), *tail, State(outermost.state)]
    if jumps_to(outermost.label, whole):
        whole.append(Label(outermost.label))
    routine.body = [*whole, return_value(_called(failed))]


def _continue_in(state: str) -> list[Statement]:
    """Continues in another state, in which another function runs the process."""
    return [store("party->state", cast("uint16_t", code(state))), return_value("party")]


def _called(function: str) -> Code:
    return Call(function, (CSP, Atom("party")))


def _pieces(routine: Routine) -> tuple[list[Statement], list[_Piece], list[Statement]] | None:
    """What comes before the first section, the sections, and what the process does when it fails; None if a jump leads
    from one of these to another.
    """
    body = routine.body
    end = next((place for place, each in enumerate(body) if each == Label(routine.outermost.label)), None)
    places = [(section, _position(body, section.first)) for section in routine.sections]
    known = [(section, place) for section, place in places if place is not None]
    if end is None or len(known) < 2:
        return None
    failing = body[end + 1 :]
    before_end = end - (body[end - 1] == State(routine.outermost.state))
    bounds = [*(place for _, place in known), before_end]
    before = body[: bounds[0]]
    pieces = [
        _Piece(section, tuple(body[place : bounds[position + 1]])) for position, (section, place) in enumerate(known)
    ]
    apart = [tuple(before), *(piece.body for piece in pieces), tuple(failing)]
    if any(not _stays_inside(part, routine.outermost.label) for part in apart):
        return None
    return before, pieces, failing


def _position(body: Sequence[Statement], wanted: Statement) -> int | None:
    return next((place for place, each in enumerate(body) if each is wanted), None)


def _after(piece: _Piece) -> int:
    """The position after the last statement of the section itself."""
    found = _position(piece.body, piece.section.last)
    assert found is not None
    return found + 1


def _stays_inside(part: Sequence[Statement], outermost: str) -> bool:
    """Whether no statement jumps out of a part, except to where the process fails."""
    own = {node.name for node in nodes(tuple(part)) if isinstance(node, Label)}
    return set(_targets(part)) <= own | {outermost}


def _targets(part: Sequence[Statement]) -> Iterator[str]:
    for node in nodes(tuple(part)):
        if isinstance(node, Goto):
            yield node.label
        elif isinstance(node, Wait):
            yield str(_arguments(node)[-1])


def _states(part: Sequence[Statement]) -> Iterator[str]:
    for node in nodes(tuple(part)):
        if isinstance(node, State):
            yield node.name
        elif isinstance(node, Wait):
            yield str(_arguments(node)[-2])


def _arguments(wait: Wait) -> tuple[Code, ...]:
    assert isinstance(wait.code, Call)
    return wait.code.arguments
