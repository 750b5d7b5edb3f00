"""The arguments of tools: unknown ones are refused, and wrong ones are explained in a sentence each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from mcp.server.mcpserver import Context, MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp.server.mcpserver.tools import Tool
from mcp.types import CallToolResult, InputRequiredResult
from pydantic import ValidationError

from cspdiag.assistants.commands import shortened


def strict_tool(function: Callable[..., Any]) -> Tool:
    """A tool that refuses arguments which the function does not have."""
    tool = Tool.from_function(function)
    model = tool.fn_metadata.arg_model
    model.model_config["extra"] = "forbid"
    model.model_rebuild(force=True)
    tool.parameters = model.model_json_schema(by_alias=True)
    return tool


class PlainServer(MCPServer[Any]):
    """A server whose answers to wrong arguments say what to do, without the words of the library that finds them."""

    async def call_tool(
        self, name: str, arguments: dict[str, Any], context: Context[Any, Any] | None = None
    ) -> CallToolResult | InputRequiredResult:
        """Call a tool; see the base class. Raises ToolError."""
        try:
            return await super().call_tool(name, arguments, context)
        except ToolError as problem:
            if not isinstance(problem.__cause__, ValidationError):
                raise
            known = next(tool.input_schema["properties"] for tool in await self.list_tools() if tool.name == name)
            words = "; ".join(_sentences(problem.__cause__, known))
            raise ToolError(shortened(f"{name} cannot be called so: {words}")) from None


def _sentences(problem: ValidationError, known: Mapping[str, Any]) -> list[str]:
    found: dict[str, str] = {}
    for error in problem.errors(include_url=False):
        argument = str(error["loc"][0])
        match error["type"]:
            case "extra_forbidden":
                listed = ", ".join(f"`{each}`" for each in known)
                found[argument] = (
                    f"there is no argument `{argument}`, only {listed}" if known else "it has no arguments"
                )
            case "missing":
                found[argument] = f"the argument `{argument}` is missing: {known[argument]['description']}"
            case _:  # The kinds of errors are those of the library, and there are many.
                reason = f"{error['msg'][:1].lower()}{error['msg'][1:]}".replace("input should", "it should")
                inside = ".".join(str(part) for part in error["loc"][:2])
                found[argument] = f"{found[argument]}, or {reason}" if argument in found else f"`{inside}`: {reason}"
    return list(found.values())
