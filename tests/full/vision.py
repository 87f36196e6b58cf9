"""The tiny vision model that several tests share: what it is taught, and what it is shown."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.base import Frame
from scope_ptz.perception.models.coordinates import convention
from scope_ptz.perception.models.vision_prompts import CAPTION_PROMPT, detect_prompt, point_prompt, query_prompt, sent_size
from tests.perception import pictures

STYLE = convention("qwen3-vl")
QUESTION = "Is there a square?"


CORNERS: dict[str, tuple[int, int, int, int] | None] = {
    "top left": (100, 100, 400, 400), "bottom right": (600, 600, 900, 900), "nowhere": None,
}  # fmt: skip
"""Where the vision model sees an orange square, in thousandths (x1, y1, x2, y2)."""


def square(corner: str, width: int = 320, height: int = 192) -> NDArray[np.uint8]:
    """A grey picture (H, W, 3) with an orange square in a corner, or without one."""
    image = np.full((height, width, 3), 90, np.uint8)
    if (box := CORNERS[corner]) is not None:
        x1, y1, x2, y2 = (round(v * s / 1000) for v, s in zip(box, (width, height, width, height), strict=True))
        image[y1:y2, x1:x2] = (255, 120, 0)
    return image


def found(corner: str) -> str:
    """What the vision model says when it is asked where the square is."""
    box = CORNERS[corner]
    return json.dumps({"objects": [] if box is None else [{"bbox_2d": list(box), "label": "square"}]})


def frame(corner: str) -> Frame:
    """A frame with a square in a corner of it."""
    return pictures.frame(square(corner))


def train_detector(folder: Path) -> Path:
    """The checkpoint, which answers the backends' own prompts. Imports torch."""
    from tests.full import tiny_vision_models

    sent = sent_size(frame("nowhere"), STYLE, 1280 * 1024)
    places = {corner: found(corner) for corner in CORNERS}
    lessons = [
        (detect_prompt(STYLE, "square", sent), places),
        (point_prompt(STYLE, "square", sent), places),
        (query_prompt(QUESTION), {c: "No." if c == "nowhere" else f"Yes, {c}." for c in CORNERS}),
        (CAPTION_PROMPT, {c: f"A square: {c}." for c in CORNERS}),
    ]
    return tiny_vision_models.tiny_vision_chat(folder, lessons)
