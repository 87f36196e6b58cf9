"""Tool schemas in a form that all servers accept.

Some servers compile a schema into a grammar and refuse what they cannot compile, such as a pattern without anchors; others know no
unions. Arguments are validated when a call is made in any case, so the schema only has to inform the model.
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
    """Return the tools with parameters of one plain type each. An optional parameter is one that is not required."""
    return [{**tool, "function": {**tool["function"], "parameters": _parameters(tool["function"]["parameters"])}} for tool in tools]


def _parameters(schema: dict[str, Any]) -> dict[str, Any]:
    properties = {name: _plain(prop) for name, prop in schema.get("properties", {}).items()}
    return {**schema, "properties": properties}


def _plain(prop: dict[str, Any]) -> dict[str, Any]:
    options = [option for option in prop.get("anyOf", ()) if option.get("type") != "null"]
    merged = {**prop, **options[0]} if len(options) == 1 else prop
    dropped = (*_CHECKED_HERE, "anyOf") if len(options) == 1 else _CHECKED_HERE
    return {key: value for key, value in merged.items() if key not in dropped}
