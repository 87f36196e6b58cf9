"""Compare packs with live Blender renders at the same poses. A seed determines the random poses."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scope_ptz.blender.client import BlenderWorker
from scope_ptz.blender.parity import box_ious, sharpness, ssim
from scope_ptz.blender.part_cache import PartCache, Progress
from scope_ptz.blender.references import add_reference
from scope_ptz.blender.requests import perspective_request
from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, Pose, angle_between_deg, direction, pan_tilt_deg, wrap_pan_deg
from scope_ptz.simulator.layers import read_colour
from scope_ptz.simulator.models import Tile
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.reproject import colour_view, id_view

LIVE_SEED = 7
"""Seed for live renders. It differs from the seed for bakes, because identical noise would increase the similarity."""

MIN_BOX_PIXELS = 400  # boxes of smaller instances are not compared

FOLIAGE = ("tree", "bush", "hedge", "planter", "flower bed", "hanging basket")
"""Plant categories, which are the hardest to re-project."""


@dataclass(frozen=True, slots=True)
class PoseReport:
    """The comparison at one pose: SSIM, sharpness relative to the live render, and mean box IoU (None if there are none).

    ``tile_share`` is the fraction of the view that is covered by sufficiently dense tiles. If it is above 0 and the zoom is above
    1, similarity and sharpness refer to that part.
    """

    viewpoint: str
    pose: Pose
    ssim: float
    sharpness_ratio: float
    box_iou: float | None
    tile_share: float


def draw_poses(scene: Scene, seed: int, wide: int, zoomed: int, viewpoints: Sequence[str] | None = None) -> list[tuple[str, Pose]]:
    """Draw ``wide`` poses at the widest zoom, and ``zoomed`` poses at 2x to 5x that show tiles. Viewpoints alternate.

    Half of the poses show content that is hard to re-project: a sign, foliage, or the ground far below. The other poses cover all
    pans and tilts at the widest zoom, and show random tiles when zoomed in.
    """
    rng, limits = random.Random(seed), Limits()
    names = [v.name for v in scene.file.viewpoints] if viewpoints is None else viewpoints
    poses = []
    for k in range(wide):
        name = names[k % len(names)]
        fraction = (k + rng.random()) / wide
        pan, tilt = rng.uniform(-179, 179), limits.min_tilt_deg + fraction * (limits.max_tilt_deg - limits.min_tilt_deg)
        if hard := _hard_direction(scene, name, k // len(names), rng, limits):
            pan, tilt = hard
        poses.append((name, limits.clamp(Pose(limits.aim_pan_deg(pan), tilt, 1.0))[0]))
    for k in range(zoomed):
        name = names[k % len(names)]
        closest = Perspective(0.0, 0.0, AXIS_M5075_G.hfov_deg(limits.max_zoom), 1280, 720)
        tiles = [t for t in scene.viewpoint(name).manifest.tiles if t.suits(closest)]
        if tiles:
            tile = rng.choice(tiles)
            if hard := _hard_direction(scene, name, k // len(names), rng, limits):
                tile = min(tiles, key=lambda t: float(angle_between_deg(direction(t.pan_deg, t.tilt_deg), direction(*hard))))
            pan, tilt = tile.pan_deg + rng.uniform(-2, 2), tile.tilt_deg + rng.uniform(-2, 2)
            zoom = 2.0 + 3.0 * k / max(1, zoomed - 1)
            poses.append((name, limits.clamp(Pose(limits.aim_pan_deg(pan), tilt, zoom))[0]))
    return poses


def _hard_direction(scene: Scene, viewpoint: str, index: int, rng: random.Random, limits: Limits) -> tuple[float, float] | None:
    """Return the pan and tilt of foliage, a sign or the ground, depending on ``index``.

    Return None if ``index`` is odd or if the scene has no such object.
    """
    camera = next(v for v in scene.file.viewpoints if v.name == viewpoint)
    kind = index // 2 % 3
    if index % 2:
        return None
    if kind == 2:
        return rng.uniform(-179, 179), rng.uniform(limits.min_tilt_deg, -35.0)
    if kind == 1:
        parents = {t.parent for t in scene.file.texts}
        candidates = [i for i in scene.file.instances if i.id in parents]
    else:
        candidates = [i for i in scene.file.instances if i.category in FOLIAGE]
    if not candidates:
        return None
    chosen = rng.choice(candidates)
    centre = (np.array(chosen.box_min_m) + np.array(chosen.box_max_m)) / 2 - np.array(camera.position_m)
    pan, tilt = (float(v) for v in pan_tilt_deg(centre))
    return float(wrap_pan_deg(pan - camera.pan0_bearing_deg)), tilt


def compare(scene: Scene, viewpoint: str, pose: Pose, colour: NDArray[np.uint8], ids: NDArray[np.uint16]) -> PoseReport:
    """Compare the pack's view at a pose with a live render: a picture ``(H, W, 3)`` and instance IDs ``(H, W)``."""
    height, width = ids.shape
    view = Perspective(pose.pan_deg, pose.tilt_deg, AXIS_M5075_G.hfov_deg(pose.zoom), width, height)
    pack = scene.viewpoint(viewpoint)
    tiled = _tile_mask(pack.manifest.tiles, view)
    mask = tiled if tiled.any() and pose.zoom > 1.0 else None
    stored = colour_view(pack, view)
    ious = list(box_ious(id_view(pack, view), ids, MIN_BOX_PIXELS).values())
    return PoseReport(
        viewpoint=viewpoint,
        pose=pose,
        ssim=ssim(stored, colour, mask),
        sharpness_ratio=sharpness(stored, mask) / max(sharpness(colour, mask), 1e-9),
        box_iou=float(np.mean(ious)) if ious else None,
        tile_share=float(tiled.mean()),
    )


def verify(
    scene: Scene,
    worker: BlenderWorker,
    poses: Sequence[tuple[str, Pose]],
    progress: Progress,
    *,
    samples: int = 16,
    width: int = 1280,
    height: int = 720,
    keep: Path | None = None,
) -> list[PoseReport]:
    """Compare packs with live renders at each pose. The worker must have loaded the scene. Actors are not rendered.

    Args:
        scene: The scene with its packs.
        worker: The worker that renders.
        poses: The viewpoints and poses to compare.
        progress: Called after every step.
        samples: Samples per pixel in the live renders.
        width: Width of the views in pixels.
        height: Height of the views in pixels.
        keep: A folder in which to save the live renders, so that later packs can be compared without Blender.
    """
    reports = []
    with TemporaryDirectory() as folder:
        step = PartCache(Path(folder), "verify", progress).steps("verify", len(poses))
        for name, pose in poses:
            view = Perspective(pose.pan_deg, pose.tilt_deg, AXIS_M5075_G.hfov_deg(pose.zoom), width, height)
            colour, ids = _render_live(worker, name, view, samples, Path(folder))
            reports.append(compare(scene, name, pose, colour, ids))
            if keep is not None:
                add_reference(keep, name, pose, colour, ids)
            step()
    return reports


def _render_live(
    worker: BlenderWorker, viewpoint: str, view: Perspective, samples: int, folder: Path
) -> tuple[NDArray[np.uint8], NDArray[np.uint16]]:
    common: dict[str, Any] = {"viewpoint": viewpoint, "projection": perspective_request(view)}
    picture, truth = folder / "live.png", folder / "live.npz"
    worker.request("colour", {**common, "samples": samples, "seed": LIVE_SEED, "out": str(picture)})
    worker.request("truth", {**common, "out": str(truth)})
    with np.load(truth) as file:
        return read_colour(picture), file["ids"]


def _tile_mask(tiles: Sequence[Tile], view: Perspective) -> NDArray[np.bool_]:
    """Return a mask ``(H, W)`` of the pixels in a view that are covered by a tile that is dense enough for the view."""
    x, y = np.meshgrid((np.arange(view.width) + 0.5) / view.width, (np.arange(view.height) + 0.5) / view.height)
    directions = view.directions(np.stack([x, y], axis=-1))
    inside = np.zeros((view.height, view.width), dtype=bool)
    for tile in tiles:
        if not tile.suits(view):
            continue
        points = np.nan_to_num(tile.view.points(directions), nan=-1.0)
        inside |= np.all((points >= 0) & (points <= 1), axis=-1)
    return inside
