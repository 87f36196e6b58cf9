"""Patterns for the second half of a message that replaces or takes back the first, with what is meant.

``repairs`` replaces directions, numbers and presets. These are the repairs that replace more ("the silver car... no, the black
one"), or that have no number ("up a bit... no, down a bit").
"""

from __future__ import annotations

import re

from scope_ptz.english.grammar.parts_of_speech import parts_of_speech
from scope_ptz.planner.grammar.parsing.rewording.rewordings import Replacement

_PAUSE = r" *(?:[,.;…–-]+) *"
_NO = rf"(?:(?:no|nah|nope|oh|sorry|wait|actually|i mean|i meant)(?:{_PAUSE}| +))"
_BIT = r"(?:a (?:tiny |little )?(?:bit|little|touch|lot|smidge|tad)|slightly)"
_WAY = r"(?:left|right|up|down|in|out)"
_TURN = r"(?:left|right|up|down) (?:by )?\d+(?:\.\d+)?(?: ?deg(?:ree)?s?|°)?"
_STAY = r"stay (?:where you are|put|there|here|as you are)"
_TOO_MUCH = r"(?:less|(?:that['’]?s |that is |it['’]?s )?too (?:much|far)|not (?:so|that|as) (?:much|far))"
_NUMBER = r"\d+(?:\.\d+)?"
_POSITIONS = frozenset({"other", "left", "right", "first", "last", "next", "same", "second", "third", "top", "bottom", "middle"})
_AXES = (frozenset({"left", "right"}), frozenset({"up", "down"}))


def _with_other_adjective(match: re.Match[str]) -> str:
    """Return "the black car" for "the silver car... no, the black one"."""
    old, new = match["old"].lower(), match["new"].lower()
    is_alike = all("ADJ" in parts_of_speech(word) and word not in _POSITIONS for word in (old, new))
    return f"the {match['new']} {match['noun']}" if is_alike else match[0]


def _with_less(match: re.Match[str]) -> str:
    """Return "10" for "30... less, say 10".

    The text stays as it is if the second number is not less than the first, or may be by how much the first is too much ("30. Too
    much, 10").
    """
    if not (match["say"] or match["same_unit"]):
        return match[0]
    return f"{match['less']}{match['unit'] or ''}" if float(match["less"]) < float(match["much"]) else match[0]


def _with_other_turn(match: re.Match[str]) -> str:
    """Return "pan left 10" for "tilt up 10. No, left 10"; repairs on one axis are left to ``repairs``."""
    axis = next(axis for axis in _AXES if match["old"].lower() in axis)
    if match["new"].split()[0].lower() in axis:
        return match[0]
    return f"{'tilt' if axis == _AXES[0] else 'pan'} {match['new']}"


REPAIRS: tuple[tuple[str, Replacement], ...] = (
    (rf"{_PAUSE}{_NO}+(?:please )?(?P<said>(?:don['’]?t|do not)(?: do (?:it|that))?|{_STAY})(?: please)?\W*$", ". Actually don't"),
    (rf"\bthe (?P<old>[a-z]+) (?P<noun>[a-z]+){_PAUSE}{_NO}+the (?P<new>[a-z]+) ones?\W*$", _with_other_adjective),
    (rf"\b{_WAY}(?: {_BIT})?{_PAUSE}{_NO}+(?P<new>{_WAY} {_BIT})\W*$", r"\g<new>"),
    (rf"\b(?:twice|thrice|{_NUMBER} times|(?:two|three|four|five) times){_PAUSE}{_NO}+(?:just |only )?once\W*$", ""),
    (
        rf"\b(?P<much>{_NUMBER})(?P<unit>x|×| ?deg(?:ree)?s?| times|%)?{_PAUSE}{_TOO_MUCH}(?:{_PAUSE}| +)"
        rf"(?P<say>(?:(?:say|maybe|just|only|make (?:it|that)|more like) )*)(?P<less>{_NUMBER})"
        rf"(?P<same_unit>x|×| ?deg(?:ree)?s?| times|%)?\W*$",
        _with_less,
    ),
    (
        rf"^(?:please )?(?:(?:pan|tilt|turn|look|move|swing|point)(?: the camera| it)? )?(?P<old>left|right|up|down) "
        rf"(?:by )?{_NUMBER}(?: ?deg(?:ree)?s?|°)?{_PAUSE}{_NO}+(?P<new>{_TURN})\W*$",
        _with_other_turn,
    ),
)
"""Pairs of a pattern and what replaces it."""
