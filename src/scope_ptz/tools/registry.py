"""The nine tools by name: their schemas for planners, and one guarded way to run them."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from scope_ptz.errors import ToolCallError
from scope_ptz.tools import arguments as args
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.looking import count_objects, query_answer
from scope_ptz.tools.moves import adjust_ptz, get_presets, go_home, go_to_preset, take_image
from scope_ptz.tools.results import Result
from scope_ptz.tools.tracking import track_object
from scope_ptz.tools.zooming import zoom_to_object


@dataclass(frozen=True, slots=True)
class Tool:
    """A tool: its name, its validated arguments, and what it does."""

    name: str
    arguments: type[args.Arguments]
    run: Callable[[ToolContext, Any], Awaitable[Result]]

    def schema(self) -> dict[str, Any]:
        """The tool in the OpenAI function format."""
        parameters = self.arguments.model_json_schema()
        for prop in parameters.get("properties", {}).values():
            prop.pop("title", None)
        parameters.pop("title", None)
        description = parameters.pop("description")
        parameters.setdefault("properties", {})
        return {
            "type": "function",
            "function": {"name": self.name, "description": description, "parameters": parameters},
        }


_ALL = (
    Tool("adjust_ptz", args.AdjustPtz, adjust_ptz),
    Tool("go_to_preset", args.GoToPreset, go_to_preset),
    Tool("go_home", args.GoHome, go_home),
    Tool("get_presets", args.GetPresets, get_presets),
    Tool("take_image", args.TakeImage, take_image),
    Tool("count_objects", args.CountObjects, count_objects),
    Tool("query_answer", args.QueryAnswer, query_answer),
    Tool("zoom_to_object", args.ZoomToObject, zoom_to_object),
    Tool("track_object", args.TrackObject, track_object),
)
TOOLS: dict[str, Tool] = {tool.name: tool for tool in _ALL}


def schemas() -> list[dict[str, Any]]:
    """All nine tools in the OpenAI function format, in the paper's order."""
    return [tool.schema() for tool in _ALL]


def parse_call(name: str, arguments: Any) -> tuple[Tool, args.Arguments]:
    """Check a call; raises ``ToolCallError`` with a message that tells a planner how to mend it."""
    tool = TOOLS.get(name)
    if tool is None:
        raise ToolCallError(f"There is no tool '{str(name)[:60]}'. The tools are {', '.join(TOOLS)}.")
    if not isinstance(arguments, dict):
        raise ToolCallError(f"The arguments of {name} must be a JSON object, got {type(arguments).__name__}.")
    try:
        return tool, tool.arguments.model_validate(arguments)
    except ValidationError as error:
        known = ", ".join(tool.arguments.model_fields) or "no arguments"
        problems = "; ".join(_problem(e["loc"], e["msg"]) for e in error.errors(include_url=False, include_input=False))
        raise ToolCallError(f"Wrong arguments for {name}: {problems}. It takes {known}.") from error


def _problem(where: tuple[int | str, ...], message: str) -> str:
    path = ".".join(str(part)[:60] for part in where)
    return f"{path}: {message}" if path else message


async def run_tool(context: ToolContext, name: str, arguments: Any) -> Result:
    """Check and run a call.

    Raises:
        ToolCallError: the call itself is wrong; nothing was done.
        UnknownNameError: a preset that does not exist; nothing was done.
        PerceptionError: the view could not be read.
        CameraError: the camera did not do what it was told.
    """
    tool, checked = parse_call(name, arguments)
    return await tool.run(context, checked)
