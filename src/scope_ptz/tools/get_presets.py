"""The tool ``get_presets``: list the preset views."""

from __future__ import annotations

from scope_ptz.tools.arguments import Arguments
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.results import PoseData, Result
from scope_ptz.tools.tool import Tool


class GetPresets(Arguments):
    """List the named preset views."""


class PresetsResult(Result):
    """The names of the presets."""

    presets: tuple[str, ...]


async def get_presets(context: ToolContext, arguments: GetPresets) -> PresetsResult:  # noqa: ARG001 - tools share one signature
    """List the presets with their descriptions."""
    presets = await context.camera.presets()
    names = tuple(p.name for p in presets)
    listing = "; ".join(f"{p.name} ({p.description})" if p.description else p.name for p in presets)
    return PresetsResult(
        message=f"Presets: {listing}." if names else "This camera has no presets.",
        pose=PoseData.of(await context.camera.pose()),
        presets=names,
    )


GET_PRESETS = Tool("get_presets", GetPresets, get_presets, "List presets", repeatable=True)
