"""``scope scene build``, ``bake`` and ``verify``: build scenes in Blender, bake packs, and compare packs with live renders."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from scope_ptz.blender.bake import bake
from scope_ptz.blender.client import BlenderWorker
from scope_ptz.blender.environment import is_ready, worker_command
from scope_ptz.blender.quality import named_quality
from scope_ptz.blender.sources import scene_names
from scope_ptz.blender.tolerances import missed_tolerances
from scope_ptz.blender.verify import PoseReport, draw_poses, verify
from scope_ptz.cli.exit import FAILED
from scope_ptz.errors import OutputError, UnknownNameError
from scope_ptz.factory.scenes import open_scene
from scope_ptz.settings import ScopeSettings, load_settings


def build_scene(source: str, out: Path | None) -> None:
    """Build a scene from its code in Blender and save it as a .blend file."""
    settings, console = load_settings(), Console(highlight=False)
    _check_scene_name(source)
    target = (out or Path(f"{Path(source).stem}.blend")).absolute()
    _make_folder(target.parent)
    started_s = time.monotonic()
    with BlenderWorker(_command(settings, console), settings.cache_dir / "build.log") as worker:
        worker.request("load_scene", {"source": source})
        facts: dict[str, Any] = worker.request("describe")
        worker.request("save", {"path": str(target)})
    counts = f"{len(facts['instances'])} objects, {len(facts['texts'])} texts, {len(facts['viewpoints'])} viewpoints"
    console.print(Text(f"Wrote {target}: {counts}, {time.monotonic() - started_s:.0f} s"), soft_wrap=True)


def bake_scene(source: str, out: Path | None, quality: str, viewpoints: list[str]) -> int:
    """Bake a scene's packs and compare them with live renders. An interrupted bake is resumed.

    Returns:
        The exit code: 1 if a pack differs too much from the live renders, but always 0 for drafts.
    """
    settings, console = load_settings(), Console(highlight=False)
    _check_scene_name(source)
    quality_level = named_quality(quality)
    folder = (out or Path("scenes") / Path(source).stem.replace("_", "-")).absolute()
    _make_folder(folder.parent)
    command = _command(settings, console)
    with _ProgressBars(console) as bars:
        baked = bake(
            source,
            folder,
            quality=quality_level,
            command=command,
            cache_dir=settings.cache_dir,
            viewpoints=viewpoints or None,
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


def verify_scene(name: str, seed: int, wide_count: int, zoomed_count: int, renders_folder: Path | None) -> int:
    """Compare a scene's packs with live renders at random poses. Return the exit code, which is 1 if they differ too much."""
    settings, console = load_settings(), Console(highlight=False)
    _check_scene_name(name)
    scene = open_scene(name)
    command = _command(settings, console)
    with _ProgressBars(console) as bars, BlenderWorker(command, settings.cache_dir / "verify.log") as worker:
        worker.request("load_scene", {"source": name})
        reports = verify(scene, worker, draw_poses(scene, seed, wide_count, zoomed_count), bars, keep=renders_folder)
    return FAILED if _show_comparison(console, reports) else 0


def _show_comparison(console: Console, reports: Sequence[PoseReport]) -> list[str]:
    """Print the comparison at each pose, and return a sentence about each missed tolerance."""
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


class _ProgressBars:
    """Progress bars with the remaining time, one for each part of a bake."""

    def __init__(self, console: Console) -> None:
        self._progress = Progress(
            TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn(),
            console=console,
        )  # fmt: skip
        self._tasks: dict[str, TaskID] = {}

    def __enter__(self) -> _ProgressBars:
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()

    def __call__(self, part: str, done: int, total: int, seconds: float) -> None:  # noqa: ARG002 - the bar measures time itself
        if part not in self._tasks:
            self._tasks[part] = self._progress.add_task(part, total=total)
        self._progress.update(self._tasks[part], completed=done, total=total)


def _check_scene_name(source: str) -> None:
    """Raise ``UnknownNameError`` for an unknown scene before Blender starts."""
    if source.endswith(".py") and Path(source).is_file():
        return
    known = scene_names()
    if source not in known:
        raise UnknownNameError("scene", source, known)


def _command(settings: ScopeSettings, console: Console) -> list[str]:
    program = settings.blender_python or settings.blender
    if program is None and not is_ready(settings.cache_dir):
        console.print("Downloading Blender's Python module (about 400 MB); this happens once.", style="yellow")
    return worker_command(settings.cache_dir, program)


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder} cannot be created: {error.strerror}.") from error
