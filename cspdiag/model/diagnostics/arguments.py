"""Diagnostics of the arguments of an instance, a struct or a function."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Edit, Label, Span
from cspdiag.base.edits import slip
from cspdiag.base.record import record


def _at(declared: Span | None, text: str) -> tuple[Label, ...]:
    return (Label(declared, text),) if declared else ()


@record
class MissingArgument(Diagnostic):
    code = "E0211"
    title = "a missing argument"

    owner: str
    names: tuple[str, ...]
    example: str | None
    declared: Span | None

    @property
    def message(self) -> str:
        shown = ", ".join(f"`{name}`" for name in self.names)
        return f"`{self.owner}` needs a value for {shown}"

    @property
    def help(self) -> str | None:
        return f"write `{self.example}`" if self.example else None

    @property
    def labels(self) -> tuple[Label, ...]:
        return _at(self.declared, f"`{self.owner}` is defined here")


@record
class UnknownArgument(Diagnostic):
    code = "E0212"
    title = "an unknown argument"

    owner: str
    name: str
    options: tuple[str, ...]
    suggestion: str | None
    declared: Span | None

    @property
    def message(self) -> str:
        return f"`{self.owner}` has no parameter `{self.name}`"

    @property
    def help(self) -> str:
        if self.suggestion:
            return f"did you mean `{self.suggestion}`?"
        if not self.options:
            return f"`{self.owner}` has no parameters"
        return "it has " + ", ".join(f"`{option}`" for option in self.options)

    @property
    def edits(self) -> tuple[Edit, ...]:
        return slip(self.span, self.name, self.suggestion)

    @property
    def labels(self) -> tuple[Label, ...]:
        return _at(self.declared, f"`{self.owner}` is defined here")


@record
class RepeatedArgument(Diagnostic):
    code = "E0213"
    title = "an argument given twice"
    help = "leave one of them out"

    name: str
    first: Span

    @property
    def message(self) -> str:
        return f"`{self.name}` is given a value twice"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, f"the first value of `{self.name}`"),)


@record
class TooManyArguments(Diagnostic):
    code = "E0214"
    title = "too many arguments"

    owner: str
    given: int
    allowed: int
    declared: Span | None

    @property
    def message(self) -> str:
        taken = {0: "no arguments", 1: "one argument"}.get(self.allowed, f"{self.allowed} arguments")
        return f"`{self.owner}` takes {taken}, but {self.given} are given"

    @property
    def help(self) -> str:
        return (
            f"remove the last {self.given - self.allowed}" if self.given - self.allowed > 1 else "remove the last one"
        )

    @property
    def labels(self) -> tuple[Label, ...]:
        return _at(self.declared, f"`{self.owner}` is defined here")


@record
class PositionalAfterNamed(Diagnostic):
    code = "E0215"
    title = "a positional argument after a named one"
    message = "an argument by position cannot follow one by name"

    names: tuple[str, ...]

    @property
    def help(self) -> str:
        if not self.names:
            return "give it by name"
        return f"give it by name: `{self.names[0]} = ...`"

    @property
    def edits(self) -> tuple[Edit, ...]:
        if len(self.names) != 1:
            return ()
        return (Edit(Span(self.span.source, self.span.start, self.span.start), f"{self.names[0]} = "),)


@record
class WrongNumberOfArguments(Diagnostic):
    code = "E0216"
    title = "the wrong number of arguments"

    function: str
    given: int
    signature: str

    @property
    def message(self) -> str:
        given = {0: "no arguments", 1: "one argument"}.get(self.given, f"{self.given} arguments")
        return f"`{self.function}` cannot be given {given}"

    @property
    def help(self) -> str:
        return f"write `{self.signature}`"


@record
class UnknownOption(Diagnostic):
    code = "E0217"
    title = "an unknown option"

    owner: str
    option: str
    options: tuple[str, ...]
    suggestion: str | None

    @property
    def message(self) -> str:
        return f"{self.owner} cannot be `{self.option}`"

    @property
    def help(self) -> str:
        if self.suggestion:
            return f"did you mean `{self.suggestion}`?"
        return "choose among " + ", ".join(f"`{option}`" for option in self.options)

    @property
    def edits(self) -> tuple[Edit, ...]:
        return slip(self.span, self.option, self.suggestion)
