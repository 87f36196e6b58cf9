"""The registry of the nine camera tools from the paper. To add a tool, write a module for it and add it to ``TOOLS``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import ValidationError

from scope_ptz.errors import ToolCallError
from scope_ptz.tools.adjust_ptz import ADJUST_PTZ
from scope_ptz.tools.arguments import Arguments
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.count_objects import COUNT_OBJECTS
from scope_ptz.tools.get_presets import GET_PRESETS
from scope_ptz.tools.go_home import GO_HOME
from scope_ptz.tools.go_to_preset import GO_TO_PRESET
from scope_ptz.tools.query_answer import QUERY_ANSWER
from scope_ptz.tools.results import Result
from scope_ptz.tools.take_image import TAKE_IMAGE
from scope_ptz.tools.tool import Tool
from scope_ptz.tools.track_object import TRACK_OBJECT
from scope_ptz.tools.zoom_to_object import ZOOM_TO_OBJECT


class ToolRegistry(Mapping[str, Tool]):
    """A mapping from names to tools, in the order in which planners receive them.

    Args:
        tools: The tools, in this order.
    """

    def __init__(self, *tools: Tool) -> None:
        self._tools = {tool.name: tool for tool in tools}

    def __getitem__(self, name: str) -> Tool:
        return self._tools[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._tools)

    def __len__(self) -> int:
        return len(self._tools)

    @property
    def moving(self) -> frozenset[str]:
        """Names of the tools that can move the camera."""
        return frozenset(name for name, tool in self._tools.items() if tool.moves)

    @property
    def perceiving(self) -> tuple[str, ...]:
        """Names of the tools that call perception."""
        return tuple(name for name, tool in self._tools.items() if tool.perceives)

    def schemas(self) -> list[dict[str, Any]]:
        """Return all tools in the OpenAI function format."""
        return [tool.schema() for tool in self._tools.values()]

    def parse_call(self, name: str, arguments: Any) -> tuple[Tool, Arguments]:
        """Validate a call, and return its tool and its arguments.

        Raises:
            ToolCallError: The name or the arguments are invalid. The message explains how to correct the call.
        """
        tool = self._tools.get(name)
        if tool is None:
            raise ToolCallError(f"There is no tool '{str(name)[:60]}'. The tools are {', '.join(self._tools)}.")
        if not isinstance(arguments, dict):
            raise ToolCallError(f"The arguments of {name} must be a JSON object, got {type(arguments).__name__}.")
        try:
            return tool, tool.arguments.model_validate(arguments)
        except ValidationError as error:
            fields = ", ".join(tool.arguments.model_fields) or "no arguments"
            problems = "; ".join(_problem(e["loc"], e["msg"]) for e in error.errors(include_url=False, include_input=False))
            raise ToolCallError(f"Wrong arguments for {name}: {problems}. It takes {fields}.") from error

    async def run(self, context: ToolContext, name: str, arguments: Any) -> Result:
        """Validate and run a call.

        Raises:
            ToolCallError: The call is invalid. Nothing was done.
            UnknownNameError: A preset does not exist. Nothing was done.
            PerceptionError: The perception call failed.
            CameraError: The camera failed.
        """
        tool, checked = self.parse_call(name, arguments)
        return await tool.run(context, checked)


def _problem(where: tuple[int | str, ...], message: str) -> str:
    path = ".".join(str(part)[:60] for part in where)
    return f"{path}: {message}" if path else message


TOOLS = ToolRegistry(
    ADJUST_PTZ,
    GO_TO_PRESET,
    GO_HOME,
    GET_PRESETS,
    TAKE_IMAGE,
    COUNT_OBJECTS,
    QUERY_ANSWER,
    ZOOM_TO_OBJECT,
    TRACK_OBJECT,
)

schemas = TOOLS.schemas
parse_call = TOOLS.parse_call
run_tool = TOOLS.run
