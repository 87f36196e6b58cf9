"""Describe tool calls in words, and parse these descriptions.

The user sees a description and confirms it in the next turn. A planner keeps no state between turns, so it parses the calls from
its own question in the conversation. Parsing is the exact inverse of describing.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import Any

from scope_ptz.planner.base import ToolCall

_NUMBER = r"(?P<{}>\d+(?:\.\d+)?(?:e[-+]?\d+)?)"
_TEXT = r'(?P<text>"(?:[^"\\]|\\.)*")'
_VIEWS_IN_WORDS = {"current": "this view", "full": "the whole scene"}
_VIEW = rf"(?P<view>{'|'.join(_VIEWS_IN_WORDS.values())})"
_PAN = rf"pan (?P<pan>left|right) {_NUMBER.format('pan_by')} degrees"
_TILT = rf"tilt (?P<tilt>up|down) {_NUMBER.format('tilt_by')} degrees"
_ZOOM = (
    rf"zoom (?P<zoom>in|out) to {_NUMBER.format('factor')} times the magnification"
    rf"|zoom (?P<by>in|out) by {_NUMBER.format('percent')} percent"
    r"|zoom all the way (?P<limit>in|out)"
)


def call_in_words(call: ToolCall) -> str:
    """Describe a valid call in words that can follow "Shall I": 'pan right 20 degrees', 'count "cars" in this view'."""
    arguments = call.arguments
    match call.name:
        case "adjust_ptz":
            return " and ".join(_move_words(arguments)) or "leave the camera where it is"
        case "go_to_preset":
            return f"go to the preset {_quote(arguments['name'])}"
        case "go_home":
            return "go to the home view"
        case "get_presets":
            return "list the presets"
        case "take_image":
            return "take a picture"
        case "count_objects":
            return f"count {_quote(arguments['description'])} in {_view_in_words(arguments)}"
        case "query_answer":
            return f"find out {_quote(arguments['question'])} from {_view_in_words(arguments)}"
        case "zoom_to_object":
            return f"zoom in on {_quote(arguments['description'])}"
        case "track_object":
            return f"follow {_quote(arguments['description'])} for {_format_number(arguments.get('duration_s', 10))} seconds"
    return f"call {call.name} with {json.dumps(arguments, ensure_ascii=False)}"


def call_from_words(words: str) -> tuple[str, dict[str, Any]] | None:
    """Parse a description of a call, and return the tool and the arguments; None for other text."""
    for pattern, call in _FORMS:
        if match := pattern.fullmatch(words):
            return call(match)
    return None


def _view_in_words(arguments: dict[str, Any]) -> str:
    return _VIEWS_IN_WORDS[arguments.get("view", "current")]


def _move_words(arguments: dict[str, Any]) -> list[str]:
    words = []
    if pan := arguments.get("pan_deg", 0):
        words.append(f"pan {'right' if pan > 0 else 'left'} {_format_number(abs(pan))} degrees")
    if tilt := arguments.get("tilt_deg", 0):
        words.append(f"tilt {'up' if tilt > 0 else 'down'} {_format_number(abs(tilt))} degrees")
    if (factor := arguments.get("zoom_factor")) is not None:
        words.append(f"zoom {'in' if factor >= 1 else 'out'} to {_format_number(factor)} times the magnification")
    if (percent := arguments.get("zoom_percent")) is not None:
        words.append(f"zoom {'in' if percent >= 0 else 'out'} by {_format_number(abs(percent))} percent")
    if limit := arguments.get("zoom_limit"):
        words.append(f"zoom all the way {limit}")
    return words


def _parse_move(match: re.Match[str]) -> tuple[str, dict[str, Any]]:
    found = match.groupdict()
    arguments: dict[str, Any] = {}
    if found["pan"]:
        arguments["pan_deg"] = _parse_number(found["pan_by"]) * (1 if found["pan"] == "right" else -1)
    if found["tilt"]:
        arguments["tilt_deg"] = _parse_number(found["tilt_by"]) * (1 if found["tilt"] == "up" else -1)
    if found["factor"]:
        arguments["zoom_factor"] = _parse_number(found["factor"])
    if found["percent"]:
        arguments["zoom_percent"] = _parse_number(found["percent"]) * (1 if found["by"] == "in" else -1)
    if found["limit"]:
        arguments["zoom_limit"] = found["limit"]
    return "adjust_ptz", arguments


def _call_with_text(tool: str, field: str) -> Callable[[re.Match[str]], tuple[str, dict[str, Any]]]:
    def call(match: re.Match[str]) -> tuple[str, dict[str, Any]]:
        found = match.groupdict()
        arguments: dict[str, Any] = {field: json.loads(found["text"])}
        if "view" in found:
            arguments["view"] = next(view for view, words in _VIEWS_IN_WORDS.items() if words == found["view"])
        if "seconds" in found:
            arguments["duration_s"] = _parse_number(found["seconds"])
        return tool, arguments

    return call


def _call_without_arguments(tool: str) -> Callable[[re.Match[str]], tuple[str, dict[str, Any]]]:
    return lambda _: (tool, {})


_FORMS: tuple[tuple[re.Pattern[str], Callable[[re.Match[str]], tuple[str, dict[str, Any]]]], ...] = (
    (re.compile("leave the camera where it is"), _call_without_arguments("adjust_ptz")),
    (
        re.compile(rf"(?=pan |tilt |zoom (?:in|out) (?:to|by) |zoom all )(?:{_PAN})?(?: and )?(?:{_TILT})?(?: and )?(?:{_ZOOM})?"),
        _parse_move,
    ),
    (re.compile(f"go to the preset {_TEXT}", re.DOTALL), _call_with_text("go_to_preset", "name")),
    (re.compile("go to the home view"), _call_without_arguments("go_home")),
    (re.compile("list the presets"), _call_without_arguments("get_presets")),
    (re.compile("take a picture"), _call_without_arguments("take_image")),
    (re.compile(f"count {_TEXT} in {_VIEW}", re.DOTALL), _call_with_text("count_objects", "description")),
    (re.compile(f"find out {_TEXT} from {_VIEW}", re.DOTALL), _call_with_text("query_answer", "question")),
    (re.compile(f"zoom in on {_TEXT}", re.DOTALL), _call_with_text("zoom_to_object", "description")),
    (
        re.compile(f"follow {_TEXT} for {_NUMBER.format('seconds')} seconds", re.DOTALL),
        _call_with_text("track_object", "description"),
    ),
    (re.compile(r"call (?P<tool>\S+) with (?P<json>\{.*\})", re.DOTALL), lambda m: (m["tool"], json.loads(m["json"]))),
)


def _quote(text: Any) -> str:
    return json.dumps(str(text), ensure_ascii=False)


def _format_number(value: float) -> str:
    """Format a number without a trailing ".0", so that parsing gives exactly the same number."""
    return str(int(value)) if float(value).is_integer() and abs(value) < 1e15 else repr(float(value))


def _parse_number(text: str) -> float:
    value = float(text)
    return int(value) if value.is_integer() and "." not in text and "e" not in text else value
