"""Whether a pack shows what Blender shows: re-projected views against live renders of the same poses, drawn by seed."""

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
from scope_ptz.blender.references import keep_reference
from scope_ptz.blender.requests import perspective_request
from scope_ptz.blender.workshop import Progress, Workshop
from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, Pose
from scope_ptz.world.layers import read_colour
from scope_ptz.world.models import Tile
from scope_ptz.world.pack import Scene
from scope_ptz.world.reproject import colour_view, id_view

SEED_OF_LIVE = 7
"""Not the seed that packs are baked with: equal noise would flatter."""

MIN_BOX_PIXELS = 400


@dataclass(frozen=True, slots=True)
class PoseReport:
    """One pose: how alike the pictures are, how sharp the pack's is against the live one, the mean IoU of boxes (None: no boxes).

    ``tile_share`` is the part of the view that lies in tiles; where it is above 0 and the zoom above 1, similarity and sharpness
    are those of that part.
    """

    viewpoint: str
    pose: Pose
    ssim: float
    sharpness_ratio: float
    box_iou: float | None
    tile_share: float


def draw_poses(scene: Scene, seed: int, wide: int, zoomed: int, viewpoints: Sequence[str] | None = None) -> list[tuple[str, Pose]]:
    """``wide`` poses at the wide end over all pans and tilts and ``zoomed`` ones at 2x to 5x on tiles, viewpoints in turn."""
    rng, limits = random.Random(seed), Limits()
    names = [v.name for v in scene.file.viewpoints] if viewpoints is None else viewpoints
    poses = []
    for k in range(wide):
        share = (k + rng.random()) / wide
        tilt = limits.min_tilt_deg + share * (limits.max_tilt_deg - limits.min_tilt_deg)
        poses.append((names[k % len(names)], Pose(rng.uniform(-179, 179), tilt, 1.0)))
    for k in range(zoomed):
        name = names[k % len(names)]
        tiles = scene.viewpoint(name).manifest.tiles
        if tiles:
            tile = rng.choice(tiles)
            pan, tilt = tile.pan_deg + rng.uniform(-2, 2), tile.tilt_deg + rng.uniform(-2, 2)
            pose, _ = limits.clamp(Pose(limits.aim_pan_deg(pan), tilt, rng.uniform(2.0, 5.0)))
            poses.append((name, pose))
    return poses


def compare(scene: Scene, viewpoint: str, pose: Pose, colour: NDArray[np.uint8], ids: NDArray[np.uint16]) -> PoseReport:
    """The pack's view of a pose against a live render (H, W, 3) and its instance numbers (H, W)."""
    height, width = ids.shape
    view = Perspective(pose.pan_deg, pose.tilt_deg, AXIS_M5075_G.hfov_deg(pose.zoom), width, height)
    here = scene.viewpoint(viewpoint)
    tiled = _in_tiles(here.manifest.tiles, view)
    mask = tiled if tiled.any() and pose.zoom > 1.0 else None
    stored = colour_view(here, view)
    ious = list(box_ious(id_view(here, view), ids, MIN_BOX_PIXELS).values())
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
    """Compare each pose; the worker must have the scene loaded. Moving actors are left out on both sides.

    ``keep``: a folder for the live renders, so that later packs can be compared without Blender (``references.py``).
    """
    reports = []
    with TemporaryDirectory() as folder:
        step = Workshop(Path(folder), "verify", progress).steps("verify", len(poses))
        for name, pose in poses:
            view = Perspective(pose.pan_deg, pose.tilt_deg, AXIS_M5075_G.hfov_deg(pose.zoom), width, height)
            colour, ids = _live(worker, name, view, samples, Path(folder))
            reports.append(compare(scene, name, pose, colour, ids))
            if keep is not None:
                keep_reference(keep, name, pose, colour, ids)
            step()
    return reports


def _live(
    worker: BlenderWorker, viewpoint: str, view: Perspective, samples: int, folder: Path
) -> tuple[NDArray[np.uint8], NDArray[np.uint16]]:
    common: dict[str, Any] = {"viewpoint": viewpoint, "projection": perspective_request(view)}
    picture, truth = folder / "live.png", folder / "live.npz"
    worker.request("colour", {**common, "samples": samples, "seed": SEED_OF_LIVE, "out": str(picture)})
    worker.request("truth", {**common, "out": str(truth)})
    with np.load(truth) as file:
        return read_colour(picture), file["ids"]


def _in_tiles(tiles: Sequence[Tile], view: Perspective) -> NDArray[np.bool_]:
    """(H, W): which pixels of a view lie in any tile."""
    x, y = np.meshgrid((np.arange(view.width) + 0.5) / view.width, (np.arange(view.height) + 0.5) / view.height)
    directions = view.directions(np.stack([x, y], axis=-1))
    inside = np.zeros((view.height, view.width), dtype=bool)
    for tile in tiles:
        shape = Perspective(tile.pan_deg, tile.tilt_deg, tile.hfov_deg, tile.colour.width, tile.colour.height)
        points = np.nan_to_num(shape.points(directions), nan=-1.0)
        inside |= np.all((points >= 0) & (points <= 1), axis=-1)
    return inside
