"""What an answer of perception says about the things of a question: how many there are, and how each of them is described."""

from __future__ import annotations

import re

from scope_ptz.english import COLOURS
from scope_ptz.english.grammar.questions.recognition import is_description
from scope_ptz.planner.grammar.binding.noun_heads import bare_noun, head_noun
from scope_ptz.planner.grammar.execution.answer_sentences import head_and_rest, noun

_EXIST = re.compile(r"(?:yes, )?there are (\d+) ", re.IGNORECASE)
_SINGLE = re.compile(r"yes, there is (?:an?|1|one)\b(?: (?P<thing>[^,:;.]+))?", re.IGNORECASE)
_NONE = re.compile(r"(?:no, )?there (?:are|is) no\b", re.IGNORECASE)
_DENIED = re.compile(r"(?:no|none|nobody|no one)\b", re.IGNORECASE)
_COMPARED = re.compile(r"the (?P<thing>[^:;,.]+?) (?:is|are) (?:the )?(?:\w+er|\w+est|more|further|farther)\b", re.IGNORECASE)
"""An answer that names one of two things: "The bus is closer: it is about 30 m away, the car about 45 m."."""

_LISTED = re.compile(r"((?:An?|\d+) .+) are ")
"""An answer that lists the things: "A child, a man with a hat and 2 women are waiting."."""

_AFTER_COLON = re.compile(r"[^:]*\b2 [^:]*: (?P<list>[^:]+)")
_TWO_ITEMS = re.compile(r"(?P<first>(?:an?|one|1) .+?) and (?P<second>(?:an?|one|1) .+)", re.IGNORECASE)
_ITEM = re.compile(r"(?:an?|1|(?P<one>one)) (?P<what>.+?)(?: about \d.*)?", re.IGNORECASE)


def stated_number(answer: str, description: str) -> int | None:
    """Return how many things an answer names: "There are 2 forklifts: ..." or "A child and 2 men are waiting."; None if unclear."""
    if _NONE.match(answer):
        return 0
    if answer.lower().startswith("no"):
        return None  # "No, none of the 3 people is walking."
    if (exist := _EXIST.match(answer)) is not None:
        return int(exist[1])
    if _SINGLE.match(answer):
        return 1
    several = head_noun(noun(description, 2)).lower()
    if several == "persons":
        several = "people"
    stated = re.search(rf"\b(\d+) (?:[\w'’-]+ ){{0,3}}?{re.escape(several)}\b", answer, re.IGNORECASE)
    if stated is not None:
        return int(stated[1])
    if (listed := _LISTED.match(answer)) is None:
        return None
    return sum(int(match[1]) if (match := re.match(r"(\d+) ", item)) else 1 for item in re.split(r", | and (?=an? |\d)", listed[1]))


def two_members(answer: str, description: str) -> tuple[str, ...]:
    """Return the descriptions of two things that an answer lists, in its order; nothing for other answers.

    "There are 2 skips: 1 blue and 1 yellow" lists a blue skip and a yellow skip.
    """
    listed = _AFTER_COLON.match(answer) or _LISTED.match(answer)
    items = _TWO_ITEMS.fullmatch(listed[1].rstrip(". ")) if listed is not None else None
    if items is None:
        return ()
    members = tuple(_described(item, noun(bare_noun(description), 1)) for item in items.groups())
    return members if len({*members} - {""}) == len(members) else ()


def compared_thing(answer: str) -> str:
    """Return the thing that the answer to a comparison names: "bus" for "The bus is closer: ..."; empty for others."""
    match = _COMPARED.match(answer)
    return match["thing"].lower() if match is not None else ""


def denies_existence(answer: str) -> bool:
    """Return whether an answer says that there is none: "No, none of the 14 people in view are wearing helmets."."""
    return _DENIED.match(answer) is not None


def single_thing(answer: str) -> str:
    """Return the thing that an answer says there is: "black dog" for "Yes, there is a black dog on the left."; empty for others."""
    match = _SINGLE.match(answer)
    thing = head_and_rest(match["thing"])[0] if match is not None and match["thing"] else ""
    return thing if thing and is_description(thing) and thing.lower() != "one" else ""


def _described(item: str, kind: str) -> str:
    """Return the description of one thing in a list: "blue skip" for "1 blue".

    It is empty for words that perception names a thing by but cannot look for: "a pointing worker".
    """
    match = _ITEM.fullmatch(item)
    if match is None:
        return ""
    what = match["what"]
    if match["one"]:
        what = f"{kind} {what}"
    elif what.lower() in COLOURS:
        what = f"{what} {kind}"
    return what if is_description(what) else ""
