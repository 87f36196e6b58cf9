"""Tool schemas as all servers take them.

Some servers compile a schema into a grammar and refuse what they cannot compile (a pattern without anchors, for one), others
know no unions. What a call may hold is checked here in any case, when it is made; the schema only has to tell the model.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

_CHECKED_HERE = (
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


def plain_schemas(tools: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """The tools with parameters of one plain type each, an optional one being one that is not required."""
    return [{**tool, "function": {**tool["function"], "parameters": _parameters(tool["function"]["parameters"])}} for tool in tools]


def _parameters(schema: dict[str, Any]) -> dict[str, Any]:
    properties = {name: _plain(prop) for name, prop in schema.get("properties", {}).items()}
    return {**schema, "properties": properties}


def _plain(prop: dict[str, Any]) -> dict[str, Any]:
    options = [option for option in prop.get("anyOf", ()) if option.get("type") != "null"]
    merged = {**prop, **options[0]} if len(options) == 1 else prop
    dropped = (*_CHECKED_HERE, "anyOf") if len(options) == 1 else _CHECKED_HERE
    return {key: value for key, value in merged.items() if key not in dropped}
