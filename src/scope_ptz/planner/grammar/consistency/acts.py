"""Find the acts of an instruction that its plan does not carry out, and the conditions that it does not test."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.consistency.evidence import Evidence
from scope_ptz.planner.grammar.consistency.words import Word

_PICTURES = frozenset(
    {"photo", "photos", "photograph", "photographs", "picture", "pictures", "snapshot", "snapshots", "screenshot"}
)
_TAKING = frozenset({"take", "taking", "snap", "grab", "save", "capture", "shoot", "record", "store"})
_TAKE_REACH = 4  # words between "take" and "picture"
_TURNS = {"pan": "pan", "panning": "pan", "tilt": "tilt", "tilting": "tilt"}
_ZOOMING = frozenset({"zoom", "zooming", "magnify"})
_TESTS = (
    ast.Seen, ast.Readable, ast.Statement, ast.Outnumbers, ast.PresetOutnumbers, ast.Ask, ast.Count, ast.Read, ast.BeforeAfter,
    ast.Compare, ast.CompareWithBefore, ast.Tally, ast.Total, ast.Difference, ast.RankCounts, ast.WhichPreset, ast.FirstWith,
    ast.CameraState, ast.Rescope, ast.WhatAbout, ast.Help,
)  # fmt: skip
"""Conditions that perception answers, and steps whose answer can be one."""
_COURTEOUS = frozenset({
    "you", "may", "might", "could", "would", "can", "please", "possible", "trouble", "bother", "mind", "ok", "okay", "fine",
    "alright", "problem", "convenient", "want", "like", "wish", "time", "need", "needed", "necessary", "help", "helps",
    "so", "not", "yes", "no",
})  # fmt: skip
"""Words after "if" that make it courtesy, or refer to an earlier answer: "if it is no trouble", "if need be", "if so"."""
_COURTESY_REACH = 7  # words after "if"


def ignored_conditions(words: Sequence[Word], evidence: Evidence) -> list[Word]:
    """Return each "if" and "unless" of a plan that tests nothing."""
    if evidence.has(*_TESTS):
        return []
    return [
        word
        for i, word in enumerate(words)
        if word.text in {"if", "unless"}
        and not word.is_described
        and not any(later.text in _COURTEOUS for later in words[i + 1 : i + 1 + _COURTESY_REACH])
    ]


def omitted_acts(words: Sequence[Word], evidence: Evidence) -> list[Word]:
    """Return the words for pictures, home, pan, tilt, zoom and following that no step of the plan carries out."""
    return [word for i, word in enumerate(words) if not (word.is_described or word.is_negated) and _is_omitted(words, i, evidence)]


def _is_omitted(words: Sequence[Word], i: int, evidence: Evidence) -> bool:
    text = words[i].text
    if text in _PICTURES:
        taken = any(word.text in _TAKING for word in words[max(0, i - _TAKE_REACH) : i])
        return taken and not evidence.has(ast.Snap)
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


def _is_part_of_preset(text: str, evidence: Evidence) -> bool:
    return any(text in name.lower() for name in evidence.presets)
