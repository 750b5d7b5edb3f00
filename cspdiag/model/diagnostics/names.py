"""What can be wrong with names: unknown ones, clashes, and names of the wrong kind of thing."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


@record
class DuplicateDefinition(Diagnostic):
    """Two definitions have the same name.

    Names of definitions hold in the whole program, imported files and the bundled library included, so that each may be used for one
    thing only.

    Refused::

        const T = 1 ms
        enum T { idle, run }

    Mended::

        const T = 1 ms
        enum Mode { idle, run }
    """

    code = "E0201"
    title = "a definition given twice"

    name: str
    first: Span
    library: str | None

    @property
    def message(self) -> str:
        return f"`{self.name}` is already defined"

    @property
    def help(self) -> str:
        if self.library:
            return f"the bundled library {self.library} defines `{self.name}`; choose another name"
        return "choose another name for one of them"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, f"the first definition of `{self.name}`"),)


@record
class DuplicateName(Diagnostic):
    """Two things in one process, submodel, struct or enum have the same name.

    Ports, parameters, instances, variables, channels, labels, states and local values share one space of names, because any of them
    may be named in the composition or in an equation. A label stands for one communication object, so that it names one arrow only.

    Refused::

        process Main {
          out y : int
          communication { var y : int = 0 }
          composition { y ! 1 }
        }

    Mended::

        process Main {
          out y : int
          communication { var x : int = 0 }
          composition { y ! x }
        }
    """

    code = "E0202"
    title = "a name used for two things"

    name: str
    where: str
    kind: str
    first: Span
    first_kind: str

    @property
    def message(self) -> str:
        return f"`{self.name}` is already {self.first_kind} in {self.where}"

    @property
    def label(self) -> str:
        return f"again, as {self.kind}"

    @property
    def help(self) -> str:
        if self.kind == self.first_kind == "the label of an arrow":
            return "a label names one arrow; join the two arrows to `source, ... -> label -> sink, ...`, or rename one label"
        if self.kind == "a local value" and self.first_kind == "an out port":
            return f"give the output its value without `let`: `{self.name} = ...`"
        return "choose another name for one of them"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, f"`{self.name}` is {self.first_kind} here"),)


@record
class ReservedName(Diagnostic):
    """A name of the language is used for something else.

    ``time``, ``sample`` and ``pi`` are values that equations may use; the names of types, functions and built-in exceptions cannot be
    given to types and exceptions of your own.

    Refused::

        const pi = 3

    Mended::

        const three = 3
    """

    code = "E0203"
    title = "a reserved name"

    name: str
    meaning: str

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.meaning}, and cannot be declared anew"

    @property
    def help(self) -> str:
        return "choose another name"


@record
class UnknownName(Diagnostic):
    """A name stands for nothing.

    Values are parameters, constants, variables and labels (in a process), inputs, states and local values (in a submodel).
    Definitions come from this file and the files it imports.

    Refused::

        const T = 1 ms
        const period = 2 * Tt

    Mended::

        const T = 1 ms
        const period = 2 * T
    """

    code = "E0204"
    title = "an unknown name"

    name: str
    wanted: str
    suggestion: str | None
    declared: Span | None
    advice: str | None = None

    @property
    def message(self) -> str:
        return f"there is no {self.wanted} `{self.name}`"

    @property
    def help(self) -> str | None:
        return f"did you mean `{self.suggestion}`?" if self.suggestion else self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.suggestion}` is declared here"),) if self.declared else ()


@record
class WrongKind(Diagnostic):
    """A name stands for another kind of thing than is wanted in its place.

    An instance is made of a process or a submodel, a composition runs instances, an environment is made for a process, values are
    had from variables and parameters but not from ports: these have to be read.

    Refused::

        enum Mode { idle, run }

        process Main {
          out y : Mode
          communication { mode : Mode }
          composition { y ! Mode.run }
        }

    Mended::

        enum Mode { idle, run }

        process Main {
          out y : Mode
          communication { var mode : Mode = Mode.idle }
          composition { y ! mode }
        }
    """

    code = "E0205"
    title = "a name of the wrong kind"

    name: str
    kind: str
    wanted: str
    advice: str | None
    declared: Span | None

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind}, not {self.wanted}"

    @property
    def help(self) -> str | None:
        return self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.name}` is declared here"),) if self.declared else ()


@record
class UnknownMember(Diagnostic):
    """What follows the point is no port, field or literal of what stands before it.

    An instance has the ports of its definition, a struct its fields, an enum its literals, and nothing else.

    Refused::

        enum Mode { idle, run }
        const start = Mode.idel

    Mended::

        enum Mode { idle, run }
        const start = Mode.idle
    """

    code = "E0206"
    title = "an unknown port, field or literal"

    name: str
    owner: str
    wanted: str
    options: tuple[str, ...]
    suggestion: str | None
    declared: Span | None

    @property
    def message(self) -> str:
        return f"{self.owner} has no {self.wanted} `{self.name}`"

    @property
    def help(self) -> str | None:
        if self.suggestion:
            return f"did you mean `{self.suggestion}`?"
        if not self.options:
            return f"it has no {self.wanted}s at all"
        shown = ", ".join(f"`{option}`" for option in self.options[:8])
        return f"it has {shown}" + (", …" if len(self.options) > 8 else "")

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"{self.owner} is declared here"),) if self.declared else ()


@record
class ShadowedReplicator(Diagnostic):
    """A replicator has the name of something that is already visible where it stands.

    The inner one would hide the outer one, and an index would silently mean something else.

    Refused::

        const N = 2

        process Main {
          out y[N] : int
          composition { par N < 2 : y[N] ! 1 }
        }

    Mended::

        const N = 2

        process Main {
          out y[N] : int
          composition { par i < N : y[i] ! 1 }
        }
    """

    code = "E0207"
    title = "a replicator that hides another name"

    name: str
    kind: str
    first: Span

    @property
    def message(self) -> str:
        return f"the replicator `{self.name}` hides {self.kind} of the same name"

    @property
    def help(self) -> str:
        return "choose another name for the replicator"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, f"`{self.name}` is {self.kind} here"),)


@record
class Recursion(Diagnostic):
    """A definition needs itself, directly or through others.

    A diagram is drawn out whole before it runs, so that a process cannot contain itself; a constant, type or struct that needs its own
    value or size has none. Repetition is written with ``mu``.

    Refused::

        const a = b + 1
        const b = a + 1

    Mended::

        const a = b + 1
        const b = 1
    """

    code = "E0208"
    title = "a definition that contains itself"

    name: str
    kind: str
    cycle: tuple[tuple[str, Span], ...]

    @property
    def message(self) -> str:
        if len(self.cycle) == 1:
            return f"{self.kind} `{self.name}` needs itself"
        names = " → ".join(name for name, _ in (*self.cycle, self.cycle[0]))
        return f"{self.kind} `{self.name}` needs itself: {names}"

    @property
    def help(self) -> str | None:
        if self.kind == "process":
            return "a process cannot contain itself; repeat with `mu` in the composition"
        return None

    @property
    def labels(self) -> tuple[Label, ...]:
        following = (*self.cycle[1:], self.cycle[0])
        return tuple(
            Label(span, f"`{name}` needs `{after}`")
            for (name, span), (after, _) in zip(self.cycle, following, strict=True)
            if len(self.cycle) > 1
        )[:12]
