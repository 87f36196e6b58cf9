"""Text of a call's outcome for the planner: concise, with rounded numbers, and text that the camera saw marked as data."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from scope_ptz.planner.base import ToolOutcome

MOST_BOXES = 12
MOST_CHARS = 4000
"""Characters kept of one text from perception. A longer text comes from a model that did not stop."""

BRIEF_CHARS = 120

_KEPT = (
    "count", "known", "found", "matches", "fill", "held_share", "duration_s", "presets", "preset", "file", "view",
    "clamped", "limited_by",
)  # fmt: skip
_SEEN_TEXTS = ("answer", "chosen")
_HARMLESS = str.maketrans({"<": "‹", ">": "›", "＜": "‹", "＞": "›"})


def observation(outcome: ToolOutcome, *, brief: bool = False) -> str:
    """Return the outcome as one JSON line. ``brief``: only what later steps may need, for a context that is nearly full."""
    if outcome.error is not None or outcome.result is None:
        error = seen_text(outcome.error or "The tool gave no result.", mark=False)
        return _line({"error": error[:BRIEF_CHARS] if brief else error})
    result = outcome.result
    content: dict[str, Any] = {key: _rounded(result[key]) for key in _KEPT if result.get(key) not in (None, (), [], "")}
    if result.get("complete") is False:
        content["complete"] = False
    if brief:
        content |= {key: seen_text(result[key][:BRIEF_CHARS]) for key in _SEEN_TEXTS if result.get(key)}
    else:
        content |= _boxes(result.get("boxes") or ())
        # The message holds everything else: the answer, its source, corrections and a second opinion.
        content["message"] = seen_text(str(result.get("message", "")), mark="source" in result)
    content["pose"] = _rounded(result.get("pose"))
    return _line(content)


def seen_text(text: str, *, mark: bool = True) -> str:
    """Return text from outside as data. It can neither close its mark nor contain tokens that steer a chat template."""
    cut = text if len(text) <= MOST_CHARS else text[:MOST_CHARS] + " (cut)"
    harmless = cut.translate(_HARMLESS)
    return f"<camera_text>{harmless}</camera_text>" if mark else harmless


def _boxes(boxes: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the corners of the boxes in hundredths of the frame, in perception's order; only the first of many."""
    if not boxes:
        return {}
    corners = [[round(box[k], 2) for k in ("x_min", "y_min", "x_max", "y_max")] for box in boxes[:MOST_BOXES]]
    more = len(boxes) - MOST_BOXES
    return {"boxes_xyxy": corners, **({"boxes_not_listed": more} if more > 0 else {})}


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, 2)
    if isinstance(value, Mapping):
        return {key: _rounded(item) for key, item in value.items()}
    return value


def _line(data: Mapping[str, Any]) -> str:
    return json.dumps(data, ensure_ascii=False, allow_nan=False)
