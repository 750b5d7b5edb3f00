"""The output of ``verify``: answers, warnings, and why nothing can be proved, in the requested format."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from typing import TYPE_CHECKING

from cspdiag.base.standard_streams import standard_error
from cspdiag.cli.support.diagnostic_formats import rendered_diagnostics
from cspdiag.cli.support.failure import UNSUCCESSFUL
from cspdiag.cli.support.terminal import put, wants_colour, write_out

if TYPE_CHECKING:
    from cspdiag.base.diagnostic import Diagnostic
    from cspdiag.proofs.answers.answer import Answer


def refused(diagnostics: Sequence[Diagnostic], arguments: Namespace) -> int:
    """Report why nothing can be proved about a program, as ``check`` reports it."""
    colour = wants_colour(arguments.color, standard_error())
    stdout, stderr = rendered_diagnostics(diagnostics, arguments.format, [arguments.file], colour=colour)
    write_out(stdout)
    put(stderr)
    return UNSUCCESSFUL


def rendered_answers(
    answers: Sequence[Answer], warnings: Sequence[Diagnostic], arguments: Namespace, nothing: str = ""
) -> tuple[str, str]:
    """The texts for standard output and for standard error. Formats that contain only answers leave warnings to
    standard error, as all do with ``nothing``, the reason why there are no answers.
    """
    stdout, stderr = _rendered(answers, warnings, arguments)
    if nothing and not arguments.quiet:
        stderr += f"cspdiag: nothing to verify: {nothing}\n"
    return stdout, stderr


def _rendered(answers: Sequence[Answer], warnings: Sequence[Diagnostic], arguments: Namespace) -> tuple[str, str]:
    from cspdiag.proofs.answers.findings import diagnostics_of

    colour = wants_colour(arguments.color, standard_error())
    if arguments.format in {"concise", "sarif", "github"}:
        return rendered_diagnostics([*warnings, *diagnostics_of(answers)], arguments.format, [], colour=colour)
    _, before = rendered_diagnostics(warnings, "text", [], colour=colour)
    match arguments.format:
        case "json":
            return answers_as_json(answers), before
        case "junit":
            from cspdiag.proofs.answers.junit import render as render_junit

            return render_junit(answers, arguments.file), before
        case "text":
            from cspdiag.proofs.answers.text import render as render_text

            return "", before + render_text(answers, colour=colour, quiet=arguments.quiet or not answers)
        case format_:
            raise AssertionError(f"answers have no format {format_!r}")


def answers_as_json(answers: Sequence[Answer]) -> str:
    """The answers as data."""
    from cspdiag.proofs.answers.json import render

    return render(answers)
