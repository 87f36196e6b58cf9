"""Render panoramas in strips, join the strips, and smooth the rows that the projection stretches."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.blender.band import Panorama, Strip
from scope_ptz.blender.client import BlenderWorker
from scope_ptz.blender.part_cache import PartCache
from scope_ptz.blender.requests import panorama_request
from scope_ptz.geometry import Equirectangular
from scope_ptz.simulator.layers import read_colour

STRIP_ROWS = 384
OVERLAP_ROWS = 8
SKY_TILT_DEG, NADIR_TILT_DEG = 22.0, -58.0  # strips entirely above or below these need fewer samples

Picture = NDArray[np.uint8]


def render_base(worker: BlenderWorker, cache: PartCache, viewpoint: str, panorama: Panorama, samples: int) -> Picture:
    """Render the base panorama as ``(H, W, 3)`` RGB.

    Each strip is cached separately, so an interrupted bake loses at most one strip.
    """
    strips = panorama.strips(STRIP_ROWS, OVERLAP_ROWS)
    step = cache.steps(f"{viewpoint}/base", len(strips))
    pictures = []
    for strip in strips:
        size = strip.width, strip.last_row - strip.first_row
        projection = panorama_request(Equirectangular(-180.0, 360.0, strip.top_tilt_deg, strip.bottom_tilt_deg, *size))

        count = samples if not _needs_fewer_samples(strip) else max(2, samples // 2)

        def produce(path: Path, projection: dict[str, Any] = projection, count: int = count) -> None:
            worker.request(
                "colour", {"viewpoint": viewpoint, "projection": projection, "samples": count, "seed": 1, "out": str(path)}
            )

        parameters = {"projection": projection, "samples": count}
        pictures.append(read_colour(cache.part(f"{viewpoint}/base-{strip.first_row:04d}", ".png", parameters, produce)))
        step()
    return smooth_rows(join_strips(panorama, strips, pictures), panorama)


def _needs_fewer_samples(strip: Strip) -> bool:
    """Return whether a strip needs fewer samples: the sky has no noise, and the ground near the nadir is smoothed later."""
    return strip.bottom_tilt_deg > SKY_TILT_DEG or strip.top_tilt_deg < NADIR_TILT_DEG


def join_strips(panorama: Panorama, strips: list[Strip], pictures: list[Picture]) -> Picture:
    """Join strips at full width, cross-faded where they overlap."""
    total = np.zeros((panorama.height, panorama.width, 3), dtype=np.float32)
    weights = np.zeros((panorama.height, 1, 1), dtype=np.float32)
    for strip, picture in zip(strips, pictures, strict=True):
        rows = np.arange(strip.first_row, strip.last_row)
        inside = np.minimum(rows - strip.first_row, strip.last_row - 1 - rows) + 1.0
        reaches_edge = (strip.first_row == 0) & (rows < STRIP_ROWS // 2) | (strip.last_row == panorama.height) & (
            rows >= strip.last_row - STRIP_ROWS // 2
        )
        weight = np.where(reaches_edge, 1e3, np.minimum(inside, 2 * OVERLAP_ROWS)).astype(np.float32)[:, None, None]
        total[strip.first_row : strip.last_row] += _widen(picture, panorama.width).astype(np.float32) * weight
        weights[strip.first_row : strip.last_row] += weight
    return np.asarray(np.rint(total / weights), dtype=np.uint8)


def _widen(picture: Picture, width: int) -> Picture:
    """Stretch a strip horizontally. It wraps around, so its left edge continues its right edge."""
    if picture.shape[1] == width:
        return picture
    pad = 8
    wrapped = np.pad(picture, ((0, 0), (pad, pad), (0, 0)), mode="wrap")
    scale = width / picture.shape[1]
    x = (np.arange(width, dtype=np.float32) + 0.5) / scale - 0.5 + pad
    columns = np.broadcast_to(x, (picture.shape[0], width)).astype(np.float32)
    rows = np.broadcast_to(np.arange(picture.shape[0], dtype=np.float32)[:, None], columns.shape)
    return np.asarray(cv2.remap(wrapped, columns, np.ascontiguousarray(rows), cv2.INTER_CUBIC), dtype=np.uint8)


def smooth_rows(picture: Picture, panorama: Panorama) -> Picture:
    """Blur each row horizontally to the level of detail at the equator, which is the highest level that a view can show."""
    result = picture.copy()
    for row in range(panorama.height):
        tilt = panorama.tilt_of_row(row + 0.5)
        spread = min(1 / max(math.cos(math.radians(tilt)), 1e-3), panorama.width / 4)
        if spread < 1.5:
            continue
        reach = math.ceil(spread / 2)
        kernel = np.clip(spread / 2 - np.abs(np.arange(-reach, reach + 1)) + 0.5, 0, 1)
        line = np.pad(picture[row : row + 1], ((0, 0), (reach, reach), (0, 0)), mode="wrap")
        blurred = cv2.filter2D(line, cv2.CV_32F, (kernel / kernel.sum())[None, :])
        result[row] = np.rint(np.clip(blurred[0, reach : reach + panorama.width], 0, 255)).astype(np.uint8)
    return result
