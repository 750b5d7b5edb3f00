"""What is wrong between the users of a channel: in sequence, in parallel, or both."""

from __future__ import annotations

from cspdiag.diagnostics import Diagnostic, Label, Span
from cspdiag.diagnostics.record import record
from cspdiag.network.relations import Access, Pair
from cspdiag.syntax import ast


def _do_in_parallel(one: Access, other: Access, verb: str, channel: str) -> str:
    """Who does the same to a channel at the same time: ```one` and `other` read `c` in parallel``."""
    if not one.instance and not other.instance:
        return f"two parallel parts of the process {verb} `{channel}`"
    return f"{one.who} and {other.who} {verb} `{channel}` in parallel"


def _both(one: Access, other: Access, verbs: tuple[str, str]) -> tuple[Label, ...]:
    """The places of a pair: the other end of the relationship, and where the two stand in the composition."""
    labels = [Label(other.span, f"{other.who} {verbs[1]} here")]
    for access, verb in ((one, verbs[0]), (other, verbs[1])):
        if access.run != access.span:
            labels.append(Label(access.run, f"{access.who}, which {verb} it, runs here"))
    return tuple(labels)


@record
class Race(Diagnostic):
    """A variable is written in one parallel part and used in another.

    A variable keeps its last value and makes nobody wait. Between parallel parts it would depend on the scheduler which value is
    seen: a race. Parallel parts exchange values over channels, where the reader waits for the writer.

    Refused::

        process Main {
          out output : int
          communication { var value : int = 0 }
          composition { value := 1 || output ! value }
        }

    Mended::

        process Main {
          out output : int
          communication { var value : int = 0 }
          composition { value := 1 ; output ! value }
        }
    """

    code = "E0520"
    title = "race on a variable"

    variable: str
    one: Access
    other: Access
    both_write: bool

    @property
    def message(self) -> str:
        if self.both_write:
            writing = _do_in_parallel(self.one, self.other, "write", self.variable)
            return f"{writing}, so that either value may be lost"
        if not self.one.instance and not self.other.instance:
            return f"`{self.variable}` is written in one parallel part of the process and read in another"
        return f"{self.one.who} writes `{self.variable}` in parallel with {self.other.who}, which reads it"

    @property
    def label(self) -> str:
        return "written here"

    @property
    def help(self) -> str | None:
        return "pass the value over a channel between the two, or run them one after the other"

    @property
    def labels(self) -> tuple[Label, ...]:
        return _both(self.one, self.other, ("writes", "writes" if self.both_write else "reads"))


@record
class ParallelWriters(Diagnostic):
    """A channel has several writers in parallel.

    A rendezvous is between one writer and one reader. Where several writers are active at the same time, the order in which their
    values come is left open, and the diagram has to say that this is meant: `any`. Writers that run one after
    the other, or in different branches of an alternative, need nothing.

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

        process Main {
          communication {
            one      : Sender
            other    : Sender
            receiver : Receiver
            one.output, other.output -> receiver.input
          }
          composition { one || other || receiver }
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

        process Main {
          communication {
            one      : Sender
            other    : Sender
            receiver : Receiver
            one.output, other.output -> any -> receiver.input
          }
          composition { one || other || receiver }
        }
    """

    code = "E0521"
    title = "several writers in parallel"

    channel: str
    one: Access
    other: Access
    said: str | None
    outermost: bool

    @property
    def message(self) -> str:
        return _do_in_parallel(self.one, self.other, "write", self.channel)

    @property
    def help(self) -> str | None:
        if self.said is not None:
            return f"only `any` takes values from several writers, one at a time; this channel says `{self.said}`"
        if self.outermost:
            return "write `-> any ->` if the values may come in any order, or run one writer after the other"
        return "write `-> any ->` so that the channel takes from one writer at a time, or run them one after the other"

    @property
    def labels(self) -> tuple[Label, ...]:
        return _both(self.one, self.other, ("writes", "writes"))


@record
class ParallelReaders(Diagnostic):
    """A channel has several readers in parallel.

    With several readers at the same time there are two meanings, and the diagram has to say which: `broadcast` gives every value
    to every reader, `any` gives each value to one of them.

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

        process Main {
          communication {
            sender : Sender
            one    : Receiver
            other  : Receiver
            sender.output -> one.input, other.input
          }
          composition { sender || one || other }
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

        process Main {
          communication {
            sender : Sender
            one    : Receiver
            other  : Receiver
            sender.output -> broadcast -> one.input, other.input
          }
          composition { sender || one || other }
        }
    """

    code = "E0522"
    title = "several readers in parallel"

    channel: str
    one: Access
    other: Access
    said: str | None

    @property
    def message(self) -> str:
        return _do_in_parallel(self.one, self.other, "read", self.channel)

    @property
    def help(self) -> str | None:
        said = "" if self.said is None else f" instead of `{self.said}`"
        return f"say `broadcast` (each of them gets every value) or `any` (one of them gets it){said}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return _both(self.one, self.other, ("reads", "reads"))


@record
class EventReadInParallel(Diagnostic):
    """An event from outside is read by several processes in parallel.

    An event is taken by whoever reads it first. In the published code of JIWY both joints waited for the stop button in this way: one
    joint could take the press, and the other one never stopped. Say `broadcast` if every reader must get every event, `any` if
    one of them is enough. A sampled input needs nothing of the kind: each reader gets each sample.

    Refused::

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { mu input ? last }
        }

        process Main {
          in button : int
          communication {
            horizontal : Receiver
            vertical   : Receiver
            button -> horizontal.input, vertical.input
          }
          composition { horizontal || vertical }
        }

    Mended::

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { mu input ? last }
        }

        process Main {
          in button : int
          communication {
            horizontal : Receiver
            vertical   : Receiver
            button -> broadcast -> horizontal.input, vertical.input
          }
          composition { horizontal || vertical }
        }
    """

    code = "E0523"
    title = "event read by several in parallel"

    port: str
    one: Access
    other: Access
    declared: Span

    @property
    def message(self) -> str:
        reading = _do_in_parallel(self.one, self.other, "read the event", self.port)
        return f"{reading}, so that one can take it from the other"

    @property
    def help(self) -> str | None:
        return "write `-> broadcast ->` if each of them must get every event, `-> any ->` if one of them is enough"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (*_both(self.one, self.other, ("reads", "reads")), Label(self.declared, "the event port"))


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
    other: ast.Kind

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
class RendezvousInSequence(Diagnostic):
    """A channel that makes its users wait for each other is asked for between parts in sequence.

    With `sync`, `broadcast` and `any` the writer goes on only when a reader has taken the value. If the reader comes after the writer
    in a sequence, the writer waits for somebody who never comes: a certain deadlock. Left alone, the channel becomes one that
    keeps the value.

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
            sender   : Sender
            receiver : Receiver
            sender.output -> sync -> receiver.input
          }
          composition { sender ; receiver }
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
            sender   : Sender
            receiver : Receiver
            sender.output -> receiver.input
          }
          composition { sender ; receiver }
        }
    """

    code = "E0526"
    title = "channel that waits, between parts in sequence"

    channel: str
    kind: str
    writer: Access
    reader: Access

    @property
    def message(self) -> str:
        return (
            f"`{self.channel}` is `{self.kind}`, but {self.writer.who} and {self.reader.who} run in sequence: "
            "each would wait for the other for ever"
        )

    @property
    def help(self) -> str | None:
        return f"leave `{self.kind}` away, so that the channel keeps the value, or put the two in parallel"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (
            Label(self.writer.run, f"{self.writer.who} writes here"),
            Label(self.reader.run, f"{self.reader.who} reads here"),
        )


@record
class BroadcastInSequence(Diagnostic):
    """A broadcast has readers that run in sequence.

    The writer of a broadcast goes on when every reader has taken the value. A reader that has not begun yet, or has ended, never takes
    it.

    Refused::

        process Sender {
          out output : int
          composition { mu output ! 1 }
        }

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { input ? last }
        }

        process Main {
          communication {
            sender : Sender
            one    : Receiver
            other  : Receiver
            sender.output -> broadcast -> one.input, other.input
          }
          composition { sender || (one ; other) }
        }

    Mended::

        process Sender {
          out output : int
          composition { mu output ! 1 }
        }

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { input ? last }
        }

        process Main {
          communication {
            sender : Sender
            one    : Receiver
            other  : Receiver
            sender.output -> one.input, other.input
          }
          composition { sender || (one ; other) }
        }
    """

    code = "E0527"
    title = "broadcast to readers in sequence"

    channel: str
    one: Access
    other: Access

    @property
    def message(self) -> str:
        return (
            f"`{self.channel}` is `broadcast`, but {self.one.who} and {self.other.who} read it in sequence: "
            "the writer would wait for both at once"
        )

    @property
    def help(self) -> str | None:
        return "put the readers in parallel, or say `any` if each value goes to whichever of them runs"

    @property
    def labels(self) -> tuple[Label, ...]:
        return _both(self.one, self.other, ("reads", "reads"))


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


@record
class ChannelOneSided(Diagnostic):
    """A channel is only written, or only read.

    A value passes when a writer and a reader meet. With one side only, whoever uses the channel waits for ever. The published code of
    JIWY declared two channels twice and their partners never.

    Refused::

        process Main {
          communication { channel values : int }
          composition { values ! 1 || skip }
        }

    Mended::

        process Main {
          communication {
            channel values : int
            var last : int = 0
          }
          composition { values ! 1 || values ? last }
        }
    """

    code = "E0529"
    title = "channel with one side only"

    channel: str
    used: Access | None

    @property
    def message(self) -> str:
        if self.used is None:
            return f"the channel `{self.channel}` is never used"
        return f"the channel `{self.channel}` has only one side: nobody is there to take or give what passes"

    @property
    def help(self) -> str | None:
        return "let one process write it with `!` and another in parallel read it with `?`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return () if self.used is None else (Label(self.used.span, "the only use"),)


@record
class ChannelReadAsVariable(Diagnostic):
    """A condition looks at a channel that keeps no value.

    Only a channel between parts in sequence keeps its last value, so that it can be looked at by its label. Between parallel parts a
    value is gone when it has passed; there it is read, once, with `?`.

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

        process Main {
          communication {
            sender   : Sender
            receiver : Receiver
            sender.output -> level : int -> receiver.input
          }
          composition { mu (sender || receiver) until level > 3 }
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
            sender   : Sender
            receiver : Receiver
            sender.output -> level : int -> receiver.input
          }
          composition { mu (sender ; wait 1 ms ; receiver) until level > 3 }
        }
    """

    code = "E0530"
    title = "value of a channel that keeps none"

    channel: str
    kind: str
    declared: Span

    @property
    def message(self) -> str:
        return f"`{self.channel}` is a `{self.kind}` channel between parallel parts and keeps no value to be looked at"

    @property
    def help(self) -> str | None:
        return f"read it into a variable with `{self.channel} ? x`, and use the variable"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, "the channel"),)


@record
class LabelOfPortRead(Diagnostic):
    """A condition looks at the label of a relationship at a port of the process.

    Such a label names the arrow in the diagram; the communication object behind it belongs to somebody outside and is not a variable
    of this process. Its values are had by reading the port.

    Refused::

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { mu input ? last }
        }

        process Main {
          in button : int
          communication {
            receiver : Receiver
            button -> pressed : int -> receiver.input
          }
          composition { mu receiver until pressed == 1 }
        }

    Mended::

        process Main {
          in button : int
          communication { var pressed : int = 0 }
          composition { mu button ? pressed until pressed == 1 }
        }
    """

    code = "E0531"
    title = "value of a port"

    name: str
    port: str
    declared: Span

    @property
    def message(self) -> str:
        return f"`{self.name}` names the relationship at the port `{self.port}`, which keeps no value to be looked at"

    @property
    def help(self) -> str | None:
        return f"read the port into a variable with `{self.port} ? x`, and use the variable"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"the port `{self.port}`"),)
