"""Match the names of presets in an instruction with those that the camera has."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import SequenceMatcher

from scope_ptz.planner.grammar.lexing.lexicon import phrases
from scope_ptz.planner.grammar.lexing.preset_names import preset_key
from scope_ptz.planner.grammar.lexing.spelling import is_english, within_one_edit

_MIN_SIMILARITY = 0.8  # minimum similarity of two preset names, from 0 to 1
_MAX_NAME_WORDS = 4
_NOT_PRESETS = frozenset({"mode", "sleep", "hell", "bed", "town", "pieces", "waste"})
_COMMAND_CLASSES = frozenset({
    "DEG", "PRON", "LEFT", "RIGHT", "UP", "DOWN", "ZOOM", "PAN", "TILT", "TELL", "CARRY", "LIMIT", "CAMERA", "BACK", "HOWMANY",
    "BE",
})  # fmt: skip
"""Classes of words that cannot be part of a preset name while the presets are unknown."""
_MIN_ABBREVIATION_CHARS = 3


def match_exactly(name: str, presets: Sequence[str]) -> str | None:
    """Return the preset with a name, ignoring case, accents, spaces and hyphens; None if there is none."""
    key = "".join(preset_key(name))
    return next((preset for preset in presets if "".join(preset_key(preset)) == key), None)


def match_preset(name: str, presets: Sequence[str]) -> str | None:
    """Return the preset that matches a name exactly, otherwise the only close match; None if there is neither."""
    name_key = "".join(preset_key(name))
    keys = {preset: "".join(preset_key(preset)) for preset in presets}
    exact = match_exactly(name, presets)
    if exact or not name_key:
        return exact
    inside = [p for p in presets if len(name_key) >= 3 and set(preset_key(name)) < set(preset_key(p))]
    if len(inside) == 1:
        return inside[0]
    numbers = {word for word in preset_key(name) if word.isdigit()}
    similar = [
        preset
        for preset, key in keys.items()
        if len(key) >= 4 and within_one_edit(name_key, key) and numbers <= set(preset_key(preset))  # "tower 6" is not "tower-4"
    ]
    if len(similar) == 1:
        return similar[0]
    short = [preset for preset, key in keys.items() if abbreviates(name_key, key)]
    if len(short) == 1:
        return short[0]
    scored = sorted(((SequenceMatcher(None, name_key, key).ratio(), preset) for preset, key in keys.items()), reverse=True)
    clear = scored and scored[0][0] >= _MIN_SIMILARITY and (len(scored) < 2 or scored[1][0] < scored[0][0] - 0.05)
    return scored[0][1] if clear and not _names_another(name, scored[0][1]) else None


def _names_another(name: str, preset: str) -> bool:
    """Return whether a name contains a number or an English word that the preset's name lacks: "tower six" is not "tower-four"."""
    own = set(preset_key(preset))
    return any(word not in own and (word.isdigit() or is_english(word)) for word in preset_key(name))


def abbreviates(short: str, long: str) -> bool:
    """Return whether a word abbreviates another: the same first letter, then some of its other consonants ("hwy" for "highway")."""
    letters = iter(long)
    return (
        len(short) >= _MIN_ABBREVIATION_CHARS
        and short[0] == long[:1]
        and not set(short[1:]) & set("aeiou")
        and all(c in letters for c in short)
    )


def plausible_name(text: str) -> bool:
    """Return whether words could name a preset: few words, none about camera motion. Used when the presets are unknown."""
    words = preset_key(text)
    if not 0 < len(words) <= _MAX_NAME_WORDS or any(word in _NOT_PRESETS for word in words):
        return False
    return not any(phrases().get((word,), frozenset()) & _COMMAND_CLASSES for word in words)
