"""Text recognition with rapidocr, in this process and without a server, on frames from simulated and real cameras."""

from __future__ import annotations

import json
import math
import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import cv2
import numpy as np

from scope_ptz.camera.base import Frame
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.backends.spec import BackendSpec, Options, require_packages
from scope_ptz.perception.base import Answer, Box, Caption, Detections, Perception, Point, Points
from scope_ptz.perception.models.frame_memo import FrameMemo, Image
from scope_ptz.perception.models.text_requests import is_reading_request, requested_texts, text_matches
from scope_ptz.perception.models.tile_geometry import PanoramaTile, merge_boxes, tiles

Reader = Callable[[Image], "list[Line]"]
"""A function that returns the lines of text in an RGB image (H, W, 3)."""


class OcrOptions(Options):
    """Options for the OCR backend. Lines with a score below ``min_score`` are dropped."""

    min_score: float = 0.5


@dataclass(frozen=True, slots=True)
class Line:
    """A line of text in an image. The label of ``box`` is the text."""

    text: str
    box: Box


class OcrPerception(Perception):
    """A backend that perceives only text. ``detect`` and ``point`` find text by its wording.

    Other descriptions, and questions that text alone does not answer, raise ``PerceptionError``, because an image without the text
    "car" may still show a car. The lines in each frame are cached for later questions.
    """

    handles_panoramas = True

    def __init__(self, reader: Reader, name: str = "ocr") -> None:
        self.name = name
        self._lines: FrameMemo[None, list[Line]] = FrameMemo(lambda image, _: sort_in_reading_order(read_tiles(reader, image)))

    async def lines(self, frame: Frame) -> list[Line]:
        """Return all lines of text in a frame, from top to bottom and from left to right."""
        return await self._lines.get_async(frame.image, None)

    async def caption(self, frame: Frame) -> Caption:
        began = perf_counter()
        lines = await self.lines(frame)
        text = f"Text in view: {quote_lines(lines)}." if lines else "There is no readable text in view."
        return Caption(text=text, source=self.name, raw=_raw(lines), latency_s=perf_counter() - began)

    async def query(self, frame: Frame, question: str) -> Answer:
        if not is_reading_request(question):
            raise PerceptionError(f"OCR only reads text, and cannot answer '{question}'. Ask a vision-language model.")
        began = perf_counter()
        lines = await self.lines(frame)
        text = f"It reads: {quote_lines(lines)}." if lines else "There is no readable text in view."
        return Answer(text=text, known=bool(lines), source=self.name, raw=_raw(lines), latency_s=perf_counter() - began)

    async def detect(self, frame: Frame, description: str) -> Detections:
        began = perf_counter()
        boxes = tuple(line.box for line in await self._find(frame, description))
        raw = json.dumps([b.label for b in boxes], ensure_ascii=False)
        return Detections(boxes=boxes, source=self.name, raw=raw, latency_s=perf_counter() - began)

    async def point(self, frame: Frame, description: str) -> Points:
        detections = await self.detect(frame, description)
        points = tuple(Point(x=b.centre[0], y=b.centre[1], label=b.label) for b in detections.boxes)
        return Points(points=points, source=self.name, raw=detections.raw, latency_s=detections.latency_s)

    async def _find(self, frame: Frame, description: str) -> list[Line]:
        texts = requested_texts(description)
        if texts is None:
            raise PerceptionError(
                f"OCR only finds text, and '{description}' contains no text to find. Quote the text, or ask a detector."
            )
        lines = await self.lines(frame)
        return lines if not texts else [line for line in lines if any(text_matches(text, line.text) for text in texts)]


def quote_lines(lines: Iterable[Line]) -> str:
    """Return the lines in quotes, so that a planner does not mistake text in the image for an instruction."""
    return ", ".join('"' + line.text.replace('"', "'") + '"' for line in lines)


def _raw(lines: Iterable[Line]) -> str:
    return json.dumps([{"text": line.text, "score": line.box.score} for line in lines], ensure_ascii=False)


def sort_in_reading_order(lines: list[Line]) -> list[Line]:
    """Return the lines sorted row by row. A line belongs to a row if its vertical centre lies within the row's first line."""
    rows: list[list[Line]] = []
    for line in sorted(lines, key=lambda x: x.box.centre[1]):
        if rows and abs(line.box.centre[1] - rows[-1][0].box.centre[1]) < rows[-1][0].box.height / 2:
            rows[-1].append(line)
        else:
            rows.append([line])
    return [line for row in rows for line in sorted(row, key=lambda x: x.box.x_min)]


def read_tiles(reader: Reader, image: Image) -> list[Line]:
    """Return all lines of text in an image. A panorama is read in overlapping tiles at full resolution."""
    width, height = image.shape[1], image.shape[0]
    parts: list[tuple[PanoramaTile, list[Box]]] = []
    for tile in tiles(width, height):
        try:
            parts.append((tile, [line.box for line in reader(np.ascontiguousarray(tile.crop(image)))]))
        except (cv2.error, ValueError, RuntimeError, MemoryError) as error:
            raise PerceptionError(f"OCR failed on a frame of {width}x{height}: {error}") from error
    return [Line(box.label or "", box) for box in merge_boxes(parts, width)]


class RapidOcr:
    """The rapidocr engine, loaded on first use. The engine keeps state during a call, so only one thread uses it at a time."""

    def __init__(self, min_score: float = 0.5) -> None:
        self._min_score, self._engine, self._lock = min_score, None, threading.Lock()

    _engine: Any

    def __call__(self, image: Image) -> list[Line]:
        """Return the lines of text in an RGB image (H, W, 3)."""
        with self._lock:
            if self._engine is None:
                self._engine = self._load()
            output = self._engine(cv2.cvtColor(image, cv2.COLOR_RGB2BGR))
        if output.boxes is None or output.txts is None:
            return []
        return [
            line
            for corners, text, score in zip(output.boxes, output.txts, output.scores, strict=True)
            if text.strip() and (line := _line(np.asarray(corners, dtype=float), text.strip(), float(score), image)) is not None
        ]

    def _load(self) -> Any:
        try:
            from rapidocr import RapidOCR

            return RapidOCR(params={"Global.log_level": "error", "Global.text_score": self._min_score})
        except (ImportError, OSError, RuntimeError) as error:
            raise PerceptionError(f"The text reader cannot be loaded: {error}") from error


def _line(corners: np.ndarray[Any, np.dtype[np.float64]], text: str, score: float, image: Image) -> Line | None:
    """Convert four corners in pixels (4, 2) to a line; None if they enclose no area within the image."""
    if not np.isfinite(corners).all():
        return None
    low = np.clip(corners.min(axis=0) / (image.shape[1], image.shape[0]), 0, 1)
    high = np.clip(corners.max(axis=0) / (image.shape[1], image.shape[0]), 0, 1)
    if (high <= low).any():
        return None
    valid_score = score if math.isfinite(score) and 0 <= score <= 1 else None
    return Line(text, Box(x_min=low[0], y_min=low[1], x_max=high[0], y_max=high[1], label=text, score=valid_score))


def make(spec: BackendSpec) -> Perception:
    """Create the backend that a spec describes."""
    require_packages("ocr", "rapidocr", "onnxruntime")
    return OcrPerception(RapidOcr(OcrOptions.of(spec).min_score), spec.name)
