"""The engine: requests in, answers and notifications out, as plain data (docs/design/studio.md)."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, TypeAlias

from cspdiag.api import ProgramError
from cspdiag.base.errors import CspdiagError
from cspdiag.studio.engine.data import Data, Notify
from cspdiag.studio.engine.failure import RequestError
from cspdiag.studio.engine.programs import Programs

if TYPE_CHECKING:
    from cspdiag.studio.engine.live.session import Session
    from cspdiag.studio.engine.program_file import ProgramFile

Answer: TypeAlias = Callable[[Data], Any]


class Engine:
    """Answers the requests of one page, and lets a session run between them. ``kind`` is ``browser`` or ``machine``;
    ``file`` has the program that the page opens with, if there is one.
    """

    def __init__(self, notify: Notify, kind: str = "machine", file: ProgramFile | None = None) -> None:
        self._notify = notify
        self._kind = kind
        self._file = file
        self._programs = Programs(file)
        self._answers: dict[str, Answer] = {
            "hello": self._hello,
            "check": self._check,
            "complete": self._complete,
            "hover": self._hover,
            "definition": self._definition,
            "format": self._format,
            "explain": self._explain,
            "draw": self._draw,
            "verify": self._verify,
            "timing": self._timing,
            "margins": self._margins,
            "compile": self._compile,
            "run": self._run,
            "start": self._start,
            "play": lambda params: self._session_of(params).play(params),
            "pause": lambda params: self._session_of(params).pause(),
            "step": lambda params: self._session_of(params).step(params),
            "input": lambda params: self._session_of(params).input(params),
            "tune": lambda params: self._session_of(params).tune(params),
            "state": lambda params: self._session_of(params).state(),
            "stop": lambda params: self._session_of(params).stop(),
        }
        self._session: Session | None = None
        self._sessions = 0

    def request(self, message: Data) -> Data:
        """The answer to a request: ``{"id": ..., "result": ...}``, or ``{"id": ..., "error": ...}``. Never raises."""
        number = message.get("id") if isinstance(message, dict) else None
        try:
            return {"id": number, "result": self._result(message)}
        except RequestError as problem:
            return _refusal(number, str(problem), problem.help)
        except ProgramError as problem:
            return _refusal(number, _first_error(problem), "correct its errors first")
        except CspdiagError as problem:
            return _refusal(number, str(problem), None)
        except OSError as problem:
            reason = problem.strerror or str(problem)
            return _refusal(number, f"{problem.filename}: {reason}" if problem.filename else reason, None)
        except ModuleNotFoundError as problem:
            reason = f"this needs the package {problem.name}, which this engine does not have"
            return _refusal(number, reason, "cspdiag on a machine has it")
        except (RecursionError, MemoryError):
            return _refusal(number, "the program is too large or too deeply nested for this engine", None)
        except Exception as problem:  # A mistake in cspdiag must not end the page's engine.
            return _refusal(
                number,
                f"cspdiag failed: {type(problem).__name__}: {problem}",
                "this is a mistake in cspdiag: please report it together with the program",
            )

    def _result(self, message: Data) -> Any:
        if not isinstance(message, dict):
            raise RequestError("a request is an object with id, method and params")
        params = message.get("params") or {}
        answer = self._answers.get(str(message.get("method")))
        if answer is None:
            known = ", ".join(self._answers)
            raise RequestError(f"there is no request {message.get('method')!r}; there are: {known}")
        if not isinstance(params, dict):
            raise RequestError("`params` is an object")
        return answer(params)

    def _hello(self, params: Data) -> Data:
        from cspdiag import __version__
        from cspdiag.codegen import TARGETS
        from cspdiag.studio.engine.live.native import why_not_native
        from cspdiag.studio.engine.models import models

        is_machine = self._kind == "machine"
        not_native = why_not_native() if is_machine else "in a browser programs run in Python"
        found: Data = {
            "engine": self._kind,
            "version": __version__,
            "able": {
                "numpy": find_spec("numpy") is not None,
                "native": not_native is None,
                "devices": is_machine,
                "real_time": is_machine,
                "save": False,
            },
            "unable": {} if not_native is None else {"native": not_native},
            "targets": list(TARGETS),
            "models": models(),
        }
        if self._file is None:
            return found
        program = self._file.read()
        return {**found, "program": program, "recordings": self._file.recordings(program["main"])}

    def _check(self, params: Data) -> Data:
        from cspdiag.studio.engine.checking import check

        return check(self._programs.view(self._programs.files_of(params)))

    def _complete(self, params: Data) -> list[Data]:
        from cspdiag.studio.engine.editing import complete

        return complete(*self._programs.at(params))

    def _hover(self, params: Data) -> Data | None:
        from cspdiag.studio.engine.editing import hover

        return hover(*self._programs.at(params))

    def _definition(self, params: Data) -> list[Data]:
        from cspdiag.studio.engine.editing import definition

        return definition(*self._programs.at(params))

    def _format(self, params: Data) -> Data:
        from cspdiag.studio.engine.editing import formatted

        text = params.get("text")
        if not isinstance(text, str):
            raise RequestError("`text` is the text to format")
        return formatted(text)

    def _explain(self, params: Data) -> Data:
        from cspdiag.studio.engine.models import manual_page

        return manual_page(str(params.get("code")))

    def _draw(self, params: Data) -> Data:
        from cspdiag.studio.engine.drawing import draw

        return draw(self._programs.view(self._programs.files_of(params)), params)

    def _verify(self, params: Data) -> list[Data]:
        from cspdiag.studio.engine.proving import verify

        return verify(self._programs.files_of(params), params)

    def _timing(self, params: Data) -> Data:
        from cspdiag.studio.engine.proving import timing

        return timing(self._programs.loaded(self._programs.files_of(params)))

    def _margins(self, params: Data) -> Data:
        from cspdiag.studio.engine.proving import margins

        return margins(self._programs.loaded(self._programs.files_of(params)), params)

    def _compile(self, params: Data) -> Data:
        from cspdiag.studio.engine.running import compiled

        return compiled(self._programs.loaded(self._programs.files_of(params)), params)

    def _run(self, params: Data) -> Data:
        from cspdiag.studio.engine.running import run

        return run(self._programs.loaded(self._programs.files_of(params)), params)

    # Live sessions

    def _start(self, params: Data) -> Data:
        from cspdiag.studio.engine.live.session import Session

        if params.get("real_time") and self._kind == "browser":
            raise RequestError("in a browser programs run in virtual time", "`cspdiag studio FILE` has real time")
        if params.get("target") == "c" and self._kind == "browser":
            raise RequestError("in a browser programs run in Python", "`cspdiag studio FILE` has native code")
        self.close()
        self._sessions += 1
        self._session = Session(self._sessions, self._programs.files_of(params), params, self._notify)
        return self._session.description()

    def _session_of(self, params: Data) -> Session:
        if self._session is None or params.get("session") != self._session.number:
            raise RequestError("there is no such session", "start one")
        return self._session

    def due(self) -> float | None:
        """Seconds until ``proceed`` is to be called, None if nothing runs."""
        return None if self._session is None else self._session.due()

    @property
    def keeps_pace(self) -> bool:
        """Whether a program runs in real time, which nothing may delay."""
        return self._session is not None and self._session.keeps_pace

    def proceed(self) -> None:
        """Let the session run for a frame, if one is due."""
        if self._session is not None:
            self._session.proceed()

    def close(self) -> None:
        """End the session, if there is one, and release the outputs of its program."""
        session, self._session = self._session, None
        if session is not None:
            session.stop()


def _first_error(problem: ProgramError) -> str:
    """A sentence: the page shows all errors beside the text."""
    errors = [each for each in problem.diagnostics if each.severity == "error"]
    first, more = errors[0], len(errors) - 1
    others = f" (and {more} more)" if more else ""
    return f"the program has errors: {first.code} {first.message}, {first.span.file}:{first.span.line}{others}"


def _refusal(number: object, message: str, help: str | None) -> Data:
    error: Data = {"message": message}
    if help is not None:
        error["help"] = help
    return {"id": number, "error": error}
