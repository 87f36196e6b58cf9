"""Simplify tool schemas to a form that all servers accept.

Some servers compile a schema into a grammar and reject keywords that they cannot compile, such as a pattern without anchors.
Others do not support unions. Calls are validated before they run, so the simplified schemas need not enforce any constraints.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

_DROPPED_KEYWORDS = (
    "pattern",
    "minLength",
    "maxLength",
    "exclusiveMinimum",
    "exclusiveMaximum",
    "minimum",
    "maximum",
    "title",
    "default",
)


def simplify_schemas(tools: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the tools with simplified parameters, without constraints and without null as an alternative type."""
    return [{**tool, "function": {**tool["function"], "parameters": _parameters(tool["function"]["parameters"])}} for tool in tools]


def _parameters(schema: dict[str, Any]) -> dict[str, Any]:
    properties = {name: _simplify_property(prop) for name, prop in schema.get("properties", {}).items()}
    return {**schema, "properties": properties}


def _simplify_property(prop: dict[str, Any]) -> dict[str, Any]:
    options = [option for option in prop.get("anyOf", ()) if option.get("type") != "null"]
    merged = {**prop, **options[0]} if len(options) == 1 else prop
    dropped = (*_DROPPED_KEYWORDS, "anyOf") if len(options) == 1 else _DROPPED_KEYWORDS
    return {key: value for key, value in merged.items() if key not in dropped}
