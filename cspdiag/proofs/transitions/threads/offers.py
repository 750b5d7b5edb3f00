"""The edges out of the configurations in which a thread waits."""

from __future__ import annotations

from typing import assert_never

from cspdiag.network.dump.delay import delay_text
from cspdiag.network.dump.expression import expression_text
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import Connection
from cspdiag.proofs.transitions.classes.built_in_exceptions import FAULT, TIMEOUT
from cspdiag.proofs.transitions.classes.program import Node
from cspdiag.proofs.transitions.specifications import is_time_out
from cspdiag.proofs.transitions.systems.labels import (
    INTERNAL,
    Delivered,
    End,
    Load,
    Start,
    Store,
    Throw,
    Time,
    Withdrawn,
)
from cspdiag.proofs.transitions.systems.references import Reference
from cspdiag.proofs.transitions.threads import frames
from cspdiag.proofs.transitions.threads.abandoning import Abandoning, is_cancellation_point
from cspdiag.proofs.transitions.threads.communications import Missed, Move, assigning
from cspdiag.proofs.transitions.threads.context import Context
from cspdiag.proofs.transitions.threads.frames import RISK, Risk, Stack
from cspdiag.proofs.transitions.threads.joining import LawParallels, fork_edges, join_edges
from cspdiag.proofs.transitions.threads.silent.follow import Follower
from cspdiag.proofs.transitions.threads.silent.law_steps import constant_output
from cspdiag.proofs.transitions.threads.thread import Configuration, Thread
from cspdiag.proofs.transitions.values import UNKNOWN, Known

_AT_ONCE = 4
"""A control law with more communications at once than this gets a component for each of them; with fewer, one component
has all their orders.
"""


class Offers(Abandoning):
    """The edges of one thread."""

    def __init__(self, thread: Thread, follower: Follower) -> None:
        super().__init__(thread, follower)
        self.laws = LawParallels(thread, follower)

    def moves(self, c: Configuration) -> list[Move]:
        """All edges out of a settled configuration; the configurations they lead to are not settled."""
        assert c.stack is not None
        frame, rest = c.stack
        if is_cancellation_point(frame) and self.is_abandoned_at_once(rest):
            return self.interruptions(c, frame)
        found = self._own(c, frame, rest)
        if is_cancellation_point(frame) or (isinstance(frame, frames.Join) and frame.stage == "wait"):
            found += self.interruptions(c, frame)
        if self.thread.role.cancellable and not c.doomed:
            found += self.cancellation(c, frame, rest)
        return found

    def _own(self, c: Configuration, frame: frames.Frame, rest: Stack) -> list[Move]:
        match frame:
            case frames.Run():
                return self._action(c, frame.node, frame.context, rest)
            case frames.Put():
                written = self.written(frame.reference, frame.value)
                return [(written, self.delivering(frame.reference, frame.node, c.at(rest)))]
            case frames.Delivering():
                return [(Delivered(frame.reference), c.at(rest))]
            case frames.Withdrawing():
                return [(Withdrawn(frame.reference), c.at(rest))]
            case frames.Choosing():
                return self._choice(c, frame, rest)
            case frames.Picking():
                return self._picking(c, frame, rest)
            case frames.Reading():
                return self._reading(c, frame, rest)
            case frames.Writing():
                return self._writing(c, frame, rest)
            case frames.Join():
                return join_edges(self.thread, self.follower, c, frame, rest)
            case frames.GuardOnly():
                assert isinstance(frame.node.action, ir.InterruptOn)
                branch = frame.node.action.branch
                return self.guarded(c.at(rest), frame.context, branch, frame.node.children[1], frame.value)
            case frames.Closing():
                return self.closing(c, frame, rest)
            case frames.InterruptPoint():
                return [(INTERNAL, c.at(rest))]
            case frames.MayEnd():
                return [(INTERNAL, self.follower.abandoned(c)), (INTERNAL, c.at(rest))]
            case frames.Open():
                return self._open(c, frame)
            case frames.Split():
                return [(INTERNAL, c.at((part, rest))) for part in frame.parts]
            case frames.Load():
                return self._load(c, frame.what, rest)
            case frames.Store():
                return [(Store(frame.reference, frame.value), c.at(rest))]
            case frames.Foreign():
                return self._foreign(c, frame, rest)
            case frames.ForeignPort():
                return self._foreign_port(c, frame, rest)
            case frames.Diverges():
                return [(INTERNAL, c)]
            case frames.Over():
                return []
            case frames.Faulted():
                return [(Time("the program ends by a fault"), c)]
            case frames.Idle() | frames.Ended() | frames.Raised():
                return self._as_branch(c, frame)
            case (
                frames.Deciding() | frames.Offering() | frames.Compute() | frames.Interrupting()
                | frames.Interruptible() | frames.Interrupt() | frames.Storing() | frames.Assign() | frames.LoopEnd()
                | frames.Iterations() | frames.Catch() | frames.Leave()
            ):  # fmt: skip
                raise AssertionError(f"{frame} is a silent step")
            case _:
                assert_never(frame)

    def _as_branch(self, c: Configuration, frame: frames.Idle | frames.Ended | frames.Raised) -> list[Move]:
        """The edges in which the parent of a branch takes part; the outermost process has no parent."""
        match frame:
            case frames.Idle():
                return [(Start(), c.at(self.body()))]
            case _ if self.thread.role.outermost:
                return []
            case frames.Ended():
                return [(End(), c.at((frames.Over() if self.thread.role.once else frames.Idle(), None)))]
            case frames.Raised():
                return [(Throw(frame.exception), c.at((frames.Ended(), None)))]
            case _:
                assert_never(frame)

    def body(self) -> Stack:
        """The stack with which the thread starts."""
        root, node = self.thread.root, self.thread.node
        if node is None:
            return (frames.Foreign(root, None), (frames.Leave(root), None))
        own = (frames.Leave(root), None) if node is root.definition.body else None
        return (frames.Run(node, root), own)

    def _action(self, c: Configuration, node: Node, context: Context, rest: Stack) -> list[Move]:
        action = node.action
        after = c.at(rest)
        match action:
            case ir.ReadValue():
                found: list[Move] = []
                for label, value, given in self.reads(c, context, action.source):
                    if isinstance(value, Missed):
                        found.append((label, self.follower.thrown(given, TIMEOUT)))
                    else:
                        found.append((label, assigning(given.at(rest), context, action.target, value)))
                return found
            case ir.WaitStep():
                takes_time = self.follower.takes_time(c, context, action)
                label = self.follower.delay(delay_text(action), takes_time)
                return [(label, after._replace(loaded=()))]
            case ir.StopStep():
                return []
            case ir.ParallelSteps():
                return fork_edges(self.thread, self.follower, c, node, context, rest)
            case _:
                raise AssertionError(f"{type(action).__name__} is a silent step")

    def _choice(self, c: Configuration, frame: frames.Choosing, rest: Stack) -> list[Move]:
        node, context = frame.node, frame.context
        assert isinstance(node.action, ir.Choice)
        found: list[Move] = []
        held = c.at(rest)
        decided = self._guards_that_may_be_taken(context, node.action, frame.decided)
        for branch, body, enabled in zip(node.action.branches, node.children, decided, strict=True):
            if enabled is not None:
                others = [other for other in node.action.branches if other is not branch]
                found += self.guarded(self.watched(held, context, others), context, branch, body, enabled[0])
        return found

    def _guards_that_may_be_taken(self, context: Context, choice: ir.Choice, decided: frames.Decided) -> frames.Decided:
        """The guards, with None for those that are never taken because another one is always ready: time-outs, and in a
        prioritized alternative all guards after that one.
        """
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

    def _picking(self, c: Configuration, frame: frames.Picking, rest: Stack) -> list[Move]:
        """The choices of an alternative with open conditions: none of them holds, or one does.

        If several hold, the alternative can do what it can if one of them holds, and refuses less: no further cases
        need to be distinguished.
        """
        node, context, decided = frame.node, frame.context, frame.decided
        assert isinstance(node.action, ir.Choice)
        may = [number for number, entry in enumerate(decided) if entry is not None and entry[1]]
        found: list[Move] = []
        for chosen in (None, *may):
            picked = tuple(
                None if number in may and number != chosen else entry for number, entry in enumerate(decided)
            )
            found.append((INTERNAL, c.at((frames.Choosing(node, context, picked), rest))))
        for number in may:
            condition = node.action.branches[number].condition
            assert condition is not None
            self._left_open(context, condition)
        return found

    def _left_open(self, context: Context, condition: Expression) -> None:
        where = context.definition.name
        self.thread.abstracted(f"`{expression_text(condition)}` in `{where}` may hold or not", condition.span)

    def _reading(self, c: Configuration, frame: frames.Reading, rest: Stack) -> list[Move]:
        context, instance, node, remaining = frame.context, frame.instance, frame.node, frame.remaining
        assert remaining is not None
        inputs = self.follower.connections(context, instance, "in")
        chain, free = self._ordered(context, inputs, remaining)
        if len(free) > _AT_ONCE:
            return self.laws.fork(c, frame, rest, inputs)
        found: list[Move] = []
        for position in (*chain[:1], *free):
            left = (frames.Reading(context, instance, node, tuple(i for i in remaining if i != position)), rest)
            end = inputs[position][0].attachment
            assert isinstance(end, ir.PortEnd | ir.ChannelEnd)
            for label, value, given in self.reads(c, context, end):
                if isinstance(value, Missed):
                    found.append((label, self.follower.thrown(given, TIMEOUT)))
                else:
                    found.append((label, given.at(left)))
        return found

    def _ordered(self, context: Context, inputs: list, remaining: tuple[int, ...]) -> tuple[list[int], list[int]]:  # type: ignore[type-arg]
        """The inputs that can be read in the order of the ports without loss, and the others.

        Inputs that are sampled together, and that nothing else in the process reads, have their samples at the same
        instants.
        """
        uses = context.definition.uses_of_ports
        chain = [
            i
            for i in remaining
            if self.thread.medium(inputs[i][1]).kind == "sampled" and uses.get(inputs[i][0].attachment, 0) == 1
        ]
        samplings = {self.thread.medium(inputs[i][1]).sampling for i in chain}
        if len(samplings) > 1:
            chain = []
        return chain, [i for i in remaining if i not in chain]

    def _writing(self, c: Configuration, frame: frames.Writing, rest: Stack) -> list[Move]:
        context, instance, node, remaining = frame.context, frame.instance, frame.node, frame.remaining
        assert remaining is not None
        outputs = self.follower.connections(context, instance, "out")
        chain = [i for i in remaining if self.thread.medium(outputs[i][1]).kind in ("output", "overwrite")]
        free = [i for i in remaining if i not in chain]
        delivers = any(self.thread.medium(outputs[i][1]).kind == "broadcast" for i in remaining)
        if len(free) > _AT_ONCE or (delivers and len(remaining) > 1):
            return self.laws.fork(c, frame, rest, outputs)
        found: list[Move] = []
        for position in (*chain[:1], *free):
            left = (frames.Writing(context, instance, node, tuple(i for i in remaining if i != position)), rest)
            connection, reference = outputs[position]
            after = self.delivering(reference, node, c.at(left))
            found.append((self.written(reference, self._computed(context, connection, instance, reference)), after))
        return found

    def _computed(self, context: Context, connection: Connection, instance: str, reference: Reference) -> Known:
        """The value that a control law writes, as far as it is followed."""
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

    def _open(self, c: Configuration, frame: frames.Open) -> list[Move]:
        self._left_open(frame.context, frame.condition)
        found = self.follower.outcomes(c, frame.context, frame.condition)
        return [
            (INTERNAL, given._replace(stack=frame.then if holds else frame.otherwise, loaded=()))
            for holds, given in found
        ]

    def _load(self, c: Configuration, reference: Reference | Risk, rest: Stack) -> list[Move]:
        if isinstance(reference, Risk):
            self.thread.abstracted(f"{reference.what} may end in a fault or not", reference.span)
            safe = c._replace(stack=rest, loaded=(*c.loaded, (RISK, True)))
            return [(INTERNAL, self.follower.thrown(safe, FAULT)), (INTERNAL, safe)]
        domain = self.thread.domain(reference)
        return [
            (Load(reference, value), c._replace(stack=rest, loaded=(*c.loaded, (reference, value))))
            for value in ((UNKNOWN,) if domain is None else domain)
        ]

    def _foreign(self, c: Configuration, frame: frames.Foreign, rest: Stack) -> list[Move]:
        """The edges of a process written in another language: it may communicate on any of its ports, one at a time,
        and end at any time.
        """
        context, node = frame.context, frame.node
        self.thread.abstracted(
            f"`{context.definition.name}` is written by hand: it may communicate in any order, and end at any time",
            context.definition.definition.span,
        )
        found: list[Move] = [(INTERNAL, c.at(rest))]
        for element in context.definition.elements:
            reference = context.ports[element]
            kind = self.thread.medium(reference).kind
            if kind == "var" and self.thread.medium(reference).relevant:
                found.append((INTERNAL, self.follower.stored(c, reference, UNKNOWN)))
            elif kind not in ("var", "constant", "discard"):
                found.append((INTERNAL, c.at((frames.ForeignPort(context, element, node), rest))))
        return found

    def _foreign_port(self, c: Configuration, frame: frames.ForeignPort, rest: Stack) -> list[Move]:
        context, (name, index), node = frame.context, frame.element, frame.node
        back = c.at((frames.Foreign(context, node), rest))
        ports = {port.name: port for port in context.definition.definition.ports}
        reference = context.ports[name, index]
        if ports[name].direction == "out":
            return [(self.written(reference, UNKNOWN), self.delivering(reference, node, back))]
        found: list[Move] = []
        for label, value, given in self.reads(back, context, ir.PortEnd(name, index)):
            found.append((label, self.follower.thrown(given, TIMEOUT) if isinstance(value, Missed) else given))
        return found
