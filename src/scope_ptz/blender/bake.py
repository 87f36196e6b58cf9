"""Bake a scene into viewpoint packs. An interrupted bake resumes where it stopped."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from scope_ptz.blender.band import Panorama, reachable_band
from scope_ptz.blender.client import BlenderWorker
from scope_ptz.blender.extents import extents
from scope_ptz.blender.keyframes import Keyframe, keyframes
from scope_ptz.blender.pack_writer import RenderedActor, RenderedTile, RenderedViewpoint, folder_size_bytes, write_pack
from scope_ptz.blender.panorama import render_base
from scope_ptz.blender.part_cache import PartCache, Progress
from scope_ptz.blender.quality import DEPTH_STEP, FAR_M, NEAR_M, PACK_BYTES, WIDER_DENSITY_PX_PER_DEG, Quality
from scope_ptz.blender.requests import panorama_request, perspective_request
from scope_ptz.blender.sheets import make_sheet
from scope_ptz.blender.sources import scene_key
from scope_ptz.blender.tiles import busiest_cells, cover, covers, join_in_rows, select_most_useful, targets
from scope_ptz.blender.verify import PoseReport, draw_poses, verify
from scope_ptz.errors import BlenderError, UnknownNameError
from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective
from scope_ptz.simulator.layers import encode_depth, read_colour
from scope_ptz.simulator.models import Extent, SceneActor, SceneFile, SceneViewpoint
from scope_ptz.simulator.pack import Scene

VIEWS_TO_CHECK, CHECK_SEED = 2, 1
"""Number of views to compare with live renders at the end of a bake, per viewpoint and zoom level (widest and zoomed in), and the
seed for their poses."""


@dataclass(frozen=True, slots=True)
class BakedViewpoint:
    """One viewpoint's baked pack.

    Attributes:
        folder: The viewpoint folder.
        size_bytes: Total size of the folder's files.
        tiles: Number of tiles.
        uncovered: Ids of the targets (texts and small instances) that the tiles do not cover completely.
    """

    folder: Path
    size_bytes: int
    tiles: int
    uncovered: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class BakeResult:
    """The result of a bake: a scene's packs, and their comparison with live renders."""

    packs: tuple[BakedViewpoint, ...]
    reports: tuple[PoseReport, ...]


def bake(
    source: str,
    out_dir: Path,
    *,
    quality: Quality,
    command: Sequence[str],
    cache_dir: Path,
    viewpoints: Sequence[str] | None = None,
    progress: Progress,
) -> BakeResult:
    """Bake a scene into a folder.

    At the end, every file's checksum is verified, and some views are compared with live renders.

    Args:
        source: A scene in ``scope_studio.scenes``, or the path of a Python file that defines ``build(stage)``.
        out_dir: The scene's folder, which must have the scene's name.
        quality: The quality settings.
        command: The command that starts the Blender worker.
        cache_dir: The folder for cached parts of unfinished bakes.
        viewpoints: Names of the viewpoints to bake; None bakes all.
        progress: Called after every step.

    Raises:
        BlenderError: Blender fails, or the folder does not have the scene's name.
        UnknownNameError: The scene has no such viewpoint.
    """
    key = scene_key(source)
    cache = PartCache(cache_dir / "bakes", key, progress)
    with BlenderWorker(command, cache.folder / "blender.log") as worker:
        step = cache.steps("scene", 2)
        worker.request("load_scene", {"source": source})
        step()
        description = worker.request("describe")
        step()
        scene = scene_file(description, key.rsplit("-", 1)[1])
        if out_dir.name != scene.name:
            raise BlenderError(f"The folder must have the scene's name: bake to '{out_dir.with_name(scene.name)}'.")
        known = {v.name: v for v in scene.viewpoints}
        names = list(known) if viewpoints is None else list(viewpoints)
        for name in names:
            if name not in known:
                raise UnknownNameError("viewpoint", name, known)
        out_dir.mkdir(parents=True, exist_ok=True)
        baker = _Baker(worker, cache, scene, description, quality)
        baked = [baker.bake_viewpoint(known[name], out_dir / name) for name in names]
        (out_dir / "scene.json").write_text(scene.model_dump_json(indent=1, exclude={"captured"}) + "\n")
        baked_scene = Scene(out_dir)
        for name in names:
            baked_scene.viewpoint(name).check_files()
        poses = draw_poses(baked_scene, CHECK_SEED, VIEWS_TO_CHECK * len(names), VIEWS_TO_CHECK * len(names), names)
        width = quality.check_width
        reports = verify(baked_scene, worker, poses, progress, samples=quality.check_samples, width=width, height=width * 9 // 16)
    return BakeResult(tuple(baked), tuple(reports))


def scene_file(description: dict[str, Any], version: str) -> SceneFile:
    """Create a scene file from the worker's description of a scene.

    Raises:
        BlenderError: The description is not a valid scene.
    """
    fields = {k: v for k, v in description.items() if k in SceneFile.model_fields}
    try:
        return SceneFile.model_validate({"version": version, **fields})
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise BlenderError(f"The built scene is invalid at {where}: {first['msg']}. Correct the scene's code.") from error


class _Baker:
    """Bakes viewpoints with one worker and one cache of parts."""

    def __init__(
        self, worker: BlenderWorker, cache: PartCache, scene: SceneFile, description: dict[str, Any], quality: Quality
    ) -> None:
        self._worker, self._cache, self._scene, self._quality = worker, cache, scene, quality
        self._strides: dict[str, float | None] = description["strides_m"]
        self._sun = None if description["sun"] is None else np.array(description["sun"])
        self._band = reachable_band(Limits(), AXIS_M5075_G)

    def bake_viewpoint(self, viewpoint: SceneViewpoint, folder: Path) -> BakedViewpoint:
        quality, name = self._quality, viewpoint.name
        ids_panorama = Panorama.of(quality.ids_width, self._band)
        ids, _ = self._render_truth(name, "ids", panorama_request(ids_panorama.projection))
        depth_panorama = Panorama.of(quality.depth_width, self._band)
        _, metres = self._render_truth(name, "depth", panorama_request(depth_panorama.projection))
        silhouettes = self._measure_extents(viewpoint)
        base_panorama = Panorama.of(quality.base_width, self._band)
        base = render_base(self._worker, self._cache, name, base_panorama, quality.base_samples)
        tile_targets = targets(self._scene, viewpoint, ids, ids_panorama.projection)
        views = [
            cell.view(quality.tile_density_px_per_deg)
            for cell in join_in_rows(select_most_useful(cover(tile_targets), tile_targets, quality.max_cells))
        ]
        tiles = self._render_tiles(name, "tiles", views)
        if quality.wider_tiles:
            wider_cells = busiest_cells(ids, ids_panorama.projection, quality.wider_tiles)
            tiles += self._render_tiles(name, "wider tiles", [cell.view(WIDER_DENSITY_PX_PER_DEG) for cell in wider_cells])
        actors = [a for actor in self._scene.actors if (a := self._render_actor(viewpoint, actor)) is not None]
        rendered = RenderedViewpoint(
            base_panorama, base, ids, encode_depth(metres, NEAR_M, FAR_M, DEPTH_STEP), tiles, actors, silhouettes
        )
        manifest = write_pack(folder, self._scene, viewpoint, rendered, quality, PACK_BYTES, self._cache.steps(f"{name}/pack", 3))
        uncovered = tuple(t.name for t in tile_targets if not covers(views, t))
        return BakedViewpoint(folder, folder_size_bytes(folder), len(manifest.tiles), uncovered)

    def _render_truth(
        self, viewpoint: str, part: str, projection: dict[str, Any]
    ) -> tuple[NDArray[np.uint16], NDArray[np.float32]]:
        def produce(path: Path) -> None:
            step = self._cache.steps(f"{viewpoint}/{part}", 1)
            self._worker.request("truth", {"viewpoint": viewpoint, "projection": projection, "out": str(path)})
            step()

        with np.load(self._cache.part(f"{viewpoint}/truth", ".npz", projection, produce)) as file:
            return file["ids"], file["depth"]

    def _render_colour(self, viewpoint: str, part: str, view: Perspective, samples: int) -> NDArray[np.uint8]:
        projection = perspective_request(view)

        def produce(path: Path) -> None:
            parameters = {"viewpoint": viewpoint, "projection": projection, "samples": samples, "seed": 1, "out": str(path)}
            self._worker.request("colour", parameters)

        return read_colour(self._cache.part(part, ".png", {"projection": projection, "samples": samples}, produce))

    def _measure_extents(self, viewpoint: SceneViewpoint) -> list[Extent]:
        def dump(path: Path) -> None:
            self._worker.request("meshes", {"out": str(path)})

        def measure(path: Path) -> None:
            silhouettes = extents(meshes, viewpoint, self._cache.step_callback(f"{viewpoint.name}/extents"))
            path.write_text(json.dumps([e.model_dump() for e in silhouettes]))

        meshes = self._cache.part("meshes", ".npz", {}, dump)
        parameters = viewpoint.model_dump(mode="json")
        file = self._cache.part(f"{viewpoint.name}/extents", ".json", parameters, measure)
        return [Extent.model_validate(e) for e in json.loads(file.read_text())]

    def _render_tiles(self, viewpoint: str, part: str, views: list[Perspective]) -> list[RenderedTile]:
        step = self._cache.steps(f"{viewpoint}/{part}", len(views))
        tiles = []
        for view in views:
            colour = self._render_colour(viewpoint, f"{viewpoint}/tile", view, self._quality.tile_samples)
            ids, _ = self._render_truth(viewpoint, "tile ids", perspective_request(view))
            tiles.append(RenderedTile(view, colour, ids))
            step()
        return tiles

    def _render_actor(self, viewpoint: SceneViewpoint, actor: SceneActor) -> RenderedActor | None:
        quality, stride_m = self._quality, self._strides[actor.id]
        limit = quality.max_sprites * 3 // 2 if stride_m else quality.max_sprites
        frames = keyframes(actor, stride_m, viewpoint, self._band, self._sun, limit)
        if not frames:
            return None
        folder = self._render_sprites(viewpoint.name, actor, frames)
        return RenderedActor(actor.number, make_sheet(frames, folder), stride_m)

    def _render_sprites(self, viewpoint: str, actor: SceneActor, frames: list[Keyframe]) -> Path:
        requests = [f.request() for f in frames]
        samples = self._quality.sprite_samples

        def produce(stamp: Path) -> None:
            folder = stamp.with_suffix("")
            folder.mkdir(exist_ok=True)
            parameters = {"actor": actor.id, "viewpoint": viewpoint, "frames": requests, "samples": samples, "out_dir": str(folder)}
            self._worker.request("sprites", parameters, progress=self._cache.step_callback(f"{viewpoint}/{actor.id}"))
            stamp.write_text("done\n")

        stamp = self._cache.part(f"{viewpoint}/{actor.id}", ".done", {"frames": requests, "samples": samples}, produce)
        return stamp.with_name(f"unfinished-{stamp.stem}")
