"""Parse yes-or-no answers, and answers about whether something is present."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.bench.answers.counts import is_only_number_denied, parse_number
from scope_ptz.bench.answers.denials import denies_entirely, says_none, says_yes
from scope_ptz.bench.answers.halves import is_half_unclear
from scope_ptz.bench.answers.numbers import find_numbers
from scope_ptz.bench.answers.parsed import ParsedAnswer, ParsedValue, Unreadable
from scope_ptz.bench.answers.text import AnswerText, NameMention
from scope_ptz.bench.answers.tokenizer import plain_words
from scope_ptz.bench.tasks.expected import NoneThere, YesNo

_YES = frozenset({"yes", "yeah", "yep", "yup", "correct", "affirmative", "true", "indeed"})
"""Words that mean yes if they are the whole segment."""
_NO = frozenset({"no", "nope", "nah", "negative", "false", "incorrect"})
"""Words that mean no if they are the whole segment."""
_NO_AT_END = frozenset({"no", "nope", "nah"})
"""Words that mean no at the end of a segment, as in "I say no" and "it is a no"."""


def yes_no_verdicts(text: AnswerText) -> set[bool]:
    """Return the verdicts that words such as "yes" and "no" give: True, False, or both if the answer contradicts itself.

    "No" counts only as a whole segment or at the end of one, because elsewhere it denies a thing ("no cones").
    """
    verdicts = {True} if says_yes(text) else set[bool]()
    for group in text.segments():
        words = [text.words[i].text for i in group]
        alone = len(words) == 1 or (group[0] == 0 and words[0] in ("yes", "yeah", "yep", "indeed"))
        if alone and words[0] in _YES:
            verdicts.add(True)
        if len(words) == 1 and words[0] in _NO:
            verdicts.add(False)
        if words[-1] in _NO_AT_END or words == ["not"]:
            verdicts |= {False, "not" in words[:-1]}
    verdicts |= {word == "yes" for word in re.findall(r"\b(?:answer|verdict) is (?:a clear )?(yes|no)\b", text.plain_text())}
    if re.search(r"\b(yes|no) (and |or )?(yes|no)\b", text.plain_text()) or "not yes" in text.plain_text():
        return {True, False}
    return verdicts


_ELLIPSIS = re.compile(
    r"^((yes|no|and|so|but|indeed|well) )*(it|they|this|that|these|those|there) (really |actually |certainly |definitely )?"
    r"(?P<verb>is|are|was|were|does|do|did|has|have)(?P<not> not)?( (the case|so|true|correct|right|actually|at all|indeed))*$"
)
"""Short answers that omit what they confirm or deny, such as "it is" and "they do not"."""
_REFUTATION = re.compile(r"^((and|so|but) )*(it|this|that|the (claim|statement)) (is|was) (false|untrue|incorrect|wrong)$")
"""Statements that a claim is false."""


def _short_answer_verdicts(text: AnswerText) -> set[bool]:
    """Return the verdicts of short answers, such as "It is not." and "They do."."""
    verdicts = set[bool]()
    for group in text.segments():
        piece = _text_of(text, group)
        if match := _ELLIPSIS.match(piece):
            verdicts.add(match["not"] is None)
            verdicts |= {word == "yes" for word in piece.split() if word in ("yes", "no")}  # "No that is" contradicts itself
        elif _REFUTATION.match(piece):
            verdicts.add(False)
    return verdicts


def parse_yes_no(expected: YesNo, text: AnswerText) -> ParsedAnswer:
    """Parse an answer as yes or no, based on words such as "yes" and on statements. Contradictory answers are unreadable."""
    verdicts = yes_no_verdicts(text) | _short_answer_verdicts(text)
    if not verdicts and is_half_unclear(text, expected.affirms):
        return Unreadable("it is about one half of the picture, perhaps not the one that was asked about")
    mentions = text.mentions({"yes": expected.affirms, "no": expected.denies})
    stated = {(mention.name == "yes") != (mention.denied or mention.contrast) for mention in mentions}
    if len(stated) == 2 and len(verdicts) == 1 and (last := text.segments()[-1:]) and _CONCLUSION.match(_text_of(text, last[0])):
        return ParsedValue(verdicts.pop())  # "At the gate: no van. At the works: 1 van. So yes."
    verdicts |= stated
    if not verdicts and says_none(text):
        verdicts = {False}
    if denies_entirely(text, ()) and True in verdicts:
        verdicts.add(False)
    for clause in text.clauses():
        if re.search(r"\bthere (is|are) (none|not any)( here| there| visible| in view)?$", _text_of(text, clause)):
            verdicts.add(False)
    if len(verdicts) == 1:
        return ParsedValue(verdicts.pop())
    return Unreadable("both yes and no" if verdicts else "neither yes nor no")


_CONCLUSION = re.compile(r"^(so|therefore|thus|hence|overall) (the answer is |it is )?(yes|no)$")
"""A final segment that states a conclusion, such as "so yes"."""


def _text_of(text: AnswerText, group: Sequence[int]) -> str:
    return " ".join(text.words[i].text for i in group)


def parse_none_there(expected: NoneThere, text: AnswerText) -> ParsedAnswer:
    """Parse an answer to a question about something that is not there.

    The value is True if the answer says that there is none and does not also describe the thing, for example by a colour. It is
    False if the answer says that there is one.
    """
    if re.search(r"\b(none|no|nothing|zero|0) or (one|two|some|several|a few|1|2)\b", text.plain_text()):
        return Unreadable("it states alternatives")
    verdicts = absence_verdicts(text, expected.subject)
    if not yes_no_verdicts(text) and is_half_unclear(text, expected.subject):
        return Unreadable("it is about one half of the picture, perhaps not the one that was asked about")
    if True in verdicts and (_states_count(text, expected.subject) or _states_claim(text, expected)):
        verdicts = {True, False}
    if len(verdicts) == 1:
        return ParsedValue(verdicts.pop())
    return Unreadable(
        "both that there is one and that there is none" if verdicts else "neither that there is one nor that there is none"
    )


def absence_verdicts(text: AnswerText, subject: Sequence[str]) -> set[bool]:
    """Return the verdicts on the absence of the subject: True for "there is none", False for "there is one", or both."""
    mentions = text.mentions({"subject": subject})
    verdicts = {not v for v in yes_no_verdicts(text)}
    mentions = [m for m in mentions if m.denied or not _refers_to_something_else(text, m, subject)]
    verdicts |= {m.denied for m in mentions if not (m.contrast or (m.denied and _is_partial_denial(text, m, subject)))}
    numbers = [q for q in find_numbers(text, subject) if not (q.counts_other or q.bound or q.denied)]
    verdicts |= {q.value == 0 for q in numbers if not mentions or q.value == 0}
    if says_none(text):
        verdicts.add(True)
    return verdicts


def _refers_to_something_else(text: AnswerText, mention: NameMention, subject: Sequence[str]) -> bool:
    """Return whether a mention refers to something else, as in "the only van is red" if the question is about green vans."""
    before = text.words[max(0, mention.start - 1) : mention.start]
    is_short = mention.end - mention.start < len(plain_words(subject[0]))
    return is_short and any(w.text in ("only", "other") for w in before)


def _is_partial_denial(text: AnswerText, mention: NameMention, subject: Sequence[str]) -> bool:
    """Return whether a denial is limited to a place or a number, as in "no kite is in the other quarters" and "not 5 kites"."""
    clause = text.words[mention.start].clause
    after = " ".join(w.text for w in text.words[mention.end : mention.end + 8] if w.clause == clause)
    elsewhere = re.match(r"(\w+ ){0,4}?((in|at|on|from|of) (the|any) others?|elsewhere)\b", after)
    return elsewhere is not None or is_only_number_denied(text, mention, subject)


def _states_count(text: AnswerText, subject: Sequence[str]) -> bool:
    """Return whether an answer states a number above zero that could count the subject."""
    number = parse_number(text, subject)
    some = isinstance(number, float) and number > 0
    return some or any(q.value > 0 and not (q.counts_other or q.denied) for q in find_numbers(text, subject))


def _states_claim(text: AnswerText, expected: NoneThere) -> bool:
    """Return whether an answer states a property that only a visible subject can have, such as its colour."""
    mentions = text.mentions({"claim": expected.claims, "subject": expected.subject})
    denials = [m for m in mentions if m.name == "subject" and m.denied]
    return any(
        not (
            m.denied
            or m.contrast
            or _describes_something_else(text, m)
            or any(_limits_denial(text, m, denial) for denial in denials)
        )
        for m in mentions
        if m.name == "claim"
    )


def _describes_something_else(text: AnswerText, claim: NameMention) -> bool:
    """Return whether a claim describes something else in the same segment, as in "a green van" and "a van stands top left"."""
    segment = text.words[claim.start].segment
    before = "".join(f"{w.text} " for w in text.words[: claim.start] if w.segment == segment)
    if _SOMETHING_ELSE.search(before) and not _REFERS_TO_SUBJECT.search(before):
        return True
    after = text.words[claim.end : claim.end + 1]
    if not after or after[0].segment != text.words[claim.end - 1].segment or re.search(r"[^\s-]", after[0].gap):
        return False
    return not (after[0].text in _WORDS_AFTER_CLAIM or after[0].text.endswith("ly"))


def _limits_denial(text: AnswerText, claim: NameMention, denial: NameMention) -> bool:
    """Return whether a claim only states where the denial applies, as in "top left: no kite"."""
    words, between = text.words, text.words[min(claim.end, denial.end) : max(claim.start, denial.start)]
    if claim.start < denial.start and words[claim.end].gap.strip() == ":" and words[claim.end].clause == words[denial.start].clause:
        return True
    same_segment = words[claim.start].segment == words[denial.start].segment
    return same_segment and not any(w.text in _NEW_STATEMENT_WORDS for w in (between if claim.start > denial.start else ()))


_SOMETHING_ELSE = re.compile(r"\b(an?|two|three|four|five|some|several) (\w+ ){2,}")
"""Words before a claim that introduce something else, such as "a van stands" in "a van stands top left"."""
_REFERS_TO_SUBJECT = re.compile(r"\b(it|its|they|this|that|one|ones|thing|object|colour|shade|hue|tone|tint)\b")
"""Words that refer to the subject, so that the claim after them is about it."""
_NEW_STATEMENT_WORDS = frozenset({"it", "they", "this", "that", "but", "and", "so", "its"})
"""Words between a denial and a claim that begin a new statement."""
_WORDS_AFTER_CLAIM = frozenset({
    "one", "ones", "thing", "things", "object", "item", "colour", "coloured", "shade", "in", "on", "at", "of", "and", "or",
    "is", "are", "was", "it", "they", "the", "a", "an", "to", "with", "by", "too", "also", "indeed", "overall", "then",
    "though", "however", "here", "there", "now", "so", "as", "for", "corner", "quarter", "quadrant", "side", "part", "half",
    "hand", "area", "region", "section", "from", "instead", "again", "please", "answer", "anyway", "i", "visible", "looking",
})  # fmt: skip
"""Words that may follow a claim without naming anything else."""
