"""Find the names of presets in a list of words."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence
from functools import lru_cache

from scope_ptz.english.grammar.numbers import NUMBER_WORDS


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
    return table


def preset_at(words: Sequence[str], presets: tuple[str, ...]) -> tuple[str, int]:
    """Return the preset whose name begins a list of words, and the number of its words, hyphens included; ("", 0) for none."""
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
