"""``scope scene list|show|view``: what there is to look at."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import anyio
from rich.console import Console
from rich.table import Table
from rich.text import Text

from scope_ptz.cli.endings import put, put_json
from scope_ptz.cli.session import Start, open_camera, open_scene, scene_search
from scope_ptz.errors import InputError, OutputError
from scope_ptz.geometry import Pose
from scope_ptz.settings import load_settings
from scope_ptz.world.pack import Scene
from scope_ptz.world.pack import list_scenes as scene_names


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
            shared = (str(scene["instances"]), str(scene["texts"]), _megabytes(scene["bytes"])) if number == 0 else ("", "", "")
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


def folder_bytes(folder: Path) -> int:
    """Size of all files in a folder."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.1f} MB"


def show_scene(name: str, contact_sheet: Path | None) -> None:
    """Print a scene's card; on wish write a picture of all presets."""
    scene = open_scene(name)
    file, console = scene.file, Console(highlight=False)
    console.print(Text.assemble((file.title, "bold"), (f"  ({file.name} {file.version}, Blender {file.blender_version})", "dim")))
    for viewpoint in file.viewpoints:
        size = _megabytes(folder_bytes(scene.folder / viewpoint.name))
        x, y, z = viewpoint.position_m
        console.print()
        console.print(Text.assemble((f"Viewpoint {viewpoint.name}", "bold cyan"), f"  {viewpoint.description}"))
        console.print(Text(f"  at ({x:.1f}, {y:.1f}, {z:.1f}) m, {size}", style="dim"))
        for preset in file.presets:
            if preset.viewpoint == viewpoint.name:
                pose = f"pan {preset.pan_deg:g}°, tilt {preset.tilt_deg:g}°, zoom {preset.zoom:g}x"
                home = "  (home)" if preset.name == file.home_preset else ""
                console.print(Text.assemble(("  " + preset.name, "bold"), f"  {pose}{home}  ", (preset.description, "dim")))
    categories = Counter([i.category for i in file.instances] + [a.category for a in file.actors])
    inventory = ", ".join(f"{count} {category}" for category, count in categories.most_common())
    _paragraph(console, f"{len(file.instances)} things of {len(categories)} kinds", inventory)
    readable = Counter(f"“{' '.join(t.text.split())}”" for t in file.texts)
    _paragraph(console, f"{len(file.texts)} texts", "; ".join(f"{t} ({n} times)" if n > 2 else t for t, n in readable.items()))
    movers = ", ".join(
        f"{a.name} ({a.waypoints[0][0]:g} to {a.waypoints[-1][0]:g} s of every {a.period_s:g} s)" for a in file.actors
    )
    _paragraph(console, f"{len(file.actors)} moving", movers)
    _paragraph(console, "Deliberately absent", ", ".join(file.absent))
    if contact_sheet is not None:
        anyio.run(_write_contact_sheet, scene, contact_sheet)
        console.print(Text(f"\nWrote {contact_sheet}"), soft_wrap=True)


def _paragraph(console: Console, title: str, body: str) -> None:
    console.print()
    console.print(Text(title, style="bold cyan"))
    console.print(Text(f"  {body or 'none'}"))


async def _write_contact_sheet(scene: Scene, path: Path) -> None:
    from PIL import Image

    from scope_ptz.agent.sheet import contact_sheet

    camera = await open_camera(Start(scene.name), scene, realtime=False)
    pictures = []
    for preset in scene.file.presets:
        await camera.go_to_preset(preset.name)
        caption = f"{preset.name} · {preset.viewpoint}"
        pictures.append((caption, Image.fromarray((await camera.frame()).image)))
    _save(contact_sheet(scene.file.title, pictures), path)


def view_scene(start: Start, wanted: tuple[float | None, float | None, float | None], out: Path) -> None:
    """Write what the camera sees at a pose (pan, tilt in degrees, zoom; what is not given stays as at the start)."""
    from PIL import Image

    async def work() -> None:
        camera = await open_camera(start, open_scene(start.scene), realtime=False)
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
