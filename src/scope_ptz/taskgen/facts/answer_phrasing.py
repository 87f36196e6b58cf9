"""Phrase correct and wrong answers for every type of expected answer. Validation uses them as the answers of runs."""

from __future__ import annotations

import random
import re
from collections.abc import Sequence
from itertools import pairwise

from scope_ptz.bench.tasks.expected import (
    ActionOnly,
    AnyExpected,
    Choice,
    Description,
    NameSet,
    NoneThere,
    Number,
    Ordering,
    Relation,
    Text,
    YesNo,
)
from scope_ptz.english import number_word

_DIRECTIONS = frozenset({"left", "right", "north", "south", "east", "west", "above", "below", "behind"})
_REPLACEMENT_CHARACTERS = "ACDEFHJKMNPRTUVWXY2346790"
"""Letters and digits that can replace a character to simulate a misreading."""


def correct_answers(expected: AnyExpected) -> tuple[str, ...]:
    """Return five or more wordings of the correct answer."""
    match expected:
        case Number():
            return _number_wordings(expected.value, expected.unit)
        case YesNo():
            word = "yes" if expected.value else "no"
            return (
                f"{word.capitalize()}.",
                word,
                f"**{word.upper()}**",
                f"{word.capitalize()}, I checked.",
                f"The answer is {word}.",
            )
        case Choice():
            return _name_wordings(expected.value)
        case Text():
            text = expected.accepted[0]
            return f'It reads "{text}".', text, f"The text says '{text}'.", f"It says **{text}**.", f'"{text.upper()}"'
        case NameSet():
            return _set_wordings(expected.value)
        case Ordering():
            listed = ", ".join(expected.value)
            in_sequence = ", then ".join(expected.value)
            numbered = "\n".join(f"{n}. {name}" for n, name in enumerate(expected.value, 1))
            return listed, f"The order is {listed}.", in_sequence.capitalize() + ".", " > ".join(expected.value), numbered
        case Relation():
            return _relation_wordings(expected, expected.value)
        case Description():
            return _description_wordings([fact.any_of[0] for fact in expected.facts])
        case NoneThere():
            many = pluralise(expected.subject[0])
            return "None.", "No.", f"There are no {many}.", f"I don't see any {many}.", f"No {many} are visible."
        case ActionOnly():
            return "Done.", "Ready.", "The camera is there.", "OK.", "I have done that."


def offered_answers(expected: AnyExpected, question: str) -> tuple[str, ...]:
    """Return the answers that a question offers ("on the left or on the right?"), in its order; empty if it offers none."""
    if not isinstance(expected, Choice | NameSet | Ordering):
        return ()
    mentions = list[tuple[int, int, str]]()
    for name, others in expected.options.items():
        for word in (name, *others):
            mentions += [(m.start(), m.end(), name) for m in re.finditer(rf"\b{re.escape(word)}\b", question, re.IGNORECASE)]
    mentions.sort(key=lambda mention: (mention[0], -mention[1]))
    names = list[str]()
    for (_, end, one), (start, _, other) in pairwise(mentions):
        if one != other and 0 < start - end <= _MAX_OFFER_GAP and not set(question[end:start]) & set(".?!:;"):
            names += [other] if names else [one, other]
        elif len(names) > 1 and start >= end:
            break
    return tuple(dict.fromkeys(names))


_MAX_OFFER_GAP = 26
"""Maximum number of characters between two offered answers, such as " or the "."""


def wrong_answer(expected: AnyExpected, rng: random.Random) -> str | None:
    """Return a wrong answer that the answer parser can read; None for a command or a question with only one option."""
    match expected:
        case Number():
            steps = [
                expected.tolerance + rng.choice((1, 2)),
                *([-expected.tolerance - 1] if expected.value > expected.tolerance else []),
            ]
            return rng.choice(_number_wordings(float(round(expected.value + rng.choice(steps))), expected.unit))
        case YesNo():
            return rng.choice(correct_answers(expected.model_copy(update={"value": not expected.value})))
        case Choice():
            others = [name for name in expected.options if name != expected.value]
            return rng.choice(_name_wordings(rng.choice(others))) if others else None
        case Text():
            return f'It reads "{_misread_character(expected.accepted[0], rng)}".'
        case NameSet():
            return rng.choice(_set_wordings(_wrong_set(expected, rng)))
        case Ordering():
            first, second, *rest = expected.value
            return ", ".join((second, first, *rest))
        case Relation():
            return rng.choice(_relation_wordings(expected, "backward" if expected.value != "backward" else "forward"))
        case Description():
            facts = [fact.any_of[0] for fact in expected.facts]
            if expected.contradictions and rng.random() < 0.5:
                return _description_wordings([*facts, rng.choice(expected.contradictions).any_of[0]])[0]
            facts.pop(rng.randrange(len(facts)))
            return _description_wordings(facts)[0] if facts else "A view."
        case NoneThere():
            one = expected.subject[0]
            return rng.choice(("Yes.", f"There is a {one}.", f"I can see 2 {pluralise(one)}."))
        case ActionOnly():
            return None


def pluralise(words: str) -> str:
    """Return the plural of a noun phrase by simple rules."""
    noun = re.split(r" (?:in|who|with|of|on|for|carrying) ", words)[0]
    if noun != words:
        return pluralise(noun) + words[len(noun) :].replace(" who is ", " who are ")
    if words.endswith("person"):
        return words[:-6] + "people"
    if words.endswith("f") and words.endswith(("loaf", "leaf", "shelf")):
        return words[:-1] + "ves"
    if words.endswith("y") and words[-2:-1] not in "aeiou":
        return words[:-1] + "ies"
    return words + ("es" if words.endswith(("s", "x", "ch", "sh")) else "" if words.endswith("people") else "s")


def number_in_words(number: int) -> str:
    """Return a whole number in words if it is from 0 to 99, otherwise in digits."""
    if not 0 <= number < 100:
        return str(number)
    return number_word(number)


def _number_wordings(value: float, unit: Sequence[str]) -> tuple[str, ...]:
    number = f"{value:g}"
    word = number_in_words(int(value)) if value == int(value) else number
    noun = unit[0] if unit else "thing"
    things = noun if value == 1 else pluralise(noun)
    verb = "is" if value == 1 else "are"
    if value == 0 and not unit:
        return "0", "Zero.", "None.", "The answer is 0.", "It is zero."
    if value == 0:
        return f"There are no {things}.", "None.", "0", f"I see no {things}.", f"No {things} are visible."
    if not unit:
        return number, f"**{number}**", f"The answer is {number}.", word.capitalize() + ".", f"It is {number}."
    return (
        f"There {verb} {number} {things}.",
        number,
        f"I count {word} {things} in the view.",
        f"{things}: {number}",
        f"{word.capitalize()}.",
    )


def _name_wordings(name: str) -> tuple[str, ...]:
    return name, f"It is {name}.", f"**{name.capitalize()}**", f"The answer is {name}.", f"I would say {name}."


def _set_wordings(names: Sequence[str]) -> tuple[str, ...]:
    if not names:
        return "None.", "Nothing.", "There are none.", "none", "None of them is there."
    listed = " and ".join([", ".join(names[:-1]), names[-1]]) if len(names) > 1 else names[0]
    bullets = "\n".join(f"- {name}" for name in names)
    return listed, f"I can see {listed}.", bullets, f"There are: {', '.join(names)}.", " & ".join(reversed(names))


def _relation_wordings(expected: Relation, value: str) -> tuple[str, ...]:
    one, two = expected.subject[0], expected.object[0]
    if value == "same":
        return (
            "The same.",
            "They are equal.",
            "Both are the same.",
            f"The {one} and the {two} are the same.",
            "There is no difference.",
        )
    words = expected.forward if value == "forward" else expected.backward
    opposite = expected.backward if value == "forward" else expected.forward
    wordings = []
    for options, first, second in ((words, one, two), (opposite, two, one)):
        for word in options[:2]:
            link = "of" if word in _DIRECTIONS else "than"
            wordings += [f"The {first} is {word} {link} the {second}.", f"{first}: {word} {link} {second}"]
    wordings.append(f"I would say that {wordings[0][0].lower()}{wordings[0][1:]}")
    if not any(word in _DIRECTIONS for word in (*words, *opposite)):
        wordings += [f"The {one if value == 'forward' else two}."]
    return tuple(wordings)


def _description_wordings(facts: Sequence[str]) -> tuple[str, ...]:
    listed = ", ".join(facts)
    return (
        f"The view shows {listed}.", f"I can see {listed}.", f"{listed}", "\n".join(f"- {fact}" for fact in facts),
        f"There is {listed}, among other things.",
    )  # fmt: skip


def _wrong_set(expected: NameSet, rng: random.Random) -> tuple[str, ...]:
    missing = [name for name in expected.options if name not in expected.value]
    if missing and (not expected.value or rng.random() < 0.5):
        return (*expected.value, rng.choice(missing))
    return (
        tuple(name for name in expected.value if name != rng.choice(expected.value))
        if len(expected.value) == 1
        else expected.value[:-1]
    )


def _misread_character(text: str, rng: random.Random) -> str:
    """Return text with one letter or digit replaced by a different one. "0" and "O" do not replace each other."""
    positions = [index for index, letter in enumerate(text) if letter.isalnum()]
    index = rng.choice(positions)
    others = [
        letter
        for letter in _REPLACEMENT_CHARACTERS
        if letter.lower() != text[index].lower() and {letter, text[index].upper()} != {"0", "O"}
    ]
    return text[:index] + rng.choice(others) + text[index + 1 :]
