"""Represent tool calls that a model wrote as text, and parse their arguments."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from scope_ptz.planner.chat.strict import encodable, strict_json

_NAME = re.compile(r"""["']name["']\s*:\s*["'](?P<name>[^"']{1,80})["']""")
MAX_QUOTED_CHARS = 300  # maximum number of characters that an error message quotes from a malformed call


@dataclass(frozen=True, slots=True)
class WrittenCall:
    """A tool call that was parsed from text.

    Attributes:
        malformed: The text found in place of a JSON object; None if the arguments are valid. If it is set, ``arguments`` is empty.
    """

    name: str
    arguments: dict[str, Any]
    malformed: str | None = None


@dataclass(frozen=True, slots=True)
class Signatures:
    """The names of the offered tools and the JSON types of their parameters, for notations in which values have no type."""

    types: Mapping[str, Mapping[str, frozenset[str]]]

    @classmethod
    def of(cls, tools: Sequence[Mapping[str, Any]]) -> Signatures:
        """Create signatures from tool schemas."""
        functions = [tool["function"] for tool in tools]
        return cls({f["name"]: {p: _types(s) for p, s in f["parameters"].get("properties", {}).items()} for f in functions})

    def __contains__(self, name: object) -> bool:
        return name in self.types

    def value(self, tool: str, parameter: str, text: str) -> Any:
        """Convert a value that was written without quotes to its type in the schema.

        Text that cannot be converted is returned unchanged, so that validation rejects it.
        """
        types = self.types.get(tool, {}).get(parameter, frozenset())
        if types == {"string"}:
            return text
        try:
            value = strict_json(text.strip())
        except ValueError:
            return text
        return text if isinstance(value, str) or (types and "string" in types and not isinstance(value, int | float)) else value


def _types(schema: Mapping[str, Any]) -> frozenset[str]:
    options = [schema, *schema.get("anyOf", ())]
    return frozenset(option["type"] for option in options if isinstance(option.get("type"), str))


def read_arguments(text: str) -> tuple[dict[str, Any], str | None]:
    """Parse arguments from JSON text.

    Returns:
        The arguments and None, or no arguments and the truncated text if it is not a JSON object. An empty text means no arguments.
    """
    stripped = encodable(text).strip()
    if not stripped or stripped == "null":
        return {}, None
    try:
        value = strict_json(stripped)
        if isinstance(value, str):  # some servers encode the object twice
            value = strict_json(value)
    except ValueError:
        return {}, stripped[:MAX_QUOTED_CHARS]
    return (value, None) if isinstance(value, dict) else ({}, stripped[:MAX_QUOTED_CHARS])


def unreadable_arguments(name: str, malformed: str) -> str:
    """Return the error message for the model about a call whose arguments are not a JSON object."""
    return f"The call of {name or 'a tool'} cannot be read: its arguments must be a JSON object, got {malformed}"


def call_from_object(value: Any) -> WrittenCall | None:
    """Return the call in a JSON object; None if the object is not a call.

    The usual form is ``{"name": ..., "arguments": {...}}``, but other keys that models use are also accepted.
    """
    if not isinstance(value, dict):
        return None
    inner = value.get("function")
    if isinstance(inner, dict):
        value = inner
    name = next((value[key] for key in ("name", "tool", "tool_name", "function") if isinstance(value.get(key), str)), None)
    if not name:
        return None
    raw_arguments: Any = next((value[key] for key in ("arguments", "parameters", "args", "input") if key in value), {})
    if isinstance(raw_arguments, dict):
        return WrittenCall(plain_name(name), raw_arguments)
    if raw_arguments is None:
        return WrittenCall(plain_name(name), {})
    arguments, malformed = read_arguments(raw_arguments if isinstance(raw_arguments, str) else repr(raw_arguments))
    return WrittenCall(plain_name(name), arguments, malformed)


def malformed_call(text: str) -> WrittenCall:
    """Return a malformed call for tagged text that cannot be parsed, with the tool's name if the text contains it."""
    match = _NAME.search(text)
    return WrittenCall(plain_name(match["name"]) if match else "", {}, text.strip()[:MAX_QUOTED_CHARS] or "nothing")


def plain_name(name: str) -> str:
    """Return a tool's name without the namespace that some models prepend."""
    return name.strip().removeprefix("functions.").removeprefix("default_api.")
