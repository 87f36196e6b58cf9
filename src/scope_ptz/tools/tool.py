"""Tool definitions."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from copy import deepcopy
from dataclasses import dataclass
from functools import cache
from typing import Any, get_type_hints

from scope_ptz.tools.arguments import Arguments
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.results import Result


@cache
def _json_schema(arguments: type[Arguments]) -> dict[str, Any]:
    """Return the JSON schema of a tool's arguments, cached because it never changes."""
    return arguments.model_json_schema()


def _always_false(arguments: Any) -> bool:  # noqa: ARG001 - must match the signature of ``only_reads``
    return False


@dataclass(frozen=True, slots=True)
class Tool:
    """A tool that planners can call.

    Attributes:
        name: The name in calls.
        arguments: The pydantic model that validates a call's arguments. Its docstring is the description that planners receive.
        run: The function that carries out a call.
        title: The display name, such as "Turn and zoom".
        repeatable: Whether two identical consecutive calls have the same effect as one.
        moves: Whether the tool can move the camera.
        perceives: Whether the tool calls perception.
        only_reads: A function that returns whether a call with the given arguments only reads the current view. Consecutive calls
            of this kind run concurrently and share one frame.
    """

    name: str
    arguments: type[Arguments]
    run: Callable[[ToolContext, Any], Awaitable[Result]]
    title: str = ""
    repeatable: bool = False
    moves: bool = False
    perceives: bool = False
    only_reads: Callable[[Any], bool] = _always_false

    def schema(self) -> dict[str, Any]:
        """Return the tool in the OpenAI function format."""
        parameters = deepcopy(_json_schema(self.arguments))
        for prop in parameters.get("properties", {}).values():
            prop.pop("title", None)
        parameters.pop("title", None)
        description = parameters.pop("description")
        parameters.setdefault("properties", {})
        return {
            "type": "function",
            "function": {"name": self.name, "description": description, "parameters": parameters},
        }

    def result_type(self) -> type[Result]:
        """Return the class of the tool's results."""
        result: type[Result] = get_type_hints(self.run)["return"]
        return result

    def defaults(self) -> dict[str, Any]:
        """Return the defaults of the arguments whose default is not None."""
        fields = self.arguments.model_fields.items()
        return {name: field.default for name, field in fields if not field.is_required() and field.default is not None}
