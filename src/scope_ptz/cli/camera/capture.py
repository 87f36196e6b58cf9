"""``scope camera capture``: capture a camera's surroundings as a scene."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.camera.manual_control import CameraSpecArgument, DryRunOption
from scope_ptz.cli.exit import put, put_json, run_async
from scope_ptz.cli.options import JsonOption
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.camera.capture.frame_taking import CaptureOptions
    from scope_ptz.factory.cameras.captures import CapturedScene, CapturePlan


def capture(
    camera: CameraSpecArgument,
    to: Annotated[
        Path | None, typer.Option("--to", metavar="FOLDER", help="Folder in which to create the scene (default: SCOPE_SCENES_DIR).")
    ] = None,
    name: Annotated[
        str | None, typer.Option("--name", help="Name of the scene, such as my-yard (default: the camera's name in scope.yaml).")
    ] = None,
    zoom: Annotated[
        list[float] | None, typer.Option("--zoom", help="Also capture the whole range at this magnification (repeatable).")
    ] = None,
    close_ups: Annotated[
        int, typer.Option("--close-ups", min=0, help="Maximum number of close-ups of areas with fine detail.")
    ] = 40,
    pan: Annotated[
        str | None, typer.Option("--pan", metavar="FROM:TO", help="Range of pan in degrees (default: the whole range).")
    ] = None,
    tilt: Annotated[
        str | None, typer.Option("--tilt", metavar="FROM:TO", help="Range of tilt in degrees (default: the whole range).")
    ] = None,
    overlap: Annotated[float, typer.Option("--overlap", help="Fraction of a picture that overlaps with the next one.")] = 0.45,
    dry_run: DryRunOption = False,
    as_json: JsonOption = False,
) -> None:
    """Capture a camera's surroundings as a scene: a digital twin of the site, built from pictures, without ground truth.

    The camera moves for a few minutes and then returns to its original pose. Running the same command again resumes an interrupted
    capture.
    """
    from rich.console import Console

    from scope_ptz.camera.capture.frame_taking import CaptureOptions
    from scope_ptz.camera.capture.plan import Ranges
    from scope_ptz.cli.display import ProgressBars
    from scope_ptz.factory.cameras.captures import capture_scene, scene_folder
    from scope_ptz.settings import load_settings

    folder = to or load_settings().scenes_dir
    if folder is None:
        raise InputError("Give the scene folder with --to, or set SCOPE_SCENES_DIR.")
    target = scene_folder(camera, folder, name)
    ranges = Ranges(_parse_range("--pan", pan), _parse_range("--tilt", tilt))
    options = CaptureOptions(ranges, tuple(zoom or ()), close_ups, overlap)
    if dry_run:
        _print_plan(camera, options, target, as_json=as_json)
        return
    scenes: list[CapturedScene] = []
    show_bars = sys.stderr.isatty() and not as_json
    with ProgressBars(Console(stderr=True), enabled=show_bars, description="{task.description:20}") as bars:

        async def work() -> None:
            scenes.append(await capture_scene(camera, target, options, bars))

        run_async(work)
    if as_json:
        put_json({**asdict(scenes[0]), "folder": str(scenes[0].folder)})
        return
    for line in _scene_lines(scenes[0]):
        put(line)


def _print_plan(camera: str, options: CaptureOptions, target: Path, *, as_json: bool) -> None:
    from scope_ptz.factory.cameras.captures import plan_capture

    plans: list[CapturePlan] = []

    async def work() -> None:
        plans.append(await plan_capture(camera, options))

    run_async(work)
    if as_json:
        put_json({**asdict(plans[0]), "folder": str(target)})
        return
    for line in _plan_lines(plans[0], target):
        put(line)


def _plan_lines(plan: CapturePlan, target: Path) -> list[str]:
    (left, right), (low, high) = plan.pan_range_deg, plan.tilt_range_deg
    lines = [
        f"A capture from {plan.camera} would cover pan {left:g} to {right:g} and tilt {low:g} to {high:g} degrees:",
        f"- one picture at the home position, and one at each of {len(plan.presets)} presets",
        *(f"- {sweep.pictures} pictures at {sweep.zoom:g}x" for sweep in plan.sweeps),
    ]
    if plan.close_up_zoom is not None:
        lines.append(f"- up to {plan.close_ups} close-ups at {plan.close_up_zoom:g}x, where the pictures have fine detail")
    return [*lines, f"It would write {target}. Dry run: the camera did not move, and nothing was written."]


def _parse_range(option: str, text: str | None) -> tuple[float, float] | None:
    if text is None:
        return None
    try:
        low, high = (float(part) for part in text.split(":"))
    except ValueError:
        raise InputError(f"{option} must be FROM:TO in degrees, such as -30:60; got '{text[:40]}'.") from None
    return low, high


def _scene_lines(scene: CapturedScene) -> list[str]:
    unregistered = scene.frames - scene.registered
    lines = [f"Wrote {scene.folder}: {scene.frames} pictures, {scene.tiles} sharper tiles, {len(scene.presets)} presets."]
    if scene.correction_deg is not None and scene.largest_correction_deg is not None:
        lines.append(
            f"The median correction of the reported poses is {scene.correction_deg:.2f} degrees, and the largest is "
            f"{scene.largest_correction_deg:.2f} degrees."
        )
    if scene.focal_factor is not None and abs(scene.focal_factor - 1) > 0.005:
        lines.append(
            f"The measured focal length at the widest zoom is {scene.focal_factor:.3f} times the reported one. The scene uses the "
            "measured focal length."
        )
    if unregistered:
        lines.append(f"{unregistered} pictures have too little detail to be registered, so their reported poses are used.")
    if scene.refused:
        lines.append(f"{scene.refused} poses were skipped because the site's rules do not permit them.")
    if scene.omitted_presets:
        lines.append(f"Presets outside the captured range were skipped: {', '.join(scene.omitted_presets)}.")
    if scene.unseen_share:
        lines.append(
            f"{scene.unseen_share:.1%} of the directions within the camera's range were not captured and are grey in the scene."
        )
    lines.append("The scene has no ground truth. Choose a vision model or a text reader with --perception.")
    lines.append(
        f"Try: SCOPE_SCENES_DIR={scene.folder.parent} scope ask --scene {scene.name} --perception MODEL 'what do you see?'"
    )
    return lines
