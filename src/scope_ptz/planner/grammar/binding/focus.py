"""What the earlier turns of a conversation were about: the things that pronouns, "one" and short follow-ups refer to."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.question_parser import parse_question
from scope_ptz.english.grammar.questions.recognition import looks_like_description
from scope_ptz.planner.grammar.binding.answered_things import (
    compared_thing,
    denies_existence,
    single_thing,
    stated_number,
    two_members,
)
from scope_ptz.planner.grammar.binding.asked_things import asked_thing, two_things
from scope_ptz.planner.grammar.binding.narrowing import are_exclusive
from scope_ptz.planner.grammar.binding.noun_heads import (
    bare_noun,
    head_noun,
    may_name_person,
    names_animal,
    names_person,
    names_several,
    noun_end,
)
from scope_ptz.planner.grammar.execution.answer_sentences import noun, without_number

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn, ToolOutcome

_MAX_TURNS = 30  # maximum number of earlier turns that are considered
_OTHER_PLACE = frozenset({"go_home", "go_to_preset"})
_RECENT = 3  # "it" skips people for a thing only this far back
_SHARE = re.compile(
    r"\bof (?:them|those|these)\b|^(?:and )?how many (?:are|have|wear|carry|hold)\b|^(?:and|what about|how about|now|any)\b",
    re.IGNORECASE,
)
"""Wordings that narrow what the turn before was about."""

PERSONAL = frozenset({"he", "him", "his", "she", "her", "hers", "himself", "herself"})
"""Pronouns for one person, or for an animal."""

PLURAL = frozenset({"they", "them", "their", "theirs", "these", "those", "ones", "both"})
"""Pronouns for several things, or for a person whose sex is unknown."""

OF_THEM = "of them"
"""Stands for the pronoun of "how many of them", which refers to several things and not to a single person."""

Look = Literal["count_objects", "query_answer", "zoom_to_object", "track_object", "named"]
"""The tool that looked; "named" for a thing that the user named without saying what to do with it."""


@dataclass(frozen=True, slots=True)
class Focus:
    """What one look of an earlier turn was about.

    Attributes:
        description: The things, as they were looked for: "worker in a blue helmet".
        number: How many there are; None if the result does not say.
        look: The tool that looked.
        question: The question that was asked; empty for other looks.
        whole: The things of which these are a share: "workers" after "how many of them wear helmets?"; empty if they are no share.
        is_chosen: Whether the camera chose the thing among several that matched, to which "they" still refers.
        members: The descriptions of two things that the answer listed; empty if it did not.
        compared: The descriptions of two things of which the question asked which is, for example, nearer; that which the answer
            named comes first. The answer named none if ``number`` is 2.
    """

    description: str
    number: int | None
    look: Look
    question: str = ""
    whole: str = ""
    is_chosen: bool = False
    members: tuple[str, ...] = ()
    compared: tuple[str, ...] = ()

    @property
    def is_several(self) -> bool:
        """Whether it is known to be several things, so that a pronoun in the singular does not say which one is meant."""
        return names_several(self.description) if self.number is None else self.number > 1

    @property
    def one(self) -> str:
        """The description of one of the things: "taxi" after a count of taxis."""
        return noun(self.description, 1) if names_several(self.description) else self.description


def foci_of(conversation: Sequence[PastTurn]) -> tuple[Focus, ...]:
    """Return what the looks of a conversation were about, oldest first. Looks that failed are left out."""
    foci: list[Focus] = []
    for turn in conversation[-_MAX_TURNS:]:
        before = foci[-1] if foci else None
        outcomes = [outcome for exchange in turn.exchanges for outcome in exchange.outcomes if outcome.error is None]
        found = [focus for outcome in outcomes for focus in _foci_of_look(outcome)]
        if not turn.exchanges and (named := _LIKE_TO_KNOW.fullmatch(turn.reply)) is not None:
            foci.append(Focus(named[1], 1, "named"))
        is_share = before is not None and _SHARE.search(turn.instruction) is not None
        foci += [replace(f, whole=_shared(before, f)) if is_share and before is not None else f for f in found]
    return tuple(foci)


def things_named(conversation: Sequence[PastTurn]) -> tuple[str, ...]:
    """Return the descriptions of the single things that the latest looks named, in the order in which they were named."""
    named: list[str] = []
    earlier: list[str] = []  # what was named before the camera went to another place
    for turn in conversation[-_RECENT:]:
        for outcome in (outcome for exchange in turn.exchanges for outcome in exchange.outcomes):
            if outcome.call.name in _OTHER_PLACE and outcome.error is None:
                earlier, named = named or earlier, []
            question = str(outcome.call.arguments.get("question", ""))
            both = two_things(question) if question else ()
            is_missing = (
                outcome.result is not None and outcome.result.get("found") is False
            )  # a thing that is not there is no other one
            named += () if is_missing else both or [focus.description for focus in _foci_of_look(outcome)[-1:]]
    return tuple(thing for thing in dict.fromkeys(named or earlier) if not names_several(thing))


def latest_counts(conversation: Sequence[PastTurn]) -> tuple[str, ...]:
    """Return the descriptions that the latest turns counted, oldest first, back to the last turn that did anything else."""
    counted: list[str] = []
    for turn in reversed(conversation):
        calls = [outcome.call for exchange in turn.exchanges for outcome in exchange.outcomes]
        if not calls or any(call.name != "count_objects" for call in calls):
            break
        counted = [*(str(call.arguments["description"]) for call in calls), *counted]
    return tuple(dict.fromkeys(counted))


def things_to_add(conversation: Sequence[PastTurn]) -> tuple[str, ...]:
    """Return the things that the latest turns counted and of which none was counted twice, so that they can be added."""
    added: list[str] = []
    for description in reversed(latest_counts(conversation)):
        if not all(are_exclusive(description, other) for other in added):
            break
        added.insert(0, description)
    return tuple(added)


def _shared(before: Focus, focus: Focus) -> str:
    """Return the things of which a look considered a share, if they are of the same kind as what it found; otherwise nothing."""
    whole = before.whole or before.description
    if before.look != "count_objects" and not before.is_several:
        return ""
    return whole if noun(head_noun(whole), 1) == noun(head_noun(focus.description), 1) else ""


def _foci_of_look(outcome: ToolOutcome) -> list[Focus]:
    result, arguments = outcome.result or {}, outcome.call.arguments
    description = str(arguments.get("description", ""))
    match outcome.call.name:
        case "count_objects":
            number = result.get("count")
            return [Focus(description, number, "count_objects")]
        case "zoom_to_object":
            matches = result.get("matches") if result.get("found") else None
            focus = Focus(description, matches, "zoom_to_object")
            chosen = str(result.get("chosen") or "")
            is_named = matches is not None and matches > 1 and looks_like_description(chosen)
            return [focus, Focus(chosen, 1, "zoom_to_object", is_chosen=True)] if is_named else [focus]
        case "track_object":
            return [Focus(description, None, "track_object")]
        case "query_answer":
            return _foci_of_answer(str(arguments.get("question", "")), str(result.get("answer", "")))
        case _:
            return []


def _foci_of_answer(question: str, answer: str) -> list[Focus]:
    thing = asked_thing(question)
    if thing is None:  # "is there a dog or a fox?"
        both = two_things(question)
        if len(both) > 1 and isinstance(parse_question(question), tree.Which):
            return [_focus_of_comparison(question, both, answer)]
        if len(both) > 1 and bare_noun(both[0]) == bare_noun(both[1]):  # "is there a red car or a blue one?"
            return [Focus(noun(bare_noun(both[0]), 2), None, "query_answer", question)]
        single = single_thing(answer) if len(both) > 1 else ""
        return [Focus(single, 1, "query_answer", question)] if single else []
    description, number = without_number(thing.description)
    is_about_others = isinstance(parse_question(question), tree.Describe)  # "what is to the left of the van?"
    stated = None if is_about_others else stated_number(answer, description)
    number = number if stated is None else stated
    if stated is None and denies_existence(answer) and _asks_for_existence(question, description):
        number = 0  # "is anyone wearing a helmet?" - "No, none of the 5 people in view is wearing a helmet."
    members = two_members(answer, description) if number == 2 else ()
    return [Focus(description, number, "query_answer", question, members=members)]


def _focus_of_comparison(question: str, both: tuple[str, ...], answer: str) -> Focus:
    """Return what "which is nearer, the bus or the car?" was about: the thing that the answer names, or both if it names none."""
    named = compared_thing(answer)
    if named not in both:
        return Focus(noun(bare_noun(both[0]), 2), 2, "query_answer", question, members=both, compared=both)
    other = both[1 - both.index(named)]
    return Focus(named, 1, "query_answer", question, compared=(named, other))


def referent(foci: Sequence[Focus], pronoun: str) -> Focus | None:
    """Return what a pronoun refers to; None if the conversation was about nothing suitable.

    "He" and "she" are people or animals. "It" is a thing if one was spoken about recently. "They" are several things, or people.

    Args:
        foci: What the conversation was about, oldest first.
        pronoun: The pronoun, in lower case; empty for a thing that is left out, as in "how many?".
    """
    latest = foci[-1] if foci else None
    if not pronoun:
        return latest
    if pronoun == OF_THEM:
        groups = (f for f in reversed(foci) if f.is_several or f.whole or f.look == "count_objects" or _is_anyone(f))
        return next(groups, latest)
    if pronoun in PERSONAL:
        people = (focus for focus in reversed(foci) if names_person(focus.description) or names_animal(focus.description))
        return latest if latest is not None and may_name_person(latest.description) else next(people, None)
    if pronoun in PLURAL:
        several = (
            f
            for f in reversed(foci)
            if not f.is_chosen and (f.is_several or names_several(f.description) or names_person(f.description))
        )
        return next(several, latest)
    things = (focus for focus in reversed(foci[-_RECENT:]) if not names_person(focus.description))
    return next(things, latest)


def _asks_for_existence(question: str, description: str) -> bool:
    """Return whether a question asks whether there is what it describes: "is there a dog?", "is anyone wearing a helmet?"."""
    asked = parse_question(question)
    return isinstance(asked, tree.Exists) or (isinstance(asked, tree.YesNo) and description.startswith("person "))


def _is_anyone(focus: Focus) -> bool:
    """Return whether a question asked whether there are people, whose number its answer need not say: "is anyone waiting?"."""
    return names_person(focus.description) and isinstance(parse_question(focus.question), tree.Exists)


WHICH_ONE = "Which of the "
"""How the question begins that asks which of several things a pronoun means."""


def which_one(focus: Focus) -> str:
    """Return the question about a pronoun in the singular that may refer to several things."""
    number = f"{focus.number} " if focus.number else ""
    return f"{WHICH_ONE}{number}{in_plural(focus.description)} do you mean?"


def in_plural(description: str) -> str:
    """Return a description in the plural: "men pointing" for "man pointing", whose participle is not the noun."""
    end = noun_end(description)
    return noun(description[:end], 2) + description[end:] if end else noun(description, 2)


def like_to_know(description: str) -> str:
    """Return the question about a thing that the user named without saying what to do with it."""
    return f"What would you like to know about the {description}?"


_LIKE_TO_KNOW = re.compile(re.escape(like_to_know("THING")).replace("THING", "(.+)"))
