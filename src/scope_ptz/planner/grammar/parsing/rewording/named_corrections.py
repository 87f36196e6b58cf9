"""Put corrections that name what is meant into one form: "zoom in. out, I mean" becomes "zoom in, I mean out".

Speakers correct themselves in many ways ("what I meant was the silos", "silos rather", "I'd prefer the silos", "by yard I mean the
silos", "up, not left"). In each of them, the words for what is meant stand beside words that say that it is a correction. Only
corrections at the end of an instruction are read. ``repairs`` then replaces the part that is corrected. If it cannot, the
instruction must not be carried out: what is meant instead would become a second step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scope_ptz.planner.grammar.lexing.lexer import Lexeme, lexemes_of
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, MOTION_VERBS
from scope_ptz.planner.grammar.parsing.parts.patterns import Match, full_match, search
from scope_ptz.planner.grammar.parsing.rewording.contractions import with_contractions
from scope_ptz.planner.grammar.parsing.rewording.phrases import reworded
from scope_ptz.planner.grammar.parsing.rewording.repairs import repaired

_PAUSES = ("STOP", "COMMA", "DASH", "COLON")
_OPENERS = "((?!i_mean|i_meant|rather) FILLER|BUT|COMMA|DASH|no|nah|wait|sorry|actually|well)*"
_MEAN = "(i_mean|i_meant|i_do_mean|SELF (do|DOV)? (mean|meant|intended))"
_WANT = "(i_want|i_need|i_would_like|i_would_prefer|i_am_after|SELF (want|wanted|need|needed|prefer|preferred|BE after))"
_NEW = "(?P<new>((?!STOP|QUESTION) _){1,6}?)"
_OLD = "(?P<old>(?!STOP) _{1,4}?)"
_WAY = "(LEFT|RIGHT|UP|DOWN|IN|OUT)"
_IT_IS = "(it|that|this) BE"
_SORRY = "(excuse_me|pardon_me|i_beg_your_pardon)"
_FORMS = (
    # what is meant comes first
    f"{_NEW} COMMA? {_MEAN}",
    f"{_NEW} BE what ({_MEAN}|{_WANT})",
    f"{_NEW} COMMA? (OR)? rather",
    f"(?P<new>(ZOOM-ING|PAN-ING|TILT-ING|TURN-ING) {_WAY} (LITTLE|LOT)?) (MODAL|would) be (better|best|preferable|nicer)",
    f"(?P<new>{_WAY}) COMMA? (not|instead_of|rather_than) (?P<denied>{_WAY})",
    # the correction comes first
    f"what ({_MEAN}|{_WANT}) BE {_NEW}",
    f"by (DET)? {_OLD} {_MEAN} {_NEW}",
    f"(for|instead_of) (DET)? {_OLD} (READ|READ-ED|read) {_NEW}",
    f"(READ|read) {_NEW} (for|instead_of) (DET)? {_OLD}",
    f"i_would_prefer {_NEW}",
    f"(?P<aside>{_IT_IS}) (really|actually|in_fact|FILLER)* (?P<new>DET _{{1,5}}?) (that)? {_WANT}",
    f"{_IT_IS} (not|not_a|NOT DET|NONE) {_OLD} COMMA (BUT)? {_IT_IS} (?P<new>DET _{{1,5}}?)",
    f"(i_said|SELF (said|TELL-ED|wrote|typed)) {_OLD} (COMMA)? (BUT|when|though|AND)? ({_MEAN}|{_WANT}) {_NEW}",
    f"(i_should|SELF (should|MODAL)) have (said|TELL-ED|meant|typed|put|written) {_NEW}",
    "(it|that|this)? (should|ought to|must) (be|have been|have said|read|say) "
    f"(?P<new>DET? (NUM (DEG|X|PERCENT|SECONDS)?|{_WAY}|PRESET))",
    f"{_SORRY} COMMA? (?P<new>(to|at|DET)* PRESET)|(?P<new>(to|at|DET)* PRESET) COMMA? {_SORRY}",
)
_COMMANDS = (*MOTION_VERBS, *DIRECTIONS, "IN", "OUT", "PRESET", "TRACK", "FIND", "SHOW", "SWITCH", "HOME")
_ASKING = ("COUNT", "HOWMANY", "COUNTNOUN", "READ", "TELL", "DESCRIBE", "BE", "LISTING", "QUESTION")
"""Classes of words of counts and questions. What comes after them is often a remark: "count the staff, should be four"."""

_OWNERS = frozenset({"its", "his", "her", "their"})
_RELATIVE_AMOUNTS = ("DOUBLE", "TWICE", "TRIPLE", "THRICE", "HALVE", "FRACTION", "MORE", "SAMEAMOUNT")


@dataclass(frozen=True, slots=True)
class _Correction:
    """A correction at the end of a text.

    Attributes:
        start: The index in the text after the last word before the correction.
        new: The words for what is meant.
        may_be_remark: Whether it may be a remark instead, as after a count, or in "zoom in, it's the sign I'm after".
    """

    start: int
    new: tuple[Lexeme, ...]
    may_be_remark: bool


def with_corrections_in_form(text: str, presets: tuple[str, ...]) -> str:
    """Return a text with the correction at its end as ", I mean ..."; other texts are unchanged."""
    found = _correction(lexemes_of(text, presets))
    if found is None:
        return text
    meant = _in_form(text, found)
    return text if found.may_be_remark and not _is_applied(meant, presets) else meant


def unresolved_correction(text: str, presets: tuple[str, ...]) -> str | None:
    """Return the words at the end of a text that correct it if it is unclear what they replace; None if there are none."""
    found = _correction(lexemes_of(text, presets))
    if found is None or found.may_be_remark:
        return None
    is_relative = found.new[0].word in _OWNERS or any(x.has(*_RELATIVE_AMOUNTS) for x in found.new)
    if not is_relative and _is_applied(_in_form(text, found), presets):
        return None
    return text[found.start :].strip(" ,.;:-–—!")


def _is_applied(text: str, presets: tuple[str, ...]) -> bool:
    """Return whether a repair replaces the words before ", I mean ..."."""
    said = repaired(with_contractions(reworded(lexemes_of(text, presets))), text)
    return search("i_mean", said.lexemes) is None


def _correction(lexemes: Sequence[Lexeme]) -> _Correction | None:
    """Return the correction at the end of an instruction; None if there is none."""
    last = len(lexemes)
    while last and lexemes[last - 1].has("STOP"):
        last -= 1
    command = next((i for i, x in enumerate(lexemes[:last]) if x.has(*_COMMANDS, *_ASKING)), last)
    for i in range(command + 1, last - 1):
        if not lexemes[i].has(*_PAUSES):
            continue
        before = lexemes[:i]
        for form in _FORMS:
            match = full_match(f"{_OPENERS} ({form}) FILLER*", lexemes[i + 1 : last])
            if match is not None and _fits(match, before):
                may_be_remark = match.has("aside") or any(x.has(*_ASKING) for x in before)
                return _Correction(before[-1].end, tuple(match["new"]), may_be_remark)
    return None


def _fits(match: Match, before: Sequence[Lexeme]) -> bool:
    """Return whether the words that a correction says were wrong occur in the command before it."""
    words = {x.word for x in before}
    if match.has("denied"):
        return match["denied"][0].word in words and match["new"][0].word not in words
    named = [x for x in match["old"] if not x.has("DET")] if match.has("old") else []
    return all(x.word in words for x in named)


def _in_form(text: str, found: _Correction) -> str:
    """Return a text with a correction as ", I mean ...", and "zoom in" for "zooming in" in it."""
    new = found.new
    said = text[new[0].start : new[-1].end]
    verb = next((name for name in ("ZOOM", "PAN", "TILT", "TURN") if new[0].has(f"{name}-ING")), None)
    plain = said if verb is None else f"{verb.lower()}{text[new[0].end : new[-1].end]}"
    return f"{text[: found.start]}, I mean {plain}"
