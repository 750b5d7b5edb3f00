"""What a proof finds: assertions that do not hold, and those about which nothing is known."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label
from cspdiag.base.record import record


@record
class Refutation(Diagnostic):
    """An assertion that does not hold."""

    process: str
    found: str
    places: tuple[Label, ...] = ()
    advice: str | None = None

    @property
    def message(self) -> str:
        return f"`{self.process}` {self.found}"

    @property
    def help(self) -> str | None:
        return self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return self.places


@record
class CanDeadlock(Refutation):
    """A process can come to a state in which processes wait for each other for ever.

    Each waits for a communication that another of them would have to take part in. Where nothing goes on at all, that is a deadlock; where others
    go on it is a knot, and easily overlooked, because something still moves.

    Refused::

        process First {
          in  reply : int
          out ask   : int

          communication { var value : int }

          composition { reply ? value ; ask ! 1 }
        }

        process Second {
          in  ask   : int
          out reply : int

          communication { var value : int }

          composition { ask ? value ; reply ! 2 }
        }

        process Both {
          communication {
            first  : First
            second : Second

            first.ask    -> second.ask
            second.reply -> first.reply
          }

          composition { first || second }
        }

        assert Both deadlock free

    Mended::

        process First {
          in  reply : int
          out ask   : int

          communication { var value : int }

          composition { ask ! 1 ; reply ? value }
        }

        process Second {
          in  ask   : int
          out reply : int

          communication { var value : int }

          composition { ask ? value ; reply ! 2 }
        }

        process Both {
          communication {
            first  : First
            second : Second

            first.ask    -> second.ask
            second.reply -> first.reply
          }

          composition { first || second }
        }

        assert Both deadlock free
    """

    code = "E1101"
    title = "processes that can wait for each other for ever"


@record
class CanLivelock(Refutation):
    """A process can go on for ever without any communication that its environment could see.

    It computes or communicates inside itself, and never again offers anything, takes a sample or lets time pass; who waits for it waits for ever.

    Refused::

        process Ping {
          in  reply : int
          out ask   : int

          communication { var value : int }

          composition { mu (ask ! 1 ; reply ? value) }
        }

        process Pong {
          in  ask   : int
          out reply : int

          communication { var value : int }

          composition { mu (ask ? value ; reply ! 2) }
        }

        process Both {
          communication {
            ping : Ping
            pong : Pong

            ping.ask   -> pong.ask
            pong.reply -> ping.reply
          }

          composition { ping || pong }
        }

        assert Both livelock free

    Mended::

        process Ping {
          in  reply : int
          out ask   : int

          communication { var value : int }

          composition { mu (ask ! 1 ; reply ? value ; wait 1 ms) }
        }

        process Pong {
          in  ask   : int
          out reply : int

          communication { var value : int }

          composition { mu (ask ? value ; reply ! 2) }
        }

        process Both {
          communication {
            ping : Ping
            pong : Pong

            ping.ask   -> pong.ask
            pong.reply -> ping.reply
          }

          composition { ping || pong }
        }

        assert Both livelock free
    """

    code = "E1102"
    title = "a process that can be busy with itself for ever"


@record
class MayNotTerminate(Refutation):
    """A process can go on for ever, or stop before it has ended.

    That a process terminates means that it comes to its end, whatever its environment does: nothing in it can be repeated for ever, and nothing waits for
    what never comes.

    Refused::

        process Ends {
          in go : bool

          communication { var value : bool }

          composition { mu go ? value until value }
        }

        assert Ends terminates

    Mended::

        process Ends {
          in go : bool

          communication { var value : bool }

          composition { go ? value ; if not value then go ? value }
        }

        assert Ends terminates
    """

    code = "E1103"
    title = "a process that may never end"


@record
class DoesNotRefine(Refutation):
    """A process does something that its specification does not do, or refuses what the specification does not refuse.

    In traces, every sequence of communications of the process has to be one of the specification. In failures, the process may moreover refuse, where it is
    at rest, only what the specification may refuse there.

    Refused::

        process Alternates {
          in a, b : bool

          communication { var value : bool }

          composition { mu (a ? value ; b ? value) }
        }

        process Repeats {
          in a, b : bool

          communication { var value : bool }

          composition { mu (a ? value ; a ? value ; b ? value) }
        }

        assert Repeats refines Alternates

    Mended::

        process Alternates {
          in a, b : bool

          communication { var value : bool }

          composition { mu (a ? value ; b ? value) }
        }

        process Repeats {
          in a, b : bool

          communication { var value : bool }

          composition { mu (a ? value ; b ? value ; a ? value ; b ? value) }
        }

        assert Repeats refines Alternates
    """

    code = "E1104"
    title = "a process that does not refine its specification"


@record
class NotProved(Diagnostic):
    """Neither a proof nor a counterexample was found.

    The time or the memory that was allowed is used up, or what was found depends on something that the proof leaves open, such as a condition on a number that
    is computed. That is no proof, and so it does not pass for one. More time (`--time-limit`), a condition on a `bool` or an `enum` instead of a number,
    or a process of its own for the part in question may settle it.

    Refused::

        process Waits {
          in level : int

          communication {
            var value : int
            var count : int = 0
          }

          composition {
            mu (
              level ? value ;
              count := count + value * value
            ) until count < 0 ;
            stop
          }
        }

        assert Waits deadlock free

    Mended::

        process Waits {
          in level : int

          communication {
            var value : int
            var count : int = 0
          }

          composition {
            mu (
              level ? value ;
              count := count + value * value
            ) until count < 0
          }
        }

        assert Waits deadlock free
    """

    code = "E1105"
    title = "an assertion that is neither proved nor refuted"

    assertion: str
    reason: str
    candidate: tuple[str, ...] = ()

    @property
    def message(self) -> str:
        return f"`{self.assertion}` is not proved: {self.reason}"

    @property
    def help(self) -> str | None:
        if not self.candidate:
            return None
        return "\n".join(("this could not be ruled out:", *self.candidate))
