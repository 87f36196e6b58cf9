"""Structured actions: one of the nine tools with its arguments, or one of three ways to end the run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np
from gymnasium import spaces

from scope_ptz.bench.tasks.task import RunOutcome
from scope_ptz.errors import InputError, UnknownNameError
from scope_ptz.gym.observations import clean_text, text_space
from scope_ptz.tools.arguments import View
from scope_ptz.tools.registry import TOOLS, parse_call

OUTCOMES: tuple[RunOutcome, ...] = get_args(RunOutcome)
CHOICES: tuple[str, ...] = (*TOOLS, *OUTCOMES)
"""The choices of ``action["tool"]``, by index: the nine tools in the order of the registry, then the outcomes that end a run."""
VIEWS: tuple[str, ...] = get_args(View)
ZOOM_LIMITS: tuple[str | None, ...] = (None, "in", "out")

MAX_PHRASE_CHARS = 500  # maximum length of text arguments and answers
_TEXT_ARGUMENT = {
    "go_to_preset": "name", "count_objects": "description", "query_answer": "question", "zoom_to_object": "description",
    "track_object": "description",
}  # fmt: skip
"""The argument of each tool that is passed in ``action["text"]``."""
_DEFAULT_FIELDS: Mapping[str, Any] = {
    "tool": 0, "pan_deg": 0.0, "tilt_deg": 0.0, "zoom_factor": 1.0, "zoom_limit": 0, "view": 0, "duration_s": 10.0, "text": "",
}  # fmt: skip
_NUMBER_RANGES = {"pan_deg": (-360.0, 360.0), "tilt_deg": (-180.0, 180.0), "zoom_factor": (0.02, 50.0), "duration_s": (0.1, 600.0)}
"""The ranges of the numeric fields: degrees, degrees, factor of the current magnification, seconds."""


@dataclass(frozen=True, slots=True)
class Finish:
    """The end of a run: its outcome, and the answer, the clarifying question or the reason for the refusal."""

    outcome: RunOutcome
    text: str


@dataclass(frozen=True, slots=True)
class Call:
    """A tool call."""

    name: str
    arguments: dict[str, Any]


def tool_space() -> spaces.Dict:
    """Return the space of actions. Fields that the selected tool does not use are ignored."""
    numbers: dict[str, spaces.Space[Any]] = {
        name: spaces.Box(low, high, (), np.float64) for name, (low, high) in _NUMBER_RANGES.items()
    }
    return spaces.Dict(
        {
            "tool": spaces.Discrete(len(CHOICES)),
            "zoom_limit": spaces.Discrete(len(ZOOM_LIMITS)),
            "view": spaces.Discrete(len(VIEWS)),
            "text": text_space(MAX_PHRASE_CHARS),
            **numbers,
        }
    )


def decode_action(action: Mapping[str, Any]) -> Call | Finish:
    """Convert an action to a tool call or to the end of a run.

    Raises:
        InputError: A field is missing or has the wrong type. The tools check text, and report errors to the agent.
    """
    try:
        choice = CHOICES[_index(action["tool"], len(CHOICES))]
        text = str(action["text"])
        if choice in OUTCOMES:
            return Finish(choice, text)
        arguments: dict[str, Any] = {}
        if choice in _TEXT_ARGUMENT:
            arguments[_TEXT_ARGUMENT[choice]] = text
        if choice in ("count_objects", "query_answer"):
            arguments["view"] = VIEWS[_index(action["view"], len(VIEWS))]
        if choice == "track_object":
            arguments["duration_s"] = float(action["duration_s"])
        if choice == "adjust_ptz":
            arguments |= _adjustment(action)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise InputError(
            f"The action is not an element of the action space ({type(error).__name__}: {error}). Build actions with tool_action "
            "and finish_action."
        ) from error
    return Call(choice, arguments)


def _index(value: Any, count: int) -> int:
    index = int(value)
    if not 0 <= index < count:
        raise IndexError(f"{index} is not from 0 to {count - 1}")
    return index


def _adjustment(action: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments of ``adjust_ptz``. A field that changes nothing is omitted, and a zoom limit replaces the factor."""
    arguments: dict[str, Any] = {axis: float(action[axis]) for axis in ("pan_deg", "tilt_deg") if float(action[axis]) != 0.0}
    limit, factor = ZOOM_LIMITS[_index(action["zoom_limit"], len(ZOOM_LIMITS))], float(action["zoom_factor"])
    if limit is not None:
        arguments["zoom_limit"] = limit
    elif factor != 1.0:
        arguments["zoom_factor"] = factor
    return arguments


def tool_action(name: str, /, **arguments: Any) -> dict[str, Any]:
    """Return the action for a tool call.

    Args:
        name: One of the nine tools.
        **arguments: Its arguments. ``zoom_percent`` is converted to a ``zoom_factor``.

    Raises:
        ToolCallError: The call is invalid.
        InputError: A number is outside the action space.

    Example:
        >>> from scope_ptz.gym import tool_action
        >>> action = tool_action("count_objects", description="cones")
        >>> action["text"], int(action["view"])
        ('cones', 0)
    """
    tool, checked = parse_call(name, arguments)
    fields = checked.model_dump(exclude_none=True)
    action = {**_DEFAULT_FIELDS, "tool": CHOICES.index(tool.name)}
    if "zoom_percent" in fields:
        fields["zoom_factor"] = 1 + fields.pop("zoom_percent") / 100
    if name in _TEXT_ARGUMENT:
        action["text"] = clean_text(fields.pop(_TEXT_ARGUMENT[name]))[:MAX_PHRASE_CHARS]
    if "view" in fields:
        action["view"] = VIEWS.index(fields.pop("view"))
    if "zoom_limit" in fields:
        action["zoom_limit"] = ZOOM_LIMITS.index(fields.pop("zoom_limit"))
    return _convert_types(action | fields)


def finish_action(text: str, outcome: str = "answered") -> dict[str, Any]:
    """Return the action that ends a run.

    Args:
        text: The answer, the clarifying question, or the reason for the refusal.
        outcome: "answered", "clarification" or "refused".

    Raises:
        UnknownNameError: There is no such outcome.
    """
    if outcome not in OUTCOMES:
        raise UnknownNameError("outcome", outcome, OUTCOMES)
    return _convert_types({**_DEFAULT_FIELDS, "tool": CHOICES.index(outcome), "text": clean_text(text)[:MAX_PHRASE_CHARS]})


def _convert_types(action: dict[str, Any]) -> dict[str, Any]:
    """Convert the fields of an action to the types of the space. Raises ``InputError`` for a number outside its range."""
    for name, (low, high) in _NUMBER_RANGES.items():
        if not low <= action[name] <= high:
            raise InputError(f"{name} must be from {low:g} to {high:g} in an action; got {action[name]:g}. Split the move.")
        action[name] = np.array(action[name], np.float64)
    return action | {name: np.int64(action[name]) for name in ("tool", "zoom_limit", "view")}
