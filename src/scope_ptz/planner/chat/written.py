"""Calls written as text, and the parsing of their arguments."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from scope_ptz.planner.chat.strict import strict_json

_NAME_IN_WRECK = re.compile(r"""["']name["']\s*:\s*["'](?P<name>[^"']{1,80})["']""")
_SHOWN_CHARS = 300


@dataclass(frozen=True, slots=True)
class WrittenCall:
    """A call in a text.

    Attributes:
        malformed: What stood in place of a JSON object; ``arguments`` is empty then.
    """

    name: str
    arguments: dict[str, Any]
    malformed: str | None = None


@dataclass(frozen=True, slots=True)
class Signatures:
    """The offered tools: their names, and the JSON types of their parameters, for notations without types."""

    types: Mapping[str, Mapping[str, frozenset[str]]]

    @classmethod
    def of(cls, tools: Sequence[Mapping[str, Any]]) -> Signatures:
        """Return the signatures of tool schemas."""
        functions = [tool["function"] for tool in tools]
        return cls({f["name"]: {p: _types(s) for p, s in f["parameters"].get("properties", {}).items()} for f in functions})

    def __contains__(self, name: object) -> bool:
        return name in self.types

    def value(self, tool: str, parameter: str, text: str) -> Any:
        """Return a value that was written without quotes, converted to the type in the schema.

        Text that does not fit stays text, so that validation refuses it.
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
    named = {option["type"] for option in options if isinstance(option.get("type"), str)}
    return frozenset(named)


def read_arguments(text: str) -> tuple[dict[str, Any], str | None]:
    """Parse arguments from JSON text. Returns the arguments, and the text itself when it is no object. Empty text means no
    arguments.
    """
    stripped = text.strip()
    if not stripped or stripped == "null":
        return {}, None
    try:
        value = strict_json(stripped)
        if isinstance(value, str):  # some servers encode the object twice
            value = strict_json(value)
    except ValueError:
        return {}, stripped[:_SHOWN_CHARS]
    return (value, None) if isinstance(value, dict) else ({}, stripped[:_SHOWN_CHARS])


def from_object(value: Any) -> WrittenCall | None:
    """Return the call in a JSON object such as ``{"name": ..., "arguments": {...}}``, in the spellings that models use, or None."""
    if not isinstance(value, dict):
        return None
    inner = value.get("function")
    if isinstance(inner, dict):
        value = inner
    name = next((value[key] for key in ("name", "tool", "tool_name", "function") if isinstance(value.get(key), str)), None)
    if not name:
        return None
    given: Any = next((value[key] for key in ("arguments", "parameters", "args", "input") if key in value), {})
    if isinstance(given, dict):
        return WrittenCall(plain_name(name), given)
    if given is None:
        return WrittenCall(plain_name(name), {})
    arguments, malformed = read_arguments(given if isinstance(given, str) else repr(given))
    return WrittenCall(plain_name(name), arguments, malformed)


def wreck(text: str) -> WrittenCall:
    """Return a failed call for text that was marked as a call and cannot be parsed, with its name where that can be found."""
    found = _NAME_IN_WRECK.search(text)
    return WrittenCall(plain_name(found["name"]) if found else "", {}, text.strip()[:_SHOWN_CHARS] or "nothing")


def plain_name(name: str) -> str:
    """Return a tool's name without the namespace that some models put before it."""
    return name.strip().removeprefix("functions.").removeprefix("default_api.")
