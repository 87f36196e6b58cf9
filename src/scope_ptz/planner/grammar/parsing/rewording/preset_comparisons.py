"""Rewrite comparisons of presets: "more vans where, yard or gate?" becomes "which has more vans, yard or gate?"."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.english.text_forms import listing
from scope_ptz.planner.grammar.parsing.remark_detection.shorter_versions import is_remark

_COMPARED = re.compile(
    r"\b(?P<how>more|most|fewer|fewest|less|least|greater number of|larger number of|higher number of|highest number of)\b"
    r"(?: of the)? (?P<what>.+)",
    re.IGNORECASE,
)
_SUPERLATIVES = frozenset({"most", "fewest", "least", "highest number of"})
_FEWER = frozenset({"fewer", "fewest", "less", "least"})
_STOP = re.compile(
    r"\b(?:where|at|in|on|over|by|there|than|or|and|standing|about|today|now|tonight|this|right|out|it"
    r"|go|take|zoom|can|could|count|than|between|which|across|of the two|around|currently|presently|please|left)\b|[,;:.?!–-]",
    re.IGNORECASE,
)
"""What ends the name of the things to compare: "vans" in "more vans where"."""

_FUNCTION_WORDS = frozenset({
    "a", "about", "afternoon", "an", "and", "are", "around", "at", "be", "better", "between", "bigger", "both", "busier", "by",
    "can", "check", "compare", "contains", "could", "count", "currently", "d", "determine", "do", "does", "down", "evening",
    "find", "for", "got", "greater", "had", "has", "have", "hello", "hey", "hi", "higher", "holding", "holds", "hosts", "i",
    "id", "in", "is", "it", "just", "kindly", "know", "larger", "let", "lets", "like", "ll", "looks", "lying", "me",
    "moment", "morning", "near", "need", "now", "number", "of", "ok", "okay", "on", "one", "or", "out", "over", "parked",
    "place", "places", "please", "positions", "presently", "preset", "presets", "question", "quick", "report", "right", "s",
    "say", "see", "settle", "shows", "sitting", "so", "stand", "standing", "stands", "tell", "that", "the", "them", "then",
    "there", "these", "think", "this", "those", "to", "today", "tonight", "two", "up", "us", "versus", "view", "views", "vs",
    "waiting", "want", "we", "where", "whether", "which", "who", "whose", "with", "wonder", "wondering", "worse", "would",
    "you",
})  # fmt: skip
"""Words that may surround a comparison without changing its meaning."""

_LAST_CLAUSE = re.compile(r"[,.;?!]+ +(?P<last>[^,.;?!]+)[.!]*$")

_GOES_THERE = re.compile(
    r"(?:[,.;?!] *|(?<=\w) )(?:then |and |and then )?(?:please )?(?:go|move|switch|head) (?:over )?"
    r"(?:there|to (?:it|that one))\W*$",
    re.IGNORECASE,
)


def with_presets_compared(text: str, names: str) -> str:
    """Return a comparison of presets in the standard form, and any other text unchanged.

    Args:
        text: The text of an instruction.
        names: A pattern for the names of the presets.
    """
    place = rf"(?:the )?(?P<{{}}>{names})"
    counted = rf"compare (?:the )?number of (?P<what>[\w ]+?) (?:at|in|on) {place.format('one')} (?:with|and|to|against|vs)"
    if both := re.fullmatch(rf"{counted} (?:that )?(?:at |in |on )?{place.format('other')}\W*", text, re.IGNORECASE):
        return f"which has more {both['what']}, {both['one']} or {both['other']}?"
    goes = _GOES_THERE.search(text)
    asked = text[: goes.start()] if goes else text
    if (ending := _LAST_CLAUSE.search(asked)) is not None and not re.search(rf"\b(?:{names})\b", ending["last"], re.IGNORECASE):
        asked = asked[: ending.start()] if is_remark(ending["last"], ()) else asked  # "..., one of the drivers is asking"
    found = list(re.finditer(rf"\b(?:{names})\b", asked, re.IGNORECASE))
    compared = _COMPARED.search(re.sub(rf"\b(?:{names})\b", lambda match: "," * len(match[0]), asked, flags=re.IGNORECASE))
    asks = re.search(r"\b(?:which|what|where|who)\b", asked, re.IGNORECASE) is not None
    compares_all = asks and len(found) > 2 and compared is not None and compared["how"].lower() in _SUPERLATIVES
    if compared is None or len({match[0].lower() for match in found}) != len(found) or not (len(found) == 2 or compares_all):
        return text
    between = asked[found[0].end() : found[-1].start()]
    link = r"," if compares_all else r"\b(?:or|and|vs|versus|than|with|against)\b"
    if not re.search(link, between, re.IGNORECASE) or re.search(r"[.;!]", between):
        return text
    what = _STOP.split(compared["what"])[0].strip()
    if not what:
        return text
    start = compared.start("what") + compared["what"].index(what)
    how = compared["how"].lower()
    rest = _without_spans(asked, [(start, start + len(what)), *(match.span() for match in found)])
    if re.search(r"\d", rest) or set(re.findall(r"[^\W\d_]+", rest.lower())) - _FUNCTION_WORDS - set(how.split()):
        return text
    comparison = "fewer" if how in _FEWER else "more"
    if compares_all:
        comparison = "the fewest" if how in _FEWER else "the most"
    return f"which has {comparison} {what}, {listing([match[0] for match in found], 'or')}?{' go there' if goes else ''}"


def _without_spans(text: str, spans: Sequence[tuple[int, int]]) -> str:
    """Return a text with spaces in place of the characters in the given spans."""
    for start, end in spans:
        text = text[:start] + " " * (end - start) + text[end:]
    return text
