"""Reading answers that name things: one of several, all that fit, facts of a description."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from scope_ptz.bench.answers.comparisons import bearer_of, comparators, reference_of, ways
from scope_ptz.bench.answers.denials import says_none, says_yes
from scope_ptz.bench.answers.numbers import find_numbers
from scope_ptz.bench.answers.options import option_mentions
from scope_ptz.bench.answers.parsed import ParsedAnswer, ParsedValue, Unreadable
from scope_ptz.bench.answers.presence import says_that_none
from scope_ptz.bench.answers.text import AnswerText, NameMention
from scope_ptz.bench.answers.tokenizer import all_wordings
from scope_ptz.bench.tasks.expected import Choice, Description, Fact, NameSet

SAME = (
    "the same", "same number", "same", "equal", "equally", "equals", "tie", "tied", "draw", "identical", "no difference",
    "not differ", "as many", "as much", "even", "evenly", "both",
)  # fmt: skip
"""How one says that two are alike; also the wordings of a choice that is called "same"."""

_CONCLUDES = frozenset({"so", "therefore", "thus", "hence", "answer", "overall", "conclusion"})
_MARKED_NONE = ("none", "0", "zero")
_ALL = re.compile(r"\b(all|everything|both|each|every)\b")


def parse_choice(expected: Choice, script: AnswerText) -> ParsedAnswer:
    """The one option that is named and not denied; where several are, the one that is picked or concluded on."""
    if expected.subject and True in says_that_none(script, expected.subject):
        return Unreadable("it says that there is none")
    options = dict(expected.options)
    if "same" in options:
        options["same"] = (*options["same"], *SAME)
    everything = [m for m in option_mentions(script, options) if not m.denied and not m.aside]
    mentions = [m for m in everything if not after_than(script, m)]
    alike = [m for m in mentions if m.name == "same"]
    rest = [m for m in mentions if m.name != "same" and alike and m.start > alike[-1].start]
    only_both = all(script.words[m.start].text == "both" for m in alike)
    if alike and not (only_both and len({m.name for m in rest}) == 1):
        return ParsedValue("same")
    if alike and not _compared(expected, script, rest)[0]:
        # Unlike "I looked at both presets. The gate has more."
        return Unreadable("whether both are meant is not clear")
    if expected.picks:
        mentions = [m for m in mentions if m.name != "same"]
        picked, out = _compared(expected, script, [m for m in everything if m.name != "same"])
        if picked & out:
            return Unreadable("the comparisons contradict each other")
        if picked or out:
            mentions = [m for m in mentions if m.name in (picked or {m.name for m in mentions} - out)]
        else:
            against = any(after_than(script, m) for m in everything)
            mentions = [
                m for m in mentions if (against and _heads(script, m)) or not _is_only_counted(script, m, expected.options[m.name])
            ]
        if len(picked) == 1:
            return ParsedValue(picked.pop())
    named = {m.name for m in mentions}
    if len(named) > 1:
        named = {m.name for m in mentions if not _is_added(script, m)} or named
    if len(named) > 1:
        named = {m.name for m in mentions if m not in _of_parts(script, mentions)} or named
    if len(named) > 1:
        last = max((i for i, w in enumerate(script.words) if w.text in _CONCLUDES), default=len(script.words))
        named = {m.name for m in mentions if m.start > last} or named
    if len(named) == 1:
        return ParsedValue(named.pop())
    return Unreadable("several options: " + ", ".join(sorted(named)) if named else "no option is named")


def _compared(expected: Choice, script: AnswerText, mentions: Sequence[NameMention]) -> tuple[set[str], set[str]]:
    """The options that a comparison picks and those that it rules out. Of two options the one that is not "farther" is "closer"."""
    picked, out = set[str](), set[str]()
    pair = {name for name in expected.options if name != "same"}
    for comparator in comparators(script, ways(expected.picks)):
        bearer = bearer_of(script, comparator, mentions)
        reference = reference_of(script, comparator, mentions)
        one = {bearer.name} if bearer else pair - {reference.name} if reference and len(pair) == 2 else set[str]()
        other = {reference.name} if reference else pair - one if one and len(pair) == 2 else set[str]()
        if comparator.denied:
            out |= one if comparator.name == "forward" else set()
        elif comparator.name == "forward":
            picked |= one
            out |= {reference.name} if reference else set()
        else:
            out |= one
            picked |= other if len(pair) == 2 else set()
    return picked, out


def _heads(script: AnswerText, mention: NameMention) -> bool:
    """ "Cones: two of them, against one bollard": what is named first and by itself is the answer, the rest is why."""
    after = script.words[mention.end : mention.end + 1]
    return mention.start <= 1 and bool(after) and after[0].gap.strip() == ":"


def _is_only_counted(script: AnswerText, mention: NameMention, further: Sequence[str]) -> bool:
    """ "9 skips", "skips: 9": that tells how many there are, not that they are what is chosen."""
    own = [q for q in find_numbers(script, (mention.name, *further)) if q.own]
    return any(0 <= mention.start - q.end <= 3 or q.start == mention.end for q in own)


def _is_added(script: AnswerText, mention: NameMention) -> bool:
    """ "Green (the wall above is red)": what is added in brackets is not what is chosen; "green (or red)" is an alternative."""
    before = script.words[mention.start - 1].text if mention.start else ""
    return script.in_brackets(mention.start) and before not in _ALTERNATIVES


_ALTERNATIVES = frozenset({"or", "maybe", "perhaps", "possibly", "probably", "rather", "actually"})


def _of_parts(script: AnswerText, mentions: Sequence[NameMention]) -> list[NameMention]:
    """Those said of a part, or of what something stands on: the yellow of "blue, with a yellow top"."""
    found = list[NameMention]()
    for at, mention in enumerate(mentions):
        after = script.words[mention.end : mention.end + 1]
        goes_on = bool(after) and after[0].clause == script.words[mention.start].clause and after[0].text not in _JOINS
        more = bool(after) and after[0].text == "and"
        before = " ".join(word.text for word in script.words[max(0, mention.start - 2) : mention.start])
        listed = at > 0 and found[-1:] == [mentions[at - 1]] and before.endswith("and")
        if (_ATTACHED.search(before) and (goes_on or more)) or (listed and goes_on):
            found.append(mention)
    return found


_ATTACHED = re.compile(r"\b(with( an?| the| its)?|on an?)$")
_JOINS = frozenset({"and", "or", "with", "on", "in", "at", "is", "are", "but"})


def after_than(script: AnswerText, mention: NameMention) -> bool:
    """Whether something is named only to be compared with."""
    clause = script.words[mention.start].clause
    before = [w.text for w in script.words[max(0, mention.start - 6) : mention.start] if w.clause == clause]
    return "than" in before[-4:] or bool({"compared", "versus", "against"} & set(before))


def parse_name_set(expected: NameSet, script: AnswerText) -> ParsedAnswer:
    """All that are named and not denied."""
    names = {name: all_wordings(name, further) for name, further in expected.options.items()}
    mentions = [m for m in script.mentions(names) if not m.denied and not m.aside and not script.is_marked(m.end, _MARKED_NONE)]
    named = frozenset(m.name for m in mentions)
    for one, two in pairwise(mentions):
        if any(w.text == "or" for w in script.words[one.end : two.start]):
            return Unreadable("an alternative")
    if named:
        return ParsedValue(named)
    if _ALL.search(script.text()):
        return Unreadable("it does not say which")
    if (not says_yes(script) and (says_none(script) or _denies_all(script))) or any(
        m.denied or script.is_marked(m.end, _MARKED_NONE) for m in script.mentions(names)
    ):
        return ParsedValue(frozenset[str]())
    return Unreadable("nothing is named")


_DENIES_ALL = re.compile(
    r"^no (?!(information|data|results?|answers?|response|output|reply|image|idea)\b)\w+\b(?! (is|are) (missing|absent))|"
    r"\bthere (is|are) (no|not any)\b|\b(found|see|saw|find|sees) (no|nothing)\b"
)


def _denies_all(script: AnswerText) -> bool:
    return _DENIES_ALL.search(script.text()) is not None


def parse_description(expected: Description, script: AnswerText) -> ParsedAnswer:
    """Which of the facts and which of the contradictions are stated."""
    return ParsedValue((_stated(expected.facts, script), _stated(expected.contradictions, script)))


def _stated(facts: Sequence[Fact], script: AnswerText) -> frozenset[int]:
    stated = set[int]()
    for number, fact in enumerate(facts):
        if any(not m.denied and not m.aside for m in script.mentions({"fact": fact.any_of})):
            stated.add(number)
    return frozenset(stated)
