"""Rewrite comparisons of two presets: "more vans where, yard or gate?" is asked as "which has more vans, yard or gate?"."""

from __future__ import annotations

import re

_COMPARED = re.compile(
    r"\b(?P<how>more|most|fewer|fewest|less|least|greater number of|larger number of|higher number of|highest number of)\b"
    r"(?: of the)? (?P<what>.+)",
    re.IGNORECASE,
)
_HOW = {"most": "more", "fewest": "fewer", "less": "fewer", "least": "fewer"}
_STOP = re.compile(
    r"\b(?:where|at|in|on|over|by|there|than|or|and|standing|about|today|now|tonight|this|right|out|it"
    r"|go|take|zoom|can|could|count|than|between|which|across|of the two|around|currently|presently|please|left)\b|[,;:.?!–-]",
    re.IGNORECASE,
)
_FUNCTION_WORDS = frozenset(
    [
        "which",
        "one",
        "where",
        "is",
        "are",
        "it",
        "the",
        "at",
        "in",
        "on",
        "has",
        "have",
        "had",
        "got",
        "there",
        "or",
        "and",
        "vs",
        "versus",
        "between",
        "do",
        "does",
        "tell",
        "me",
        "us",
        "know",
        "check",
        "see",
        "if",
        "whether",
        "can",
        "you",
        "could",
        "would",
        "please",
        "today",
        "tonight",
        "now",
        "this",
        "morning",
        "afternoon",
        "evening",
        "standing",
        "parked",
        "waiting",
        "sitting",
        "lying",
        "about",
        "around",
        "right",
        "out",
        "of",
        "two",
        "these",
        "those",
        "presets",
        "preset",
        "places",
        "place",
        "views",
        "view",
        "positions",
        "compare",
        "determine",
        "find",
        "report",
        "say",
        "whose",
        "who",
        "count",
        "both",
        "them",
        "i",
        "we",
        "want",
        "wonder",
        "wondering",
        "need",
        "to",
        "like",
        "just",
        "so",
        "hey",
        "hi",
        "hello",
        "ok",
        "okay",
        "then",
        "a",
        "an",
        "bigger",
        "higher",
        "larger",
        "greater",
        "number",
        "with",
        "for",
        "up",
        "down",
        "over",
        "by",
        "near",
        "that",
        "s",
        "holds",
        "contains",
        "hosts",
        "shows",
        "holding",
        "looks",
        "busier",
        "worse",
        "better",
        "currently",
        "presently",
        "settle",
        "which's",
        "where's's",
        "me",
        "id",
        "d",
        "quick",
        "question",
        "moment",
        "would'd",
        "ll",
        "you'd",
        "lets",
        "let",
        "think",
        "find",
        "see",
        "be",
    ]
)
"""Words that may surround a comparison without changing its meaning."""

_GOES_THERE = re.compile(
    r"[,.;?!] *(?:then |and |and then )?(?:please )?(?:go|move|switch|head) (?:over )?(?:there|to (?:it|that one))\W*$", re.I
)


def with_presets_compared(text: str, names: str) -> str:
    """Return a comparison of two presets in the plain form; any other text unchanged.

    Args:
        text: The text of an instruction.
        names: A pattern for the names of the presets.
    """
    goes = _GOES_THERE.search(text)
    asked = text[: goes.start()] if goes else text
    found = list(re.finditer(rf"\b(?:{names})\b", asked, re.IGNORECASE))
    compared = _COMPARED.search(re.sub(rf"\b(?:{names})\b", lambda match: "," * len(match[0]), asked, flags=re.IGNORECASE))
    if len(found) != 2 or compared is None or found[0][0].lower() == found[1][0].lower():
        return text
    between = asked[found[0].end() : found[1].start()]
    if not re.search(r"\b(?:or|and|vs|versus|than)\b", between, re.IGNORECASE) or re.search(r"[.;!]", between):
        return text
    what = _STOP.split(compared["what"])[0].strip()
    if not what:
        return text
    start = compared.start("what") + compared["what"].index(what)
    rest = "".join(
        " " if any(a <= i < b for a, b in ((start, start + len(what)), *(m.span() for m in found))) else c
        for i, c in enumerate(asked)
    )
    how = compared["how"].lower()
    words = re.findall(r"[^\W\d_]+", rest.lower())
    if any(word not in _FUNCTION_WORDS and word not in how.split() for word in words) or re.search(r"\d", rest):
        return text
    return f"which has {_HOW.get(how, how if how == 'fewer' else 'more')} {what}, {found[0][0]} or {found[1][0]}?" + (
        " go there" if goes else ""
    )
