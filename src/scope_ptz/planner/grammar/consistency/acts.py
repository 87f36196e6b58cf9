"""Find the acts of an instruction that its plan does not carry out."""

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
