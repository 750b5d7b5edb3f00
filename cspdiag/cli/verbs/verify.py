"""``cspdiag verify``: prove the assertions of a program, or show how they fail."""

from __future__ import annotations

import os
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cspdiag.arguments import LONGEST_LIMIT
from cspdiag.base.render.snippet import on_one_line
from cspdiag.base.standard_streams import standard_error
from cspdiag.cli.support.diagnostic_formats import FORMATS, REPORTS, rendered_diagnostics, unreadable
from cspdiag.cli.support.failure import FINE, UNSUCCESSFUL, NoResultError, UsageError
from cspdiag.cli.support.files.output import replace_text
from cspdiag.cli.support.files.written import file_path, require_different, require_file
from cspdiag.cli.support.numbers import add_real, add_settings, positive
from cspdiag.cli.support.proofs.answers import answers_as_json, refused, rendered_answers
from cspdiag.cli.support.terminal import put, say, wants_colour, write_out

if TYPE_CHECKING:
    from cspdiag.obligations import ProofObligations
    from cspdiag.pipeline import Reader
    from cspdiag.proofs.answers.answer import Answer

EXAMPLE = (
    "cspdiag verify models/jiwy/jiwy.csp\n"
    "cspdiag verify models/dining/deadlock.csp --trace-out trace.json\n"
    "cspdiag run models/dining/deadlock.csp --replay trace.json\n"
    "cspdiag verify models/dining/deadlock.csp --draw deadlock.svg"
)
METHODS = ("rules", "sat", "invariants", "stubborn", "minimization", "breadth-first")


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("file", metavar="FILE", help="a program; - reads standard input")
    parser.add_argument("--process", metavar="NAME", help="only what is asserted of this process, or is expected of it")
    add_settings(parser)
    add_real(parser)
    parser.add_argument(
        "--method", choices=METHODS, help="use this proof method only (default: the first that answers)"
    )
    parser.add_argument(
        "--engine", choices=("cspdiag", "spin"), default="cspdiag", help="the prover (default: cspdiag)"
    )
    parser.add_argument(
        "--time-limit",
        metavar="S",
        type=positive(1e-6, LONGEST_LIMIT, "seconds"),
        default=60.0,
        help="seconds for each assertion (default: 60)",
    )
    parser.add_argument(
        "--memory-limit",
        metavar="MB",
        type=positive(1e-6, 1e9, "megabytes"),
        default=2000.0,
        help="megabytes for states (default: 2000)",
    )
    parser.add_argument(
        "--format", choices=FORMATS, default="text",
        help=(
            "output format: text and concise, for people, on standard error; the others, and what --timing "
            "prints, on standard output (default: text)"
        ),
    )  # fmt: skip
    parser.add_argument("--json", type=file_path, metavar="FILE", help="also write to FILE what --format json prints")
    parser.add_argument(
        "--trace-out", type=file_path, metavar="FILE", help="the first counterexample, for run --replay"
    )
    parser.add_argument(
        "--draw", type=file_path, metavar="FILE",
        help="the waiting processes of the first deadlock or knot, as .svg, .png or .pdf",
    )  # fmt: skip
    parser.add_argument(
        "--timing", action="store_true", help="print response times, latencies and advice instead of proving assertions"
    )
    parser.add_argument(
        "--gantt", type=file_path, metavar="FILE", help="with --timing: one hyperperiod as an .svg picture"
    )
    parser.add_argument(
        "--wcet-from",
        type=file_path,
        metavar="FILE",
        help="execution times measured in a run, instead of those in the text",
    )
    parser.add_argument(
        "--wcet-factor",
        type=positive(1, 1000, "times"),
        metavar="FACTOR",
        help="with --wcet-from: by how much times may be longer than the longest one measured, from 1",
    )
    parser.add_argument("--no-cache", action="store_true", help="prove again what was proved before")
    parser.add_argument("--quiet", action="store_true", help="show only what is not proved")


def run(arguments: Namespace) -> int:
    """Prove, and report; the exit code says whether everything was proved."""
    try:
        return _run(arguments)
    except OSError as problem:
        if problem.filename == arguments.file:
            found = [unreadable(problem, arguments.file)]
            if arguments.format in REPORTS:
                refused(found, arguments)
            _write_json(arguments, rendered_diagnostics(found, "json", [], colour=False)[0])
        raise


def _run(arguments: Namespace) -> int:
    if arguments.wcet_factor is not None and arguments.wcet_from is None:
        raise UsageError("--wcet-factor: multiplies measured times: give them with --wcet-from FILE")
    if arguments.timing or arguments.gantt is not None or arguments.wcet_from is not None:
        from cspdiag.cli.verbs.verify_timing import run_timing

        return run_timing(arguments)
    from cspdiag.cli.support.proofs.cache import Cache, Printed

    if arguments.engine == "spin" and arguments.method is not None:
        raise UsageError("--method is for the prover of cspdiag: --engine spin has its own (leave one of them out)")
    require_file("--trace-out", arguments.trace_out)
    require_file("--json", arguments.json)
    written = {"--trace-out": arguments.trace_out, "--draw": arguments.draw, "--json": arguments.json}
    require_different({"the program": arguments.file, **written})
    if arguments.draw is not None:
        from cspdiag.cli.support.deadlock_picture import check_picture

        check_picture("--draw", arguments.draw)
    cache = Cache(repr(_relevant_options(arguments)))
    is_cached = not arguments.no_cache and arguments.file != "-"
    is_cached = is_cached and arguments.trace_out is None and arguments.draw is None
    printed = cache.find() if is_cached else None
    obligations: ProofObligations | None = None
    answers: list[Answer] = []
    if printed is None:
        from cspdiag.network.lower.external_bodies import files_of_bodies

        obligations = _find_obligations(arguments, cache.read)
        found = obligations.checked.report.diagnostics
        if obligations.checked.report.has_errors:
            _write_json(arguments, rendered_diagnostics(found, "json", [], colour=False)[0])
            return refused(found, arguments)
        for tree in () if obligations.checked.program is None else obligations.checked.program.trees:
            cache.note(files_of_bodies(tree))
        answers = _answers(obligations, arguments, cache.read)
        code = FINE if all(answer.outcome == "proved" for answer in answers) else UNSUCCESSFUL
        stdout, stderr = rendered_answers(answers, found, arguments, obligations.nothing)
        printed = Printed(code, stdout, stderr, answers_as_json(answers))
        if is_cached and all(answer.outcome != "unknown" for answer in answers):
            cache.store(printed)
    write_out(printed.stdout)
    put(printed.stderr)
    _write_json(arguments, printed.json)
    if obligations is not None:
        _write_trace(arguments, answers)
        _draw(arguments, answers, obligations)
    return printed.code


_IRRELEVANT = frozenset({"no_cache", "trace_out", "draw", "json"})
"""The options on which what is printed does not depend."""


def _relevant_options(arguments: Namespace) -> dict[str, object]:
    """The options on which the output depends."""
    settled = {name: value for name, value in vars(arguments).items() if name not in _IRRELEVANT}
    return {**settled, "color": wants_colour(arguments.color, standard_error()), "folder": os.getcwd()}


def _find_obligations(arguments: Namespace, read: Reader) -> ProofObligations:
    """The assertions to prove, with the networks for them."""
    from cspdiag.network.lower.program import SelectionError
    from cspdiag.obligations import proof_obligations
    from cspdiag.settings import SettingError

    try:
        obligations = proof_obligations(
            read(arguments.file),
            read,
            process=arguments.process,
            settings=_settings(arguments),
            real=arguments.real,
            by_rules=arguments.engine == "cspdiag" and arguments.method in (None, "rules"),
        )
        obligations.lower()
    except (SettingError, SelectionError) as problem:
        raise UsageError(str(problem)) from None
    return obligations


def _settings(arguments: Namespace) -> dict[str, str]:
    from cspdiag.settings import split_settings

    return split_settings(arguments.settings)


def _answers(obligations: ProofObligations, arguments: Namespace, read: Reader) -> list[Answer]:
    from cspdiag.proofs.verdict import Limits
    from cspdiag.verify.confirm import Verifier
    from cspdiag.verify.systems import VerificationError

    memory = int(arguments.memory_limit * 1e6)
    spin = arguments.engine == "spin"
    verifier = Verifier(obligations, read, arguments.method, spin=spin, settings=_settings(arguments))
    try:
        return [verifier.answer(question, Limits(arguments.time_limit, memory)) for question in obligations.questions]
    except VerificationError as problem:
        raise NoResultError(str(problem)) from None


def _write_json(arguments: Namespace, text: str) -> None:
    if arguments.json is not None:
        replace_text(str(arguments.json), text)
        _report_written(arguments, arguments.json)


def _write_trace(arguments: Namespace, answers: Sequence[Answer]) -> None:
    if arguments.trace_out is None:
        return
    from cspdiag.verify.confirm import trace_of

    refuted = next((answer for answer in answers if answer.counterexample is not None), None)
    if refuted is None:
        say(f"cspdiag: nothing was refuted, so {on_one_line(arguments.trace_out)} was not written")
    else:
        replace_text(str(arguments.trace_out), trace_of(refuted, _settings(arguments), arguments.real))
        _report_written(arguments, arguments.trace_out)


def _draw(arguments: Namespace, answers: Sequence[Answer], obligations: ProofObligations) -> None:
    if arguments.draw is None:
        return
    from cspdiag.cli.support.deadlock_picture import write_picture
    from cspdiag.verify.deadlock_picture import deadlock_shown_by

    found = (answer.counterexample for answer in answers if answer.counterexample is not None)
    drawn = (deadlock_shown_by(each, obligations.network(each.process)) for each in found)
    deadlock = next(filter(None, drawn), None)
    if deadlock is None:
        say(f"cspdiag: no processes wait forever, so {on_one_line(arguments.draw)} was not written")
    else:
        write_picture(arguments.draw, deadlock, obligations.checked.program)
        _report_written(arguments, arguments.draw)


def _report_written(arguments: Namespace, path: Path) -> None:
    if not arguments.quiet:
        say(f"wrote {on_one_line(path)}")
