"""What a thread offers where it waits: the edges out of a configuration."""

from __future__ import annotations

from typing import Any

from cspdiag.network.dump.expression import expression_text
from cspdiag.network.ir.actions import ChannelEnd, Choice, ParallelSteps, PortEnd, ReadValue, StopStep, WaitStep
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import Connection
from cspdiag.proofs.transitions.abandoning import Abandoning, is_point
from cspdiag.proofs.transitions.facts import FAULT, TIMEOUT
from cspdiag.proofs.transitions.program import Node
from cspdiag.proofs.transitions.specifications import is_time_out
from cspdiag.proofs.transitions.systems.template import INTERNAL_LABEL, Reference
from cspdiag.proofs.transitions.threads.communications import MISSED, Move, assigning
from cspdiag.proofs.transitions.threads.computing import RISK
from cspdiag.proofs.transitions.threads.follow import Follower
from cspdiag.proofs.transitions.threads.joining import LawParallels, fork_edges, join_edges
from cspdiag.proofs.transitions.threads.law_steps import constant_output
from cspdiag.proofs.transitions.threads.thread import Configuration, Context, Frame, Stack, Thread
from cspdiag.proofs.transitions.values import UNKNOWN, Known

_AT_ONCE = 4
"""With more communications at once than that, each has a component of its own instead of all orders in one."""


class Offers(Abandoning):
    """The edges of one thread."""

    def __init__(self, thread: Thread, follower: Follower) -> None:
        super().__init__(thread, follower)
        self.laws = LawParallels(thread, follower)

    def moves(self, c: Configuration) -> list[Move]:
        """All edges out of a settled configuration; what they lead to is not settled."""
        assert c.stack is not None
        frame, rest = c.stack
        if is_point(frame) and self.is_abandoned_at_once(rest):
            return self.interruptions(c, frame)
        found = self._own(c, frame, rest)
        if is_point(frame) or (frame[0] == "join" and frame[3] == "wait"):
            found += self.interruptions(c, frame)
        if self.thread.role.cancellable and not c.doomed:
            found += self.cancellation(c, frame)
        return found

    def _own(self, c: Configuration, frame: Frame, rest: Stack) -> list[Move]:
        match frame[0]:
            case "run":
                return self._action(c, frame[1], frame[2], rest)
            case "put":
                return [(self.written(frame[1], frame[2]), self.delivering(frame[1], frame[3], c._replace(stack=rest)))]
            case "delivering":
                return [(("delivered", frame[1]), c._replace(stack=rest))]
            case "withdrawing":
                return [(("withdrawn", frame[1]), c._replace(stack=rest))]
            case "choice":
                return self._choice(c, frame, rest)
            case "picking":
                return self._picking(c, frame, rest)
            case "reading":
                return self._reading(c, frame, rest)
            case "writing":
                return self._writing(c, frame, rest)
            case "join":
                return join_edges(self.thread, self.follower, c, frame, rest)
            case "guard only":
                _, node, context, value = frame
                branch = node.action.branch
                return self.guarded(c._replace(stack=rest), context, branch, node.children[1], value)
            case "closing":
                return self.closing(c, frame, rest)
            case "pass":
                return [(INTERNAL_LABEL, c._replace(stack=rest))]
            case "either":
                return [(INTERNAL_LABEL, self.follower.abandoned(c)), (INTERNAL_LABEL, c._replace(stack=rest))]
            case "open":
                return self._open(c, frame)
            case "split":
                return [(INTERNAL_LABEL, c._replace(stack=(part, rest))) for part in frame[1]]
            case "load":
                return self._load(c, frame[1], rest)
            case "store":
                return [(("store", frame[1], frame[2]), c._replace(stack=rest))]
            case "foreign":
                return self._foreign(c, frame, rest)
            case "foreign port":
                return self._foreign_port(c, frame, rest)
            case "diverges":
                return [(INTERNAL_LABEL, c)]
            case "idle":
                return [(("start",), c._replace(stack=self.body()))]
            case "ended":
                if self.thread.role.outermost:
                    return []
                return [(("end",), c._replace(stack=(("over" if self.thread.role.once else "idle",), None)))]
            case "over":
                return []
            case "faulted":
                return [(("time", "the program ends by a fault"), c)]
            case "raised":
                if self.thread.role.outermost:
                    return []
                return [(("throw", frame[1]), c._replace(stack=(("ended",), None)))]
        raise AssertionError(frame[0])

    def body(self) -> Stack:
        """All that the thread does."""
        root, node = self.thread.root, self.thread.node
        if node is None:
            return (("foreign", root, None), (("leave", root), None))
        own = (("leave", root), None) if node is root.definition.body else None
        return (("run", node, root), own)

    def _action(self, c: Configuration, node: Node, context: Context, rest: Stack) -> list[Move]:
        action = node.action
        after = c._replace(stack=rest)
        match action:
            case ReadValue():
                found: list[Move] = []
                for label, value, given in self.reads(c, context, action.source):
                    if value is MISSED:
                        found.append((label, self.follower.thrown(given, TIMEOUT)))
                    else:
                        found.append((label, assigning(given._replace(stack=rest), context, action.target, value)))
                return found
            case WaitStep():
                takes_time = self.follower.takes_time(c, context, action.duration)
                label = self.follower.delay(f"wait {expression_text(action.duration)}", takes_time)
                return [(label, after._replace(loaded=()))]
            case StopStep():
                return []
            case ParallelSteps():
                return fork_edges(self.thread, self.follower, c, node, context, rest)
        raise AssertionError(type(action).__name__)

    def _choice(self, c: Configuration, frame: Frame, rest: Stack) -> list[Move]:
        _, node, context, decided = frame
        assert isinstance(node.action, Choice)
        found: list[Move] = []
        held = c._replace(stack=rest)
        decided = self._as_far_as_taken(context, node.action, decided)
        for branch, body, enabled in zip(node.action.branches, node.children, decided, strict=True):
            if enabled is not None:
                others = [other for other in node.action.branches if other is not branch]
                found += self.guarded(self.watched(held, context, others), context, branch, body, enabled[0])
        return found

    def _as_far_as_taken(self, context: Context, choice: Choice, decided: tuple[Any, ...]) -> tuple[Any, ...]:
        """The guards without those that are never taken, because another one is always ready: time-outs, and with priority all that come after it."""
        always = [
            number
            for number, (branch, entry) in enumerate(zip(choice.branches, decided, strict=True))
            if entry is not None and self.is_always_ready(context, branch)
        ]
        if not always:
            return decided
        return tuple(
            None if is_time_out(branch) or (choice.prioritized and number > always[0]) else entry
            for number, (branch, entry) in enumerate(zip(choice.branches, decided, strict=True))
        )

    def _picking(self, c: Configuration, frame: Frame, rest: Stack) -> list[Move]:
        """An alternative with conditions that may hold or not: none of them does, or one.

        Where several hold, the alternative does what it does where one of them holds, and refuses less: more need not be told apart.
        """
        _, node, context, decided = frame
        assert isinstance(node.action, Choice)
        may = [number for number, entry in enumerate(decided) if entry is not None and entry[1]]
        found: list[Move] = []
        for chosen in (None, *may):
            picked = tuple(
                None if number in may and number != chosen else entry for number, entry in enumerate(decided)
            )
            found.append((INTERNAL_LABEL, c._replace(stack=(("choice", node, context, picked), rest))))
        for number in may:
            condition = node.action.branches[number].condition
            assert condition is not None
            self._left_open(context, condition)
        return found

    def _left_open(self, context: Context, condition: Expression) -> None:
        where = context.definition.name
        self.thread.abstracted(f"`{expression_text(condition)}` in `{where}` may hold or not", condition.span)

    def _reading(self, c: Configuration, frame: Frame, rest: Stack) -> list[Move]:
        _, context, instance, node, remaining = frame
        inputs = self.follower.connections(context, instance, "in")
        chain, free = self._ordered(context, inputs, remaining)
        if len(free) > _AT_ONCE:
            return self.laws.fork(c, frame, rest, inputs)
        found: list[Move] = []
        for position in (*chain[:1], *free):
            left = (("reading", context, instance, node, tuple(i for i in remaining if i != position)), rest)
            end = inputs[position][0].attachment
            assert isinstance(end, PortEnd | ChannelEnd)
            for label, value, given in self.reads(c, context, end):
                if value is MISSED:
                    found.append((label, self.follower.thrown(given, TIMEOUT)))
                else:
                    found.append((label, given._replace(stack=left)))
        return found

    def _ordered(self, context: Context, inputs: list, remaining: tuple[int, ...]) -> tuple[list[int], list[int]]:  # type: ignore[type-arg]
        """Those of the inputs that are always taken in the order of the ports, and the others.

        Sampled inputs of one period that nobody else in the process reads are there at the same instants.
        """
        uses = context.definition.uses_of_ports
        chain = [
            i
            for i in remaining
            if self.thread.medium(inputs[i][1]).kind == "sampled" and uses.get(inputs[i][0].attachment, 0) == 1
        ]
        periods = {self.thread.medium(inputs[i][1]).period for i in chain}
        if len(periods) > 1:
            chain = []
        return chain, [i for i in remaining if i not in chain]

    def _writing(self, c: Configuration, frame: Frame, rest: Stack) -> list[Move]:
        _, context, instance, node, remaining = frame
        outputs = self.follower.connections(context, instance, "out")
        chain = [i for i in remaining if self.thread.medium(outputs[i][1]).kind in ("output", "overwrite")]
        free = [i for i in remaining if i not in chain]
        delivers = any(self.thread.medium(outputs[i][1]).kind == "broadcast" for i in remaining)
        if len(free) > _AT_ONCE or (delivers and len(remaining) > 1):
            return self.laws.fork(c, frame, rest, outputs)
        found: list[Move] = []
        for position in (*chain[:1], *free):
            left = (("writing", context, instance, node, tuple(i for i in remaining if i != position)), rest)
            connection, reference = outputs[position]
            after = self.delivering(reference, node, c._replace(stack=left))
            found.append((self.written(reference, self._computed(context, connection, instance, reference)), after))
        return found

    def _computed(self, context: Context, connection: Connection, instance: str, reference: Reference) -> Known:
        """What a control law writes, as far as it is followed."""
        medium = self.thread.medium(reference)
        if medium.kind != "output" or not medium.relevant:
            return UNKNOWN
        law = self.thread.law(context, instance)
        assert law is not None
        value = constant_output(law, connection.port)
        if value is UNKNOWN:
            span = context.definition.instances[instance].span
            self.follower.not_shown(context, medium, f"of the control law `{instance}`", span)
        return value

    def _open(self, c: Configuration, frame: Frame) -> list[Move]:
        _, context, condition, then, otherwise = frame
        self._left_open(context, condition)
        found = self.follower.outcomes(c, context, condition)
        return [
            (INTERNAL_LABEL, given._replace(stack=then if holds else otherwise, loaded=())) for holds, given in found
        ]

    def _load(self, c: Configuration, reference: Reference, rest: Stack) -> list[Move]:
        if reference[0] == "risk":
            self.thread.abstracted("a computation may end in a fault or not", reference[1])
            safe = c._replace(stack=rest, loaded=(*c.loaded, (RISK, True)))
            return [(INTERNAL_LABEL, self.follower.thrown(safe, FAULT)), (INTERNAL_LABEL, safe)]
        domain = self.thread.domain(reference)
        return [
            (("load", reference, value), c._replace(stack=rest, loaded=(*c.loaded, (reference, value))))
            for value in ((UNKNOWN,) if domain is None else domain)
        ]

    def _foreign(self, c: Configuration, frame: Frame, rest: Stack) -> list[Move]:
        """A process written in another language: it may communicate on any of its ports, one after the other, and end whenever it likes."""
        _, context, node = frame
        self.thread.abstracted(
            f"`{context.definition.name}` is written by hand: it may communicate in any order, and end at any time",
            context.definition.definition.span,
        )
        found: list[Move] = [(INTERNAL_LABEL, c._replace(stack=rest))]
        for element in context.definition.elements:
            reference = context.ports[element]
            kind = self.thread.medium(reference).kind
            if kind == "var" and self.thread.medium(reference).relevant:
                found.append((INTERNAL_LABEL, self.follower.stored(c, reference, UNKNOWN)))
            elif kind not in ("var", "constant", "discard"):
                found.append((INTERNAL_LABEL, c._replace(stack=(("foreign port", context, element, node), rest))))
        return found

    def _foreign_port(self, c: Configuration, frame: Frame, rest: Stack) -> list[Move]:
        _, context, (name, index), node = frame
        back = c._replace(stack=(("foreign", context, node), rest))
        ports = {port.name: port for port in context.definition.definition.ports}
        reference = context.ports[name, index]
        if ports[name].direction == "out":
            return [(self.written(reference, UNKNOWN), self.delivering(reference, node, back))]
        found: list[Move] = []
        for label, value, given in self.reads(back, context, PortEnd(name, index)):
            found.append((label, self.follower.thrown(given, TIMEOUT) if value is MISSED else given))
        return found
