"""Find the parts of a call that stand neither in the instruction nor in earlier results.

The check is stricter than the tools. A call that it objects to may be right, but the user must confirm it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from scope_ptz.planner.base import ToolCall
from scope_ptz.planner.hybrid.grounds import Grounds, base_form, words_of
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

_TOLERANCE = 0.011
_DIRECTIONS = {
    "left": frozenset({"left", "leftward", "leftwards", "anticlockwise", "counterclockwise"}),
    "right": frozenset({"right", "rightward", "rightwards", "clockwise"}),
    "up": frozenset({"up", "upward", "upwards", "higher", "raise", "lift"}),
    "down": frozenset({"down", "downward", "downwards", "lower", "dip"}),
}
_AFTER_RIGHT = frozenset({"now", "away", "then", "here", "there", "hand", "angle", "angles"})  # "right now" is no direction
_BEFORE_LEFT = frozenset({"are", "is", "anything", "nothing", "any", "none", "have", "has", "was", "were"})  # "anything left"
_BEFORE_UP_OR_DOWN = frozenset({"bring", "sum", "add", "call", "pick", "show", "set", "break", "write", "hurry"})
_ZOOM = {
    "in": frozenset({"in", "closer", "nearer", "tighter", "magnify", "enlarge", "closest", "zoom"}),
    "out": frozenset({"out", "wider", "widen", "back", "away", "widest"}),
}
_LIMIT = frozenset({"all", "fully", "max", "maximum", "min", "minimum", "widest", "closest", "limit", "completely", "far", "much"})
_EVERY = frozenset({"all", "each", "every"})
_PRESETS = frozenset({"preset", "view", "position", "place", "viewpoint"})
_TURN = frozenset({"turn", "circle", "rotation", "revolution", "round", "way"})
_ACTS = {
    GO_HOME.name: frozenset({"home", "start", "reset", "beginning", "origin"}),
    TAKE_IMAGE.name: frozenset({"picture", "photo", "photograph", "image", "snapshot", "screenshot", "snap", "still", "shot"}),
    ZOOM_TO_OBJECT.name: frozenset(
        {"zoom", "close", "closer", "look", "show", "focus", "find", "centre", "read", "point", "frame", "aim", "nearer", "up"}
    ),
    TRACK_OBJECT.name: frozenset({"track", "follow", "keep", "tail", "trail", "watch", "stay", "monitor"}),
}
"""One of these words must stand in the instruction before the tool moves the camera or takes a picture."""

_WHOLE_SCENE = frozenset(
    {"whole", "entire", "everywhere", "around", "sweep", "scan", "full", "anywhere", "panorama", "site", "surroundings", "complete"}
)
_AGAIN = frozenset(
    {"again", "time", "until", "till", "each", "every", "step", "keep", "repeat", "while", "once", "twice", "more", "all"}
)


def without_grounds(call: ToolCall, grounds: Grounds, made: Sequence[ToolCall] = ()) -> list[str]:
    """Return the parts of a valid call that stand neither in the instruction nor in earlier results, in words.

    Args:
        call: A call with valid arguments.
        grounds: The words and numbers on which the call may be based.
        made: The calls of this run that were carried out.

    Returns:
        The parts without grounds; empty if the call may be carried out.
    """
    arguments = call.arguments
    match call.name:
        case ADJUST_PTZ.name:
            parts = _move(AdjustPtz.model_validate(arguments), grounds)
            parts += ["a second time"] if _is_repeated(call, made) and not _says(grounds, _AGAIN) else []
        case GO_TO_PRESET.name:
            parts = [] if _names_preset(str(arguments["name"]), grounds) else [f'the preset "{arguments["name"]}"']
        case GET_PRESETS.name:
            parts = []
        case COUNT_OBJECTS.name:
            parts = _nouns(str(arguments["description"]), grounds)
        case QUERY_ANSWER.name:
            parts = _nouns(str(arguments["question"]), grounds)
        case ZOOM_TO_OBJECT.name | TRACK_OBJECT.name:
            parts = _nouns(str(arguments["description"]), grounds) + _duration(call.name, arguments, grounds)
        case GO_HOME.name | TAKE_IMAGE.name:
            parts = []
        case _:
            return [f"the tool {call.name}"]
    if call.name in _ACTS and not _says(grounds, _ACTS[call.name]):
        parts.append({GO_HOME.name: "the home view", TAKE_IMAGE.name: "a picture"}.get(call.name, "the move"))
    if arguments.get("view") == "full" and not _says(grounds, _WHOLE_SCENE):
        parts.append("the whole scene")
    if grounds.is_still and _moves(call):
        parts.append("a move")
    return parts


def _moves(call: ToolCall) -> bool:
    return call.name in {ADJUST_PTZ.name, GO_TO_PRESET.name, GO_HOME.name, ZOOM_TO_OBJECT.name, TRACK_OBJECT.name}


def _is_repeated(call: ToolCall, made: Sequence[ToolCall]) -> bool:
    return any(earlier.name == call.name and earlier.arguments == call.arguments for earlier in made)


def _says(grounds: Grounds, words: frozenset[str]) -> bool:
    return any(base_form(word) in words or word in words for word in grounds.said)


def _move(move: AdjustPtz, grounds: Grounds) -> list[str]:
    parts = []
    for degrees, negative, positive in ((move.pan_deg, "left", "right"), (move.tilt_deg, "down", "up")):
        if degrees:
            direction = positive if degrees > 0 else negative
            parts += [] if _names_direction(direction, grounds) else [direction]
            parts += [] if _has_degrees(abs(degrees), grounds) else [f"{abs(degrees):g} degrees"]
    return parts + _zoom(move, grounds)


def _zoom(move: AdjustPtz, grounds: Grounds) -> list[str]:
    if move.zoom_limit is not None:
        named = _says(grounds, _ZOOM[move.zoom_limit]) and _says(grounds, _LIMIT)
        return [] if named else [f"zooming all the way {move.zoom_limit}"]
    factor = move.zoom_factor
    if move.zoom_percent:
        factor = 1 + move.zoom_percent / 100
    if factor is None or factor == 1:
        return []
    sense = "in" if factor > 1 else "out"
    change = 100 * abs(factor - 1)
    amounts = (factor, 1 / factor, change, change / 100)
    parts = [] if _says(grounds, _ZOOM[sense]) and not _is_opposed(sense, grounds) else [f"zooming {sense}"]
    return parts + ([] if any(_has_number(amount, grounds) for amount in amounts) else [f"the factor {factor:g}"])


def _is_opposed(sense: str, grounds: Grounds) -> bool:
    """Return whether the user names only the other sense: "zoom out" opposes zooming in, although "zoom" alone does not."""
    return sense == "in" and any(pair == ("zoom", "out") for pair in pairwise(grounds.said)) and "in" not in grounds.said


def _names_direction(direction: str, grounds: Grounds) -> bool:
    words = grounds.said
    for i, word in enumerate(words):
        before = words[i - 1] if i else ""
        after = words[i + 1] if i + 1 < len(words) else ""
        is_idiom = (
            (word == "right" and after in _AFTER_RIGHT)
            or (word == "left" and before in _BEFORE_LEFT)
            or (word in {"up", "down"} and before in _BEFORE_UP_OR_DOWN)
        )
        if word in _DIRECTIONS[direction] and not is_idiom:
            return True
    return any(word in _DIRECTIONS[direction] for word in grounds.seen)


def _has_degrees(degrees: float, grounds: Grounds) -> bool:
    """Return whether an angle is stated: in degrees, or as a part of a turn."""
    return _has_number(degrees, grounds) or (_says(grounds, _TURN) and _has_number(degrees / 360, grounds))


def _has_number(value: float, grounds: Grounds) -> bool:
    return any(abs(number - value) <= _TOLERANCE for number in grounds.numbers)


def _duration(tool: str, arguments: Mapping[str, Any], grounds: Grounds) -> list[str]:
    seconds = float(arguments.get("duration_s", TrackObject.model_fields["duration_s"].default))
    if tool != TRACK_OBJECT.name or seconds == TrackObject.model_fields["duration_s"].default:
        return []
    minutes = _says(grounds, frozenset({"minute"})) and (seconds == 60 or _has_number(seconds / 60, grounds))
    stated = _has_number(seconds, grounds) or minutes
    return [] if stated else [f"{seconds:g} seconds"]


def _names_preset(name: str, grounds: Grounds) -> bool:
    if _says(grounds, _EVERY) and _says(grounds, _PRESETS):
        return True
    parts = tuple(word for word in words_of(name.replace("-", " ").replace("_", " ")) if word.isalnum())
    said = tuple(word for word in grounds.said if word.isalnum())
    joined = "".join(parts)
    return any(said[i : i + len(parts)] == parts for i in range(len(said))) or (bool(joined) and joined in said)


def _nouns(text: str, grounds: Grounds) -> list[str]:
    """Return the words of a description or question that name things and stand nowhere."""
    words = dict.fromkeys(word for word in words_of(text) if any(c.isalnum() for c in word))
    skipped = FUNCTION_WORDS | ABOUT_THE_PICTURE
    missing = [w for w in words if w not in skipped and base_form(w) not in skipped and not _stands(w, grounds)]
    return [f'"{word}"' for word in missing]


def _stands(word: str, grounds: Grounds) -> bool:
    if base_form(word) in grounds.words:
        return True
    return word.replace(".", "", 1).isdigit() and _has_number(float(word), grounds)
