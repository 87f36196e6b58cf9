"""Format the outcome of a tool call as text for a chat model.

The text is short, numbers are rounded, and text that comes from the scene is marked as data.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from scope_ptz.planner.base import ToolOutcome

MAX_BOXES = 12  # further boxes are counted, but not listed
MAX_CHARS = 4000
"""Maximum length of text from perception. Longer text usually comes from a model that did not stop generating."""

BRIEF_CHARS = 120  # maximum length of a text in a shortened outcome

_RESULT_FIELDS = (
    "count", "known", "found", "matches", "fill", "held_share", "duration_s", "presets", "preset", "file", "view",
    "clamped", "limited_by",
)  # fmt: skip
_TEXT_FIELDS = ("answer", "chosen")
_REPLACED_BRACKETS = str.maketrans({"<": "‹", ">": "›", "＜": "‹", "＞": "›"})


def observation(outcome: ToolOutcome, *, is_shortened: bool = False) -> str:
    """Return an outcome as one line of JSON. If ``is_shortened``, it contains only what later steps may need, to save context."""
    if outcome.error is not None or outcome.result is None:
        error = as_data(outcome.error or "The tool gave no result.", mark=False)
        return _json_line({"error": error[:BRIEF_CHARS] if is_shortened else error})
    result = outcome.result
    content: dict[str, Any] = {
        key: _round_numbers(result[key]) for key in _RESULT_FIELDS if result.get(key) not in (None, (), [], "")
    }
    if result.get("complete") is False:
        content["complete"] = False
    if is_shortened:
        content |= {key: as_data(result[key][:BRIEF_CHARS]) for key in _TEXT_FIELDS if result.get(key)}
    else:
        content |= _boxes(result.get("boxes") or ())
        # The message contains everything else: the answer, its source, corrections and a second opinion.
        content["message"] = as_data(str(result.get("message", "")), mark="source" in result)
    content["pose"] = _round_numbers(result.get("pose"))
    return _json_line(content)


def as_data(text: str, *, mark: bool = True) -> str:
    """Format untrusted text, such as a perception reply, as data.

    Angle brackets are replaced, so that the text can neither close the ``camera_text`` element nor contain a chat template's
    control tokens. With ``mark``, the text is enclosed in that element.
    """
    cut = text if len(text) <= MAX_CHARS else text[:MAX_CHARS] + " (cut)"
    escaped = cut.translate(_REPLACED_BRACKETS)
    return f"<camera_text>{escaped}</camera_text>" if mark else escaped


def _boxes(boxes: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the corners of the first ``MAX_BOXES`` boxes as fractions of the frame, rounded to two decimal places."""
    if not boxes:
        return {}
    corners = [[round(box[k], 2) for k in ("x_min", "y_min", "x_max", "y_max")] for box in boxes[:MAX_BOXES]]
    more = len(boxes) - MAX_BOXES
    return {"boxes_xyxy": corners, **({"boxes_not_listed": more} if more > 0 else {})}


def _round_numbers(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, 2)
    if isinstance(value, Mapping):
        return {key: _round_numbers(item) for key, item in value.items()}
    return value


def _json_line(data: Mapping[str, Any]) -> str:
    return json.dumps(data, ensure_ascii=False, allow_nan=False)
