"""Reading answers that name things: yes or no, one of several, all that fit, none at all, facts of a description."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from scope_ptz.bench.expected import Choice, Description, Fact, NameSet, NoneThere, YesNo
from scope_ptz.bench.reader_numbers import find_quantities, says_none
from scope_ptz.bench.reader_text import Mention, Script, wordings_of
from scope_ptz.bench.reading import Reading, Unreadable, Value

SAME = (
    "the same", "same number", "same", "equal", "equally", "equals", "tie", "tied", "draw", "identical", "no difference",
    "not differ", "as many", "as much", "even", "evenly", "both",
)  # fmt: skip
"""How one says that two are alike; also the wordings of a choice that is called "same"."""

_YES = frozenset({"yes", "yeah", "yep", "yup", "correct", "affirmative", "true", "indeed"})
_NO = frozenset({"no", "nope", "nah", "negative", "false", "incorrect"})
_CONCLUDES = frozenset({"so", "therefore", "thus", "hence", "answer", "overall", "conclusion"})
_ALL = re.compile(r"\b(all|everything|both|each|every)\b")


def verdict_words(script: Script) -> set[bool]:
    """The yes and no that stand by themselves: at the beginning before a comma, or as a whole clause."""
    said = set[bool]()
    for group in script.segments():
        words = [script.words[i].text for i in group]
        alone = len(words) == 1 or (group[0] == 0 and words[0] in ("yes", "yeah", "yep", "indeed"))
        if alone and words[0] in _YES:
            said.add(True)
        if len(words) == 1 and words[0] in _NO:
            said.add(False)
    said |= {word == "yes" for word in re.findall(r"\b(?:answer|verdict) is (?:a clear )?(yes|no)\b", script.text())}
    if re.match(r"(yes|no) (and |or )?(yes|no)\b", script.text()):
        return {True, False}
    return said


def read_yes_no(expected: YesNo, script: Script) -> Reading:
    """A bare yes or no, and what is stated about the thing; they must not contradict each other."""
    said = verdict_words(script)
    for mention in script.mentions({"yes": expected.affirms, "no": expected.denies}):
        said.add((mention.name == "yes") != (mention.denied or mention.aside))
    if not said and says_none(script):
        said = {False}
    clauses = (" ".join(script.words[i].text for i in group) for group in script.clauses())
    if any(re.search(r"\bthere (is|are) (none|not any)( here| there| visible| in view)?$", clause) for clause in clauses):
        said.add(False)
    if len(said) == 1:
        return Value(said.pop())
    return Unreadable("both yes and no" if said else "neither yes nor no")


def read_choice(expected: Choice, script: Script) -> Reading:
    """The one option that is named and not denied; where several are, the one that is concluded on."""
    names = {name: wordings_of(name, further) for name, further in expected.options.items()}
    if "same" in names:
        names["same"] = (*names["same"], *SAME)
    mentions = [m for m in script.mentions(names) if not m.denied and not m.aside and not after_than(script, m)]
    if any(m.name == "same" for m in mentions):
        return Value("same")
    named = {m.name for m in mentions}
    if len(named) > 1 and expected.picks:
        named = _picked(expected, script, mentions) or named
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


def after_than(script: Script, mention: Mention) -> bool:
    """Whether something is named only to be compared with."""
    clause = script.words[mention.start].clause
    before = [w.text for w in script.words[max(0, mention.start - 6) : mention.start] if w.clause == clause]
    return "than" in before[-4:] or bool({"compared", "versus", "against"} & set(before))


def read_name_set(expected: NameSet, script: Script) -> Reading:
    """All that are named and not denied."""
    names = {name: wordings_of(name, further) for name, further in expected.options.items()}
    mentions = [m for m in script.mentions(names) if not m.denied and not m.aside]
    named = frozenset(m.name for m in mentions)
    for one, two in pairwise(mentions):
        if any(w.text == "or" for w in script.words[one.end : two.start]):
            return Unreadable("an alternative")
    if named:
        return Value(named)
    if _ALL.search(script.text()):
        return Unreadable("it does not say which")
    if says_none(script) or any(m.denied for m in script.mentions(names)) or _denies_all(script):
        return Value(frozenset[str]())
    return Unreadable("nothing is named")


def _denies_all(script: Script) -> bool:
    return (
        re.search(r"^no \w+|\bthere (is|are) (no|not any)\b|\b(found|see|saw|find|sees) (no|nothing)\b", script.text()) is not None
    )


def read_none_there(expected: NoneThere, script: Script) -> Reading:
    """True when the answer says that there is none, False when it says that there is one."""
    if re.search(r"\b(none|no|nothing|zero|0) or (one|two|some|several|a few|1|2)\b", script.text()):
        return Unreadable("an alternative")
    mentions = script.mentions({"subject": expected.subject})
    said = {not v for v in verdict_words(script)}
    said |= {m.denied for m in mentions if not m.aside}
    if not mentions:
        said |= {q.value == 0 for q in find_quantities(script, expected.subject) if not (q.other or q.bound or q.denied)}
        if says_none(script):
            said.add(True)
    if len(said) == 1:
        return Value(said.pop())
    return Unreadable(
        "both that there is one and that there is none" if said else "neither that there is one nor that there is none"
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
