"""Channels that lack a side, and channels that are looked at as if they kept a value."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.network.relations import Access


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
