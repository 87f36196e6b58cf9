"""Draw a run's detections on its pictures."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.agent.records import Called
from scope_ptz.agent.trace import Trace
from scope_ptz.errors import TraceError
from scope_ptz.perception.base import Box

ACCENT = (76, 195, 247)
INK = (14, 19, 26)
MAX_NUMBERED_MARKS = 40
"""Maximum number of marks to number. If there are more, none is numbered, because the numbers would cover the picture."""


def call_for_picture(trace: Trace, name: str) -> Called | None:
    """Return the first call in a run whose result refers to the picture ``name``; None if there is none."""
    for call in trace.calls:
        result = call.outcome.result or {}
        if name in (result.get("frames") or ()):
            return call
    return None


def marks_of(call: Called | None, name: str) -> list[dict[str, Any]]:
    """Return a call's detections in the picture ``name``, numbered from 1 in drawing order.

    Boxes are fractions of the frame's width and height. They belong to the call's last picture; its other pictures have none.
    """
    result = (call.outcome.result or {}) if call is not None else {}
    frames = list(result.get("frames") or ())
    if frames[-1:] != [name]:
        return []
    boxes = result.get("boxes") or ([result["box"]] if result.get("box") else [])
    marks: list[dict[str, Any]] = []
    for box_data in boxes:
        box = Box.model_validate(box_data)
        marks.append({"number": len(marks) + 1, "box": box.model_dump(mode="json")})
    return marks


def draw_marks(picture: bytes, marks: list[dict[str, Any]]) -> bytes:
    """Draw marks on an encoded picture, and return it as a JPEG.

    Raises:
        TraceError: The picture is damaged.
    """
    image: Any = cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_COLOR)
    if image is None:
        raise TraceError("The picture of the run is damaged.")
    height, width = int(image.shape[0]), int(image.shape[1])
    accent, line_width = ACCENT[::-1], max(2, round(width / 640))
    for mark in marks:
        box = mark["box"]
        left, top = round(box["x_min"] * width), round(box["y_min"] * height)
        cv2.rectangle(
            image, (left, top), (round(box["x_max"] * width), round(box["y_max"] * height)), accent, line_width, cv2.LINE_AA
        )
        if len(marks) <= MAX_NUMBERED_MARKS:
            _draw_number(image, str(mark["number"]), left, top, line_width)
    encoded, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, 90])
    if not encoded:
        raise TraceError("The picture of the run cannot be encoded.")
    return bytes(data)


def _draw_number(image: NDArray[Any], text: str, left: int, top: int, line_width: int) -> None:
    scale = 0.25 + line_width * 0.12
    (text_width, text_height), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, scale, 1)
    top = max(top, text_height + 6)
    cv2.rectangle(image, (left, top - text_height - 6), (left + text_width + 6, top), ACCENT[::-1], cv2.FILLED)
    cv2.putText(image, text, (left + 3, top - 4), cv2.FONT_HERSHEY_SIMPLEX, scale, INK[::-1], 1, cv2.LINE_AA)
