"""Diagnostics of names: unknown names, clashes, and names of the wrong kind."""

from __future__ import annotations

import re

from cspdiag.base import Diagnostic, Edit, Label, Span
from cspdiag.base.edits import slip
from cspdiag.base.record import record


@record
class DuplicateDefinition(Diagnostic):
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
            return (
                "a label names one arrow; join the two arrows to `source, ... -> label -> sink, ...`, or rename one "
                "label"
            )
        if self.kind == "a local value" and self.first_kind == "an out port":
            return f"give the output its value without `let`: `{self.name} = ...`"
        return "choose another name for one of them"

    @property
    def edits(self) -> tuple[Edit, ...]:
        let = re.search(r"\blet\s+\Z", self.span.source.text[max(0, self.span.start - 20) : self.span.start])
        if let is None or (self.kind, self.first_kind) != ("a local value", "an out port"):
            return ()
        return (Edit(Span(self.span.source, self.span.start - len(let[0]), self.span.start), ""),)

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, f"`{self.name}` is {self.first_kind} here"),)


@record
class ReservedName(Diagnostic):
    code = "E0203"
    title = "a reserved name"
    help = "choose another name"

    name: str
    meaning: str

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.meaning}, and cannot be redefined"


@record
class UnknownName(Diagnostic):
    code = "E0204"
    title = "an unknown name"

    name: str
    expected: str
    suggestion: str | None
    declared: Span | None
    advice: str | None = None
    is_synonym: bool = False
    """Whether the unknown name is what other languages call the suggestion."""

    @property
    def message(self) -> str:
        return f"there is no {self.expected} `{self.name}`"

    @property
    def help(self) -> str | None:
        return f"did you mean `{self.suggestion}`?" if self.suggestion else self.advice

    @property
    def edits(self) -> tuple[Edit, ...]:
        if self.is_synonym and self.suggestion and self.span.text == self.name:
            return (Edit(self.span, self.suggestion),)
        return slip(self.span, self.name, self.suggestion)

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.suggestion}` is declared here"),) if self.declared else ()


@record
class WrongKind(Diagnostic):
    code = "E0205"
    title = "a name of the wrong kind"

    name: str
    kind: str
    expected: str
    advice: str | None
    declared: Span | None

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind}, not {self.expected}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.name}` is declared here"),) if self.declared else ()


@record
class UnknownMember(Diagnostic):
    code = "E0206"
    title = "an unknown port, field or literal"

    name: str
    owner: str
    expected: str
    options: tuple[str, ...]
    suggestion: str | None
    declared: Span | None

    @property
    def message(self) -> str:
        return f"{self.owner} has no {self.expected} `{self.name}`"

    @property
    def help(self) -> str | None:
        if self.suggestion:
            return f"did you mean `{self.suggestion}`?"
        if not self.options:
            return f"it has no {self.expected}s at all"
        shown = ", ".join(f"`{option}`" for option in self.options[:8])
        return f"it has {shown}" + (", …" if len(self.options) > 8 else "")

    @property
    def edits(self) -> tuple[Edit, ...]:
        return slip(self.span, self.name, self.suggestion)

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"{self.owner} is declared here"),) if self.declared else ()


@record
class ShadowedReplicator(Diagnostic):
    code = "E0207"
    title = "a replicator that hides another name"
    help = "choose another name for the replicator"

    name: str
    kind: str
    first: Span

    @property
    def message(self) -> str:
        return f"the replicator `{self.name}` hides {self.kind} of the same name"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, f"`{self.name}` is {self.kind} here"),)


@record
class Recursion(Diagnostic):
    code = "E0208"
    title = "a definition that depends on itself"

    name: str
    kind: str
    cycle: tuple[tuple[str, Span], ...]

    @property
    def message(self) -> str:
        if len(self.cycle) == 1:
            return f"{self.kind} `{self.name}` depends on itself"
        names = " → ".join(name for name, _ in (*self.cycle, self.cycle[0]))
        return f"{self.kind} `{self.name}` depends on itself: {names}"

    @property
    def help(self) -> str | None:
        if self.kind == "process":
            return "a process cannot contain itself; repeat with `mu` in the composition"
        return None

    @property
    def labels(self) -> tuple[Label, ...]:
        following = (*self.cycle[1:], self.cycle[0])
        return tuple(
            Label(span, f"`{name}` depends on `{after}`")
            for (name, span), (after, _) in zip(self.cycle, following, strict=True)
            if len(self.cycle) > 1
        )[:12]
