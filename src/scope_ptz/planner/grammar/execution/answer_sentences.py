"""Phrase the answers of the grammar planner, which state only facts from tool results."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence

from scope_ptz import english
from scope_ptz.builtin_names import GROUND_TRUTH
from scope_ptz.english.grammar.common_nouns import is_common_noun
from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.english.nouns import UNCOUNTABLE, plural_noun
from scope_ptz.english.numerals import cardinal, number_word
from scope_ptz.planner.grammar.answerable import answerable_questions
from scope_ptz.planner.grammar.execution.visible_counts import is_complete
from scope_ptz.planner.grammar.instruction_tree import (
    Condition,
    Joined,
    Negated,
    Outnumbers,
    PresetOutnumbers,
    Quantity,
    Readable,
    Seen,
    Statement,
)

_MAX_SPELLED = 12  # larger counts are written in digits
_MODIFIER_START = re.compile(
    r"\s(?:in|on|at|of|with|by|near|behind|beside|under|above|between|from|inside|outside|to|that|which|who|next|"
    r"wearing|holding|carrying|parked|standing|"
    r"facing|driving|walking|visible|along|across|around|opposite|beyond|through|among|towards|alongside|beneath|underneath|saying|over|below|against|without|not)\b"
)
_OPERATORS = {">=": "at least ", "<=": "at most ", ">": "more than ", "<": "fewer than ", "==": "exactly "}


def number(value: float) -> str:
    """Return a number without trailing zeros, with at most two decimals."""
    return str(int(value)) if float(value).is_integer() else f"{value:.2f}".rstrip("0").rstrip(".")


def count_word(count: int) -> str:
    """Return a number of moves: from 1 to 12 as a word, otherwise in digits. Counts of objects are always in digits."""
    return english.number_word(count) if 0 < count <= _MAX_SPELLED else str(count)


def head_and_rest(description: str) -> tuple[str, str]:
    """Split a description after its head noun: "red cars" and " behind the gate", "people" and " sitting down"."""
    match = _MODIFIER_START.search(description) or _participle_after_noun(description) or _finite_verb_after_noun(description)
    return (description[: match.start()], description[match.start() :]) if match else (description, "")


def _end_of_noun(head: str) -> int:
    """Return the index at which the noun ends: before the adjectives that follow a plural, as in "roller doors half open"."""
    words = head.split(" ")
    last = words[-1].lower()
    if english.is_plural(last) or is_common_noun(last) or lexicon().concept(last) is not None:
        return len(head)
    plural = next((i for i in reversed(range(len(words))) if english.is_plural(words[i].lower())), len(words) - 1)
    return len(" ".join(words[: plural + 1]))


def _participle_after_noun(description: str) -> re.Match[str] | None:
    """Return the participle that follows the noun, as in "people sitting down", but not in "market awning"."""
    for match in re.finditer(r"\s(\w+ing)\b", description):
        last = description[: match.start()].split(" ")[-1].lower()
        if (
            (english.is_plural(last) or is_person_noun(last))
            and not is_common_noun(match[1].lower())
            and lexicon().concept(match[1].lower()) is None
        ):
            return match
    return None


def is_person_noun(noun: str) -> bool:
    """Return whether a singular or plural noun is a word for people."""
    concept = lexicon().concept(noun)
    return concept is not None and "person" in lexicon().kinds(concept)


def _finite_verb_after_noun(description: str) -> re.Match[str] | None:
    """Return the verb that follows the noun, as in "workers wear a helmet", but not in "cars park"."""
    match = _FINITE_VERB.search(description)
    return match if match is not None and english.is_plural(description[: match.start()].split(" ")[-1].lower()) else None


_FINITE_VERB = re.compile(r"\s(wear|carry|hold|have|use|ride|drive|push|pull)\s", re.IGNORECASE)
_THIRD_PERSON = {"carry": "carries", "have": "has", "push": "pushes"}


def _with_relative_pronoun(head: str, rest: str, count: float) -> str:
    """Return what follows the noun, with "who" or "that" before a finite verb: "3 workers who wear a helmet"."""
    if (match := _FINITE_VERB.match(rest)) is None:
        return rest
    verb = match[1].lower()
    pronoun = "who" if is_person_noun(head.split(" ")[-1].lower()) else "that"
    return f" {pronoun} {_THIRD_PERSON.get(verb, f'{verb}s') if count == 1 else verb} {rest[match.end() :]}"


def noun(description: str, count: float) -> str:
    """Return the description with its head noun in the singular or plural."""
    if is_uncountable(description):
        return description
    if description.lower() in english.COLOURS:
        description += " thing"
    end = _end_of_noun(head_and_rest(description)[0])
    head, rest = description[:end], description[end:]
    *front, last = head.split(" ")
    inflected = " ".join([*front, _inflected(last, english.singular if count == 1 else plural_noun)])
    return inflected + _with_relative_pronoun(head, rest, count)


def is_uncountable(description: str) -> bool:
    """Return whether a description names something uncountable, such as "smoke" or "standing water"."""
    return head_and_rest(description)[0].split(" ")[-1].lower() in UNCOUNTABLE


def _inflected(word: str, inflect: Callable[[str], str]) -> str:
    """Return an inflected form of a word. Letters that do not change keep their case."""
    plain = word.lower()
    inflected = inflect(plain)
    differences = (i for i, (a, b) in enumerate(zip(plain, inflected, strict=False)) if a != b)
    unchanged = next(differences, min(len(plain), len(inflected)))
    return word[:unchanged] + inflected[unchanged:]


def counted(description: str, count: int, *, complete: bool = True) -> str:
    """Return a count with its noun: "3 cones", "no cones", or "at least 3 cones" when there may be more."""
    if count and is_uncountable(description):
        return f"some {description}"
    if not (complete and is_complete(count)):
        return f"at least {count} {noun(description, count)}" if count else f"no {noun(description, 0)} clearly"
    return f"{count or 'no'} {noun(description, count)}"


def not_made_out(description: str, place: str) -> str:
    """Return the statement that a picture shows none of some things clearly, although there may be some."""
    return f"I cannot make out any {noun(description, 0)} {place}, but there may be some that are too small or hidden"


def all_counted(counts: Sequence[tuple[str, int, bool]]) -> str:
    """Return counts with their nouns, each given as description, number and whether it is complete: "1 van and 7 cars".

    If there are none at all, "no" is said once: "no vans or cars".
    """
    if len(counts) > 1 and not any(count for _, count, _ in counts) and all(complete for _, _, complete in counts):
        first, *others = (noun(description, 2) for description, _, _ in counts)
        return english.listing([f"no {first}", *others], "or")
    return english.listing([counted(description, count, complete=complete) for description, count, complete in counts])


def where(view: str, descriptions: Sequence[str] = ()) -> str:
    """Return the scope of a count in words, after a space; empty if each description already names a part of the view."""
    if view == "full":
        return " in the whole scene"
    return "" if descriptions and all(map(_PART_OF_VIEW.search, descriptions)) else " in this view"


_PART_OF_VIEW = re.compile(
    r" (?:in|on|at) the (?:(?:top|bottom|upper|lower|left|right)(?:[ -]hand)? ?)+(?:half|side|quarter|corner)?$"
    r"| in the (?:middle|centre|foreground|background|distance|(?:left|right|top|bottom|middle) third)$",
    re.IGNORECASE,
)


def pose_text(pose: Mapping[str, float]) -> str:
    """Return a pose in words."""
    return f"pan {pose['pan_deg']:.1f}, tilt {pose['tilt_deg']:.1f}, zoom {pose['zoom']:.1f}x"


def sentence(text: str) -> str:
    """Return the text with a capital first letter, and with a full stop unless it ends with other punctuation."""
    text = text.strip()
    if not text:
        return ""
    return text[0].upper() + text[1:] + ("" if text.endswith((".", "!", "?", ".)")) else ".")


_NOT_UNDERSTOOD = re.compile(
    r"The (?:question|description) '(?P<text>.+)' is not understood\b"
    r"|I did not understand '(?P<words>.+)' in the (?:question|description)\b",
    re.DOTALL,
)


_CANNOT_TELL = re.compile(r"I cannot tell\b[^.]*")


def is_not_understood(error: str) -> bool:
    """Return whether an error reports that perception did not understand a question or a description."""
    return _NOT_UNDERSTOOD.match(error) is not None


def not_understood_text(error: str) -> str:
    """Return the note that perception did not understand a question or a description, or knows nothing about a place.

    Empty for other errors.
    """
    if unknown := _CANNOT_TELL.match(error):
        return unknown[0]
    match = _NOT_UNDERSTOOD.match(error)
    if match is None:
        return ""
    if match["text"] and error.startswith("The question"):
        return f"I did not understand that question. {answerable_questions(match['text'])}"
    words = re.sub(r"'( and |, )'", r'"\1"', match["words"] or "")
    return f'I did not understand "{match["text"] or words}"'


def reports_absence(answer: str) -> bool:
    """Return whether an answer reports that what a question is about is not in view: "There are no docks in view"."""
    return _ABSENT.match(answer) is not None


_ABSENT = re.compile(r"There (?:is|are) no\b|I (?:can see|see) no\b", re.IGNORECASE)


def object_pronoun(description: str) -> str:
    """Return the pronoun for one thing as an object: "it", or "them" for a person, whose sex may be unknown."""
    head, _ = head_and_rest(description)
    return "them" if is_person_noun(head.split(" ")[-1].lower()) else "it"


def with_lower_initial(text: str) -> str:
    """Return text with a lower-case first letter, unless it begins with "I" or capitals, so that it can follow a colon."""
    return text if len(text) < 2 or not text[1].islower() else text[0].lower() + text[1:]


def chosen_text(description: str, matches: int, chosen: str) -> str:
    """Return which of several things was chosen: "one of the 20 signs in view, the Plough sign"."""
    description, _ = without_number(description)
    name = chosen.removeprefix("The ").removeprefix("the ")
    name = "" if name.lower() == noun(description, 1).lower() else name  # "white van" does not say which of the white vans
    things = noun(description, matches)
    number = number_word(matches) if things[:1].isdigit() and matches < 100 else str(matches)  # "one of the two 5 mph signs"
    return f"one of the {number} {things} in view{f', the {name}' if name else ''}"


def without_number(description: str) -> tuple[str, int | None]:
    """Split a description from the number before it: "skips" and 2 for "two skips"; None for a description without a number.

    In "one way signs", the number belongs to the next word.
    """
    first, _, rest = description.partition(" ")
    count = cardinal(first.lower())
    is_counted = count not in {None, 1} and english.is_plural(head_and_rest(rest)[0].split(" ")[-1].lower())
    return (rest, count) if rest and is_counted else (description, None)


def reason_and_reaction(reason: str, reaction: str) -> str:
    """Append what the camera did to the reason for it: "I can see no trucks, so I left it at that"."""
    if not reason:
        return f"so I {reaction}"
    return f"{reason} So I {reaction}" if reason[-1] in ".!?" else f"{reason}, so I {reaction}"


def quantity_text(quantity: Quantity, description: str) -> str:
    """Return a condition on a count in words: "at least 6 cones"."""
    if quantity == Quantity("==", 0):
        return f"no {noun(description, 2)}"
    if quantity == Quantity():
        return f"any {noun(description, 2)}"
    return f"{_OPERATORS[quantity.operator]}{number(quantity.number)} {noun(description, quantity.number)}"


def condition_text(condition: Condition) -> str:
    """Return a condition in words that can follow "I never", such as "saw at least 6 cones"."""
    if isinstance(condition, Seen):
        return f"saw {quantity_text(condition.quantity, condition.thing.text)}"
    if isinstance(condition, Readable):
        return f"could read the {condition.thing.text}"
    if isinstance(condition, Statement):
        return f"saw that the {condition.subject.text} is {'' if condition.expected else 'not '}{condition.predicate}"
    if isinstance(condition, PresetOutnumbers):
        return f"saw {condition.comparison} {condition.thing.text} at {condition.first.name} than at {condition.second.name}"
    if isinstance(condition, Outnumbers):
        return f"saw {condition.comparison} {condition.first.text} than {condition.second.text}"
    if isinstance(condition, Negated):
        return f"reached a view where it does not hold that I {condition_text(condition.part)}"
    if isinstance(condition, Joined):
        return english.listing([condition_text(part) for part in condition.parts], "and" if condition.mode == "all" else "or")
    return "met the condition"


def source_text(sources: Sequence[str]) -> str:
    """Return the note that names the sources of perception results; empty for none."""
    if not sources:
        return ""
    named = ["the simulator's ground truth" if source == GROUND_TRUTH else source for source in sources]
    return f" (Source: {english.listing(named)}.)"
