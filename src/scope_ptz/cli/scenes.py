"""``scope scene list|show|view``: what there is to look at."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import anyio
import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from scope_ptz.cli.cards import card, folder_bytes, markdown, megabytes
from scope_ptz.cli.endings import put, put_json
from scope_ptz.errors import InputError, OutputError
from scope_ptz.factory.cameras import open_camera
from scope_ptz.factory.scenes import open_scene, scene_search
from scope_ptz.geometry import Pose
from scope_ptz.settings import has_desktop, load_settings
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.pack import list_scenes as scene_names


def list_scenes(*, as_json: bool) -> None:
    """Print every scene that can be loaded, with its viewpoints and sizes."""
    scenes = [_facts(open_scene(name)) for name in scene_names(scene_search(load_settings()))]
    if as_json:
        put_json(scenes)
        return
    if not scenes:
        put("There are no scenes. `scope doctor` says where they are looked for.")
        return
    table = Table("scene", "viewpoint", "presets", "instances", "texts", "size", box=None, pad_edge=False, header_style="dim")
    for scene in scenes:
        for number, viewpoint in enumerate(scene["viewpoints"]):
            shared = (str(scene["instances"]), str(scene["texts"]), megabytes(scene["bytes"])) if number == 0 else ("", "", "")
            table.add_row(scene["name"] if number == 0 else "", viewpoint["name"], ", ".join(viewpoint["presets"]), *shared)
    Console(highlight=False).print(table)


def _facts(scene: Scene) -> dict[str, Any]:
    file = scene.file
    return {
        "name": scene.name,
        "viewpoints": [
            {"name": v.name, "presets": [p.name for p in file.presets if p.viewpoint == v.name]} for v in file.viewpoints
        ],
        "instances": len(file.instances),
        "texts": len(file.texts),
        "bytes": folder_bytes(scene.folder),
    }


def show_scene(name: str, sheet: Path | None, *, opened: bool | None, as_markdown: bool) -> None:
    """Print a scene's card, and draw a sheet of all its presets.

    Args:
        name: the scene.
        sheet: PNG file for the sheet; one in the cache folder when None.
        opened: whether the sheet is shown in the desktop's picture viewer; None: when a person sits at a desktop.
        as_markdown: print the card as a Markdown page and nothing else.
    """
    scene = open_scene(name)
    if as_markdown:
        put(markdown(scene, None if sheet is None else str(sheet)).rstrip("\n"))
        return
    file, console = scene.file, Console(highlight=False)
    console.print(Text.assemble((file.title, "bold"), (f"  ({file.name} {file.version}, Blender {file.blender_version})", "dim")))
    for paragraph in card(scene):
        console.print()
        console.print(Text(paragraph.title, style="bold cyan"))
        for line, body in paragraph.lines:
            console.print(Text.assemble("  ", (f"{line}  " if line else "", "bold"), body.replace("`", "")))
    path = sheet or _cached_sheet(scene)
    anyio.run(_write_contact_sheet, scene, path)
    console.print(Text(f"\nContact sheet: {path}"), soft_wrap=True)
    if sys.stdout.isatty() and has_desktop() if opened is None else opened:
        typer.launch(str(path))


def _cached_sheet(scene: Scene) -> Path:
    folder = load_settings().cache_dir / "sheets"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder} cannot be made: {error.strerror}. Set SCOPE_CACHE_DIR, or give --contact-sheet.") from error
    return folder / f"{scene.name}-{scene.file.version}.png"


async def _write_contact_sheet(scene: Scene, path: Path) -> None:
    from PIL import Image

    from scope_ptz.agent.contact_sheet import contact_sheet

    camera = (await open_camera(f"sim:{scene.name}")).camera
    pictures = []
    for preset in scene.file.presets:
        await camera.go_to_preset(preset.name)
        caption = f"{preset.name} · {preset.viewpoint}"
        pictures.append((caption, Image.fromarray((await camera.frame()).image)))
    _save(contact_sheet(scene.file.title, pictures), path)


def view_scene(
    name: str, viewpoint: str | None, preset: str | None, time_s: float | None,
    wanted: tuple[float | None, float | None, float | None], out: Path,
) -> None:  # fmt: skip
    """Write what the camera sees at a pose (pan, tilt in degrees, zoom; what is not given stays as at the start)."""
    from PIL import Image

    async def work() -> None:
        camera = (await open_camera(f"sim:{name}", viewpoint=viewpoint, preset=preset, time_s=time_s)).camera
        here = await camera.pose()
        pan, tilt, zoom = (given if given is not None else now for given, now in zip(wanted, _parts(here), strict=True))
        try:
            arrival = await camera.move(Pose(pan, tilt, zoom))
        except ValueError as error:
            raise InputError(f"That is no pose: {error}.") from error
        _save(Image.fromarray((await camera.frame()).image), out)
        pose = arrival.pose.as_dict()
        cut = f" (stopped by the {' and '.join(arrival.clamped)} limit)" if arrival.clamped else ""
        put(f"Wrote {out}: pan {pose['pan_deg']:g}, tilt {pose['tilt_deg']:g}, zoom {pose['zoom']:g}x{cut}")

    anyio.run(work)


def _parts(pose: Pose) -> tuple[float, float, float]:
    return pose.pan_deg, pose.tilt_deg, pose.zoom


def _save(image: Any, path: Path) -> None:
    try:
        image.save(path)
    except (OSError, ValueError) as error:
        raise OutputError(f"{path} cannot be written: {error}.") from error
