"""Write a registered capture as a scene: a viewpoint pack with pictures but no ground truth."""

from __future__ import annotations

import json
import math
import re
import shutil
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.blender.band import Panorama, reachable_band
from scope_ptz.blender.pack_writer import layer_of
from scope_ptz.camera.capture.composition import UNSEEN_COLOUR, Composer, FramePicture, View, frame_picture
from scope_ptz.camera.capture.hidden_parts import hidden_mask, keep_out_mask
from scope_ptz.camera.capture.progress import Progress
from scope_ptz.camera.capture.registration import Registration, measured_optics
from scope_ptz.camera.capture.session import CaptureSession, CaptureSettings
from scope_ptz.errors import OutputError
from scope_ptz.geometry import Limits, Optics, Perspective, Pose, direction, wrap_pan_deg
from scope_ptz.simulator.layers import write_colour, write_ids
from scope_ptz.simulator.models import CapturedFrom, Depth, Layer, Manifest, SceneFile, ScenePreset, SceneViewpoint, Tile

VIEWPOINT = "camera"
"""Name of the viewpoint in a captured scene."""

BASE_DENSITY = 1.27
"""Pixel density of the panorama relative to the centre of a wide frame.

With this value, views from the pack are as sharp as the frames.
"""

MAX_WIDE_DENSITY = 1.15
"""Maximum pixel density of frames in the panorama, relative to the widest frames. Denser frames become tiles."""

BASE_QUALITY, TILE_QUALITY = 90, 86  # AVIF quality of the panorama and of tiles, from 0 to 100
BASE_SHARPENING, TILE_SHARPENING, SHARPENING_SIGMA_PX = 0.6, 0.2, 0.8
"""Strengths and radius of the unsharp mask that is applied before pictures are stored.

It compensates for resampling twice: frames to the pack, and later the pack to a view. With these strengths, the Laplacian variance
of views is closest to that of the captured frames.
"""

SEEN_MASK_SCALE = 4  # factor by which the mask of seen pixels is downsampled along each axis

Picture = NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class WrittenScene:
    """The result of writing a scene.

    Attributes:
        folder: The scene's folder.
        file: The content of its ``scene.json``.
        tiles: Number of tiles, which are sharper than the panorama.
        omitted_presets: Names of the presets that were omitted because they are outside the captured range.
    """

    folder: Path
    file: SceneFile
    tiles: int
    omitted_presets: tuple[str, ...]


def write_scene(session: CaptureSession, registration: Registration, folder: Path, progress: Progress) -> WrittenScene:
    """Write a capture as a scene.

    Args:
        session: The capture.
        registration: The registered frames of the capture.
        folder: The scene's folder, which must not exist yet. Its name becomes the name of the scene.
        progress: Called with the name of a phase, the number of finished steps, and the total number of steps.

    Raises:
        OutputError: The folder cannot be written to, or a stored frame is missing or damaged.
    """
    new_folder = folder.with_name(f".{folder.name}.new")
    shutil.rmtree(new_folder, ignore_errors=True)
    try:
        (new_folder / VIEWPOINT / "tiles").mkdir(parents=True)
        written = _write(session, registration, new_folder, folder.name, progress)
        if not written.tiles:
            (new_folder / VIEWPOINT / "tiles").rmdir()
        new_folder.rename(folder)
    except OSError as error:
        raise OutputError(f"The scene cannot be written to {folder}: {error.strerror or error}.") from error
    finally:
        shutil.rmtree(new_folder, ignore_errors=True)
    return replace(written, folder=folder)


def _write(session: CaptureSession, registration: Registration, new_folder: Path, name: str, progress: Progress) -> WrittenScene:
    settings = session.settings
    optics = measured_optics(Optics(settings.zoom_table), registration.focal_factors)
    limits = Limits(*settings.pan_range_deg, *settings.tilt_range_deg, *settings.zoom_range, pan_endless=settings.pan_endless)
    painter = _Painter(session, registration)
    widest_px = min(frame.focal_px for frame in registration.placed)
    wide = [k for k, frame in enumerate(registration.placed) if frame.focal_px <= MAX_WIDE_DENSITY * widest_px]
    width = 64 * math.ceil(2 * math.pi * widest_px * BASE_DENSITY / 64)
    panorama = Panorama.of(width, reachable_band(limits, optics))
    base, seen = painter.paint(panorama.projection, wide, BASE_SHARPENING, lambda done, total: progress("Panorama", done, total))
    views = [(k, registration.placed[k].upright) for k in range(len(registration.placed)) if k not in set(wide)]
    viewpoint_folder = new_folder / VIEWPOINT
    tiles = _tiles(viewpoint_folder, painter, views, wide, progress)
    progress("Files", 0, 1)
    manifest = _manifest(viewpoint_folder, name, panorama, base, seen, tiles)
    presets, home, omitted = _presets(registration, limits)
    file = SceneFile(
        name=name,
        title=name.replace("-", " ").capitalize(),
        version=manifest.scene_version,
        blender_version="none",
        viewpoints=[SceneViewpoint(name=VIEWPOINT, position_m=(0, 0, 0), pan0_bearing_deg=0, description="position of the camera")],
        presets=presets,
        home_preset=home,
        instances=[],
        texts=[],
        captured=_capture_source(
            settings, session.started_at, limits, optics, _unseen_share(limits, optics, settings, panorama, seen)
        ),
    )
    (viewpoint_folder / "manifest.json").write_text(manifest.model_dump_json() + "\n", encoding="utf-8")
    (new_folder / "scene.json").write_text(file.model_dump_json(indent=1) + "\n", encoding="utf-8")
    (new_folder / "capture.json").write_text(json.dumps(_capture_record(registration), indent=1) + "\n", encoding="utf-8")
    progress("Files", 1, 1)
    return WrittenScene(new_folder, file, len(tiles), omitted)


class _Painter:
    """Composes the pack's pictures, excluding everything that the site's rules hide."""

    def __init__(self, session: CaptureSession, registration: Registration) -> None:
        self._session, self._registration = session, registration
        self._composer = Composer(registration.placed, self._read)

    def paint(
        self, view: View, chosen: Sequence[int], sharpening: float, progress: Callable[[int, int], None] = lambda *_: None
    ) -> tuple[Picture, NDArray[np.bool_]]:
        """Return a picture (H, W, 3) and the mask (H, W) of its seen pixels."""
        picture, seen = self._composer.compose(view, chosen, progress)
        soft = cv2.GaussianBlur(picture, (0, 0), SHARPENING_SIGMA_PX)
        cv2.addWeighted(picture, 1 + sharpening, soft, -sharpening, 0, dst=picture)
        picture[~seen] = UNSEEN_COLOUR
        hidden = keep_out_mask(self._session.settings, view)
        if hidden is not None:
            picture[hidden] = UNSEEN_COLOUR
            seen[hidden] = False
        return picture, seen

    def tile(self, index: int, view: Perspective, wide: Sequence[int]) -> Picture:
        """Return the tile picture for a zoomed frame. Wide frames help to detect moving objects and fill the corners."""
        placed = self._registration.placed
        forward = placed[index].axes[2]
        similar = [k for k, other in enumerate(placed) if 0.87 <= other.focal_px / placed[index].focal_px <= MAX_WIDE_DENSITY]
        nearest = sorted(wide, key=lambda k: -float(placed[k].axes[2] @ forward))[:3]
        return self.paint(view, sorted({*similar, *nearest}), TILE_SHARPENING)[0]

    def _read(self, index: int) -> FramePicture:
        shot = self._registration.shots[index]
        image = self._session.image(shot)
        return frame_picture(image, hidden_mask(self._session.settings, shot, image), self._registration.gains[index])


def _tiles(
    viewpoint_folder: Path, painter: _Painter, views: Sequence[tuple[int, Perspective]], wide: Sequence[int], progress: Progress
) -> list[Tile]:
    """Write the tiles and return their manifest entries. All tiles share one empty instance-id layer."""
    if not views:
        return []
    tiles = []
    size = views[0][1]
    write_ids(viewpoint_folder / "tiles/ids.webp", np.zeros((size.height, size.width), np.uint16))
    ids = layer_of(viewpoint_folder, "tiles/ids.webp", size.width, size.height)
    with ThreadPoolExecutor(2) as pool:
        jobs = []
        for number, (index, view) in enumerate(views):
            name = f"tiles/{number:03d}.avif"
            jobs.append(pool.submit(write_colour, viewpoint_folder / name, painter.tile(index, view, wide), TILE_QUALITY))
            progress("Tiles", number + 1, len(views))
        for job in jobs:
            job.result()
    for number, (_, view) in enumerate(views):
        colour = layer_of(viewpoint_folder, f"tiles/{number:03d}.avif", view.width, view.height)
        tiles.append(Tile(pan_deg=view.pan_deg, tilt_deg=view.tilt_deg, hfov_deg=view.hfov_deg, colour=colour, ids=ids))
    return tiles


def _manifest(
    viewpoint_folder: Path, name: str, panorama: Panorama, base: Picture, seen: NDArray[np.bool_], tiles: list[Tile]
) -> Manifest:  # fmt: skip
    """Write the panorama and empty ground-truth layers, and return the manifest."""
    write_colour(viewpoint_folder / "base.avif", base, BASE_QUALITY)
    empty = np.zeros((32, 64), np.uint16)
    write_ids(viewpoint_folder / "ids.webp", empty)
    write_ids(viewpoint_folder / "depth.webp", empty)
    small = seen[::SEEN_MASK_SCALE, ::SEEN_MASK_SCALE]
    cv2.imwrite(str(viewpoint_folder / "seen.png"), small.astype(np.uint8) * 255)
    base_layer = layer_of(viewpoint_folder, "base.avif", base.shape[1], base.shape[0])
    depth = layer_of(viewpoint_folder, "depth.webp", 64, 32)
    return Manifest(
        scene=name,
        scene_version=base_layer.sha256[:12],
        viewpoint=VIEWPOINT,
        position_m=(0, 0, 0),
        pan0_bearing_deg=0,
        blender_version="none",
        samples=0,
        band=panorama.band,
        base=base_layer,
        ids=layer_of(viewpoint_folder, "ids.webp", 64, 32),
        depth=Depth(**depth.model_dump(), near_m=1.0, far_m=1000.0),
        tiles=tiles,
        extents=[],
        seen=Layer(**layer_of(viewpoint_folder, "seen.png", small.shape[1], small.shape[0]).model_dump()),
    )


def _capture_source(
    settings: CaptureSettings, started_at: str, limits: Limits, optics: Optics, unseen_share: float
) -> CapturedFrom:
    return CapturedFrom(
        camera=settings.camera.partition(" at ")[0],  # without its address
        captured_at=started_at,
        pan_range_deg=(limits.min_pan_deg, limits.max_pan_deg),
        tilt_range_deg=(limits.min_tilt_deg, limits.max_tilt_deg),
        zoom_range=(limits.min_zoom, limits.max_zoom),
        pan_endless=limits.pan_endless,
        zoom_table=optics.table,
        frame_width=settings.frame_width,
        frame_height=settings.frame_height,
        unseen_share=round(unseen_share, 5),
    )


def _unseen_share(
    limits: Limits, optics: Optics, settings: CaptureSettings, panorama: Panorama, seen: NDArray[np.bool_]
) -> float:  # fmt: skip
    """Return the fraction of the directions visible at the widest zoom that no captured frame covers."""
    projection, pans = panorama.projection, np.arange(-179.0, 180.0, 2.0)
    # Aim the camera as close to each direction as its limits permit. Whether the direction is then in view depends only on its tilt
    # and the remaining pan offset.
    pan_offsets = np.array([wrap_pan_deg(pan - limits.clamp(Pose(limits.aim_pan_deg(pan)))[0].pan_deg) for pan in pans.tolist()])
    total = missing = 0.0
    for tilt in np.arange(-89.0, 90.0, 2.0).tolist():
        aimed, _ = limits.clamp(Pose(0.0, tilt))
        view = Perspective(
            0.0, aimed.tilt_deg, optics.hfov_deg(limits.min_zoom), settings.frame_width, settings.frame_height
        )  # fmt: skip
        points = view.points(direction(pan_offsets, tilt))
        in_view = np.all((points > 0.01) & (points < 0.99), axis=-1)  # false for NaN
        panorama_px = projection.points(direction(pans[in_view], tilt)) * (seen.shape[1], seen.shape[0])
        columns, rows = panorama_px.astype(int).T
        inside = (rows >= 0) & (rows < seen.shape[0])
        unseen = ~inside
        unseen[inside] = ~seen[rows[inside], np.minimum(columns[inside], seen.shape[1] - 1)]
        weight = math.cos(math.radians(tilt))
        total += weight * len(unseen)
        missing += weight * int(unseen.sum())
    return missing / total if total else 0.0


def _presets(registration: Registration, limits: Limits) -> tuple[list[ScenePreset], str, tuple[str, ...]]:
    """Return the presets at their adjusted poses, the name of the home preset, and the names of the omitted presets."""
    presets: list[ScenePreset] = []
    omitted: list[str] = []
    home = Pose((limits.min_pan_deg + limits.max_pan_deg) / 2, limits.clamp(Pose())[0].tilt_deg, limits.min_zoom)
    for shot, placed_frame in zip(registration.shots, registration.placed, strict=True):
        view = placed_frame.upright
        pose = Pose(limits.aim_pan_deg(view.pan_deg), view.tilt_deg, shot.zoom)
        inside, _ = limits.clamp(pose)
        offset_deg = max(abs(wrap_pan_deg(inside.pan_deg - pose.pan_deg)), abs(inside.tilt_deg - pose.tilt_deg))
        if shot.key == "home":
            home = inside
        elif shot.preset and offset_deg > 1.0:
            omitted.append(shot.preset)
        elif shot.preset:
            presets.append(_preset(shot.preset, inside, {preset.name for preset in presets}))
    home_name = next((preset.name for preset in presets if _is_close(preset, home)), None)
    if home_name is None:
        home_name = _unused_name("home", {preset.name for preset in presets})
        presets.insert(0, _preset(home_name, home, set()))
    return presets, home_name, tuple(omitted)


def _preset(name: str, pose: Pose, taken: set[str]) -> ScenePreset:
    kebab = _unused_name(re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-") or "preset", taken)
    rounded = pose.as_dict()
    return ScenePreset(
        name=kebab, viewpoint=VIEWPOINT, pan_deg=rounded["pan_deg"], tilt_deg=rounded["tilt_deg"], zoom=rounded["zoom"],
        description="" if kebab == name else name,
    )  # fmt: skip


def _unused_name(name: str, taken: set[str]) -> str:
    candidates = (name if number == 1 else f"{name}-{number}" for number in range(1, len(taken) + 2))
    return next(candidate for candidate in candidates if candidate not in taken)


def _is_close(preset: ScenePreset, pose: Pose) -> bool:
    difference_deg = max(abs(wrap_pan_deg(preset.pan_deg - pose.pan_deg)), abs(preset.tilt_deg - pose.tilt_deg))
    return difference_deg < 0.5 and math.isclose(preset.zoom, pose.zoom, rel_tol=0.02)


def _capture_record(registration: Registration) -> dict[str, object]:
    """Return the content of ``capture.json``, including each frame's reported and adjusted pose."""
    frames = []
    for shot, placed_frame, is_registered, gain in zip(
        registration.shots, registration.placed, registration.registered, registration.gains, strict=True
    ):
        view = placed_frame.upright
        frames.append(
            {
                "key": shot.key,
                "reported": {"pan_deg": shot.pan_deg, "tilt_deg": shot.tilt_deg, "zoom": shot.zoom, "hfov_deg": shot.hfov_deg},
                "adjusted": {"pan_deg": view.pan_deg, "tilt_deg": view.tilt_deg, "hfov_deg": view.hfov_deg},
                "registered": is_registered,
                "gain": [round(float(value), 4) for value in gain],
            }
        )
    return {"format": 1, "matches": registration.matches, "residual_px": registration.residual_px, "frames": frames}
