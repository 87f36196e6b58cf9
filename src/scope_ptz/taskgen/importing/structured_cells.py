"""Parse cells that contain JSON, Python literals with single quotes, or plain lists of words."""

from __future__ import annotations

import ast
import json
import math
import re
from typing import Any

_LIST = re.compile(r"\s*(?:->|→|;|,|\||\n)\s*")
_MAX_CHARS = 100_000
_EMPTY_VALUES = frozenset({"", "null", "none", "n/a", "na", "nan", "-", "[]", "{}"})


def parse_cell(text: str) -> Any:
    """Parse a cell. An empty cell gives None, and words without brackets give a list.

    Raises:
        ValueError: The cell begins like JSON or a Python literal, but cannot be parsed.
    """
    text = text.strip().strip("`")
    if text.lower() in _EMPTY_VALUES:
        return None
    if text[0] not in "[{(\"'":
        return [word for word in _LIST.split(text) if word]
    if len(text) > _MAX_CHARS:
        raise ValueError(f"it is longer than {_MAX_CHARS} characters")
    for parse in (_parse_json, _parse_literal):
        try:
            content = parse(text)
        except (ValueError, SyntaxError, RecursionError, MemoryError):
            continue
        return parse_cell(content) if isinstance(content, str) and content.strip()[:1] in ("[", "{") else content
    raise ValueError("it is neither JSON nor a list")


def _parse_json(text: str) -> Any:
    return json.loads(text, parse_constant=_reject_constant)


def _parse_literal(text: str) -> Any:
    """Parse a Python literal that contains only types that JSON supports."""
    return _to_json_value(ast.literal_eval(re.sub(r"\b(true|false|null)\b(?=\s*[,}\]])", _python_word, text)))


def _python_word(word: re.Match[str]) -> str:
    return {"true": "True", "false": "False", "null": "None"}[word[0]]


def _to_json_value(value: Any) -> Any:
    if isinstance(value, list | tuple | set | frozenset):
        return [_to_json_value(item) for item in value]
    if isinstance(value, dict):
        return {str(name): _to_json_value(item) for name, item in value.items()}
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError("a number that is not finite")
    if value is None or isinstance(value, str | int | float | bool):
        return value
    raise ValueError(f"{type(value).__name__} is not a JSON value")


def _reject_constant(name: str) -> Any:
    raise ValueError(f"{name} is not allowed in JSON")
