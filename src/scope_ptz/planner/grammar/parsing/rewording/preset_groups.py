"""Name each preset of a group: "both bays" for "bay-one" and "bay-two" becomes "the bay one and the bay two"."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache

from scope_ptz.english import plural
from scope_ptz.english.grammar.numbers import NUMBER_WORDS

_AT = r"(?:at|in|on|of|across|between|from|visit|show me|go to)"
_BUSIER = {"busier": "more", "fuller": "more", "quieter": "fewer", "emptier": "fewer"}


@lru_cache(maxsize=64)
def _groups(presets: tuple[str, ...]) -> Mapping[str, Mapping[str, str]]:
    """Return, for each word that begins or ends the names of two presets or more, these presets by what tells them apart.

    A number is listed in words and in digits: "bay" has {"one": "bay one", "1": "bay one", "two": "bay two", "2": "bay two"}.
    """
    groups: dict[str, dict[str, str]] = {}
    for preset in presets:
        words = re.findall(r"[^\W_]+", preset.lower())
        if len(words) < 2:
            continue
        name = " ".join(words)
        for noun, other in ((words[0], " ".join(words[1:])), (words[-1], " ".join(words[:-1]))):
            members = groups.setdefault(noun, {})
            members[other] = name
            if other in NUMBER_WORDS:
                members[f"{NUMBER_WORDS[other]:g}"] = name
            members.update({word: name for word, value in NUMBER_WORDS.items() if f"{value:g}" == other})
    return {noun: members for noun, members in groups.items() if noun.isalpha() and len(set(members.values())) > 1}


def with_groups_named(text: str, presets: tuple[str, ...]) -> str:
    """Return "which has more vans, bay one or bay two?" for "which bay has more vans, one or two?", and so on.

    Args:
        text: The text of an instruction.
        presets: The camera's presets.
    """
    for noun, members in _groups(presets).items():
        if noun in text.lower():
            text = _with_members_named(text, noun, members)
    return text


def _with_members_named(text: str, noun: str, members: Mapping[str, str]) -> str:
    """Return a text with the names of the presets of one group."""
    nouns = re.escape(plural(noun))
    which = "|".join(sorted(map(re.escape, members), key=len, reverse=True))
    names = list(dict.fromkeys(members.values()))
    if len(names) == 2:
        text = re.sub(
            rf"\b({_AT}) (?:both(?: of)?(?: the)?|(?:each of )?the two) {nouns}\b",
            rf"\1 the {names[0]} and the {names[1]}",
            text,
            flags=re.IGNORECASE,
        )

    def both(match: re.Match[str]) -> tuple[str, str] | None:
        one, other = members[match["one"].lower()], members[match["other"].lower()]
        return None if one == other else (one, other)

    def listed(match: re.Match[str]) -> str:
        pair = both(match)
        return match[0] if pair is None else f"the {pair[0]} {match['link']} the {pair[1]}"

    def compared(match: re.Match[str]) -> str:
        pair = both(match)
        return match[0] if pair is None else f"which {match['compared']}, the {pair[0]} or the {pair[1]}"

    def counted(match: re.Match[str]) -> str:
        pair = both(match)
        if pair is None:
            return match[0]
        return f"which has {_BUSIER[match['way'].lower()]} {match['things']}, the {pair[0]} or the {pair[1]}?"

    choice = rf"(?:the )?(?P<one>{which}),? or (?:the )?(?P<other>{which})\b"
    two = rf"(?P<one>{which}) (?P<link>and|or|then|versus|vs) (?:the )?(?P<other>{which})"
    text = re.sub(rf"\bwhich {re.escape(noun)} (?P<compared>[^,.;?!]+), {choice}", compared, text, flags=re.IGNORECASE)
    text = re.sub(
        rf"^(?:which is the )?(?P<way>{'|'.join(_BUSIER)}) {re.escape(noun)}[,:]? {choice}\? "
        r"(?:please )?count (?:the )?(?P<things>[\w ]+?)\W*$",
        counted,
        text,
        flags=re.IGNORECASE,
    )
    for head in (nouns, re.escape(noun)):
        text = re.sub(rf"(?<!which )\b(?:the )?{head} {two}\b", listed, text, flags=re.IGNORECASE)
    return text
