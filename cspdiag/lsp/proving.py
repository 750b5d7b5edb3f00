"""Proves the assertions of a program in a process of its own, so that the editor is answered meanwhile."""

from __future__ import annotations

import asyncio
import json
import pickle
import sys
from collections.abc import Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any, assert_never

from cspdiag.base.errors import CspdiagError
from cspdiag.base.parent import end_with_input
from cspdiag.base.sources import given_source, read_source
from cspdiag.base.span import SourceFile
from cspdiag.editing.proved import Proved

if TYPE_CHECKING:
    from cspdiag.proofs.answers.answer import Answer

TIME_LIMIT = 60.0
"""Seconds for each assertion, as for ``cspdiag verify``."""
MEMORY_LIMIT = 2_000_000_000
"""Bytes for states, as for ``cspdiag verify``."""

_PROGRAM = (
    "import json, sys; request = json.loads(sys.stdin.readline()); sys.path[:] = request['path']; "
    "from cspdiag.lsp.proving import answer; answer(request)"
)


class ProvingError(CspdiagError):
    """Nothing can be proved; the text says why."""


async def prove(main: SourceFile, texts: Mapping[str, str | None], start: int) -> list[Proved]:
    """Answer the assertion that begins at an offset, given all texts of the program, None for those that could not be
    read. Raises ProvingError.
    """
    request = {
        "path": sys.path,
        "main": main.name,
        "texts": {**texts, main.name: main.text},
        "start": start,
    }
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-c", _PROGRAM, stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.PIPE,
    )  # fmt: skip
    try:
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdin.write(json.dumps(request).encode() + b"\n")
        # Its standard input stays open: the process ends with this one.
        output, errors = await asyncio.gather(process.stdout.read(), process.stderr.read())
        await process.wait()
    finally:
        with suppress(ProcessLookupError):
            process.kill()
    if process.returncode:
        lines = errors.decode(errors="replace").strip().splitlines()
        raise ProvingError(lines[-1] if lines else f"the prover ended with exit code {process.returncode}")
    # What the process of this program has written.
    found: list[Proved] | str = pickle.loads(output)
    if isinstance(found, str):
        raise ProvingError(found)
    return found


def answer(request: Mapping[str, object]) -> None:
    """Be the process: write the answers, or why there are none, to standard output."""
    end_with_input()
    output = sys.stdout.buffer
    # Whatever a prover prints does not belong to the answer.
    sys.stdout = sys.stderr
    output.write(pickle.dumps(_answers(request)))
    output.flush()


def _answers(request: Mapping[str, object]) -> list[Proved] | str:
    from cspdiag.editing.steps import steps_shown
    from cspdiag.obligations import proof_obligations
    from cspdiag.proofs.answers.findings import diagnostic_of
    from cspdiag.proofs.verdict import Limits
    from cspdiag.verify.confirm import Verifier
    from cspdiag.verify.systems import VerificationError

    main, texts, start = request["main"], request["texts"], request["start"]
    assert isinstance(main, str)
    assert isinstance(texts, dict)

    def read(name: str) -> SourceFile:
        # What is not in the program itself is what it calls.
        return given_source(name, texts) if name in texts else read_source(name)

    obligations = proof_obligations(read(main), read)
    report = obligations.checked.report
    if report.has_errors:
        return "the program has errors"
    questions = [each for each in obligations.questions if each.span.start == start and each.asserted]
    obligations.lower(questions)
    problem = report.first_error
    if problem is not None:
        # Only now: it belongs to these assertions.
        return problem.message
    verifier = Verifier(obligations, read, None)
    try:
        answers = [verifier.answer(question, Limits(TIME_LIMIT, MEMORY_LIMIT)) for question in questions]
    except VerificationError as problem:
        return str(problem)
    program = obligations.checked.program

    def steps(answer: Answer) -> tuple[dict[str, Any], ...]:
        if answer.counterexample is None or program is None:
            return ()
        network = obligations.network(answer.question.process)
        return tuple(steps_shown(program, answer.counterexample, network))

    return [Proved(each.question.span.start, title_of(each), diagnostic_of(each), steps(each)) for each in answers]


def title_of(answer: Answer) -> str:
    """An answer in a sentence."""
    from cspdiag.proofs.answers.findings import diagnostic_of

    found = diagnostic_of(answer)
    match answer.outcome:
        case "proved":
            return f"Proved: {answer.reason}"
        case "refuted":
            return f"Refuted: {answer.reason if found is None else found.message}"
        case "unknown":
            # The message of the diagnostic says again that it is not proved.
            return f"Not proved: {answer.reason}"
        case _:
            assert_never(answer.outcome)
