"""The silent steps of a control law: which of its inputs and outputs are communications, and what it writes to
variables.
"""

from __future__ import annotations

from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.expressions import LiteralValue
from cspdiag.network.ir.network import Connection, SubmodelClass
from cspdiag.proofs.transitions.occurrences import BLOCKING
from cspdiag.proofs.transitions.systems.references import Reference
from cspdiag.proofs.transitions.threads import frames
from cspdiag.proofs.transitions.threads.context import Context
from cspdiag.proofs.transitions.threads.frames import Stack
from cspdiag.proofs.transitions.threads.silent.computing import Computing
from cspdiag.proofs.transitions.threads.thread import Configuration
from cspdiag.proofs.transitions.values import UNKNOWN, Known


class LawSteps(Computing):
    """Runs the control laws of one thread."""

    def connections(self, context: Context, instance: str, direction: str) -> list[tuple[Connection, Reference]]:
        """The connections of the inputs or outputs of a submodel, in the order of its ports, with their media."""
        law = self.thread.law(context, instance)
        assert law is not None
        names = {port.name for port in law.ports if port.direction == direction}
        connections = context.definition.instances[instance].connections
        return [(c, context.reference(c.attachment)) for c in connections if c.port in names]

    def _reading(self, c: Configuration, frame: frames.Reading, rest: Stack) -> Configuration | None:
        """Decides at first which inputs are to be read."""
        context, instance, node, remaining = frame.context, frame.instance, frame.node, frame.remaining
        if remaining is None:
            instance_of = context.definition.instances[instance]
            if self.thread.facts.faults.of_inputs(instance_of, context.definition.name):
                self.risk(c, f"what `{instance}` reads", instance_of.span)
            inputs = self.connections(context, instance, "in")
            waiting = [i for i, (_, reference) in enumerate(inputs) if self.thread.medium(reference).kind in BLOCKING]
            if c.fetched is not None:
                fetched = c.fetched[0]
                kept = [i for i in waiting if inputs[i][1] != fetched]
                if len(kept) == len(waiting) and waiting:
                    self.cannot_fuse(c)
                c = c if len(kept) == len(waiting) else c._replace(fetched=None)
                waiting = kept
            if not waiting:
                return self.passing(c._replace(loaded=()), rest, node)
            return c._replace(stack=(frames.Reading(context, instance, node, tuple(waiting)), rest), loaded=())
        return None if remaining else c.at(rest)

    def _compute(self, c: Configuration, frame: frames.Compute, rest: Stack) -> Configuration | None:
        context, instance, node = frame.context, frame.instance, frame.node
        law = self.thread.law(context, instance)
        assert law is not None
        outputs = self.connections(context, instance, "out")
        shown = any(self.thread.medium(reference).kind == "output" for _, reference in outputs)
        if shown or self.thread.facts.faults.of_law(law):
            self.risk(c, f"a sample of the control law `{instance}`", context.definition.instances[instance].span)
        c = c._replace(stack=(frames.Writing(context, instance, node, None), rest), loaded=())
        for connection, reference in outputs:
            if self.thread.medium(reference).kind == "var":
                c = self.stored(c, reference, constant_output(law, connection.port))
        return c

    def _writing(self, c: Configuration, frame: frames.Writing, rest: Stack) -> Configuration | None:
        """Decides at first which outputs are to be written."""
        context, instance, node, remaining = frame.context, frame.instance, frame.node, frame.remaining
        if remaining is None:
            if c.doomed:
                return self.abandoned(c)
            outputs = self.connections(context, instance, "out")
            kinds = [self.thread.medium(reference).kind for _, reference in outputs]
            left = tuple(i for i, kind in enumerate(kinds) if kind not in ("var", "discard"))
            if not left:
                return self.passing(c, rest, node)
            return c.at((frames.Writing(context, instance, node, left), rest))
        return None if remaining else c.at(rest)


def constant_output(law: SubmodelClass, port: str) -> Known:
    """The value of an output that always has the same value; otherwise UNKNOWN."""
    for equation in law.equations:
        if (
            not isinstance(equation, ExternalCall)
            and equation.name == port
            and isinstance(equation.value, LiteralValue)
        ):
            return equation.value.value
    return UNKNOWN
