"""Find the names of presets in a list of words."""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import lru_cache

from scope_ptz.english.grammar.numbers import NUMBER_WORDS

_VAGUE = frozenset(
    {"end", "side", "corner", "edge", "top", "bottom", "middle", "centre", "center", "front", "view", "area", "zone"}
)
"""Last words of names that often mean something else: "turn to the end"."""


def preset_key(name: str) -> tuple[str, ...]:
    """Return a preset name in the form used for comparison: lower-case words without accents, with numbers in digits."""
    decomposed = unicodedata.normalize("NFKD", name.lower())
    words = re.findall(r"[^\W\d_]+|\d+", "".join(c for c in decomposed if not unicodedata.combining(c)))
    return tuple(str(int(NUMBER_WORDS[w])) if w in NUMBER_WORDS and NUMBER_WORDS[w] < 100 else w for w in words)


@lru_cache(maxsize=64)
def preset_table(presets: tuple[str, ...]) -> Mapping[tuple[str, ...], str]:
    """Return the presets by the words of their names; "car-park" has the words "car park" and "carpark"."""
    table: dict[tuple[str, ...], str] = {}
    for preset in presets:
        key = preset_key(preset)
        if key:
            table[key] = preset
            table.setdefault(("".join(key),), preset)
    shorter = Counter(key[1:] for key in map(preset_key, presets) if len(key) > 2)  # "car park" for "visitor-car-park"
    for preset in presets:
        key = preset_key(preset)
        if shorter[key[1:]] == 1:
            table.setdefault(key[1:], preset)
    return table


@lru_cache(maxsize=64)
def short_names(presets: tuple[str, ...]) -> Mapping[str, str]:
    """Return the presets by the last word of their names, such as "gate" for "main-gate", if no other name contains that word."""
    keys = {preset: preset_key(preset) for preset in presets}
    words = Counter(word for key in keys.values() for word in set(key))
    return {key[-1]: preset for preset, key in keys.items() if len(key) > 1 and words[key[-1]] == 1 and key[-1] not in _VAGUE}


def preset_at(words: Sequence[str], presets: tuple[str, ...]) -> tuple[str, int]:
    """Return the preset whose name begins a list of words, and its length in words, counting hyphens; ("", 0) if there is none."""
    if not presets:
        return "", 0
    table = preset_table(presets)
    longest = max(map(len, table))
    found, found_used, used = "", 0, 0
    key: tuple[str, ...] = ()
    for word in words:
        used += 1
        if word in {"-", "_"} and key:
            continue
        part = preset_key(word)
        key += part
        if not part or len(key) > longest:
            break
        if key in table:
            found, found_used = table[key], used
    return found, found_used
