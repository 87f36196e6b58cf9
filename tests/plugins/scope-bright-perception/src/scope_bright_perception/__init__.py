"""Perception that finds what is brighter than everything around it: ``--perception bright``."""

from __future__ import annotations

import numpy as np

from scope_ptz.camera.base import Frame
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.backends.spec import BackendSpec
from scope_ptz.perception.base import Answer, Box, Caption, Detections, Perception, Points


class BrightPerception(Perception):
    """A detector with one idea. It answers no questions."""

    skills = frozenset({"detect"})

    def __init__(self, name: str) -> None:
        self.name = name

    async def detect(self, frame: Frame, description: str) -> Detections:
        rows, columns = np.nonzero(frame.image.min(axis=2) >= 250)
        if not len(rows):
            return Detections(boxes=(), source=self.name, latency_s=0.001)
        box = Box(
            x_min=columns.min() / frame.width, x_max=(columns.max() + 1) / frame.width,
            y_min=rows.min() / frame.height, y_max=(rows.max() + 1) / frame.height,
        )  # fmt: skip
        return Detections(boxes=(box,), source=self.name, latency_s=0.001)

    async def query(self, frame: Frame, question: str) -> Answer:
        raise PerceptionError("I only find bright things.")

    async def caption(self, frame: Frame) -> Caption:
        raise PerceptionError("I only find bright things.")

    async def point(self, frame: Frame, description: str) -> Points:
        raise PerceptionError("I only find bright things.")


def make(spec: BackendSpec) -> Perception:
    """Make the backend that a spec describes."""
    return BrightPerception(spec.name)
