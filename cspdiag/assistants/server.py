"""The server: a tool for each thing that an assistant may want to do with a program."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, Literal, TypedDict

from mcp.server.mcpserver import MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp.types import CallToolResult, ContentBlock, ImageContent, TextContent
from pydantic import Field

from cspdiag.assistants.arguments import PlainServer, strict_tool
from cspdiag.assistants.commands import PATIENCE, Finished, command, shortened
from cspdiag.assistants.folder import Folder, OutsideError
from cspdiag.base.files.resources import language_page

INSTRUCTIONS = """\
cspdiag is a language for communication and composition diagrams of CSP: concurrent, multi-rate controllers, their \
checks, proofs, runs and pictures. Read the resource cspdiag://language before you write a program. After each change \
check the program; `explain` has a manual page for each code. `verify` proves freedom from deadlock and what else the \
program asserts, and shows a counterexample otherwise; `run` executes the program against an environment of its text, \
with the bodies in Python that it has."""

File = Annotated[str, Field(description="a program, as a path relative to the folder")]
Process = Annotated[str | None, Field(description="a process; the outermost one by default")]
Settings = Annotated[
    dict[str, bool | str | float] | None,
    Field(description='constants and parameters: {"Tsh": "10 ms", "gains.kp": 3, "pan.inertia": 2e-3}'),
]
Seconds = Annotated[float, Field(gt=0, le=3600, description="the time limit in seconds")]


class Programs(TypedDict):
    """The programs of the folder."""

    programs: list[str]


class Diagnostics(TypedDict):
    """Errors and warnings, each with code, severity, message, place, help, related places and edits that fix it."""

    errors: int
    warnings: int
    diagnostics: list[dict[str, Any]]


class Answers(TypedDict):
    """An answer for each assertion: its verdict is proved, refuted or unknown."""

    proved: int
    refuted: int
    unknown: int
    answers: list[dict[str, Any]]


class Figures(TypedDict, total=False):
    """How many values passed a port and how often they changed; of numbers the least and the greatest."""

    values: int
    changes: int
    least: float | str
    greatest: float | str
    last: bool | float | str


class RunResult(TypedDict):
    """How a run ended, and the figures of each external port, as `cspdiag run --json` writes them."""

    successful: bool
    summary: str
    ports: dict[str, Figures]


class Picture(TypedDict):
    """What a picture shows."""

    shows: str


class Page(TypedDict):
    """A manual page."""

    code: str
    page: str


class Formatted(TypedDict):
    """Whether the text was or would be changed, and how."""

    changed: bool
    difference: str


def server(path: Path) -> MCPServer[Any]:
    """A server for the programs of a folder."""
    from cspdiag import __version__

    tools = _Tools(Folder(path))
    offered = (tools.programs, tools.check, tools.verify, tools.run, tools.draw, tools.explain, tools.fmt)
    serving = PlainServer(
        "cspdiag",
        instructions=INSTRUCTIONS,
        version=__version__,
        log_level="WARNING",
        tools=[strict_tool(tool) for tool in offered],
    )

    @serving.resource("cspdiag://language", mime_type="text/markdown")
    def language() -> str:
        """The language in brief: enough to read, write and change programs."""
        return language_page()

    return serving


class _Tools:
    """The tools; the docstring of each is what the assistant reads."""

    def __init__(self, folder: Folder) -> None:
        self._folder = folder

    async def programs(self) -> Annotated[CallToolResult, Programs]:
        """List the programs of the folder."""
        found = list(self._folder.programs())
        return _result("\n".join(found) or "The folder has no programs.", Programs(programs=found))

    async def check(self, file: File) -> Annotated[CallToolResult, Diagnostics]:
        """Find everything that is wrong with a program: syntax, names, types and units, connections, kinds of channels,
        compositions, sample periods. Errors that have exactly one correction have it as `edits`.
        """
        name = self._program(file)
        done = await self._command("check", "--format", "json", "--", name)
        found = _json(done.out, done)
        errors = sum(each["severity"] == "error" for each in found)
        text = (await self._command("check", "--format", "text", "--", name)).err if found else "No errors."
        return _result(text, Diagnostics(errors=errors, warnings=len(found) - errors, diagnostics=found))

    async def verify(
        self, file: File, process: Process = None, settings: Settings = None, seconds: Seconds = 60
    ) -> Annotated[CallToolResult, Answers]:
        """Prove the assertions of a program, or that it has no deadlock and no livelock if it asserts nothing. What is
        refuted has a counterexample, and changes after which it is proved where such are found. The time limit is for
        each assertion.
        """
        options = _options(process, settings)
        name = self._program(file)
        limit = ("--time-limit", f"{seconds:g}")
        with TemporaryDirectory() as folder:
            data = Path(folder, "answers.json")
            done = await self._command(
                "verify", "--json", str(data), *limit, *options, "--", name, seconds=20 * seconds + PATIENCE
            )
            answers = _json(data.read_text(encoding="utf-8") if data.exists() else "", done)
        text = _without_written(done)
        if any("verdict" not in each for each in answers):
            raise ToolError(shortened(text))
        count = {outcome: sum(each["verdict"] == outcome for each in answers) for outcome in _VERDICTS}
        return _result(
            text,
            Answers(proved=count["proved"], refuted=count["refuted"], unknown=count["unknown"], answers=answers),
        )

    async def run(
        self,
        file: File,
        duration: Annotated[str, Field(description='simulated time after which it ends: "20 s", "500 ms"')] = "10 s",
        environment: Annotated[str | None, Field(description="an environment; the first one by default")] = None,
        settings: Settings = None,
        plot: Annotated[bool, Field(description="whether to plot the external ports")] = True,
        seconds: Seconds = 60,
    ) -> Annotated[CallToolResult, RunResult]:
        """Run a program against an environment, in virtual time, and say how it ended: at the time limit, by itself, in
        a deadlock (and which process waits for which), or with an error. Bodies in Python that the program names are
        executed.
        """
        name = self._program(file)
        chosen = () if environment is None else (f"--environment={environment}",)
        with TemporaryDirectory() as folder:
            ended, picture = Path(folder, "run.json"), Path(folder, "run.png")
            done = await self._command(
                "run", f"--for={duration.replace(' ', '')}", *chosen, *_options(None, settings), "--json",
                str(ended), *(("--plot", str(picture)) if plot else ()), "--", name, seconds=seconds, may_fail=True,
            )  # fmt: skip
            lines = [_without_written(done)]
            if done.code is None:
                lines.append(f"It was ended because it took more than {seconds:g} s.")
            if done.out:
                lines.append(f"The program printed:\n{done.out}")
            text = shortened("\n".join(lines))
            if done.code is not None and not ended.exists():
                raise ToolError(text)  # It was not run.
            ports = json.loads(ended.read_text(encoding="utf-8"))["ports"] if ended.exists() else {}
            result = RunResult(successful=done.code == 0, summary=text, ports=ports)
            return _result(text, result, picture if picture.exists() else None)

    async def draw(
        self,
        file: File,
        process: Annotated[str | None, Field(description="a process or an environment")] = None,
        diagram: Annotated[
            Literal["communication", "composition", "both"], Field(description="which diagram")
        ] = "both",
        depth: Annotated[int, Field(ge=1, le=5, description="how many levels of instances are unfolded")] = 1,
    ) -> Annotated[CallToolResult, Picture]:
        """Draw the diagrams of a process; a program with errors is drawn as far as it can be read, with its errors
        marked.
        """
        name = self._program(file)
        chosen = () if process is None else (f"--process={process}",)
        with TemporaryDirectory() as folder:
            # In a folder a picture has the name of what it shows.
            done = await self._command(
                "draw", "--check", "--scale", "1.5", "--diagram", diagram, "--depth", str(depth), *chosen, "--format",
                "png", "-o", f"{folder}/", "--", name, may_fail=True,
            )  # fmt: skip
            picture = next(Path(folder).glob("*.png"), None)
            if picture is None:
                raise ToolError(shortened(done.err))
            shows = f"`{picture.stem}` of {name}"
            return _result(f"This shows {shows}.", Picture(shows=shows), picture)

    async def explain(
        self, code: Annotated[str, Field(description="the code of a diagnostic, such as E0301")]
    ) -> Annotated[CallToolResult, Page]:
        """The manual page of a diagnostic: what is wrong, why it matters, how to correct it, with examples."""
        page = (await self._command("explain", "--", code)).out
        return _result(page, Page(code=code, page=page))

    async def fmt(
        self,
        file: File,
        write: Annotated[bool, Field(description="whether to change the file; otherwise only show how")] = True,
    ) -> Annotated[CallToolResult, Formatted]:
        """Format a program."""
        name = self._program(file)
        done = await self._command("fmt", "--diff", "--", name)
        difference = done.out
        if done.code != 0 and not difference:
            raise ToolError(shortened(done.err))
        if difference and write:
            await self._command("fmt", "--", name)
        words = "It is formatted." if not difference else f"{'Changed' if write else 'Would change'}:\n{difference}"
        return _result(words, Formatted(changed=bool(difference), difference=difference))

    def _program(self, file: str) -> str:
        try:
            return self._folder.program(file)
        except (OutsideError, OSError) as problem:
            raise ToolError(shortened(str(problem))) from None

    async def _command(self, *arguments: str, seconds: float = 60, may_fail: bool = False) -> Finished:
        done = await command(self._folder.path, *arguments, seconds=seconds)
        if may_fail:
            return done
        if done.code is None:
            raise ToolError(f"cspdiag {arguments[0]} took more than {seconds:g} s and was ended")
        if done.code not in (0, 1):
            raise ToolError(shortened(done.err) or f"cspdiag {arguments[0]} failed")
        return done


_VERDICTS = ("proved", "refuted", "unknown")


def _options(process: str | None, settings: dict[str, bool | str | float] | None) -> list[str]:
    # With `=`, because a value may begin as an option does; and what is true in JSON is `true`, not 1.
    chosen = [] if process is None else [f"--process={process}"]
    values = {
        name: str(value).lower() if isinstance(value, bool) else value for name, value in (settings or {}).items()
    }
    return chosen + [f"--set={name}={value}" for name, value in values.items()]


def _without_written(done: Finished) -> str:
    """What a command says, except which files it has written: nobody sees those."""
    lines = done.err.splitlines()
    return "\n".join(line for line in lines if not line.strip().startswith("wrote "))


def _json(text: str, done: Finished) -> list[dict[str, Any]]:
    """The data that a command has written."""
    try:
        found: list[dict[str, Any]] = json.loads(text)
    except ValueError:
        raise ToolError(shortened(done.err) or "there was no answer") from None
    return found


def _result(text: str, structured: Any, picture: Path | None = None) -> CallToolResult:
    content: list[ContentBlock] = [TextContent(type="text", text=shortened(text))]
    if picture is not None:
        data = base64.b64encode(picture.read_bytes()).decode("ascii")
        content.append(ImageContent(type="image", data=data, mime_type="image/png"))
    return CallToolResult(content=content, structured_content=structured)
