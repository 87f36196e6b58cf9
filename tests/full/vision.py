"""The tiny vision model that several tests share: its lessons and its pictures."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.base import Frame
from scope_ptz.perception.models.coordinates import get_convention
from scope_ptz.perception.models.vision_prompts import CAPTION_PROMPT, detect_prompt, point_prompt, query_prompt, sent_size
from tests.perception import pictures

STYLE = get_convention("qwen3-vl")
QUESTION = "Is there a square?"


CORNERS: dict[str, tuple[int, int, int, int] | None] = {
    "top left": (100, 100, 400, 400), "bottom right": (600, 600, 900, 900), "nowhere": None,
}  # fmt: skip
"""Positions of the orange square in a picture, in thousandths of its size (x1, y1, x2, y2)."""


def square(corner: str, width: int = 320, height: int = 192) -> NDArray[np.uint8]:
    """Return a grey picture (H, W, 3) with an orange square in a corner, or without one."""
    image = np.full((height, width, 3), 90, np.uint8)
    if (box := CORNERS[corner]) is not None:
        x1, y1, x2, y2 = (round(v * s / 1000) for v, s in zip(box, (width, height, width, height), strict=True))
        image[y1:y2, x1:x2] = (255, 120, 0)
    return image


def detection_reply(corner: str) -> str:
    """Return the model's reply to a detection prompt."""
    box = CORNERS[corner]
    return json.dumps({"objects": [] if box is None else [{"bbox_2d": list(box), "label": "square"}]})


def frame(corner: str) -> Frame:
    """Return a frame with a square in a corner."""
    return pictures.frame(square(corner))


def train_detector(folder: Path) -> Path:
    """Train a checkpoint on the prompts of the backends, and return its folder. Imports torch."""
    from tests.full import tiny_vision_models

    sent = sent_size(frame("nowhere"), STYLE, 1280 * 1024)
    detections = {corner: detection_reply(corner) for corner in CORNERS}
    lessons = [
        (detect_prompt(STYLE, "square", sent), detections),
        (point_prompt(STYLE, "square", sent), detections),
        (query_prompt(QUESTION), {c: "No." if c == "nowhere" else f"Yes, {c}." for c in CORNERS}),
        (CAPTION_PROMPT, {c: f"A square: {c}." for c in CORNERS}),
    ]
    return tiny_vision_models.tiny_vision_chat(folder, lessons)
