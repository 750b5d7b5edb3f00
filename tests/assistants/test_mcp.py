"""``cspdiag mcp``, with the client of the protocol's own library."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest
from mcp import Client, StdioServerParameters
from mcp.types import CallToolResult, ImageContent, TextContent

from cspdiag.assistants import commands
from cspdiag.assistants.server import server
from cspdiag.draw.layout.elk import engine_available

RELAY = """\
process Relay {
  in  given : int
  out taken : int

  communication {
    var held : int = 0
  }

  composition {
    mu (given ? held ; taken ! 2 * held)
  }
}

submodel Source {
  out value : int
  state n : int = 0
  next n = n + 1
  value = n
}

environment Bench for Relay step 1 ms {
  source : Source
  source.value -> given
  taken -> _
}
"""
STUCK = """\
process First {
  in reply : int
  out ask : int
  communication { var v : int = 0 }
  composition { reply ? v ; ask ! 1 }
}
process Both {
  communication {
    one : First
    two : First
    one.ask -> two.reply
    two.ask -> one.reply
  }
  composition { one || two }
}
"""
PRESSED = """\
process Desk {
  in button : bool
  in level : int
  communication {
    var pressed : bool
    var read : int
  }
  composition {
    mu (button ? pressed -> skip [] level ? read -> skip)
  }
}
submodel Hand {
  out button : bool
  out level : int
  button = time > 2 s
  level = if time > 4 s then 7 else 3
}
environment Bench for Desk {
  hand : Hand
  hand.button -> button
  hand.level -> level
}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a program in a folder, and one beside it."""
    place = tmp_path / "my programs"
    (place / "parts").mkdir(parents=True)
    (place / "parts" / "relay.csp").write_text(RELAY)
    (place / "stuck.csp").write_text(STUCK)
    (tmp_path / "other.csp").write_text(RELAY)
    return place


def with_client(folder: Path, use: Callable[[Client], Awaitable[None]]) -> None:
    """Connect a client with a server in this process."""

    async def main() -> None:
        async with Client(server(folder)) as client:
            await use(client)

    asyncio.run(main())


def structured(result: CallToolResult) -> dict[str, Any]:
    assert not result.is_error, text_of(result)
    assert result.structured_content is not None
    return dict(result.structured_content)


def text_of(result: CallToolResult) -> str:
    return "".join(part.text for part in result.content if isinstance(part, TextContent))


def pictures(result: CallToolResult) -> list[ImageContent]:
    return [part for part in result.content if isinstance(part, ImageContent)]


def test_programs_are_checked_proved_and_run(folder: Path) -> None:
    async def use(client: Client) -> None:
        found = structured(await client.call_tool("programs", {}))
        assert sorted(found["programs"]) == ["parts/relay.csp", "stuck.csp"]
        checked = structured(await client.call_tool("check", {"file": "parts/relay.csp"}))
        assert checked == {"errors": 0, "warnings": 0, "diagnostics": []}
        refuted = await client.call_tool("verify", {"file": "stuck.csp", "process": "Both"})
        assert structured(refuted)["refuted"] == 1
        assert structured(refuted)["answers"][0]["counterexample"]["failure"] == "deadlock"
        assert "`one` waits to read two.ask" in text_of(refuted)
        ran = await client.call_tool("run", {"file": "parts/relay.csp", "duration": "20 ms", "plot": False})
        assert structured(ran)["successful"]
        assert "reached the time limit at 20 ms" in structured(ran)["summary"]
        # At the end the output is released.
        taken = {"values": 21, "changes": 21, "least": 0, "greatest": 40, "last": 0}
        assert structured(ran)["ports"]["taken"] == taken
        stuck = structured(await client.call_tool("run", {"file": "stuck.csp"}))
        assert not stuck["successful"]
        assert "Both.one waits to read" in stuck["summary"]
        assert "recorded" not in stuck["summary"]

    with_client(folder, use)


def test_what_came_once_is_one_value(folder: Path) -> None:
    """And truth values are those of JSON."""
    (folder / "pressed.csp").write_text(PRESSED)

    async def use(client: Client) -> None:
        ran = structured(await client.call_tool("run", {"file": "pressed.csp", "duration": "6 s", "plot": False}))
        assert ran["ports"]["button"] == {"values": 1, "changes": 1, "last": True}
        assert ran["ports"]["level"] == {"values": 1, "changes": 1, "least": 7, "greatest": 7, "last": 7}

    with_client(folder, use)


def test_a_proof_is_made_once(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    carried_out = []

    async def noted(path: Path, *arguments: str, seconds: float) -> commands.Finished:
        carried_out.append(arguments[0])
        return await commands.command(path, *arguments, seconds=seconds)

    monkeypatch.setattr("cspdiag.assistants.server.command", noted)

    async def use(client: Client) -> None:
        found = await client.call_tool("verify", {"file": "stuck.csp", "process": "Both"})
        assert structured(found)["refuted"] == 1
        assert "wrote" not in text_of(found)

    with_client(folder, use)
    assert carried_out == ["verify"]


def test_wrong_programs_and_names_get_an_answer(folder: Path) -> None:
    (folder / "wrong.csp").write_text(RELAY.replace("? held", "? hold"))
    (folder / "gain.csp").write_text(f"const gain = 1.5\n{RELAY}")
    (folder / "link.csp").symlink_to(folder.parent / "other.csp")
    (folder / "loop.csp").symlink_to("loop.csp")
    os.mkfifo(folder / "pipe.csp")
    (folder / "cut.csp").write_text("process {")

    async def use(client: Client) -> None:
        listed = structured(await client.call_tool("programs", {}))["programs"]
        assert sorted(listed) == ["cut.csp", "gain.csp", "parts/relay.csp", "stuck.csp", "wrong.csp"]
        wrong = await client.call_tool("check", {"file": "wrong.csp"})
        (found,) = structured(wrong)["diagnostics"]
        assert (found["code"], found["file"], found["line"]) == ("E0204", "wrong.csp", 10)
        assert "there is no" in text_of(wrong)
        for tool, arguments, words in (
            ("check", {"file": "../other.csp"}, "is outside the folder"),
            ("check", {"file": "link.csp"}, "is outside the folder"),
            ("check", {"file": str(folder.parent / "other.csp")}, "is outside the folder"),
            ("check", {"file": "parts"}, "there is no program `parts`: there are"),
            ("check", {"file": "loop.csp"}, "is a symbolic link that leads to itself"),
            ("check", {"file": "pipe.csp"}, "is not a file, but a pipe"),
            ("check", {"file": "x" * 100_000}, "there is no program `xxx"),
            ("run", {"file": "wrong.csp"}, "E0204"),
            ("fmt", {"file": "cut.csp"}, "error[E"),
            ("run", {"file": "cut.csp"}, "error[E"),
            ("verify", {"file": "cut.csp"}, "error[E"),
            ("run", {"file": "stuck.csp", "until": "1 s"}, "there is no argument `until`, only `file`, `duration`"),
            ("programs", {"file": "stuck.csp"}, "it has no arguments"),
            ("check", {}, "the argument `file` is missing: a program"),
            (
                "run",
                {"file": "stuck.csp", "settings": {"x": []}},
                "it should be a valid string, or it should be a valid",
            ),
            ("draw", {"file": "stuck.csp", "diagram": "all"}, "it should be 'communication', 'composition' or 'both'"),
            ("run", {"file": "stuck.csp", "duration": "soon"}, "is not a time"),
            ("run", {"file": "stuck.csp", "seconds": -1}, "greater than 0"),
            ("run", {"file": "stuck.csp", "settings": {"x": 1}}, "x"),
            ("run", {"file": "gain.csp", "settings": {"gain": True}}, "`true` is not of type double"),
            ("run", {"file": "gain.csp", "settings": {"--help": 3}}, "there is no parameter '--help'"),
            ("run", {"file": "gain.csp", "environment": "--help"}, "there is no environment `--help`"),
            ("run", {"file": "gain.csp", "duration": "-1 s"}, "write a positive duration"),
            ("verify", {"file": "wrong.csp"}, "E0204"),
            ("verify", {"file": "stuck.csp", "process": "--help"}, "--help"),
            ("explain", {"code": "E9999"}, "E9999"),
            ("draw", {"file": "stuck.csp", "process": "None"}, "None"),
        ):
            result = await client.call_tool(tool, arguments)
            said = text_of(result)
            assert result.is_error, (tool, arguments)
            assert words in said, (tool, arguments, said)
            assert "pydantic" not in said
            assert "Traceback" not in said

    with_client(folder, use)


def test_a_program_is_formatted(folder: Path) -> None:
    program = folder / "parts" / "relay.csp"

    async def use(client: Client) -> None:
        program.write_text(RELAY.replace("  in  given", "      in given"))
        shown = structured(await client.call_tool("fmt", {"file": "parts/relay.csp", "write": False}))
        assert shown["changed"]
        assert "+  in  given : int" in shown["difference"]
        assert program.read_text() != RELAY
        await client.call_tool("fmt", {"file": "parts/relay.csp"})
        assert not structured(await client.call_tool("fmt", {"file": "parts/relay.csp"}))["changed"]

    with_client(folder, use)


@pytest.mark.skipif(not engine_available(), reason="the layout engine is not there: make setup fetches it")
def test_pictures_are_drawn(folder: Path) -> None:
    async def use(client: Client) -> None:
        drawn = await client.call_tool("draw", {"file": "stuck.csp", "process": "Both"})
        plotted = await client.call_tool("run", {"file": "parts/relay.csp", "duration": "5 ms"})
        assert [len(pictures(result)) for result in (drawn, plotted)] == [1, 1]
        assert pictures(drawn)[0].mime_type == "image/png"
        assert pictures(drawn)[0].data.startswith("iVBORw0KGgo")
        assert structured(drawn)["shows"] == "`Both` of stuck.csp"
        assert structured(await client.call_tool("draw", {"file": "stuck.csp"}))["shows"] == "`Both` of stuck.csp"

    with_client(folder, use)


def test_what_takes_too_long_is_ended(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    async def use(client: Client) -> None:
        arguments = {"file": "parts/relay.csp", "duration": "1000000 s", "plot": False, "seconds": 2}
        result = structured(await client.call_tool("run", arguments))
        assert not result["successful"]
        assert "It was ended because it took more than 2 s" in result["summary"]

    with_client(folder, use)
    monkeypatch.setattr(commands, "LONGEST", 10)
    assert commands.shortened("0123456789" * 2) == "01234\n... 10 characters left out ...\n56789"


def test_an_assistant_starts_it_and_reads_about_the_language(folder: Path) -> None:
    async def main() -> None:
        command = StdioServerParameters(command=sys.executable, args=["-m", "cspdiag", "mcp", str(folder)])
        async with Client(command) as client:
            tools = (await client.list_tools()).tools
            assert sorted(tool.name for tool in tools) == [
                "check", "draw", "explain", "fmt", "programs", "run", "verify",
            ]  # fmt: skip
            assert all(tool.description for tool in tools)
            (page,) = (await client.read_resource("cspdiag://language")).contents
            assert "process" in getattr(page, "text", "")

    asyncio.run(main())


@pytest.mark.skipif(sys.platform != "linux", reason="finds processes in /proc")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_commands_end_with_the_server(folder: Path, number: signal.Signals) -> None:
    """Although the connection stays open."""
    with subprocess.Popen(
        [sys.executable, "-m", "cspdiag", "mcp", folder], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        assert process.stdin is not None
        client = {"protocolVersion": "2025-03-26", "capabilities": {}, "clientInfo": {"name": "x", "version": "1"}}
        call = {"name": "run", "arguments": {"file": "parts/relay.csp", "duration": "1000000 s", "plot": False}}
        for message in (
            {"id": 1, "method": "initialize", "params": client},
            {"method": "notifications/initialized"},
            {"id": 2, "method": "tools/call", "params": call},
        ):
            process.stdin.write(json.dumps({"jsonrpc": "2.0", **message}).encode() + b"\n")
            process.stdin.flush()
        while not (running := children(process.pid)):
            time.sleep(0.05)
        process.send_signal(number)
        assert process.wait(30) == -number
        limit = time.monotonic() + 30
        while any(is_running(each) for each in running):
            assert time.monotonic() < limit
            time.sleep(0.05)


def children(process: int) -> list[int]:
    return [int(each) for each in Path(f"/proc/{process}/task/{process}/children").read_text().split()]


def is_running(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False
