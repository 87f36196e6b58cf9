"""The ``scope scene`` commands: list, show and view scenes, build and bake them in Blender, and verify their packs."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from scope_ptz.cli.display import ProgressBars, sanitize
from scope_ptz.cli.exit import FAILED, put, put_json, run_async
from scope_ptz.cli.options import JsonOption, OutputFile, SeedOption, StartFlags
from scope_ptz.cli.typer_extensions import command
from scope_ptz.errors import InputError, OutputError, PackError

if TYPE_CHECKING:
    from scope_ptz.blender.verify import PoseReport
    from scope_ptz.settings import ScopeSettings
    from scope_ptz.simulator.models import ScenePreset
    from scope_ptz.simulator.pack import Scene

MAX_NAMES = 8  # maximum number of names in each list on the short card; the others are only counted

SceneName = Annotated[str, typer.Argument(help="Name of the scene; see `scope scene list`.")]
SceneSource = Annotated[str, typer.Argument(help="Name of a built-in scene, or a Python file with `build(stage)`.")]

scene_app = typer.Typer()


@scene_app.command("list")
@command
def scene_list(as_json: JsonOption = False) -> int:
    """List the installed scenes, and report those that cannot be loaded."""
    from scope_ptz.factory.scenes import scene_search
    from scope_ptz.settings import load_settings
    from scope_ptz.simulator.card import megabytes
    from scope_ptz.simulator.pack import find_scenes

    folders = dict(sorted(find_scenes(scene_search(load_settings())).items()))
    scenes = [_scene_data(name, folder) for name, folder in folders.items()]
    if as_json:
        put_json(scenes)
        return 0
    if not scenes:
        put("There are no scenes. Run `scope doctor` to find out why.")
        return 0
    table = Table("scene", "viewpoint", "presets", "objects", "texts", "size", box=None, pad_edge=False, header_style="dim")
    for scene in scenes:
        for number, viewpoint in enumerate(scene["viewpoints"]):
            scene_cells = (str(scene["instances"]), str(scene["texts"]), megabytes(scene["bytes"])) if number == 0 else ("", "", "")
            table.add_row(scene["name"] if number == 0 else "", viewpoint["name"], ", ".join(viewpoint["presets"]), *scene_cells)
    console = Console(highlight=False)
    console.print(table)
    for scene in scenes:
        if "error" in scene:
            console.print(Text(sanitize(f"{scene['name']} cannot be loaded: {scene['error']}"), style="red"), soft_wrap=True)
    return 0


def _scene_data(name: str, folder: Path) -> dict[str, Any]:
    """Return a scene as JSON data. ``error`` is present only if the scene cannot be loaded."""
    from scope_ptz.factory.scenes import open_scene
    from scope_ptz.simulator.card import folder_bytes

    try:
        file = open_scene(name).file
    except PackError as error:
        return {"name": name, "viewpoints": [], "instances": 0, "texts": 0, "bytes": 0, "error": str(error)}
    return {
        "name": name,
        "viewpoints": [
            {"name": v.name, "presets": [p.name for p in file.presets if p.viewpoint == v.name]} for v in file.viewpoints
        ],
        "instances": len(file.instances),
        "texts": len(file.texts),
        "bytes": folder_bytes(folder),
    }


@scene_app.command("show")
@command
def scene_show(
    name: SceneName,
    everything: Annotated[bool, typer.Option("--all", help="Print the whole card, with all text, objects and checksums.")] = False,
    contact_sheet: Annotated[
        Path | None, typer.Option("--contact-sheet", help="PNG file for the picture of all presets (default: in the cache).")
    ] = None,
    open_picture: Annotated[
        bool | None, typer.Option("--open/--no-open", help="Open the picture (default: open it if there is a desktop).")
    ] = None,
    as_markdown: Annotated[bool, typer.Option("--markdown", help="Print only the card, as a Markdown page.")] = False,
) -> None:
    """Print a scene's card: its viewpoints, presets, objects and text. Also draw a picture of all presets."""
    from scope_ptz.factory.scenes import open_scene
    from scope_ptz.settings import has_desktop
    from scope_ptz.simulator.card import markdown

    scene = open_scene(name)
    if as_markdown:
        put(markdown(scene, None if contact_sheet is None else str(contact_sheet)).rstrip("\n"))
        return
    file, console = scene.file, Console(highlight=False)
    origin = f"Blender {file.blender_version}" if file.captured is None else "captured"
    console.print(Text.assemble((file.title, "bold"), (f"  ({file.name} {file.version}, {origin})", "dim")))
    if everything:
        _print_card(console, scene)
    else:
        _print_short_card(console, scene)
    path = contact_sheet or _cached_sheet(scene)
    run_async(partial(_write_contact_sheet, scene, path))
    console.print(Text(f"\nContact sheet: {path}"), soft_wrap=True)
    if not everything:
        console.print(Text(f"`scope scene show {name} --all` prints everything.", style="dim"))
    if sys.stdout.isatty() and has_desktop() if open_picture is None else open_picture:
        typer.launch(str(path))


def _print_card(console: Console, scene: Scene) -> None:
    from scope_ptz.simulator.card import card

    for section in card(scene):
        console.print()
        console.print(Text(section.title, style="bold cyan"))
        for label, text in section.lines:
            console.print(Text.assemble("  ", (f"{label}  " if label else "", "bold"), text.replace("`", "")))


def _print_short_card(console: Console, scene: Scene) -> None:
    """Print the viewpoints with their presets, and summaries of the objects and of the text in the scene."""
    from scope_ptz.simulator.card import capture_summary, contents

    file = scene.file
    width = max(len(preset.name) for preset in file.presets)
    for viewpoint in file.viewpoints:
        _print_line(
            console,
            Text.assemble(
                (f"Viewpoint {viewpoint.name}", "bold cyan"), f": {viewpoint.description}" if viewpoint.description else ""
            ),
        )
        for preset in file.presets:
            if preset.viewpoint == viewpoint.name:
                home = " (home)" if preset.name == file.home_preset else ""
                line = f"{_pose_text(preset)}{home}  {preset.description}"
                _print_line(console, Text.assemble("  ", (f"{preset.name:{width}}", "bold"), "  ", line))
    if file.captured is not None:
        console.print(Text.assemble(("Captured", "bold cyan"), " " + sanitize(capture_summary(file.captured))))
        return
    for title, items in contents(file):
        more = f", and {len(items) - MAX_NAMES} more" if len(items) > MAX_NAMES else ""
        console.print(Text.assemble((title, "bold cyan"), f": {', '.join(items[:MAX_NAMES]) or 'none'}{more}"))


def _print_line(console: Console, text: Text) -> None:
    console.print(text, no_wrap=True, overflow="ellipsis")


def _pose_text(preset: ScenePreset) -> str:
    return f"pan {preset.pan_deg:g}°, tilt {preset.tilt_deg:g}°, zoom {preset.zoom:g}x"


def _cached_sheet(scene: Scene) -> Path:
    from scope_ptz.settings import load_settings

    folder = load_settings().cache_dir / "sheets"
    _make_folder(folder, " Set SCOPE_CACHE_DIR, or give --contact-sheet.")
    return folder / f"{scene.name}-{scene.file.version}.png"


async def _write_contact_sheet(scene: Scene, path: Path) -> None:
    from scope_ptz.factory.scenes import draw_presets

    _save_image(await draw_presets(scene), path)


@scene_app.command("view")
@command
def scene_view(
    start: StartFlags,
    out: OutputFile,
    name: Annotated[str | None, typer.Argument(help="Name of the scene, unless --camera or --scene is given.")] = None,
    pan: Annotated[
        float | None, typer.Option("--pan", help="Pan in degrees, positive is right (default: that of the start pose).")
    ] = None,
    tilt: Annotated[
        float | None, typer.Option("--tilt", help="Tilt in degrees, positive is up (default: that of the start pose).")
    ] = None,
    zoom: Annotated[
        float | None, typer.Option("--zoom", help="Magnification, 1 is widest (default: that of the start pose).")
    ] = None,
) -> None:
    """Save the camera's view at a pose as a picture file."""
    from PIL import Image

    from scope_ptz.geometry import Pose

    if name is not None and (start.camera or start.scene):
        raise InputError("Give the scene or camera once: as the argument, with --camera, or with --scene.")
    if name is not None:
        start = replace(start, scene=name)

    async def work() -> None:
        async with await start.open() as opened:
            current = await opened.camera.pose()
            target = (
                requested if requested is not None else current_value
                for requested, current_value in zip(
                    (pan, tilt, zoom), (current.pan_deg, current.tilt_deg, current.zoom), strict=True
                )
            )
            try:
                arrival = await opened.camera.move(Pose(*target))
            except ValueError as error:
                raise InputError(f"The pose is not possible: {error}.") from error
            _save_image(Image.fromarray((await opened.camera.frame()).image), out)
        reached = arrival.pose.as_dict()
        note = f" (stopped by the {' and '.join(arrival.clamped)} limit)" if arrival.clamped else ""
        put(f"Wrote {out}: pan {reached['pan_deg']:g}, tilt {reached['tilt_deg']:g}, zoom {reached['zoom']:g}x{note}")

    run_async(work)


def _save_image(image: Any, path: Path) -> None:
    try:
        image.save(path)
    except (OSError, ValueError) as error:
        raise OutputError(f"{path} cannot be written: {error}.") from error


@scene_app.command("build")
@command
def scene_build(
    name: SceneSource,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Blender file to write (default: NAME.blend).")] = None,
) -> None:
    """Build a scene from its code in Blender and save it as a .blend file."""
    from scope_ptz.blender.client import BlenderWorker
    from scope_ptz.blender.sources import check_scene_name
    from scope_ptz.settings import load_settings

    settings, console = load_settings(), Console(highlight=False)
    check_scene_name(name)
    target = (out or Path(f"{Path(name).stem}.blend")).absolute()
    _make_folder(target.parent)
    started_s = time.monotonic()
    with BlenderWorker(_blender_command(settings, console), settings.cache_dir / "build.log") as worker:
        worker.request("load_scene", {"source": name})
        facts: dict[str, Any] = worker.request("describe")
        worker.request("save", {"path": str(target)})
    counts = f"{len(facts['instances'])} objects, {len(facts['texts'])} texts, {len(facts['viewpoints'])} viewpoints"
    console.print(Text(f"Wrote {target}: {counts}, {time.monotonic() - started_s:.0f} s"), soft_wrap=True)


@scene_app.command("bake")
@command
def scene_bake(
    name: SceneSource,
    quality: Annotated[str, typer.Option("--quality", help="Render quality: draft, standard or high.")] = "standard",
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Scene folder to write (default: scenes/NAME).")] = None,
    viewpoint: Annotated[list[str] | None, typer.Option("--viewpoint", help="Bake only this viewpoint (repeatable).")] = None,
) -> int:
    """Render a scene's viewpoints into packs. Running the same command again resumes an interrupted bake."""
    from scope_ptz.blender.bake import bake
    from scope_ptz.blender.quality import named_quality
    from scope_ptz.blender.sources import check_scene_name
    from scope_ptz.settings import load_settings

    settings, console = load_settings(), Console(highlight=False)
    check_scene_name(name)
    quality_level = named_quality(quality)
    folder = (out or Path("scenes") / Path(name).stem.replace("_", "-")).absolute()
    _make_folder(folder.parent)
    blender_command = _blender_command(settings, console)
    with ProgressBars(console) as bars:
        baked = bake(
            name,
            folder,
            quality=quality_level,
            command=blender_command,
            cache_dir=settings.cache_dir,
            viewpoints=viewpoint or None,
            progress=bars,
        )
    for pack in baked.packs:
        line = f"{pack.folder}: {pack.size_bytes / 1e6:.2f} MB, {pack.tiles} tiles"
        console.print(Text(line), soft_wrap=True)
        if pack.uncovered:
            console.print(Text(f"  not covered by a tile: {', '.join(pack.uncovered)}", style="yellow"))
    shortfalls = _show_comparison(console, baked.reports)
    console.print(Text(f"To see it: SCOPE_SCENES_DIR={folder.parent} scope scene show {folder.name}", style="dim"), soft_wrap=True)
    return FAILED if shortfalls and quality_level.must_meet_tolerances else 0


@scene_app.command("verify")
@command
def scene_verify(
    name: SceneName,
    seed: SeedOption = 1,
    wide: Annotated[int, typer.Option("--wide", min=0, help="Number of random poses at the widest zoom, at any tilt.")] = 8,
    zoomed: Annotated[
        int, typer.Option("--zoomed", min=0, help="Number of random poses at 2x to 5x, where the pack has tiles.")
    ] = 8,
    keep: Annotated[Path | None, typer.Option("--keep", help="Folder in which to save the live renders.")] = None,
) -> int:
    """Compare views from a scene's packs with live Blender renders of the same poses."""
    from scope_ptz.blender.client import BlenderWorker
    from scope_ptz.blender.sources import check_scene_name
    from scope_ptz.blender.verify import draw_poses, verify
    from scope_ptz.factory.scenes import open_scene
    from scope_ptz.settings import load_settings

    settings, console = load_settings(), Console(highlight=False)
    check_scene_name(name)
    scene = open_scene(name)
    blender_command = _blender_command(settings, console)
    with ProgressBars(console) as bars, BlenderWorker(blender_command, settings.cache_dir / "verify.log") as worker:
        worker.request("load_scene", {"source": name})
        reports = verify(scene, worker, draw_poses(scene, seed, wide, zoomed), bars, keep=keep)
    return FAILED if _show_comparison(console, reports) else 0


def _show_comparison(console: Console, reports: Sequence[PoseReport]) -> list[str]:
    """Print the comparison at each pose, and return a sentence about each missed tolerance."""
    from scope_ptz.blender.tolerances import missed_tolerances

    table = Table("viewpoint", "pan", "tilt", "zoom", "SSIM", "sharpness", "box IoU", "in tiles")
    for report in reports:
        figures = (
            f"{report.pose.pan_deg:.1f}",
            f"{report.pose.tilt_deg:.1f}",
            f"{report.pose.zoom:.2f}",
            f"{report.ssim:.3f}",
            f"{report.sharpness_ratio:.2f}",
        )
        table.add_row(
            report.viewpoint, *figures, "-" if report.box_iou is None else f"{report.box_iou:.3f}", f"{report.tile_share:.0%}"
        )
    console.print(table)
    shortfalls = missed_tolerances(reports)
    for line in shortfalls:
        console.print(Text(f"  {line}", style="red"), soft_wrap=True)
    console.print(
        Text("The differences are too large." if shortfalls else "All tolerances are met.", style="red" if shortfalls else "green")
    )
    return shortfalls


def _blender_command(settings: ScopeSettings, console: Console) -> list[str]:
    from scope_ptz.blender.environment import is_ready, worker_command

    program = settings.blender_python or settings.blender
    if program is None and not is_ready(settings.cache_dir):
        console.print("Downloading Blender's Python module (about 400 MB); this happens once.", style="yellow")
    return worker_command(settings.cache_dir, program)


def _make_folder(folder: Path, advice: str = "") -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder} cannot be created: {error.strerror}.{advice}") from error
