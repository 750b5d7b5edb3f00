"""The explanation of a run that ended with a missed sample: what the reader did meanwhile, and what helps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from cspdiag.base.diagnostic import Diagnostic

if TYPE_CHECKING:
    from cspdiag.network.diagnostics.samples.rates import SamplesMissed
    from cspdiag.simulate.result import Run


def explained_timeout(result: Run, diagnostics: Sequence[Diagnostic]) -> str | None:
    """One or two lines to print below the summary; None if the run did not end with a missed sample.

    ``diagnostics`` are those of the program: if one of them reports what takes too long between two reads, it is
    repeated.
    """
    from cspdiag.runtime.kernel.exceptions import Timeout

    error = result.outcome.error
    place = error.place if isinstance(error, Timeout) and not error.is_of_link else None
    if place is None:
        return None
    from cspdiag.network.diagnostics.samples.rates import SamplesMissed

    for found in diagnostics:
        if isinstance(found, SamplesMissed) and _is_at(found, place.statement):
            where = f"{_base(found.span.source.name)}:{found.span.line}"
            return f"  {found.account} ({where}, W0707)\n  {found.help}"
    computes = ", or computes as long," if result.outcome.real_time else ""
    return (
        f"  from its first read of an input on, {place.process} takes each sample before the next one comes; what "
        "waits a period or longer in between"
        f"{computes} misses it\n  read in an alternative with the rest, or in a process of its own (cspdiag explain "
        "W0707)"
    )


def _is_at(found: SamplesMissed, statement: str | None) -> bool:
    return any(
        f"{_base(span.source.name)}:{span.line}" == _base(statement or "") for span in (found.read, found.earlier)
    )


def _base(path: str) -> str:
    return path.replace("\\", "/").rsplit("/", 1)[-1]
