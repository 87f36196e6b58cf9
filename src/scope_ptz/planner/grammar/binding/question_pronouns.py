"""Replace the pronouns of a question by what they refer to."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from scope_ptz.english import article
from scope_ptz.english.grammar.parts_of_speech import parts_of_speech
from scope_ptz.planner.grammar.binding.focus import OF_THEM
from scope_ptz.planner.grammar.binding.narrowing import last_item
from scope_ptz.planner.grammar.binding.noun_heads import bare_noun, has_one, is_ranked, names_animal, names_person, names_several
from scope_ptz.planner.grammar.execution.answer_sentences import head_and_rest, noun

_SUBJECTS = frozenset({"it", "he", "she", "they", "him", "them", "those", "these"})
_POSSESSIVES = frozenset({"its", "his", "their"})
_DETERMINERS = frozenset(
    {"the", "a", "an", "any", "some", "each", "every", "this", "that", "anyone", "anybody", "someone", "who", "whose"}
)
_PERSONS = frozenset({"anyone", "anybody", "someone", "somebody", "who", "whose"})
_NEW_CLAUSE = frozenset({"and", "or", "but", "if", "when", "while", "because", "before", "after", "so"})
_PERSONAL = frozenset({"he", "she", "him", "his", "her"})
_DUMMY_IT = re.compile(
    r"\bit\s+(?:raining|dark|light|day|night|sunny|foggy|cloudy|snowing|busy|daytime|wet|bright|safe|windy|snowy|like|late|early|hot"
    r"|cold|warm|drizzling|pouring|hailing|sleeting|freezing|getting \w+|rain|snow|going to (?:rain|snow)|stop raining"
    r"|have (?:rained|snowed))\b"
    r"|\bwhat(?:['’]s| is) it(?:\W*$| like\b)|\bit is\b"
    r"|\b(?:what|which)\s+(?:time|day|date|year|month|season)\s+is\s+it\b"
    r"|\bhow\s+(?:(?:long|late|cold|warm|hot)\s+is\s+it\b|far\s+is\s+it\s+(?:to|from)\b)"
    r"|\b(?:is|was)\s+it\s+(?:true|possible|likely|the case)\b",
    re.IGNORECASE,
)
"""Wordings in which "it" stands for the weather, the time, a distance or a statement."""

_SAYS_ON = re.compile(
    r"(?P<what>what) does it (?:say|read) (?:on|above|over|across) (?P<thing>(?:the|that|this|those|these) .+?)(?P<end>\W*)",
    re.IGNORECASE,
)
_ONE = re.compile(
    r"\b(?P<before>which|each|every|that|this|another|any|the(?: [\w'’-]+){0,3}) (?P<one>ones?)\b"
    r"(?! (?:of|hundred|thousand|metre|meter)\b)",
    re.IGNORECASE,
)
_ITEM_ONE = re.compile(
    r"\b(?:wear|wears|wearing|have|has|carry|carries|carrying|hold|holds|holding) (?P<one>one)(?=\W*$)", re.IGNORECASE
)
"""Wordings in which "one" is something that people wear or carry."""

_OTHER_ONE = re.compile(r"\bthe other one\b", re.IGNORECASE)

_PROPERTY = frozenset(
    {"colour", "color", "name", "number", "plate", "registration", "sign", "text", "price", "make", "type", "state", "height"}
)

Referent = Callable[[str], str]
"""Returns the description that a pronoun refers to; empty if there is none. It may raise the question to ask the user."""


def is_impersonal(text: str) -> bool:
    """Return whether "it" in the text refers to no object, as in "is it raining?" and "what time is it?"."""
    return bool(_DUMMY_IT.search(text))


def without_anticipation(question: str) -> str:
    """Return "what does the blue cabin say?" for "what does it say on the blue cabin?", in which "it" refers to nothing."""
    match = _SAYS_ON.fullmatch(question.strip())
    if match is None:
        return question
    verb = "do" if names_several(match["thing"]) else "does"
    return f"{match['what']} {verb} {match['thing']} say{match['end']}"


def with_noun_for_one(question: str, referent: Referent) -> str:
    """Return a question with the noun that "one" stands for: "what colour is the nearest taxi?" for "... the nearest one?"."""
    if (worn := _ITEM_ONE.search(question)) is not None and (item := last_item(referent("ones"))):
        return f"{question[: worn.start('one')]}{article(item)}{question[worn.end('one') :]}"
    match = _ONE.search(question)
    if match is None or not has_one(match[0]):
        return question
    if not (description := referent("ones")):
        return question
    words = head_and_rest(description)[0]
    is_whole = match["before"].lower() in {"which", "each", "every", "any"} and not is_ranked(words)
    named = noun(words if is_whole else bare_noun(words), 2 if match["one"].lower() == "ones" else 1)
    return f"{question[: match.start('one')]}{named}{question[match.end('one') :]}"


def names_other_one(question: str) -> bool:
    """Return whether a question is about "the other one"."""
    return _OTHER_ONE.search(question) is not None


def with_other_one(question: str, referent: Referent) -> str:
    """Return a question with "the other one" replaced by what it refers to: "what is the right dog doing?"."""
    match = _OTHER_ONE.search(question)
    if match is None or not (description := referent("one")):
        return question
    return f"{question[: match.start()]}the {description}{question[match.end() :]}"


def with_referents(question: str, referent: Referent) -> str:
    """Return a question in which pronouns are replaced by what they refer to, unless that is named in the question itself.

    Args:
        question: The question.
        referent: Returns what a pronoun refers to.
    """
    if is_impersonal(question):
        return question
    pieces = re.split(r"([\w'’-]+)", question)
    places = list(range(1, len(pieces), 2))
    words = [pieces[i].lower() for i in places]
    for i, word in enumerate(words):
        is_her = word == "her"
        is_possessive = word in _POSSESSIVES or (is_her and i + 1 < len(words))
        if not (word in _SUBJECTS or is_possessive or is_her) or _is_inside(words, i, is_possessive=is_possessive):
            continue
        if word in {"those", "these"} and i + 1 < len(words) and "NOUN" in parts_of_speech(words[i + 1]):
            continue
        is_partitive = words[i - 1 : i] == ["of"] and word == "them"
        if not (description := referent(OF_THEM if is_partitive else word)):
            continue
        if is_possessive:
            _insert_owner(pieces, words, i, description)
        else:
            pieces[places[i]] = f"the {description}"
            _agree(pieces, words, i, plural=names_several(description))
        return "".join(pieces)
    return question


def _insert_owner(pieces: list[str], words: Sequence[str], i: int, description: str) -> None:
    """Replace "his" by "the worker's", or "his jacket" by "the jacket of the worker in the van"."""
    place = 2 * i + 1
    part, of_whole = head_and_rest(description)
    if (
        part.lower().split(" ") == list(words[i + 1 : i + 1 + len(part.split(" "))]) and of_whole
    ):  # "its plate" after "the plate of the van"
        pieces[place] = "the"
        pieces[2 * (i + len(part.split(" "))) + 1] += of_whole
        return
    if not of_whole and not is_ranked(description):
        pieces[place] = f"the {description}'s" if not description.endswith("s") else f"the {description}'"
        return
    size = 1 if i + 2 >= len(words) or words[i + 1] in _PROPERTY or "NOUN" not in parts_of_speech(words[i + 2]) else 2
    last = min(place + 2 * size, len(pieces) - 2)
    pieces[place] = "the"
    pieces[last] = f"{pieces[last]} of the {description}"


def _agree(pieces: list[str], words: Sequence[str], i: int, *, plural: bool) -> None:
    """Make the verb before a pronoun agree with what takes the place of the pronoun: "are they" becomes "is the bus"."""
    if i == 0:
        return
    pairs = {"is": "are", "does": "do", "has": "have", "was": "were"}
    forms = pairs if plural else {several: one for one, several in pairs.items()}
    if words[i - 1] in forms and words[i] in {"it", "he", "she", "they"}:
        pieces[2 * i - 1] = forms[words[i - 1]]


def _is_inside(words: Sequence[str], i: int, *, is_possessive: bool) -> bool:
    """Return whether a pronoun refers to a noun phrase before it in the same question: "does the bus have its lights on?"."""
    first = next((j for j in range(i) if words[j] in _DETERMINERS), None)
    if first is None:
        return False
    if not is_possessive and not _NEW_CLAUSE & set(words[first + 1 : i]):
        return False  # the object of a verb is not its subject: "is the man watching it?"
    person = (
        words[first] in _PERSONS or names_person(" ".join(words[first + 1 : i])) or names_animal(" ".join(words[first + 1 : i]))
    )
    if words[i] in _PERSONAL:
        return person
    return not person or words[i] in {"they", "their", "them"}
