"""Find the actions in an instruction that its plan does not carry out, and the conditions that it does not test."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.consistency.evidence import Evidence
from scope_ptz.planner.grammar.consistency.words import Word

_PICTURES = frozenset(
    {"photo", "photos", "photograph", "photographs", "picture", "pictures", "snapshot", "snapshots", "screenshot"}
)
_TAKING = frozenset({"take", "taking", "snap", "grab", "save", "capture", "shoot", "record", "store"})
_WISHING = frozenset({"like", "love", "want", "need", "prefer", "appreciate"})
_RESEMBLING = frozenset({"look", "looks", "looked", "looking", "is", "s", "something", "nothing", "just", "more"})
"""Words before a "like" that compares and does not wish: "it looks like a photo"."""
_INDEFINITE = frozenset({"a", "an", "one", "another", "some", "two", "three"})
_TAKE_REACH = 4  # number of words before "picture" in which to look for "take"
_TURNS = {"pan": "pan", "panning": "pan", "tilt": "tilt", "tilting": "tilt"}
_FORBIDDEN = {
    "follow": (ast.Track,), "track": (ast.Track,), "picture": (ast.Snap,), "photo": (ast.Snap,), "home": (ast.Home,),
    "count": (ast.Count,), "counting": (ast.Count,), "zoom": (ast.ZoomTo,), "zooming": (ast.ZoomTo,), "pan": (), "panning": (),
    "tilt": (), "tilting": (),
}  # fmt: skip
"""Steps that must not be in a plan if a word is forbidden. For a turn or zoom, the plan must not move that axis either."""
_AXES = {"pan": "pan", "panning": "pan", "tilt": "tilt", "tilting": "tilt", "zoom": "zoom", "zooming": "zoom"}
_FORBIDDING_REACH = 5  # number of words before a forbidden action in which to look for "not"
_ZOOMING = frozenset({"zoom", "zooming", "magnify"})
_TESTS = (
    ast.Seen, ast.Readable, ast.Statement, ast.Outnumbers, ast.PresetOutnumbers, ast.Ask, ast.Count, ast.Read, ast.BeforeAfter,
    ast.Compare, ast.CompareWithBefore, ast.Tally, ast.Total, ast.Difference, ast.RankCounts, ast.WhichPreset, ast.FirstWith,
    ast.CameraState, ast.Rescope, ast.WhatAbout, ast.Help,
)  # fmt: skip
"""Conditions that need an observation, and steps whose answer can serve as a condition."""
_COURTEOUS = frozenset({
    "you", "may", "might", "could", "would", "can", "please", "possible", "trouble", "bother", "mind", "ok", "okay", "fine",
    "alright", "problem", "convenient", "want", "like", "wish", "time", "need", "needed", "necessary", "help", "helps",
    "so", "not", "yes", "no",
})  # fmt: skip
"""Words after "if" that only express courtesy, or refer to an earlier answer: "if it is no trouble", "if need be", "if so"."""
_COURTESY_REACH = 7  # number of words after "if" in which to look for courtesy


def ignored_conditions(words: Sequence[Word], evidence: Evidence) -> list[Word]:
    """Return each "if" and "unless" of an instruction if the plan tests nothing."""
    if evidence.has(*_TESTS):
        return []
    return [
        word
        for i, word in enumerate(words)
        if word.text in {"if", "unless"}
        and not word.is_described
        and not any(later.text in _COURTEOUS for later in words[i + 1 : i + 1 + _COURTESY_REACH])
    ]


def omitted_actions(words: Sequence[Word], evidence: Evidence) -> list[Word]:
    """Return the words for pictures, home, pan, tilt and zoom that no step of the plan carries out."""
    return [word for i, word in enumerate(words) if not (word.is_described or word.is_negated) and _is_omitted(words, i, evidence)]


def forbidden_actions(words: Sequence[Word], evidence: Evidence) -> list[Word]:
    """Return the words of forbidden actions that the plan carries out: "follow it. No, don't follow it"."""
    return [
        word
        for i, word in enumerate(words)
        if word.is_negated
        and not word.is_described
        and (steps := _FORBIDDEN.get(word.text)) is not None
        and (evidence.has(*steps) or _AXES.get(word.text) in evidence.axes)
        and word.text not in {later.text for later in words[i + 1 :] if not later.is_negated}
        and not _is_other_zoom(words, i, evidence)
        and _is_forbidden(words, i)
        and _ends_clause(words, i)
    ]


_STATING = frozenset(
    {"if", "is", "are", "was", "were", "has", "have", "can", "could", "does", "will", "isn", "aren", "hasn", "haven"}
)
"""Words before "not" that state something: "if the truck is not in view, zoom out"."""


def _is_other_zoom(words: Sequence[Word], i: int, evidence: Evidence) -> bool:
    """Return whether a zoom is forbidden that the plan does not make: "zoom out, but don't zoom in"."""
    way = words[i + 1].text if i + 1 < len(words) else ""
    return (
        words[i].text in {"zoom", "zooming"} and way in {"in", "out"} and way not in evidence.zooms and not evidence.has(ast.ZoomTo)
    )


def _is_forbidden(words: Sequence[Word], i: int) -> bool:
    """Return whether "do not", "don't", "never", "no" or "without" precedes a word. "If not" does not count."""
    before = [word.text for word in words[max(0, i - _FORBIDDING_REACH) : i]]
    if before[-1:] in (["no"], ["without"]) or before[-2:] in (["without", "the"], ["not", "the"]):
        return True  # "zoom in and pan left, no zoom"
    return any(b in {"not", "t", "dont", "never"} and a not in _STATING for a, b in pairwise(before))


def _ends_clause(words: Sequence[Word], i: int) -> bool:
    """Return whether a word ends its clause, or only a pronoun follows it, so that the clause is about the same thing as before."""
    after = words[i + 1] if i + 1 < len(words) else None
    later = words[i + 2] if i + 2 < len(words) else None
    is_last = later is None or later.is_break
    if after is not None and after.text in {"please", "though", "actually", "thanks", "after", "now", "yet", "in", "out"}:
        return True  # "no picture please", "don't tilt after all"
    return after is None or after.is_break or (after.text in {"it", "him", "her", "them", "that"} and is_last)


def _is_omitted(words: Sequence[Word], i: int, evidence: Evidence) -> bool:
    text = words[i].text
    if text in _PICTURES:
        before = [word.text for word in words[max(0, i - _TAKE_REACH) : i]]
        is_taken = not _TAKING.isdisjoint(before) or (_is_wished_for(before) and not evidence.has(ast.ZoomTo, ast.Zoom))
        return is_taken and not evidence.has(ast.Snap)
    if text == "home":
        return not evidence.has(ast.Home, ast.Back) and not _is_part_of_preset(text, evidence)
    if text in _TURNS:
        return _TURNS[text] not in evidence.axes and not evidence.has(
            ast.Sweep, ast.Aim, ast.Back, ast.CameraState, ast.Loop, ast.ZoomTo, ast.GoToPreset, ast.Help
        )
    if text in _ZOOMING:
        return "zoom" not in evidence.axes and not evidence.has(
            ast.ZoomTo, ast.Back, ast.Track, ast.CameraState, ast.Snap, ast.Home, ast.Help
        )
    return False


def _is_wished_for(before: Sequence[str]) -> bool:
    """Return whether the words before "photo" wish for one: "I'd like a quick photo", unlike "I need the photo gallery"."""
    return any(
        word in _WISHING and not _INDEFINITE.isdisjoint(before[i + 1 :]) and (not i or before[i - 1] not in _RESEMBLING)
        for i, word in enumerate(before)
    )


def _is_part_of_preset(text: str, evidence: Evidence) -> bool:
    return any(text in name.lower() for name in evidence.presets)
