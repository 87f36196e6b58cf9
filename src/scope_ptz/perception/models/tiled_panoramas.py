"""Detection in panoramas, for backends that would scale a panorama down: part by part, at the resolution of ordinary frames."""

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
from scope_ptz.perception.models.tile_geometry import PanoramaTile, merged, merged_points, tiles, without_seam_twins

MAX_CONCURRENT_PARTS = 4
"""Maximum number of parts that are processed at the same time."""

SAME_POINT = 0.15
"""Points of two parts within this share of the panorama's height are the same object."""

FULL_TURN_DEG = 359.5  # a panorama at least this wide wraps around

R = TypeVar("R", Detections, Points)


class TiledPerception(Perception):
    """Wraps a backend and passes stitched panoramas to its ``detect`` and ``point`` in overlapping parts.

    If one part fails, the whole call fails, because a count without it would be too low. Ordinary frames, questions and captions
    are passed on unchanged.
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
        seen = await _all([(tile, partial(self.backend.detect, part, description)) for tile, part in parts])
        boxes = merged(((tile, found.boxes) for tile, found in seen), frame.width)
        if isinstance(frame.projection, Equirectangular) and frame.projection.pan_span_deg >= FULL_TURN_DEG:
            boxes = without_seam_twins(boxes)
        if all(box.score is not None for box in boxes):
            boxes.sort(key=lambda b: -(b.score or 0.0))
        return _combined([found for _, found in seen], began).model_copy(update={"boxes": tuple(boxes)})

    async def point(self, frame: Frame, description: str) -> Points:
        parts = _parts(frame)
        if len(parts) == 1:
            return await self.backend.point(frame, description)
        began = perf_counter()
        seen = await _all([(tile, partial(self.backend.point, part, description)) for tile, part in parts])
        near = SAME_POINT / 5 * frame.height / frame.width
        points = merged_points(((tile, found.points) for tile, found in seen), frame.width, near)
        return _combined([found for _, found in seen], began).model_copy(update={"points": tuple(points)})

    async def close(self) -> None:
        await self.backend.close()


def _parts(frame: Frame) -> list[tuple[PanoramaTile, Frame]]:
    """Return the frame itself, or the overlapping parts of a panorama as frames."""
    whole = frame.projection
    cuts = tiles(frame.width, frame.height)
    if len(cuts) == 1 or not isinstance(whole, Equirectangular):
        return [(PanoramaTile(0, frame.width), frame)]
    return [(tile, _part(frame, whole, tile)) for tile in cuts]


def _part(frame: Frame, whole: Equirectangular, tile: PanoramaTile) -> Frame:
    density = whole.pan_span_deg / whole.width
    left_deg, span_deg = whole.left_pan_deg + tile.left * density, (tile.right - tile.left) * density
    projection = Equirectangular(
        left_deg, span_deg, whole.top_tilt_deg, whole.bottom_tilt_deg, tile.right - tile.left, whole.height
    )
    return Frame(np.ascontiguousarray(tile.crop(frame.image)), frame.pose, span_deg, frame.time_s, projection, frame.origin)


async def _all(calls: list[tuple[PanoramaTile, Callable[[], Awaitable[R]]]]) -> list[tuple[PanoramaTile, R]]:
    """Run all calls concurrently, and return the results in order.

    Raises:
        PerceptionError: The first error, with the attempts of all calls.
    """
    results: dict[int, R] = {}
    errors: list[PerceptionError] = []
    limiter = anyio.CapacityLimiter(MAX_CONCURRENT_PARTS)

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
        tried: list[RequestRecord] = [attempt for found in results.values() for attempt in found.attempts]
        tried += [attempt for error in errors for attempt in error.attempts]
        raise PerceptionError(str(errors[0]), kind=errors[0].kind, attempts=tried) from errors[0]
    return [(tile, results[index]) for index, (tile, _) in enumerate(calls)]


def _combined(parts: list[R], began: float) -> R:
    """Combine the results of all parts into one, except for their boxes or points."""
    update = {
        "raw": "\n".join(part.raw for part in parts),
        "notes": tuple(dict.fromkeys(note for part in parts for note in part.notes)),
        "attempts": tuple(a for part in parts for a in part.attempts),
        "complete": all(part.complete for part in parts),
        "latency_s": perf_counter() - began,
    }
    return parts[0].model_copy(update=update)
