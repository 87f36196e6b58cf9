"""The direct camera tools: adjust_ptz, go_to_preset, go_home, get_presets, take_image."""

from __future__ import annotations

from dataclasses import replace

from scope_ptz.geometry import Limits, Pose
from scope_ptz.tools.arguments import AdjustPtz, GetPresets, GoHome, GoToPreset, TakeImage
from scope_ptz.tools.context import ToolContext, pose_text
from scope_ptz.tools.results import ImageResult, MoveResult, PoseData, PresetsResult


def wanted_pose(start: Pose, arguments: AdjustPtz, limits: Limits) -> Pose:
    """The pose that a relative adjustment asks for, before clamping."""
    turned = start.turned(arguments.pan_deg, arguments.tilt_deg)
    if arguments.zoom_factor is not None:
        # A huge finite factor may overflow to infinity; the stop is where it would end anyway.
        return replace(turned, zoom=min(start.zoom * arguments.zoom_factor, 1e6))
    if arguments.zoom_percent is not None:
        return replace(turned, zoom=min(start.zoom * (1 + arguments.zoom_percent / 100), 1e6))
    if arguments.zoom_limit is not None:
        return replace(turned, zoom=limits.max_zoom if arguments.zoom_limit == "in" else limits.min_zoom)
    return turned


async def adjust_ptz(context: ToolContext, arguments: AdjustPtz) -> MoveResult:
    start = await context.camera.pose()
    arrival = await context.camera.move(wanted_pose(start, arguments, context.camera.info.limits))
    verb = "Moved" if arrival.pose != start else "The camera did not move"
    return MoveResult(message=f"{verb}; {pose_text(arrival)}.", pose=PoseData.of(arrival.pose), clamped=arrival.clamped)


async def go_to_preset(context: ToolContext, arguments: GoToPreset) -> MoveResult:
    arrival = await context.camera.go_to_preset(arguments.name)
    return MoveResult(
        message=f"At preset {arguments.name}; {pose_text(arrival)}.",
        pose=PoseData.of(arrival.pose),
        clamped=arrival.clamped,
        preset=arguments.name,
    )


async def go_home(context: ToolContext, arguments: GoHome) -> MoveResult:
    arrival = await context.camera.go_home()
    return MoveResult(message=f"At home; {pose_text(arrival)}.", pose=PoseData.of(arrival.pose), clamped=arrival.clamped)


async def get_presets(context: ToolContext, arguments: GetPresets) -> PresetsResult:
    presets = await context.camera.presets()
    names = tuple(p.name for p in presets)
    listing = "; ".join(f"{p.name} ({p.description})" if p.description else p.name for p in presets)
    return PresetsResult(
        message=f"Presets: {listing}." if names else "This camera has no presets.",
        pose=PoseData.of(await context.camera.pose()),
        presets=names,
    )


async def take_image(context: ToolContext, arguments: TakeImage) -> ImageResult:
    frame = await context.camera.frame()
    name = context.images.save_picture(frame)
    return ImageResult(message=f"Saved the picture as {name}.", pose=PoseData.of(frame.pose), file=name)
