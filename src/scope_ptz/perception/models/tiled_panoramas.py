"""Tile-by-tile detection in panoramas, for backends that would otherwise scale a panorama down."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from functools import partial
from time import perf_counter
from typing import TypeVar

import anyio
import numpy as np

from scope_ptz.camera.base import Frame
from scope_ptz.errors import PerceptionError, RequestRecord
from scope_ptz.geometry import Equirectangular
from scope_ptz.perception.base import Answer, Caption, Detections, Perception, Points
from scope_ptz.perception.models.tile_geometry import PanoramaTile, merge_boxes, merge_points, remove_seam_duplicates, tiles

MAX_CONCURRENT_TILES = 4
"""Maximum number of tiles that are processed concurrently."""

SAME_POINT = 0.15
"""Maximum distance between two points in different tiles that mark the same object.

In pixels, the points may differ by ``SAME_POINT * height / 5`` horizontally, and by ``SAME_POINT * height * height / width``
vertically.
"""

FULL_TURN_DEG = 359.5  # a panorama at least this wide wraps around

R = TypeVar("R", Detections, Points)


class TiledPerception(Perception):
    """A wrapper that passes stitched panoramas to a backend's ``detect`` and ``point`` as overlapping tiles.

    If one tile fails, the whole call fails, because a count without that tile would be too low. Ordinary frames, questions and
    captions are passed on unchanged.
    """

    handles_panoramas = True

    def __init__(self, backend: Perception) -> None:
        self.backend, self.name, self.skills = backend, backend.name, backend.skills

    async def caption(self, frame: Frame) -> Caption:
        return await self.backend.caption(frame)

    async def query(self, frame: Frame, question: str) -> Answer:
        return await self.backend.query(frame, question)

    async def detect(self, frame: Frame, description: str) -> Detections:
        parts = _parts(frame)
        if len(parts) == 1:
            return await self.backend.detect(frame, description)
        began = perf_counter()
        results = await _run_all([(tile, partial(self.backend.detect, part, description)) for tile, part in parts])
        boxes = merge_boxes(((tile, result.boxes) for tile, result in results), frame.width)
        if isinstance(frame.projection, Equirectangular) and frame.projection.pan_span_deg >= FULL_TURN_DEG:
            boxes = remove_seam_duplicates(boxes)
        if all(box.score is not None for box in boxes):
            boxes.sort(key=lambda b: -(b.score or 0.0))
        return _combine([result for _, result in results], began).model_copy(update={"boxes": tuple(boxes)})

    async def point(self, frame: Frame, description: str) -> Points:
        parts = _parts(frame)
        if len(parts) == 1:
            return await self.backend.point(frame, description)
        began = perf_counter()
        results = await _run_all([(tile, partial(self.backend.point, part, description)) for tile, part in parts])
        max_distance = SAME_POINT / 5 * frame.height / frame.width
        points = merge_points(((tile, result.points) for tile, result in results), frame.width, max_distance)
        return _combine([result for _, result in results], began).model_copy(update={"points": tuple(points)})

    async def close(self) -> None:
        await self.backend.close()


def _parts(frame: Frame) -> list[tuple[PanoramaTile, Frame]]:
    """Return the frame itself, or the overlapping tiles of a panorama as frames."""
    panorama = frame.projection
    panorama_tiles = tiles(frame.width, frame.height)
    if len(panorama_tiles) == 1 or not isinstance(panorama, Equirectangular):
        return [(PanoramaTile(0, frame.width), frame)]
    return [(tile, _part(frame, panorama, tile)) for tile in panorama_tiles]


def _part(frame: Frame, panorama: Equirectangular, tile: PanoramaTile) -> Frame:
    density = panorama.pan_span_deg / panorama.width
    left_deg, span_deg = panorama.left_pan_deg + tile.left * density, (tile.right - tile.left) * density
    projection = Equirectangular(
        left_deg, span_deg, panorama.top_tilt_deg, panorama.bottom_tilt_deg, tile.right - tile.left, panorama.height
    )
    return Frame(np.ascontiguousarray(tile.crop(frame.image)), frame.pose, span_deg, frame.time_s, projection, frame.origin)


async def _run_all(calls: list[tuple[PanoramaTile, Callable[[], Awaitable[R]]]]) -> list[tuple[PanoramaTile, R]]:
    """Run all calls concurrently, and return the results in order.

    Raises:
        PerceptionError: The first error, with the attempts of all calls.
    """
    results: dict[int, R] = {}
    errors: list[PerceptionError] = []
    limiter = anyio.CapacityLimiter(MAX_CONCURRENT_TILES)

    async def run(index: int, ask: Callable[[], Awaitable[R]]) -> None:
        async with limiter:
            if errors:
                return
            try:
                results[index] = await ask()
            except PerceptionError as error:
                errors.append(error)

    async with anyio.create_task_group() as group:
        for index, (_, ask) in enumerate(calls):
            group.start_soon(run, index, ask)
    if errors:
        attempts: list[RequestRecord] = [attempt for result in results.values() for attempt in result.attempts]
        attempts += [attempt for error in errors for attempt in error.attempts]
        raise PerceptionError(str(errors[0]), kind=errors[0].kind, attempts=attempts) from errors[0]
    return [(tile, results[index]) for index, (tile, _) in enumerate(calls)]


def _combine(parts: list[R], began: float) -> R:
    """Combine the results of all tiles into one, except for their boxes or points."""
    update = {
        "raw": "\n".join(part.raw for part in parts),
        "notes": tuple(dict.fromkeys(note for part in parts for note in part.notes)),
        "attempts": tuple(a for part in parts for a in part.attempts),
        "complete": all(part.complete for part in parts),
        "latency_s": perf_counter() - began,
    }
    return parts[0].model_copy(update=update)
