"""Parse strict JSON for tool calls: only finite numbers, and only characters that UTF-8 can encode."""

from __future__ import annotations

import json
import math
from typing import Any

__all__ = ["encodable", "strict_json"]


def strict_json(text: str) -> Any:
    """Parse JSON without NaN, infinities, numbers that overflow, or extreme nesting.

    Raises:
        ValueError: The text is not valid JSON, or contains a value that is not allowed.
    """
    try:
        value = json.loads(encodable(text), parse_constant=_reject_constant, parse_float=_parse_finite)
        # Lone surrogates can come only from escapes such as \ud800.
        return _clean(value) if "\\ud" in text.lower() else value
    except RecursionError as error:
        raise ValueError("it is nested too deeply") from error


def encodable(text: str) -> str:
    """Replace lone surrogates, which UTF-8 cannot encode, with question marks."""
    return text.encode("utf-8", "replace").decode("utf-8")


def _clean(value: Any) -> Any:
    if isinstance(value, str):
        return encodable(value)
    if isinstance(value, list):
        return [_clean(item) for item in value]
    if isinstance(value, dict):
        return {_clean(key): _clean(item) for key, item in value.items()}
    return value


def _reject_constant(name: str) -> Any:
    raise ValueError(f"{name} is not a finite number")


def _parse_finite(digits: str) -> float:
    value = float(digits)
    if not math.isfinite(value):
        raise ValueError(f"{digits[:20]} is too large")
    return value
