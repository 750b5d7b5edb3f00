"""The manual page of a kind of diagnostic, read from its docstring."""

from __future__ import annotations

from inspect import cleandoc

from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.record import record


@record
class ManualPage:
    """A page: what the diagnostic means, why it is refused, a program that triggers it and the mended program."""

    code: str
    title: str
    severity: str
    meaning: str
    reason: str
    refused: str
    mended: str

    @property
    def text(self) -> str:
        """The page for a terminal."""
        parts = [f"{self.code}: {self.title}", self.meaning, self.reason]
        for head, program in (("Refused:", self.refused), ("Mended:", self.mended)):
            if program:
                indented = "\n".join(f"    {line}".rstrip() for line in program.splitlines())
                parts += [head, indented]
        return "\n\n".join(part for part in parts if part) + "\n"

    @property
    def markdown(self) -> str:
        """The page below a heading, with the programs in fenced blocks."""
        parts = [self.meaning, self.reason]
        for head, program in (("Refused:", self.refused), ("Mended:", self.mended)):
            if program:
                parts += [head, f"```csp\n{program}```"]
        return "\n\n".join(part for part in parts if part) + "\n"


def manual_page(kind: type[Diagnostic]) -> ManualPage:
    """The page of a kind of diagnostic; sections that its docstring lacks are empty."""
    text, refused, mended = _sections(cleandoc(kind.__doc__ or ""))
    meaning, _, reason = text.partition("\n\n")
    return ManualPage(
        code=kind.code,
        title=kind.title,
        severity=kind.severity,
        meaning=meaning,
        reason=reason.strip(),
        refused=refused,
        mended=mended,
    )


def _sections(text: str) -> tuple[str, str, str]:
    prose, _, rest = text.partition("Refused::")
    prose = prose.replace("``", "`")
    refused, _, mended = rest.partition("Mended::")
    return prose.strip(), _program(refused), _program(mended)


def _program(text: str) -> str:
    # cleandoc leaves the first line alone and removes what the following ones have in common.
    program = cleandoc("\n" + text).strip("\n")
    return f"{program}\n" if program else ""
