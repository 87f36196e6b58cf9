"""Parse answers that name things: one of several options, a set of names, or the facts of a description."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from scope_ptz.bench.answers.comparisons import comparatives_by_direction, described_thing, find_comparatives, reference_of
from scope_ptz.bench.answers.denials import says_none, says_yes
from scope_ptz.bench.answers.numbers import find_numbers
from scope_ptz.bench.answers.options import option_mentions
from scope_ptz.bench.answers.parsed import ParsedAnswer, ParsedValue, Unreadable
from scope_ptz.bench.answers.presence import absence_verdicts
from scope_ptz.bench.answers.text import AnswerText, NameMention
from scope_ptz.bench.answers.tokenizer import all_wordings
from scope_ptz.bench.tasks.expected import Choice, Description, Fact, NameSet

EQUALITY_PHRASES = (
    "the same", "same number", "same", "equal", "equally", "equals", "tie", "tied", "draw", "identical", "no difference",
    "not differ", "as many", "as much", "even", "evenly", "both",
)  # fmt: skip
"""Phrases that state equality. They are also wordings of an option named "same"."""

_CONCLUDING_WORDS = frozenset({"so", "therefore", "thus", "hence", "answer", "overall", "conclusion"})
"""Words that introduce the conclusion of an answer."""
_ABSENCE_MARKS = ("none", "0", "zero")
"""Marks after a name that mean that the thing is absent, as in "bins: none"."""
_ALL_OPTIONS_WORDS = re.compile(r"\b(all|everything|both|each|every)\b")
"""Words that refer to all options without naming them."""


def parse_choice(expected: Choice, text: AnswerText) -> ParsedAnswer:
    """Parse the only option that an answer names without denying it.

    If an answer names several options, return the one that a comparison picks or that the answer concludes with.
    """
    if expected.subject and True in absence_verdicts(text, expected.subject):
        return Unreadable("it says that there is none")
    stated = _stated_options(expected, text)
    mentions = [m for m in stated if not is_reference(text, m)]
    equality = _parse_equality(expected, text, mentions)
    if equality is not None:
        return equality
    if not expected.picks:
        return _single_option(text, mentions)
    return _parse_comparison(
        expected, text, [m for m in stated if m.name != "same"], [m for m in mentions if m.name != "same"], stated
    )


def _stated_options(expected: Choice, text: AnswerText) -> list[NameMention]:
    """Return the mentions of options that are neither denied nor made only for contrast."""
    options = dict(expected.options)
    if "same" in options:
        options["same"] = (*options["same"], *EQUALITY_PHRASES)
    return [m for m in option_mentions(text, options) if not m.denied and not m.contrast]


def _parse_equality(expected: Choice, text: AnswerText, mentions: Sequence[NameMention]) -> ParsedAnswer | None:
    """Parse an answer that calls the options equal; return None for other answers."""
    equalities = [m for m in mentions if m.name == "same"]
    if not equalities:
        return None
    later = [m for m in mentions if m.name != "same" and m.start > equalities[-1].start]
    only_both = all(text.words[m.start].text == "both" for m in equalities)
    if not only_both or len({m.name for m in later}) != 1:
        return ParsedValue("same")
    if not _compare_options(expected, text, later)[0]:
        # No comparison follows, unlike in "I looked at both presets. The gate has more."
        return Unreadable("whether both are meant is not clear")
    return None


def _parse_comparison(
    expected: Choice,
    text: AnswerText,
    compared: Sequence[NameMention],
    mentions: Sequence[NameMention],
    stated: Sequence[NameMention],
) -> ParsedAnswer:
    """Parse the answer to a question about an extreme, such as "most" or "closest".

    Args:
        expected: The expected choice.
        text: The answer.
        compared: Mentions of options, without mentions of equality.
        mentions: The mentions in ``compared``, except those that are only the reference of a comparison.
        stated: The mentions in ``compared``, and the mentions of equality.
    """
    picked, excluded = _compare_options(expected, text, compared)
    if picked & excluded:
        return Unreadable("the comparisons contradict each other")
    if len(picked) == 1:
        return ParsedValue(picked.pop())
    if picked or excluded:
        candidates = picked or {m.name for m in mentions} - excluded
        return _single_option(text, [m for m in mentions if m.name in candidates])
    has_reference = any(is_reference(text, m) for m in stated)
    chosen = [
        m for m in mentions if (has_reference and _is_heading(text, m)) or not _is_only_counted(text, m, expected.options[m.name])
    ]
    return _single_option(text, chosen)


def _single_option(text: AnswerText, mentions: Sequence[NameMention]) -> ParsedAnswer:
    """Return the only option that an answer names.

    If the answer names several, ignore bracketed remarks, then mentions of parts, then everything before the conclusion, until one
    option remains.
    """
    named = {m.name for m in mentions}
    if len(named) > 1:
        named = {m.name for m in mentions if not _is_remark(text, m)} or named
    if len(named) > 1:
        parts = _part_mentions(text, mentions)
        named = {m.name for m in mentions if m not in parts} or named
    if len(named) > 1:
        conclusion = max((i for i, w in enumerate(text.words) if w.text in _CONCLUDING_WORDS), default=len(text.words))
        named = {m.name for m in mentions if m.start > conclusion} or named
    if len(named) == 1:
        return ParsedValue(named.pop())
    return Unreadable("several options: " + ", ".join(sorted(named)) if named else "no option is named")


def _compare_options(expected: Choice, text: AnswerText, mentions: Sequence[NameMention]) -> tuple[set[str], set[str]]:
    """Return the options that the comparisons in an answer pick, and the options that they exclude.

    If there are only two options, excluding one picks the other: if the gate is farther, the other option is closer.
    """
    picked, excluded = set[str](), set[str]()
    pair = {name for name in expected.options if name != "same"}
    for comparative in find_comparatives(text, comparatives_by_direction(expected.picks)):
        described = described_thing(text, comparative, mentions)
        reference = reference_of(text, comparative, mentions)
        subject = {described.name} if described else pair - {reference.name} if reference and len(pair) == 2 else set[str]()
        other = {reference.name} if reference else pair - subject if subject and len(pair) == 2 else set[str]()
        if comparative.denied:
            excluded |= subject if comparative.name == "forward" else set()
        elif comparative.name == "forward":
            picked |= subject
            excluded |= {reference.name} if reference else set()
        else:
            excluded |= subject
            picked |= other if len(pair) == 2 else set()
    return picked, excluded


def _is_heading(text: AnswerText, mention: NameMention) -> bool:
    """Return whether an option is a heading at the start of the answer, as in "Cones: two of them, against one bollard"."""
    after = text.words[mention.end : mention.end + 1]
    return mention.start <= 1 and bool(after) and after[0].gap.strip() == ":"


def _is_only_counted(text: AnswerText, mention: NameMention, wordings: Sequence[str]) -> bool:
    """Return whether the answer only counts an option ("9 skips", "skips: 9") without choosing it."""
    counts = [n for n in find_numbers(text, (mention.name, *wordings)) if n.counts_unit]
    return any(0 <= mention.start - n.end <= 3 or n.start == mention.end for n in counts)


def _is_remark(text: AnswerText, mention: NameMention) -> bool:
    """Return whether a mention is part of a remark, like "red" in "green (the wall above is red)" but not in "green (or red)"."""
    before = text.words[mention.start - 1].text if mention.start else ""
    return text.in_brackets(mention.start) and before not in _ALTERNATIVES


_ALTERNATIVES = frozenset({"or", "maybe", "perhaps", "possibly", "probably", "rather", "actually"})
"""Words in brackets that introduce an alternative answer rather than a remark."""


def _part_mentions(text: AnswerText, mentions: Sequence[NameMention]) -> list[NameMention]:
    """Return the mentions that describe only a part of a thing or its support, like "yellow" in "blue, with a yellow top"."""
    parts = list[NameMention]()
    for at, mention in enumerate(mentions):
        after = text.words[mention.end : mention.end + 1]
        continues = bool(after) and after[0].clause == text.words[mention.start].clause and after[0].text not in _CONNECTING_WORDS
        more = bool(after) and after[0].text == "and"
        before = " ".join(word.text for word in text.words[max(0, mention.start - 2) : mention.start])
        listed = at > 0 and parts[-1:] == [mentions[at - 1]] and before.endswith("and")
        if (_PART_INTRODUCTION.search(before) and (continues or more)) or (listed and continues):
            parts.append(mention)
    return parts


_PART_INTRODUCTION = re.compile(r"\b(with( an?| the| its)?|on an?)$")
"""Words before a mention which show that it describes a part of a thing or its support."""
_CONNECTING_WORDS = frozenset({"and", "or", "with", "on", "in", "at", "is", "are", "but"})
"""Words after a mention which show that it does not modify a following noun, unlike "yellow" in "yellow top"."""


def is_reference(text: AnswerText, mention: NameMention) -> bool:
    """Return whether a mention is the reference of a comparison, as in "more than the gate"."""
    clause = text.words[mention.start].clause
    before = [w.text for w in text.words[max(0, mention.start - 6) : mention.start] if w.clause == clause]
    return "than" in before[-4:] or bool({"compared", "versus", "against"} & set(before))


def parse_name_set(expected: NameSet, text: AnswerText) -> ParsedAnswer:
    """Parse the set of all names that an answer states without denying them."""
    names = {name: all_wordings(name, other_wordings) for name, other_wordings in expected.options.items()}
    mentions = [m for m in text.mentions(names) if not m.denied and not m.contrast and not text.is_marked(m.end, _ABSENCE_MARKS)]
    named = frozenset(m.name for m in mentions)
    for first, second in pairwise(mentions):
        if any(w.text == "or" for w in text.words[first.end : second.start]):
            return Unreadable("it states alternatives")
    if named:
        return ParsedValue(named)
    if _ALL_OPTIONS_WORDS.search(text.plain_text()):
        return Unreadable("it does not say which")
    if (not says_yes(text) and (says_none(text) or _denies_all(text))) or any(
        m.denied or text.is_marked(m.end, _ABSENCE_MARKS) for m in text.mentions(names)
    ):
        return ParsedValue(frozenset[str]())
    return Unreadable("nothing is named")


_DENIES_ALL = re.compile(
    r"^no (?!(information|data|results?|answers?|response|output|reply|image|idea)\b)\w+\b(?! (is|are) (missing|absent))|"
    r"\bthere (is|are) (no|not any)\b|\b(parts|see|saw|find|sees) (no|nothing)\b"
)
"""Denials of everything, such as "no lamps" and "there are no". Phrases such as "no data" do not match."""


def _denies_all(text: AnswerText) -> bool:
    return _DENIES_ALL.search(text.plain_text()) is not None


def parse_description(expected: Description, text: AnswerText) -> ParsedAnswer:
    """Parse the expected facts and the contradictions that an answer states."""
    return ParsedValue((_stated_facts(expected.facts, text), _stated_facts(expected.contradictions, text)))


def _stated_facts(facts: Sequence[Fact], text: AnswerText) -> frozenset[int]:
    """Return the indices of the facts that an answer states."""
    stated = set[int]()
    for number, fact in enumerate(facts):
        if any(not m.denied and not m.contrast for m in text.mentions({"fact": fact.any_of})):
            stated.add(number)
    return frozenset(stated)
