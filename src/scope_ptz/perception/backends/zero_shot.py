"""Zero-shot object detectors that run in this process: OWLv2 and Grounding DINO, through the transformers pipeline."""

from __future__ import annotations

import json
import math
import threading
from collections.abc import Callable
from time import perf_counter
from typing import Any

from anyio import to_thread

from scope_ptz.camera.base import Frame
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.backends.spec import BackendSpec, Options, require_packages
from scope_ptz.perception.base import Answer, Box, Caption, Detections, Perception, Point, Points
from scope_ptz.perception.models.coordinates import RawLocation, get_convention, locations_in_frame
from scope_ptz.perception.models.frame_memo import Image
from scope_ptz.perception.models.tile_geometry import non_maximum_suppression

RawDetections = list[dict[str, Any]]
Detector = Callable[[Image, str], RawDetections]
"""A function that takes an RGB image and a phrase and returns ``[{"score", "label", "box": {"xmin", "ymin", "xmax", "ymax"}}]``, in
pixels."""


class ZeroShotOptions(Options):
    """Options for zero-shot detectors.

    Attributes:
        threshold: Detections with a lower score are dropped.
        overlap: A box that overlaps a better one by more than this (intersection over union) is dropped.
        device: The torch device ("cpu", "cuda:0"), or "auto" for the best one available.
    """

    threshold: float = 0.2
    overlap: float = 0.6
    device: str = "auto"


class ZeroShotPerception(Perception):
    """A detector that locates the objects described by a phrase, best score first. It cannot answer questions."""

    skills = frozenset(("detect", "point"))

    def __init__(self, detector: Detector, options: ZeroShotOptions | None = None, name: str = "zero-shot") -> None:
        self.name, self._detector, self._options = name, detector, options or ZeroShotOptions()

    async def caption(self, frame: Frame) -> Caption:  # noqa: ARG002
        raise PerceptionError(f"{self.name} is a detector and cannot describe pictures. Ask a vision-language model.")

    async def query(self, frame: Frame, question: str) -> Answer:  # noqa: ARG002
        raise PerceptionError(f"{self.name} is a detector and cannot answer questions. Ask a vision-language model.")

    async def detect(self, frame: Frame, description: str) -> Detections:
        phrase = " ".join(description.split())
        if not phrase:
            raise PerceptionError("The description is empty.")
        began = perf_counter()
        boxes, raw, notes = await to_thread.run_sync(self._detect, frame.image, phrase)
        return Detections(boxes=boxes, source=self.name, raw=raw, notes=notes, latency_s=perf_counter() - began)

    async def point(self, frame: Frame, description: str) -> Points:
        detections = await self.detect(frame, description)
        points = tuple(Point(x=b.centre[0], y=b.centre[1], label=b.label) for b in detections.boxes)
        return Points(points=points, source=self.name, raw=detections.raw, notes=detections.notes, latency_s=detections.latency_s)

    def _detect(self, image: Image, phrase: str) -> tuple[tuple[Box, ...], str, tuple[str, ...]]:
        width, height = image.shape[1], image.shape[0]
        try:
            raw = self._detector(image, phrase)
        except (RuntimeError, ValueError, MemoryError, IndexError) as error:
            raise PerceptionError(f"{self.name} failed on a frame of {width}x{height}: {error}") from error
        locations = [
            location
            for location in map(_raw_location, raw)
            if location.score is not None and location.score >= self._options.threshold
        ]
        located = locations_in_frame(locations, get_convention("pixels"), (width, height))
        return tuple(non_maximum_suppression(located.boxes, self._options.overlap)), json.dumps(raw, default=str), located.notes


def _raw_location(detection: dict[str, Any]) -> RawLocation:
    box, score = detection["box"], float(detection["score"])
    numbers = tuple(float(box[k]) for k in ("xmin", "ymin", "xmax", "ymax"))
    return RawLocation(numbers, str(detection.get("label") or "") or None, score if math.isfinite(score) else None)


class PipelineDetector:
    """A transformers pipeline, loaded on first use, that processes one image at a time."""

    def __init__(self, model: str, options: ZeroShotOptions) -> None:
        self._model, self._options, self._pipeline, self._lock = model, options, None, threading.Lock()

    _pipeline: Any

    def __call__(self, image: Image, phrase: str) -> RawDetections:
        from PIL import Image as PillowImage

        with self._lock:
            if self._pipeline is None:
                self._pipeline = self._load()
            detections: RawDetections = self._pipeline(
                PillowImage.fromarray(image), candidate_labels=[phrase], threshold=self._options.threshold
            )
        return detections

    def _load(self) -> Any:
        try:
            import torch
            from transformers import pipeline

            device = self._options.device
            if device == "auto":
                device = "cuda:0" if torch.cuda.is_available() else "cpu"
            return pipeline("zero-shot-object-detection", model=self._model, device=device)
        except (OSError, ValueError, ImportError) as error:
            raise PerceptionError(f"The detector '{self._model}' cannot be loaded: {error}") from error


def make(spec: BackendSpec) -> Perception:
    """Create the backend that a spec describes."""
    require_packages("local", "transformers", "torch")
    options = ZeroShotOptions.of(spec)
    return ZeroShotPerception(PipelineDetector(spec.needed_model(), options), options, spec.name)
