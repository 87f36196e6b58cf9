"""Reading whether something is so, and whether there is any of it."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.bench.answers.counts import is_miscounted, parse_number
from scope_ptz.bench.answers.denials import denies_flatly, says_none, says_yes
from scope_ptz.bench.answers.halves import leaves_the_half_open
from scope_ptz.bench.answers.numbers import find_numbers
from scope_ptz.bench.answers.parsed import ParsedAnswer, ParsedValue, Unreadable
from scope_ptz.bench.answers.text import AnswerText, NameMention
from scope_ptz.bench.answers.tokenizer import plain_words
from scope_ptz.bench.tasks.expected import NoneThere, YesNo

_YES = frozenset({"yes", "yeah", "yep", "yup", "correct", "affirmative", "true", "indeed"})
_NO = frozenset({"no", "nope", "nah", "negative", "false", "incorrect"})
_NO_LAST = frozenset({"no", "nope", "nah"})
"""At the end of a piece they deny nothing that follows: "I say no", "it is a no"."""


def verdict_words(script: AnswerText) -> set[bool]:
    """The yes and no that stand by themselves: at the beginning before a comma, or as a whole clause."""
    said = {True} if says_yes(script) else set[bool]()
    for group in script.segments():
        words = [script.words[i].text for i in group]
        alone = len(words) == 1 or (group[0] == 0 and words[0] in ("yes", "yeah", "yep", "indeed"))
        if alone and words[0] in _YES:
            said.add(True)
        if len(words) == 1 and words[0] in _NO:
            said.add(False)
        if words[-1] in _NO_LAST or words == ["not"]:
            said |= {False, "not" in words[:-1]}
    said |= {word == "yes" for word in re.findall(r"\b(?:answer|verdict) is (?:a clear )?(yes|no)\b", script.text())}
    if re.search(r"\b(yes|no) (and |or )?(yes|no)\b", script.text()) or "not yes" in script.text():
        return {True, False}
    return said


_ELLIPSIS = re.compile(
    r"^((yes|no|and|so|but|indeed|well) )*(it|they|this|that|these|those|there) (really |actually |certainly |definitely )?"
    r"(?P<verb>is|are|was|were|does|do|did|has|have)(?P<not> not)?( (the case|so|true|correct|right|actually|at all|indeed))*$"
)
_REFUTED = re.compile(r"^((and|so|but) )*(it|this|that|the (claim|statement)) (is|was) (false|untrue|incorrect|wrong)$")


def _short_answers(script: AnswerText) -> set[bool]:
    """ "It is not.", "They do.", "That is not the case." """
    said = set[bool]()
    for group in script.segments():
        piece = _text_of(script, group)
        if match := _ELLIPSIS.match(piece):
            said.add(match["not"] is None)
        elif _REFUTED.match(piece):
            said.add(False)
    return said


def parse_yes_no(expected: YesNo, script: AnswerText) -> ParsedAnswer:
    """A bare yes or no, and what is stated about the thing; they must not contradict each other."""
    said = verdict_words(script) | _short_answers(script)
    if not said and leaves_the_half_open(script, expected.affirms):
        return Unreadable("of which half it is told may not be what is asked")
    mentions = script.mentions({"yes": expected.affirms, "no": expected.denies})
    stated = {(mention.name == "yes") != (mention.denied or mention.aside) for mention in mentions}
    if len(stated) == 2 and len(said) == 1 and (last := script.segments()[-1:]) and _CONCLUDED.match(_text_of(script, last[0])):
        return ParsedValue(said.pop())  # "At the gate: no van. At the works: 1 van. So yes."
    said |= stated
    if not said and says_none(script):
        said = {False}
    if denies_flatly(script, ()) and True in said:
        said.add(False)
    for clause in script.clauses():
        if re.search(r"\bthere (is|are) (none|not any)( here| there| visible| in view)?$", _text_of(script, clause)):
            said.add(False)
    if len(said) == 1:
        return ParsedValue(said.pop())
    return Unreadable("both yes and no" if said else "neither yes nor no")


_CONCLUDED = re.compile(r"^(so|therefore|thus|hence|overall) (the answer is |it is )?(yes|no)$")


def _text_of(script: AnswerText, group: Sequence[int]) -> str:
    return " ".join(script.words[i].text for i in group)


def parse_none_there(expected: NoneThere, script: AnswerText) -> ParsedAnswer:
    """True when the answer says that there is none and nothing that is only said of one that is there; False when there is one."""
    if re.search(r"\b(none|no|nothing|zero|0) or (one|two|some|several|a few|1|2)\b", script.text()):
        return Unreadable("an alternative")
    said = says_that_none(script, expected.subject)
    if not verdict_words(script) and leaves_the_half_open(script, expected.subject):
        return Unreadable("of which half it is told may not be what is asked")
    if True in said and (_counts_some(script, expected.subject) or _claims(script, expected)):
        said = {True, False}
    if len(said) == 1:
        return ParsedValue(said.pop())
    return Unreadable(
        "both that there is one and that there is none" if said else "neither that there is one nor that there is none"
    )


def says_that_none(script: AnswerText, subject: Sequence[str]) -> set[bool]:
    """True: somewhere the text says that there is none; False: that there is one."""
    mentions = script.mentions({"subject": subject})
    said = {not v for v in verdict_words(script)}
    mentions = [m for m in mentions if m.denied or not _is_another(script, m, subject)]
    said |= {m.denied for m in mentions if not (m.aside or (m.denied and _is_partial(script, m, subject)))}
    numbers = [q for q in find_numbers(script, subject) if not (q.other or q.bound or q.denied)]
    said |= {q.value == 0 for q in numbers if not mentions or q.value == 0}
    if says_none(script):
        said.add(True)
    return said


def _is_another(script: AnswerText, mention: NameMention, subject: Sequence[str]) -> bool:
    """ "The only van is red", where green vans are asked after: it is said of one that is not meant."""
    before = script.words[max(0, mention.start - 1) : mention.start]
    is_short = mention.end - mention.start < len(plain_words(subject[0]))
    return is_short and any(w.text in ("only", "other") for w in before)


def _is_partial(script: AnswerText, mention: NameMention, subject: Sequence[str]) -> bool:
    """ "No kite is in the other quarters", "not 5 kites": that does not say that there is none."""
    clause = script.words[mention.start].clause
    after = " ".join(w.text for w in script.words[mention.end : mention.end + 8] if w.clause == clause)
    elsewhere = re.match(r"(\w+ ){0,4}?((in|at|on|from|of) (the|any) others?|elsewhere)\b", after)
    return elsewhere is not None or is_miscounted(script, mention, subject)


def _counts_some(script: AnswerText, subject: Sequence[str]) -> bool:
    """Whether a number above zero is told that could count what is said not to be there."""
    number = parse_number(script, subject)
    some = isinstance(number, float) and number > 0
    return some or any(q.value > 0 and not (q.other or q.denied) for q in find_numbers(script, subject))


def _claims(script: AnswerText, expected: NoneThere) -> bool:
    """Whether something is stated that could only be said of one that is there; said of a named other thing it is no such claim."""
    mentions = script.mentions({"claim": expected.claims, "subject": expected.subject})
    denials = [m for m in mentions if m.name == "subject" and m.denied]
    return any(
        not (m.denied or m.aside or _is_of_another(script, m) or any(_is_where(script, m, denial) for denial in denials))
        for m in mentions
        if m.name == "claim"
    )


def _is_of_another(script: AnswerText, claim: NameMention) -> bool:
    """ "A green van", "a van stands top left": something else is named in the piece."""
    segment = script.words[claim.start].segment
    before = "".join(f"{w.text} " for w in script.words[: claim.start] if w.segment == segment)
    if _ANOTHER.search(before) and not _ITS_OWN.search(before):
        return True
    after = script.words[claim.end : claim.end + 1]
    if not after or after[0].segment != script.words[claim.end - 1].segment or re.search(r"[^\s-]", after[0].gap):
        return False
    return not (after[0].text in _OF_THE_SUBJECT or after[0].text.endswith("ly"))


def _is_where(script: AnswerText, claim: NameMention, denial: NameMention) -> bool:
    """Whether a claim tells where or of which the denial is: "top left: no kite", "the kite is absent from the top left"."""
    words, between = script.words, script.words[min(claim.end, denial.end) : max(claim.start, denial.start)]
    if claim.start < denial.start and words[claim.end].gap.strip() == ":" and words[claim.end].clause == words[denial.start].clause:
        return True
    one_piece = words[claim.start].segment == words[denial.start].segment
    return one_piece and not any(w.text in _GOES_ON for w in (between if claim.start > denial.start else ()))


_ANOTHER = re.compile(r"\b(an?|two|three|four|five|some|several) (\w+ ){2,}")
_ITS_OWN = re.compile(r"\b(it|its|they|this|that|one|ones|thing|object|colour|shade|hue|tone|tint)\b")
_GOES_ON = frozenset({"it", "they", "this", "that", "but", "and", "so", "its"})
_OF_THE_SUBJECT = frozenset({
    "one", "ones", "thing", "things", "object", "item", "colour", "coloured", "shade", "in", "on", "at", "of", "and", "or",
    "is", "are", "was", "it", "they", "the", "a", "an", "to", "with", "by", "too", "also", "indeed", "overall", "then",
    "though", "however", "here", "there", "now", "so", "as", "for", "corner", "quarter", "quadrant", "side", "part", "half",
    "hand", "area", "region", "section", "from", "instead", "again", "please", "answer", "anyway", "i", "visible", "looking",
})  # fmt: skip
"""What may follow a claim without making it another thing's."""
