"""What a server does before the first command: it checks a program a few times.

That loads the modules that a check needs, the grammar too, and the interpreter adapts the instructions that it runs.
"""

from __future__ import annotations

from contextlib import suppress

from cspdiag.base.files.resources import case_study
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.cli.main import verb_parser
from cspdiag.cli.support.diagnostic_formats import FORMATS, rendered_diagnostics
from cspdiag.pipeline import check

_TIMES = 4


def practise() -> None:
    """Check the case study, and what is left of it if it is cut in half, and show the findings in all formats."""
    verb_parser("check")
    with suppress(OSError):
        whole = read_source(case_study())
        half = SourceFile(name=whole.name, text=whole.text[: len(whole.text) // 2])
        for _ in range(_TIMES):
            check(whole, read_source)
            found = check(half, read_source).report.diagnostics
        for name in FORMATS:
            rendered_diagnostics(found, name, [whole.name], colour=True)
