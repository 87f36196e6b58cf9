"""Find the directions of an instruction that its plan does not follow, and those of a plan that the instruction does not name."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.consistency.evidence import Evidence
from scope_ptz.planner.grammar.consistency.words import Word
from scope_ptz.planner.grammar.lexing.spelling import within_one_edit

_WORDS = {
    "left": ("left", "lefts", "leftward", "leftwards", "lft", "anticlockwise", "counterclockwise", "ccw"),
    "right": ("right", "rigth", "rights", "rightward", "rightwards", "clockwise", "cw"),
    "up": ("up", "upward", "upwards", "higher", "skyward", "skywards"),
    "down": ("down", "downward", "downwards", "dn", "lower"),
}
_DIRECTION_OF = {word: direction for direction, words in _WORDS.items() for word in words}
_OTHER_DIRECTION_WORDS = {
    "left": frozenset({"l", "anti", "counter", "port"}),
    "right": frozenset({"r", "starboard"}),
    "up": frozenset({"u", "raise", "raising", "raised", "lift", "lifting", "elevate", "elevating", "above", "sky", "upper", "top"}),
    "down": frozenset({"d", "drop", "dropping", "lowering", "dip", "dipping", "below", "under", "ground", "floor", "bottom"}),
}
"""Other words that can name a direction. A plan may move in that direction, but need not."""

_AFTER_RIGHT = frozenset({
    "now", "away", "then", "out", "in", "round", "around", "over", "at", "on", "through", "across", "angle", "angles", "hand",
    "back", "to", "up", "down", "behind", "below", "beside", "by", "next", "above", "near", "under", "underneath", "the", "time",
    "here", "there",
})  # fmt: skip
"""Words before which "right" may mean "exactly"."""

_PARTS = frozenset({"side", "lane", "edge", "end", "corner", "bank", "wing", "wall", "half"})
"""Nouns that make "the left" and "the right" a place."""

_PARTS_OF_THINGS = frozenset({"turn", "arm", "leg", "foot", "wheel", "wing", "side", "flank", "indicator", "headlight"})
"""Nouns that make "its left" and "their right" a part of a thing, or what it does."""

_BEFORE_LEFT = frozenset({
    "are", "is", "were", "was", "people", "cars", "none", "nothing", "anything", "any", "have", "has", "got", "s", "ve", "someone",
    "somebody", "he", "she", "they", "who", "i",
})  # fmt: skip
_MOTION = frozenset({
    "pan", "tilt", "look", "move", "go", "point", "aim", "angle", "pitch", "nudge", "tip", "swing", "camera", "it", "lens", "view",
    "turn", "bit", "little", "touch", "tad", "further", "more", "degrees", "degree", "deg", "panning", "tilting", "looking",
    "moving", "diagonally",
})  # fmt: skip
_DETERMINERS = frozenset({"the", "a", "an", "my", "our", "his", "her", "their", "its", "some", "those", "these", "all"})
_AMOUNTS = frozenset(
    {"bit", "little", "lot", "touch", "tad", "few", "same", "full", "whole", "way", "fraction", "quarter", "half", "notch"}
)
_VERB_REACH = 5  # number of words before "left" in which a verb of motion makes it a direction
_TOWARDS = frozenset({"at", "to", "towards", "toward", "on", "onto", "face"})
_INDIRECT_MOVE_WORDS = frozenset({
    "increase", "raise", "boost", "back", "again", "same", "opposite", "reverse", "undo", "another", "further", "more", "minus",
    "negative", "repeat", "return", "centre", "center", "level", "decrease", "reduce", "lessen", "other", "around", "round",
    "behind", "u", "i", "ahead", "straight", "horizon", "twice", "retrace",
})  # fmt: skip
"""Words with which a plan may move in a direction that is not named, such as "back" and "another"."""

_ZOOM_IN = frozenset({"in", "closer", "nearer", "tighter", "tighten", "tightening", "inwards"})
_ZOOM_OUT = frozenset({"out", "wider", "widen", "widening", "outwards", "broaden"})
_OTHER_ZOOM_OUT_WORDS = frozenset(
    {"back", "off", "away", "halve", "half", "wide", "reduce", "decrease", "lower", "less", "down", "undo"}
)


def ignored_directions(words: Sequence[Word], evidence: Evidence) -> list[Word]:
    """Return the words for directions that the plan does not follow."""
    return [
        word
        for i, word in enumerate(words)
        if (direction := _DIRECTION_OF.get(word.text))
        and not (word.is_described or word.is_negated)
        and _is_direction(words, i, direction)
        and direction not in evidence.directions | evidence.zero_turns
        and not (direction in {"up", "down"} and evidence.has(ast.GoToPreset) and not evidence.axes)
        and not _leads_to_target(words, i, evidence)
    ]


def _leads_to_target(words: Sequence[Word], i: int, evidence: Evidence) -> bool:
    """Return whether a direction only says where a thing or preset is: "look up at the gantry"."""
    after = {word.text for word in words[i + 1 : i + 3]}
    return bool(after & _TOWARDS) and evidence.has(ast.ZoomTo, ast.GoToPreset, ast.Track)


def _is_direction(words: Sequence[Word], i: int, direction: str) -> bool:
    """Return whether a word can only be a direction: not "right now", "none left" or "bring up"."""
    before = words[i - 1].text if i else ""
    after = words[i + 1].text if i + 1 < len(words) else ""
    if before in {"the", "our", "its"} and after in _PARTS and direction in {"left", "right"}:
        return False  # "the light from the right side"
    if before in {"its", "his", "her", "their"} and after.removesuffix("s") in _PARTS_OF_THINGS:
        return False  # "time its right turn"
    if words[i].text == "right":
        is_tag = before == "," and after == "?"  # "nobody's there, right?"
        return not is_tag and after not in _AFTER_RIGHT and before not in {"all", "straight", ""}  # "Right, count the cars"
    if words[i].text == "left":
        return before not in _BEFORE_LEFT and not _is_verb(words, i)
    if direction in {"up", "down"}:
        return before in _MOTION and after not in {"to", "close", "the"}  # "go up the north fence"
    return True


def _is_verb(words: Sequence[Word], i: int) -> bool:
    """Return whether "left" is the past of "leave": "the boys left the lights on", unlike "the view left a bit"."""
    before = [word.text for word in words[max(0, i - _VERB_REACH) : i]]
    after = [word.text for word in words[i + 1 : i + 3]]
    has_subject = len(before) > 1 and before[-2] in _DETERMINERS
    has_object = len(after) > 1 and after[0] in _DETERMINERS and after[1] not in _AMOUNTS
    return has_subject and has_object and _MOTION.isdisjoint(before)


def unnamed_directions(words: Sequence[Word], evidence: Evidence) -> list[str]:
    """Return the directions in which the plan turns, but which the instruction does not name."""
    texts = {_corrected_direction(word.text) for word in words if not word.is_described}
    if texts & _INDIRECT_MOVE_WORDS or any(text.startswith(("-", "+")) or text == "plus" for text in texts):
        return []
    named = {_DIRECTION_OF[text] for text in texts if text in _DIRECTION_OF}
    named |= {direction for direction, also in _OTHER_DIRECTION_WORDS.items() if texts & also}
    aimed = evidence.has(ast.Aim)
    unnamed = sorted(evidence.directions - named)
    return [] if aimed else [d for d in unnamed if d != "right" or evidence.directions & named & {"left"}]


def _corrected_direction(text: str) -> str:
    """Return the direction that a word with one typing error stands for ("leeft"); other words unchanged."""
    if any(text in words for words in _OTHER_DIRECTION_WORDS.values()):
        return text  # "lift"
    return next((word for word in ("left", "right", "down") if len(text) > 3 and within_one_edit(text, word)), text)


def contradicted_zoom(words: Sequence[Word], evidence: Evidence) -> list[Word]:
    """Return the words for zooming in if the plan only zooms out, or for zooming out if it only zooms in."""
    senses = {"in": _zoom_words(words, _ZOOM_IN), "out": _zoom_words(words, _ZOOM_OUT)}
    texts = {word.text for word in words}
    if evidence.has(ast.ZoomTo, ast.Track, ast.Back):
        return []
    if senses["in"] and evidence.zooms == {"out"} and not senses["out"] and not texts & _OTHER_ZOOM_OUT_WORDS:
        return senses["in"]
    return senses["out"] if senses["out"] and evidence.zooms == {"in"} and not senses["in"] else []


def _zoom_words(words: Sequence[Word], sense: frozenset[str]) -> list[Word]:
    return [
        word
        for i, word in enumerate(words)
        if word.text in sense
        and not (word.is_described or word.is_negated)
        and (word.text not in {"in", "out"} or any(w.text.startswith(("zoom", "zom")) for w in words[max(0, i - 3) : i]))
    ]
