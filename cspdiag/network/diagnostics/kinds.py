"""Kinds of channels that do not fit the relations of their users."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.network.relations import Pair
from cspdiag.network.shapes import AskedKind


@record
class MixedRelation(Diagnostic):
    """A channel connects some parts that run in parallel and some that run in sequence.

    Between parallel parts a value passes when both are there; between parts in sequence it has to be kept until the later one
    comes. One channel cannot do both: the rendezvous would block the part that has no partner, the variable would lose the
    values of the other pair.

    Refused::

        process Sender {
          out output : int
          composition { output ! 1 }
        }

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { input ? last }
        }

        process Main {
          communication {
            sender : Sender
            now    : Receiver
            later  : Receiver
            sender.output -> now.input, later.input
          }
          composition { (sender || now) ; later }
        }

    Mended::

        process Sender {
          out output : int
          composition { output ! 1 }
        }

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { input ? last }
        }

        process Main {
          communication {
            sender : Sender
            again  : Sender
            now    : Receiver
            later  : Receiver
            sender.output -> now.input
            again.output  -> later.input
          }
          composition { (sender || now) ; again ; later }
        }
    """

    code = "E0524"
    title = "users of a channel both in sequence and in parallel"

    channel: str
    parallel: Pair
    sequential: Pair

    @property
    def message(self) -> str:
        writer, reader = self.parallel
        earlier, later = self.sequential
        return (
            f"`{self.channel}` passes values between {writer.who} and {reader.who}, which are in parallel, "
            f"and between {earlier.who} and {later.who}, which are in sequence"
        )

    @property
    def help(self) -> str | None:
        return "give each pair a channel of its own: one that waits for the partner, and one that keeps a value"

    @property
    def labels(self) -> tuple[Label, ...]:
        writer, reader = self.parallel
        earlier, later = self.sequential
        return (
            Label(writer.run, f"{writer.who} writes in parallel with {reader.who}"),
            Label(earlier.run, f"{earlier.who} writes"),
            Label(later.run, f"{later.who} reads in sequence with it"),
        )


@record
class KindsDisagree(Diagnostic):
    """One channel is said to be of two kinds.

    A relationship of a process and a relationship inside one of its instances can both say the kind of the channel behind a port. It is one channel, and
    it has one kind.

    Refused::

        process Sender {
          out output : int
          composition { mu output ! 1 }
        }

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { mu input ? last }
        }

        process Pair {
          in input : int
          communication {
            one   : Receiver
            other : Receiver
            input -> broadcast -> one.input, other.input
          }
          composition { one || other }
        }

        process Main {
          communication {
            sender : Sender
            pair   : Pair
            sender.output -> any -> pair.input
          }
          composition { sender || pair }
        }

    Mended::

        process Sender {
          out output : int
          composition { mu output ! 1 }
        }

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { mu input ? last }
        }

        process Pair {
          in input : int
          communication {
            one   : Receiver
            other : Receiver
            input -> broadcast -> one.input, other.input
          }
          composition { one || other }
        }

        process Main {
          communication {
            sender : Sender
            pair   : Pair
            sender.output -> pair.input
          }
          composition { sender || pair }
        }
    """

    code = "E0525"
    title = "two kinds for one channel"

    channel: str
    kind: str
    other: AskedKind

    @property
    def message(self) -> str:
        return f"`{self.channel}` is said to be `{self.kind}` here and `{self.other.name}` elsewhere"

    @property
    def help(self) -> str | None:
        return "a channel has one kind: say the same, or leave it away in one of the places"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.other.span, f"`{self.other.name}` here"),)


@record
class KindContradicts(Diagnostic):
    """A port of the outermost process is given a kind that it cannot have.

    The environment never waits for the program. A sampled input gives each sample to every reader; an event input keeps the latest
    event; an output takes every value at once. So a sampled input has no kind, an event input may be `broadcast` or
    `any`, an output `any`, and none of them a rendezvous or a buffer.

    Refused::

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { mu input ? last }
        }

        process Main {
          in angle : int @ 1 ms
          communication {
            one   : Receiver
            other : Receiver
            angle -> any -> one.input, other.input
          }
          composition { one || other }
        }

    Mended::

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { mu input ? last }
        }

        process Main {
          in angle : int @ 1 ms
          communication {
            one   : Receiver
            other : Receiver
            angle -> one.input, other.input
          }
          composition { one || other }
        }
    """

    code = "E0528"
    title = "kind that a port of the outermost process cannot have"

    port: str
    kind: str
    direction: str
    sampled: bool
    declared: Span

    @property
    def message(self) -> str:
        if self.direction == "out":
            return f"the output `{self.port}` of the outermost process cannot be `{self.kind}`"
        if self.sampled:
            return f"the sampled input `{self.port}` cannot be `{self.kind}`: every reader gets every sample"
        return f"the event input `{self.port}` cannot be `{self.kind}`: it keeps the latest event until it is read"

    @property
    def help(self) -> str | None:
        if self.direction == "out":
            return "leave the kind away, or say `any` where several write it in parallel"
        if self.sampled:
            return "leave the kind away"
        return "say `broadcast` or `any` where several read it in parallel, and nothing otherwise"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, "declared here"),)
