"""``scope scene list``, ``show`` and ``view``: list scenes, print their cards, and save views."""

from __future__ import annotations

import sys
from collections import Counter
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from scope_ptz.cli.exit import put, put_json, run_async
from scope_ptz.cli.options import StartFlags
from scope_ptz.cli.texts import sanitize
from scope_ptz.errors import InputError, OutputError, PackError
from scope_ptz.factory.cameras import open_camera
from scope_ptz.factory.scenes import open_scene, scene_search
from scope_ptz.geometry import Pose
from scope_ptz.settings import has_desktop, load_settings
from scope_ptz.simulator.card import capture_summary, card, folder_bytes, markdown, megabytes
from scope_ptz.simulator.models import ScenePreset
from scope_ptz.simulator.pack import Scene, find_scenes

MAX_NAMES = 8  # maximum number of names in each list on the short card; the others are only counted


def list_scenes(*, as_json: bool) -> int:
    """Print every scene with its viewpoints and sizes, and the errors for scenes that cannot be loaded."""
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


def print_markdown(name: str, sheet: Path | None) -> None:
    """Print a scene's card as a Markdown page with a link to the contact sheet."""
    put(markdown(open_scene(name), None if sheet is None else str(sheet)).rstrip("\n"))


def show_scene(name: str, sheet: Path | None, *, open_sheet: bool | None, everything: bool) -> None:
    """Print a scene's card, and draw a contact sheet of its presets.

    Args:
        name: The scene.
        sheet: PNG file for the contact sheet; None for a file in the cache folder.
        open_sheet: Whether to open the sheet in a picture viewer; None to open it if there is a terminal and a desktop.
        everything: Whether to print the whole card instead of a short card that fits on a screen.
    """
    scene = open_scene(name)
    file, console = scene.file, Console(highlight=False)
    origin = f"Blender {file.blender_version}" if file.captured is None else "captured"
    console.print(Text.assemble((file.title, "bold"), (f"  ({file.name} {file.version}, {origin})", "dim")))
    if everything:
        _print_card(console, scene)
    else:
        _print_short_card(console, scene)
    path = sheet or _cached_sheet(scene)
    run_async(partial(_write_contact_sheet, scene, path))
    console.print(Text(f"\nContact sheet: {path}"), soft_wrap=True)
    if not everything:
        console.print(Text(f"`scope scene show {name} --all` prints everything.", style="dim"))
    if sys.stdout.isatty() and has_desktop() if open_sheet is None else open_sheet:
        typer.launch(str(path))


def _print_card(console: Console, scene: Scene) -> None:
    for section in card(scene):
        console.print()
        console.print(Text(section.title, style="bold cyan"))
        for label, text in section.lines:
            console.print(Text.assemble("  ", (f"{label}  " if label else "", "bold"), text.replace("`", "")))


def _print_short_card(console: Console, scene: Scene) -> None:
    """Print the viewpoints with their presets, and summaries of the objects and of the text in the scene."""
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
    categories = Counter([i.category for i in file.instances] + [a.category for a in file.actors])
    counts = [f"{count} {category}" for category, count in categories.most_common()]
    texts = [f"“{text}”" for text in dict.fromkeys(" ".join(t.text.split()) for t in file.texts)]
    for title, items in (
        (f"Objects ({len(file.instances) + len(file.actors)})", counts),
        (f"Texts ({len(file.texts)})", texts),
        ("Moving objects", [actor.name for actor in file.actors]),
        ("Deliberately absent", list(file.absent)),
    ):
        more = f", and {len(items) - MAX_NAMES} more" if len(items) > MAX_NAMES else ""
        console.print(Text.assemble((title, "bold cyan"), f": {', '.join(items[:MAX_NAMES]) or 'none'}{more}"))


def _print_line(console: Console, text: Text) -> None:
    console.print(text, no_wrap=True, overflow="ellipsis")


def _pose_text(preset: ScenePreset) -> str:
    return f"pan {preset.pan_deg:g}°, tilt {preset.tilt_deg:g}°, zoom {preset.zoom:g}x"


def _cached_sheet(scene: Scene) -> Path:
    folder = load_settings().cache_dir / "sheets"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder} cannot be created: {error.strerror}. Set SCOPE_CACHE_DIR, or give --contact-sheet.") from error
    return folder / f"{scene.name}-{scene.file.version}.png"


async def _write_contact_sheet(scene: Scene, path: Path) -> None:
    from PIL import Image

    from scope_ptz.agent.contact_sheet import contact_sheet

    pictures = []
    async with await open_camera(f"sim:{scene.name}") as opened:
        for preset in scene.file.presets:
            await opened.camera.go_to_preset(preset.name)
            caption = f"{preset.name} · {preset.viewpoint}"
            pictures.append((caption, Image.fromarray((await opened.camera.frame()).image)))
    _save_image(contact_sheet(scene.file.title, pictures), path)


def view_scene(flags: StartFlags, name: str | None, pose: tuple[float | None, float | None, float | None], out: Path) -> None:
    """Save a camera's view as a picture file.

    Args:
        flags: The options for the camera and its start pose.
        name: The scene of a simulated camera, if ``flags`` contains neither scene nor camera.
        pose: Pan and tilt in degrees, and zoom; None to keep the value of the start pose.
        out: The picture file.
    """
    from PIL import Image

    if name is not None and (flags.camera or flags.scene):
        raise InputError("Give the scene or camera once: as the argument, with --camera, or with --scene.")
    start = flags if name is None else replace(flags, scene=name)

    async def work() -> None:
        async with await start.open() as opened:
            current = await opened.camera.pose()
            pan, tilt, zoom = (
                requested if requested is not None else current_value
                for requested, current_value in zip(pose, _pose_values(current), strict=True)
            )
            try:
                arrival = await opened.camera.move(Pose(pan, tilt, zoom))
            except ValueError as error:
                raise InputError(f"The pose is not possible: {error}.") from error
            _save_image(Image.fromarray((await opened.camera.frame()).image), out)
        reached = arrival.pose.as_dict()
        note = f" (stopped by the {' and '.join(arrival.clamped)} limit)" if arrival.clamped else ""
        put(f"Wrote {out}: pan {reached['pan_deg']:g}, tilt {reached['tilt_deg']:g}, zoom {reached['zoom']:g}x{note}")

    run_async(work)


def _pose_values(pose: Pose) -> tuple[float, float, float]:
    return pose.pan_deg, pose.tilt_deg, pose.zoom


def _save_image(image: Any, path: Path) -> None:
    try:
        image.save(path)
    except (OSError, ValueError) as error:
        raise OutputError(f"{path} cannot be written: {error}.") from error
