"""The tool ``go_home``: return to the home view."""

from __future__ import annotations

from scope_ptz.tools.arguments import Arguments
from scope_ptz.tools.context import ToolContext, move_result
from scope_ptz.tools.results import MoveResult
from scope_ptz.tools.tool import Tool


class GoHome(Arguments):
    """Return to the home view."""


async def go_home(context: ToolContext, arguments: GoHome) -> MoveResult:  # noqa: ARG001 - tools share one signature
    """Move to the home pose."""
    arrival = await context.camera.go_home()
    return move_result(context.camera, "At home", arrival)


GO_HOME = Tool("go_home", GoHome, go_home, "Go home", repeatable=True, moves=True)
