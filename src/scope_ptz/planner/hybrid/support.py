"""Find the parts of a call that neither the instruction nor earlier results support.

The check is stricter than the tools. An unsupported call may be correct, but the user must confirm it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from scope_ptz.planner.base import ToolCall
from scope_ptz.planner.hybrid.evidence import Evidence, base_form, words_of
from scope_ptz.planner.hybrid.neutral_words import ABOUT_THE_PICTURE, FUNCTION_WORDS
from scope_ptz.tools.adjust_ptz import ADJUST_PTZ, AdjustPtz
from scope_ptz.tools.count_objects import COUNT_OBJECTS
from scope_ptz.tools.get_presets import GET_PRESETS
from scope_ptz.tools.go_home import GO_HOME
from scope_ptz.tools.go_to_preset import GO_TO_PRESET
from scope_ptz.tools.query_answer import QUERY_ANSWER
from scope_ptz.tools.take_image import TAKE_IMAGE
from scope_ptz.tools.track_object import TRACK_OBJECT, TrackObject
from scope_ptz.tools.zoom_to_object import ZOOM_TO_OBJECT

_NUMBER_TOLERANCE = 0.011
_DIRECTION_WORDS = {
    "left": frozenset({"left", "leftward", "leftwards", "anticlockwise", "counterclockwise"}),
    "right": frozenset({"right", "rightward", "rightwards", "clockwise"}),
    "up": frozenset({"up", "upward", "upwards", "higher", "raise", "lift"}),
    "down": frozenset({"down", "downward", "downwards", "lower", "dip"}),
}
_AFTER_RIGHT = frozenset({"now", "away", "then", "here", "there", "hand", "angle", "angles"})  # "right now" is not a direction
_BEFORE_LEFT = frozenset({"are", "is", "anything", "nothing", "any", "none", "have", "has", "was", "were"})  # "anything left"
_BEFORE_UP_OR_DOWN = frozenset({"bring", "sum", "add", "call", "pick", "show", "set", "break", "write", "hurry"})
_ZOOM_WORDS = {
    "in": frozenset({"in", "closer", "nearer", "tighter", "magnify", "enlarge", "closest", "zoom"}),
    "out": frozenset({"out", "wider", "widen", "back", "away", "widest"}),
}
_LIMIT_WORDS = frozenset(
    {"all", "fully", "max", "maximum", "min", "minimum", "widest", "closest", "limit", "completely", "far", "much"}
)
_EVERY_WORDS = frozenset({"all", "each", "every"})
_PRESET_WORDS = frozenset({"preset", "view", "position", "place", "viewpoint"})
_TURN_WORDS = frozenset({"turn", "circle", "rotation", "revolution", "round", "way"})
_ACTION_WORDS = {
    GO_HOME.name: frozenset({"home", "start", "reset", "beginning", "origin"}),
    TAKE_IMAGE.name: frozenset({"picture", "photo", "photograph", "image", "snapshot", "screenshot", "snap", "still", "shot"}),
    ZOOM_TO_OBJECT.name: frozenset(
        {"zoom", "close", "closer", "look", "show", "focus", "find", "centre", "read", "point", "frame", "aim", "nearer", "up"}
    ),
    TRACK_OBJECT.name: frozenset({"track", "follow", "keep", "tail", "trail", "watch", "stay", "monitor"}),
}
"""The action words of each tool. The instruction must contain at least one of them."""

_WHOLE_SCENE_WORDS = frozenset(
    {"whole", "entire", "everywhere", "around", "sweep", "scan", "full", "anywhere", "panorama", "site", "surroundings", "complete"}
)
_REPEAT_WORDS = frozenset(
    {"again", "time", "until", "till", "each", "every", "step", "keep", "repeat", "while", "once", "twice", "more", "all"}
)


def unsupported_parts(call: ToolCall, evidence: Evidence, earlier_calls: Sequence[ToolCall] = ()) -> list[str]:
    """Return, in words, the parts of a valid call that the evidence does not support.

    Args:
        call: A call with valid arguments.
        evidence: The words and numbers that can support the call.
        earlier_calls: The calls already carried out in this run.

    Returns:
        The unsupported parts; empty if the call can be carried out without confirmation.
    """
    arguments = call.arguments
    match call.name:
        case ADJUST_PTZ.name:
            parts = _unsupported_move(AdjustPtz.model_validate(arguments), evidence)
            parts += ["a second time"] if _is_repeated(call, earlier_calls) and not _mentions(evidence, _REPEAT_WORDS) else []
        case GO_TO_PRESET.name:
            parts = [] if _names_preset(str(arguments["name"]), evidence) else [f'the preset "{arguments["name"]}"']
        case GET_PRESETS.name:
            parts = []
        case COUNT_OBJECTS.name:
            parts = _unsupported_words(str(arguments["description"]), evidence)
        case QUERY_ANSWER.name:
            parts = _unsupported_words(str(arguments["question"]), evidence)
        case ZOOM_TO_OBJECT.name | TRACK_OBJECT.name:
            parts = _unsupported_words(str(arguments["description"]), evidence) + _unsupported_duration(
                call.name, arguments, evidence
            )
        case GO_HOME.name | TAKE_IMAGE.name:
            parts = []
        case _:
            return [f"the tool {call.name}"]
    if call.name in _ACTION_WORDS and not _mentions(evidence, _ACTION_WORDS[call.name]):
        parts.append({GO_HOME.name: "the home view", TAKE_IMAGE.name: "a picture"}.get(call.name, "the move"))
    if arguments.get("view") == "full" and not _mentions(evidence, _WHOLE_SCENE_WORDS):
        parts.append("the whole scene")
    if evidence.keep_still and _moves_camera(call):
        parts.append("a move")
    return parts


def _moves_camera(call: ToolCall) -> bool:
    return call.name in {ADJUST_PTZ.name, GO_TO_PRESET.name, GO_HOME.name, ZOOM_TO_OBJECT.name, TRACK_OBJECT.name}


def _is_repeated(call: ToolCall, earlier_calls: Sequence[ToolCall]) -> bool:
    return any(earlier.name == call.name and earlier.arguments == call.arguments for earlier in earlier_calls)


def _mentions(evidence: Evidence, words: frozenset[str]) -> bool:
    return any(base_form(word) in words or word in words for word in evidence.user_words)


def _unsupported_move(move: AdjustPtz, evidence: Evidence) -> list[str]:
    parts = []
    for degrees, negative, positive in ((move.pan_deg, "left", "right"), (move.tilt_deg, "down", "up")):
        if degrees:
            direction = positive if degrees > 0 else negative
            parts += [] if _names_direction(direction, evidence) else [direction]
            parts += [] if _has_degrees(abs(degrees), evidence) else [f"{abs(degrees):g} degrees"]
    return parts + _unsupported_zoom(move, evidence)


def _unsupported_zoom(move: AdjustPtz, evidence: Evidence) -> list[str]:
    if move.zoom_limit is not None:
        named = _mentions(evidence, _ZOOM_WORDS[move.zoom_limit]) and _mentions(evidence, _LIMIT_WORDS)
        return [] if named else [f"zooming all the way {move.zoom_limit}"]
    factor = move.zoom_factor
    if move.zoom_percent:
        factor = 1 + move.zoom_percent / 100
    if factor is None or factor == 1:
        return []
    direction = "in" if factor > 1 else "out"
    change = 100 * abs(factor - 1)
    amounts = (factor, 1 / factor, change, change / 100)
    parts = (
        []
        if _mentions(evidence, _ZOOM_WORDS[direction]) and not _contradicts_zoom(direction, evidence)
        else [f"zooming {direction}"]
    )
    return parts + ([] if any(_has_number(amount, evidence) for amount in amounts) else [f"the factor {factor:g}"])


def _contradicts_zoom(direction: str, evidence: Evidence) -> bool:
    """Return whether a zoom in contradicts the user, who says only "zoom out"."""
    return (
        direction == "in"
        and any(pair == ("zoom", "out") for pair in pairwise(evidence.user_words))
        and "in" not in evidence.user_words
    )


def _names_direction(direction: str, evidence: Evidence) -> bool:
    words = evidence.user_words
    for i, word in enumerate(words):
        before = words[i - 1] if i else ""
        after = words[i + 1] if i + 1 < len(words) else ""
        is_idiom = (
            (word == "right" and after in _AFTER_RIGHT)
            or (word == "left" and before in _BEFORE_LEFT)
            or (word in {"up", "down"} and before in _BEFORE_UP_OR_DOWN)
        )
        if word in _DIRECTION_WORDS[direction] and not is_idiom:
            return True
    return any(word in _DIRECTION_WORDS[direction] for word in evidence.observed_words)


def _has_degrees(degrees: float, evidence: Evidence) -> bool:
    """Return whether an angle is stated, in degrees or as a fraction of a turn."""
    return _has_number(degrees, evidence) or (_mentions(evidence, _TURN_WORDS) and _has_number(degrees / 360, evidence))


def _has_number(value: float, evidence: Evidence) -> bool:
    return any(abs(number - value) <= _NUMBER_TOLERANCE for number in evidence.numbers)


def _unsupported_duration(tool: str, arguments: Mapping[str, Any], evidence: Evidence) -> list[str]:
    seconds = float(arguments.get("duration_s", TrackObject.model_fields["duration_s"].default))
    if tool != TRACK_OBJECT.name or seconds == TrackObject.model_fields["duration_s"].default:
        return []
    minutes = _mentions(evidence, frozenset({"minute"})) and (seconds == 60 or _has_number(seconds / 60, evidence))
    stated = _has_number(seconds, evidence) or minutes
    return [] if stated else [f"{seconds:g} seconds"]


def _names_preset(name: str, evidence: Evidence) -> bool:
    if _mentions(evidence, _EVERY_WORDS) and _mentions(evidence, _PRESET_WORDS):
        return True
    parts = tuple(word for word in words_of(name.replace("-", " ").replace("_", " ")) if word.isalnum())
    user_words = tuple(word for word in evidence.user_words if word.isalnum())
    joined = "".join(parts)
    return any(user_words[i : i + len(parts)] == parts for i in range(len(user_words))) or (bool(joined) and joined in user_words)


def _unsupported_words(text: str, evidence: Evidence) -> list[str]:
    """Return the content words of a description or question that the evidence does not contain."""
    words = dict.fromkeys(word for word in words_of(text) if any(c.isalnum() for c in word))
    skipped = FUNCTION_WORDS | ABOUT_THE_PICTURE
    unsupported = [w for w in words if w not in skipped and base_form(w) not in skipped and not _is_supported(w, evidence)]
    return [f'"{word}"' for word in unsupported]


def _is_supported(word: str, evidence: Evidence) -> bool:
    if base_form(word) in evidence.base_forms:
        return True
    return word.replace(".", "", 1).isdigit() and _has_number(float(word), evidence)
