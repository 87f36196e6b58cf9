"""The tool ``go_to_preset``: go to a named preset view."""

from __future__ import annotations

from pydantic import Field

from scope_ptz.tools.arguments import Arguments, Phrase
from scope_ptz.tools.context import ToolContext, move_result
from scope_ptz.tools.results import MoveResult
from scope_ptz.tools.tool import Tool


class GoToPreset(Arguments):
    """Go to a named preset view."""

    name: Phrase = Field(description="Name of the preset, as get_presets lists it.")


async def go_to_preset(context: ToolContext, arguments: GoToPreset) -> MoveResult:
    """Move to a preset."""
    arrival = await context.camera.go_to_preset(arguments.name)
    return move_result(context.camera, f"At preset {arguments.name}", arrival, arguments.name)


GO_TO_PRESET = Tool("go_to_preset", GoToPreset, go_to_preset, "Go to a preset", repeatable=True, moves=True)
