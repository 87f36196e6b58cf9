"""Reading answers that name things: one of several, all that fit, facts of a description."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from scope_ptz.bench.expected import Choice, Description, Fact, NameSet
from scope_ptz.bench.reader_denials import says_none, says_yes
from scope_ptz.bench.reader_presence import says_that_none
from scope_ptz.bench.reader_text import Mention, Script, wordings_of
from scope_ptz.bench.reading import Reading, Unreadable, Value

SAME = (
    "the same", "same number", "same", "equal", "equally", "equals", "tie", "tied", "draw", "identical", "no difference",
    "not differ", "as many", "as much", "even", "evenly", "both",
)  # fmt: skip
"""How one says that two are alike; also the wordings of a choice that is called "same"."""

_CONCLUDES = frozenset({"so", "therefore", "thus", "hence", "answer", "overall", "conclusion"})
_MARKED_NONE = ("none", "0", "zero")
_ALL = re.compile(r"\b(all|everything|both|each|every)\b")


def read_choice(expected: Choice, script: Script) -> Reading:
    """The one option that is named and not denied; where several are, the one that is concluded on."""
    if expected.subject and True in says_that_none(script, expected.subject):
        return Unreadable("it says that there is none")
    names = {name: wordings_of(name, further) for name, further in expected.options.items()}
    if "same" in names:
        names["same"] = (*names["same"], *SAME)
    mentions = [m for m in script.mentions(names) if not m.denied and not m.aside and not after_than(script, m)]
    alike = [m for m in mentions if m.name == "same"]
    rest = [m for m in mentions if m.name != "same" and alike and m.start > alike[-1].start]
    only_both = all(script.words[m.start].text == "both" for m in alike)
    if alike and only_both and len({m.name for m in rest}) == 1:
        # "I looked at both presets. The gate has more."
        mentions = [m for m in mentions if m.name != "same"] if _picked(expected, script, rest) else mentions
    elif alike:
        return Value("same")
    named = {m.name for m in mentions}
    if len(named) > 1 and expected.picks:
        named = _picked(expected, script, mentions) or named
    if len(named) > 1:
        named = {m.name for m in mentions if m not in _of_parts(script, mentions)} or named
    if len(named) > 1:
        last = max((i for i, w in enumerate(script.words) if w.text in _CONCLUDES), default=len(script.words))
        named = {m.name for m in mentions if m.start > last} or named
    if len(named) == 1:
        return Value(named.pop())
    return Unreadable("several options: " + ", ".join(sorted(named)) if named else "no option is named")


def _picked(expected: Choice, script: Script, mentions: Sequence[Mention]) -> set[str]:
    """What is named before a word that picks, in its segment or else its clause."""
    picked = set[str]()
    for pick in script.mentions({"pick": expected.picks}):
        if pick.denied:
            continue
        word = script.words[pick.start]
        near = [m for m in mentions if script.words[m.start].segment == word.segment]
        near = near or [m for m in mentions if script.words[m.start].clause == word.clause]
        before = [m for m in near if m.start < pick.start]
        picked |= {(before[-1] if before else near[0]).name} if near else set()
    return picked


def _of_parts(script: Script, mentions: Sequence[Mention]) -> list[Mention]:
    """Those said of a part, or of what something stands on: the yellow of "blue, with a yellow top"."""
    found = list[Mention]()
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


def after_than(script: Script, mention: Mention) -> bool:
    """Whether something is named only to be compared with."""
    clause = script.words[mention.start].clause
    before = [w.text for w in script.words[max(0, mention.start - 6) : mention.start] if w.clause == clause]
    return "than" in before[-4:] or bool({"compared", "versus", "against"} & set(before))


def read_name_set(expected: NameSet, script: Script) -> Reading:
    """All that are named and not denied."""
    names = {name: wordings_of(name, further) for name, further in expected.options.items()}
    mentions = [m for m in script.mentions(names) if not m.denied and not m.aside and not script.is_marked(m.end, _MARKED_NONE)]
    named = frozenset(m.name for m in mentions)
    for one, two in pairwise(mentions):
        if any(w.text == "or" for w in script.words[one.end : two.start]):
            return Unreadable("an alternative")
    if named:
        return Value(named)
    if _ALL.search(script.text()):
        return Unreadable("it does not say which")
    if (not says_yes(script) and (says_none(script) or _denies_all(script))) or any(
        m.denied or script.is_marked(m.end, _MARKED_NONE) for m in script.mentions(names)
    ):
        return Value(frozenset[str]())
    return Unreadable("nothing is named")


def _denies_all(script: Script) -> bool:
    return (
        re.search(
            r"^no \w+\b(?! (is|are) (missing|absent))|\bthere (is|are) (no|not any)\b|\b(found|see|saw|find|sees) (no|nothing)\b",
            script.text(),
        )
        is not None
    )


def read_description(expected: Description, script: Script) -> Reading:
    """Which of the facts and which of the contradictions are stated."""
    return Value((_stated(expected.facts, script), _stated(expected.contradictions, script)))


def _stated(facts: Sequence[Fact], script: Script) -> frozenset[int]:
    stated = set[int]()
    for number, fact in enumerate(facts):
        if any(not m.denied and not m.aside for m in script.mentions({"fact": fact.any_of})):
            stated.add(number)
    return frozenset(stated)
