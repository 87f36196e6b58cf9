"""Shorter versions of an instruction that was not understood: without the segments that the model takes for remarks."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.parsing.asides import may_withdraw
from scope_ptz.planner.grammar.parsing.parts.clause import VERBS
from scope_ptz.planner.grammar.parsing.parts.statements import is_statement
from scope_ptz.planner.grammar.parsing.remark_detection.features import features_of
from scope_ptz.planner.grammar.parsing.remark_detection.model import remark_model
from scope_ptz.planner.grammar.parsing.remark_detection.remark_forms import SUBJECT
from scope_ptz.planner.grammar.parsing.remark_detection.segments import Segment, segments_of
from scope_ptz.planner.grammar.parsing.remark_detection.shorter_versions import (
    MAX_SHORTENED_CHARS,
    UNFINISHED,
    is_amount,
    opens_request,
    refers_back,
)
from scope_ptz.planner.grammar.parsing.remark_detection.surrounding_remarks import AT_AN_END, WITHDRAWAL

_MAX_SEGMENTS = 12
_MAX_VERSIONS = 8
_MIN_LOG_ODDS = 0.0
_MIN_WORDS = 2
_MIN_STATEMENT_WORDS = 4  # shorter statements may be about what was said before them: "pan left 20, Sarah objected"

_NEGATED_STATEMENT = re.compile(
    rf"^(?:{SUBJECT})\b(?! (?:don['’]?t|do not|didn['’]?t) (?:want|need|mean))"
    r".*?\b(?:not|never|\w+n['’]t|cannot)\b",
    re.IGNORECASE,
)
"""A statement with a negation, which forbids nothing: "they haven't signed the form"."""

_EVENT = re.compile(r"^(?:before|after) (?:i|we|he|she|they|it|the|my|our|someone|\w+ \w+s)\b", re.IGNORECASE)
"""The beginning of a clause about a time: "before the boss comes"."""

_TAKING_BACK = re.compile(
    rf"{AT_AN_END}|\b(?:that|this|for it)\W*$|\bfor the other\b|\bbetter\b|\bstays?\b"
    rf"|\b(?:{WITHDRAWAL}|jokes?|called (?:it|that|this) off|(?:never|not) to|nobody (?:wants|needs)"
    r"|(?:it|that|this) (?:should|must|ought|has to|needs)"
    r"|(?:is|are|was)(?:n['’]t| not) (?:needed|necessary))\b",
    re.IGNORECASE,
)
"""Words with which a statement may take something back, or ask for something else: "it should be lower", "belay that"."""

_RULE_FOR_OTHERS = re.compile(
    r"^(?:they|he|she)(?:['’](?:s|re) not| (?:is|are|was|were)(?: not|n['’]t)) (?:supposed|meant) to\b",
    re.IGNORECASE,
)
"""What other people must not do, which forbids the camera nothing: "they're not supposed to park there"."""

_EMBEDDED_QUESTION = re.compile(
    r"^(?:(?:i|we)(?:['’]d)?|would) (?:\w+ ){0,3}(?:know|learn|find out|see|hear|be told) (?:how|what|which|who|whose"
    r"|where|if|whether)\b",
    re.IGNORECASE,
)
"""The beginning of a question in the form of a statement: "I need to know which words are on the board"."""

_BINDING = re.compile(
    r"\b(?:don['’]?t|do not|not|no|never|nor|without|instead|unless|if|when(?! you (?:get|have|can))|until|till|otherwise|else"
    r"|whichever|either|only|except|rather|wait|actually|cancel|forget|ignore|scratch|stop|mind|mean|first|then|next|before|after"
    r"|than|same|both|each|every|again|whole|entire|full|everywhere|anywhere|(?:last|that|this|other) one|lot|bit|touch|twice"
    r"|zoom|pan|tilt)\b",
    re.IGNORECASE,
)
"""Words with which a segment may change what the others ask for, so that it must not be left out."""


def versions_without_remarks(text: str, presets: tuple[str, ...]) -> Iterator[str]:
    """Yield shorter versions of an instruction: first without the likeliest remark, then without the two likeliest, and so on.

    What is kept must be complete, and must not refer to what was left out ("there is a van by the fence, follow it").
    """
    segments = segments_of(text) if len(text) <= MAX_SHORTENED_CHARS else ()
    if not 1 < len(segments) <= _MAX_SEGMENTS:
        return
    log_odds = {
        index: remark_model().log_odds(features_of(segments, index, presets))
        for index, segment in enumerate(segments)
        if not (_is_binding(segment.text, presets) or _is_short_comment(segments, index))
    }
    remarks = sorted((index for index, value in log_odds.items() if value > _MIN_LOG_ODDS), key=lambda index: -log_odds[index])
    left_out = [remarks[:size] for size in range(1, len(remarks) + 1)] + [[index] for index in remarks[1:]]
    for indices in left_out[:_MAX_VERSIONS]:
        version = _without(segments, frozenset(indices), presets)
        if version is not None:
            yield version


def _is_binding(text: str, presets: tuple[str, ...]) -> bool:
    """Return whether a segment begins with a command or asks, or may restrict, forbid, repeat or take back something."""
    first = next((lexeme for lexeme in lexemes_of(text, presets) if not lexeme.has("FILLER", "AND", "BUT")), None)
    if first is not None and (first.has(*VERBS, "TELL", "HOWMANY") or first.word == "of"):
        return True  # "one picture, only one, of the van"
    if _TAKING_BACK.search(text) is not None or _EMBEDDED_QUESTION.match(text) is not None:
        return True
    if may_withdraw(lexemes_of(text)) and _RULE_FOR_OTHERS.match(text) is None:
        return True
    if (negated := _NEGATED_STATEMENT.match(text)) is not None:
        text = text[negated.end() :]
    elif (event := _EVENT.match(text)) is not None:
        text = text[event.end() :]
    return _BINDING.search(text) is not None


def _is_short_comment(segments: Sequence[Segment], index: int) -> bool:
    """Return whether a segment is a short statement after others, so that it may be about them: "Sarah objected"."""
    text = segments[index].text
    return index > 0 and len(text.split()) < _MIN_STATEMENT_WORDS and is_statement(lexemes_of(text))


def _without(segments: Sequence[Segment], left_out: frozenset[int], presets: tuple[str, ...]) -> str | None:
    """Return an instruction without some of its segments; None if the rest is incomplete or refers to them."""
    kept = [index for index in range(len(segments)) if index not in left_out]
    said = " ".join(segments[index].text for index in kept)
    if len(said.split()) < _MIN_WORDS or is_amount(said, " ".join(segments[index].text for index in sorted(left_out))):
        return None
    for index in kept:
        own = segments[index].text
        if index + 1 in left_out and UNFINISHED.search(own) is not None:
            return None
        if index - 1 in left_out:
            follows_mark = segments[index - 1].mark != ""
            if refers_back(own) or not (follows_mark or opens_request(own, presets)):
                return None
    following = [*kept[1:], len(segments)]
    parts = [segments[i].text + _strongest_mark(segments[i:after]) for i, after in zip(kept, following, strict=True)]
    return " ".join(parts).strip(" ,;:-–—")


def _strongest_mark(segments: Sequence[Segment]) -> str:
    """Return the mark that separates what comes before some segments from what comes after: one that ends a sentence, if any."""
    marks = [segment.mark for segment in segments if segment.mark]
    mark = next((mark for mark in marks if set(mark) & set(".!?;")), marks[0] if marks else "")
    return f" {mark}" if mark[:1] in {"-", "–", "—"} else mark
