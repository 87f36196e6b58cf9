"""Inflect English verbs and nouns."""

from __future__ import annotations

from scope_ptz.english.nouns import plural_noun

_IRREGULAR_PAST = {
    "go": ("went", "gone"), "bring": ("brought",), "take": ("took", "taken"), "come": ("came",), "put": ("put",),
    "get": ("got", "gotten"), "give": ("gave", "given"), "make": ("made",), "swing": ("swung",), "spin": ("spun",),
    "slide": ("slid",), "find": ("found",), "see": ("saw", "seen"), "show": ("showed", "shown"), "tell": ("told",),
    "say": ("said",), "read": ("read",), "keep": ("kept",), "have": ("had",), "shoot": ("shot",), "draw": ("drew", "drawn"),
    "run": ("ran",), "set": ("set",), "send": ("sent",), "let": ("let",), "cut": ("cut",), "leave": ("left",),
    "know": ("knew", "known"), "hold": ("held",), "do": ("did", "done"), "think": ("thought",), "stick": ("stuck",),
    "creep": ("crept",), "sweep": ("swept",), "begin": ("began", "begun"), "choose": ("chose", "chosen"),
}  # fmt: skip
_VOWELS = frozenset("aeiou")
_DOUBLED = frozenset({"travel", "swivel", "pivot", "level", "panel", "label"})  # "swivelling", unlike "tilting"


def verb_forms(verb: str) -> dict[str, tuple[str, ...]]:
    """Return the forms of a verb by name: "" for the base, "s", "ing" and "ed". Only the first word of a phrase is inflected."""
    first, *rest = verb.split(" ")
    tail = " ".join(["", *rest])
    third = first + ("es" if first.endswith(("s", "x", "ch", "sh", "z", "o")) else "s")
    if first.endswith("y") and first[-2:-1] not in _VOWELS:
        third = f"{first[:-1]}ies"
    stems = _stems(first)
    ing = (f"{first[:-2]}ying",) if first.endswith("ie") else tuple(f"{stem}ing" for stem in stems)  # "lying"
    past = _IRREGULAR_PAST.get(first) or tuple(
        f"{first[:-1]}ied" if first.endswith("y") and first[-2:-1] not in _VOWELS else f"{stem}ed" for stem in stems
    )
    if first in {"have"}:
        third = "has"
    return {
        "": (first + tail,),
        "s": (third + tail,),
        "ing": tuple(form + tail for form in ing),
        "ed": tuple(form + tail for form in past),
    }


def _stems(verb: str) -> tuple[str, ...]:
    """Return the stems before "ing" and "ed", in British and American spelling."""
    if verb.endswith("e") and not verb.endswith(("ee", "ye", "oe")):
        return (verb[:-1],)
    is_short = len(verb) >= 3 and verb[-1] not in _VOWELS | set("wxy") and verb[-2] in _VOWELS and verb[-3] not in _VOWELS
    if verb in _DOUBLED:
        return (verb + verb[-1], verb)
    one_syllable = sum(c in _VOWELS for c in verb) == 1
    return (verb + verb[-1],) if is_short and one_syllable else (verb,)


def noun_forms(noun: str) -> tuple[str, ...]:
    """Return the singular and plural of a noun phrase. Only its last word is inflected."""
    *first, last = noun.split(" ")
    return noun, " ".join([*first, plural_noun(last)])
