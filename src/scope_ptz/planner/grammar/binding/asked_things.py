"""Find the thing that a question asks about: the words of the question that describe it, and its description."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

from scope_ptz.english import singular
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.question_parser import parse_description, parse_question
from scope_ptz.english.grammar.questions.recognition import is_description
from scope_ptz.planner.grammar.binding.narrowing import is_state, is_worn
from scope_ptz.planner.grammar.binding.noun_heads import is_ranked, names_several, without_predicate

if TYPE_CHECKING:
    from scope_ptz.planner.grammar.instruction_tree import Thing

_MAX_WORDS = 16  # longer questions are not searched, because the search takes quadratic time
_ARTICLE = re.compile(
    r"\b(?:(?:an?|any|some|each|every|all|this|that|these|those)|(?:(?:any|each|all|some)\s+of\s+)?(?:the|these|those))\s+",
    re.IGNORECASE,
)
_PRONOUNS = frozenset({
    "it", "he", "she", "they", "him", "her", "them", "one", "ones", "this", "that", "these", "those", "there", "thing", "things",
    "anything", "something", "everything", "text", "you", "who", "what",
})  # fmt: skip
"""Words that describe no thing of their own."""
_WHO = re.compile(r"who(?:['’]s| is| are| has| have|se)?\s+|who(?=\w)", re.IGNORECASE)
_OF_GROUP = re.compile(
    r"of (?:the|these|those) (?P<noun>[\w-]+(?: [\w-]+)??) (?=(?:is|are|has|have|wears?|carr(?:y|ies)|holds?) )", re.IGNORECASE
)
_WHICH = re.compile(
    r"(?:which|what)\s+(?:of\s+(?:the|these|those)\s+)?(?P<noun>.+?)\s+(?P<verb>is|are|has|have|does|do|looks?|wears?|carr(?:y|ies)|holds?)\s+"
    r"(?P<rest>.+)",
    re.IGNORECASE,
)
_LEFT = re.compile(r" (?:gone|going|got to|off to|now)$", re.IGNORECASE)
"""Words at the end of "where has the van gone" that do not describe the thing."""

_NUMBERED = re.compile(r"(?P<kind>[a-z][a-z -]*) \d+", re.IGNORECASE)
_PLAIN_ARTICLES = frozenset({"the", "any", "some"})
_ENDS_RANKED = re.compile(r"(?P<asked>.+ )[\w-]+")
_VERB_BEFORE = re.compile(r"\b(?:is|are|does|do|has|have) $", re.IGNORECASE)
_VERBS = {"has": "with", "have": "with", "wear": "wearing", "carry": "carrying", "hold": "holding"}
_PERSON = frozenset({"anyone", "anybody", "someone", "somebody", "everyone", "everybody"})
_PART_OF = re.compile(r"(?P<part>[\w -]+) of the (?P<owner>.+)")
_OWNER = re.compile(r"(.+\w)['’]s? \w")
_ANYONE = re.compile(r"\b(?:any|some|every)(?:one|body)\b", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class AskedThing:
    """The thing that a question asks about.

    Attributes:
        description: Its description, such as "car" for "what colour is the car?" and "nearest car" for "which car is nearest?".
        start: Where the words that describe it begin in the question, so that another thing can take their place.
        end: Where these words end.
    """

    description: str
    start: int
    end: int


@lru_cache(maxsize=512)
def asked_thing(question: str) -> AskedThing | None:
    """Return the thing that a question asks about; None if it asks about no thing, or about several."""
    text = question.rstrip("?!. ")
    words = list(re.finditer(r"\S+", text))
    if not 0 < len(words) <= _MAX_WORDS:
        return None
    asked = parse_question(question)
    tests = asked.tests if isinstance(asked, tree.What) else ()
    if asked is not None and (tests or _WHO.match(text)) and (found := _with_predicate(text, tests)) is not None:
        return found
    described = _described(asked)
    if described is None or len(described.phrases) != 1:
        return None
    plain = _without_article(described)
    for start in reversed(range(len(words))):
        for end in range(len(words), start, -1):
            span = text[words[start].start() : words[end - 1].end()].rstrip(",;")
            if is_description(span) and _without_article(parse_description(span)) == plain:
                return _asked(text, asked, words[start].start(), words[start].start() + len(span))
    return None


def two_things(question: str) -> tuple[str, ...]:
    """Return the two things of a question: "taxi" and "bus" for "where are the taxi and the bus?"; nothing for others."""
    asked = parse_question(question)
    described = asked.options if isinstance(asked, tree.Which) else _described(asked)
    if described is None or len(described.phrases) != 2:
        return ()
    if any(phrase.tests or phrase.order or phrase.ordinal for phrase in described.phrases):
        return ()  # their words alone do not describe them
    return tuple(" ".join(phrase.words) for phrase in described.phrases)


def with_other_thing(question: str, description: str) -> str | None:
    """Return the same question about another thing: "what colour is the green lorry?"; None if it asks about no thing.

    Another number replaces that of the same kind: with "dock 6", "is there a lorry at dock 5?" asks about a lorry at dock 6.
    """
    if (numbered := _NUMBERED.fullmatch(description)) is not None:
        same_kind = re.compile(rf"\b{re.escape(numbered['kind'])} \d+\b", re.IGNORECASE)
        if len(same_kind.findall(question)) == 1:
            return same_kind.sub(description, question)
    thing = asked_thing(question)
    if thing is None or thing.end <= thing.start:
        return None
    asked_words = question[thing.start : thing.end]
    if asked_words.split(" ")[0].lower() in _PERSON and description.startswith("person "):
        return f"{question[: thing.start]}anyone{description.removeprefix('person')}{question[thing.end :]}"
    if (owned := _PART_OF.fullmatch(description)) is not None:
        part = re.match(r"['’]s? [\w-]+", question[thing.end :])
        if part is not None and owned["owner"].lower() == thing.description.lower():  # "his bike" after "the cyclist's jacket"
            return f"{question[: thing.end]}'s {owned['part']}{question[thing.end + part.end() :]}"
    article = _ARTICLE.match(asked_words)
    is_numbered = description.split(" ")[-1].isdigit()  # "dock 3"
    is_part = description.lower().startswith(f"{thing.description.lower()} ")  # "a dog on the right"
    is_kept = article is not None and (is_part or article[0].lower().strip() in _PLAIN_ARTICLES)
    kept = "" if is_numbered else article[0] if article is not None and is_kept else "the "
    before = _VERB_BEFORE.search(question[: thing.start])
    lead = question[: thing.start]
    if before is not None:
        lead = lead[: before.start()] + _form(before[0], plural=names_several(description))
    return f"{lead}{kept}{description}{question[thing.end :]}"


def with_other_predicate(question: str, named: Thing) -> str:
    """Return a question that asks the same about the same thing in another respect; empty if the words name another thing.

    After "what is behind the van?", "in front of it" asks "what is in front of it?". After "is the red car the nearest?", "the
    farthest" asks "is the red car the farthest?".
    """
    asked = parse_question(question)
    if isinstance(asked, tree.Describe) and any(isinstance(test, tree.Relation) for test in asked.tests) and named.predicate:
        tests = {type(test) for phrase in parse_description(f"thing {named.predicate}").phrases for test in phrase.tests}
        return f"what is {named.predicate}?" if tests == {tree.Relation} else ""
    ranked = _ENDS_RANKED.fullmatch(question.rstrip("?!. "))
    is_yes_no = isinstance(asked, tree.YesNo) and any(isinstance(test, tree.Order) for test in asked.tests)
    is_rank = " " not in named.text and is_ranked(f"{named.text} thing")
    return f"{ranked['asked']}{named.text}?" if ranked is not None and is_yes_no and is_rank else ""


def _form(verb: str, *, plural: bool) -> str:
    """Return "are " for "is " before a plural, and the reverse."""
    pairs = {"is": "are", "does": "do", "has": "have"}
    forms = pairs if plural else {several: one for one, several in pairs.items()}
    return f"{forms.get(verb.strip().lower(), verb.strip())} "


def _described(question: tree.Question | None) -> tree.Description | None:
    """Return the description of the thing that a question asks about; None for questions about no thing or about several."""
    match question:
        case tree.YesNo(subject=what):
            return what
        case tree.IsA(subject=what):
            return what
        case tree.Describe(tests=(tree.Relation(other=what),), what=None):
            return what  # "what is to the left of the road roller?"
        case (
            tree.Exists(what=what) | tree.Count(what=what) | tree.Ask(what=what) | tree.Read(what=what) | tree.Price(what=what)
            | tree.Time(what=what) | tree.Where(what=what) | tree.Quarter(what=what) | tree.What(what=what)
            | tree.KindOf(what=what) | tree.Identify(what=what) | tree.HowFar(what=what) | tree.Describe(what=what)
            | tree.TextExists(what=what)
        ):  # fmt: skip
            return what
        case _:
            return None


def _without_article(description: tree.Description) -> tree.Description:
    return tree.Description(tuple(tree.Phrase(p.words, p.tests, p.order, p.ordinal, p.amount) for p in description.phrases))


def _asked(text: str, asked: tree.Question | None, start: int, end: int) -> AskedThing | None:
    """Return the thing that a span of a question describes.

    The grammar reads a predicate as part of the noun phrase ("is the bus moving?"). It is left out, unless it says which person is
    meant ("is anyone wearing a helmet?").
    """
    noun_phrase = text[start:end]
    first = noun_phrase.split(" ")[0].lower()
    if first in _PRONOUNS:
        return None
    description = _LEFT.sub("", noun_phrase) if isinstance(asked, tree.Where) else noun_phrase
    if isinstance(asked, tree.YesNo):
        with_rest = without_predicate(text[start:])
        is_marked = (text[end:].startswith(" with ") or is_worn(with_rest)) and len(with_rest) < len(
            text
        ) - start  # "is the man with an umbrella walking?"
        marked = with_rest if is_marked else _with_first_test(text[start:], asked.tests)
        if (
            isinstance(asked.tests[-1:][0] if asked.tests else None, tree.Has)
            and (worn := _before_verb(text[start:]))
            and is_worn(worn)
        ):
            marked = worn  # "does the man in the red jacket have a helmet?"
        description = marked or without_predicate(noun_phrase)
        if not description:
            return None
        end = start + len(description)
        if first in _PERSON:
            description, end = text[start:], len(text)
    article = next((match for match in _ARTICLE.finditer(text) if match.end() == start), None)
    start = article.start() if article else start
    if (owner := _OWNER.match(description)) is not None:
        return AskedThing(owner[1], start, end - len(description) + len(owner[1]))  # "what colour is the worker's helmet?"
    return AskedThing(_ANYONE.sub("person", description), start, end)


def _before_verb(text: str) -> str:
    """Return the words before the verb of having: "man in the red hat" of "man in the red hat have a bag"; else nothing."""
    before, verb, _ = text.partition(" have ")
    return before if verb else ""


def _with_first_test(text: str, tests: Sequence[tree.Test]) -> str:
    """Return the subject of a question with what marks it: "man in the red helmet" of "man in the red helmet on the phone".

    Of several predicates, only the last one is asked about. Empty if there is only one.
    """
    if len(tests) < 2:
        return ""
    last = tests[-1]
    predicates = rf" {re.escape(last.preposition)} " if isinstance(last, tree.Relation) and last.preposition else r" \w+ing "
    begins = [match.start() for match in re.finditer(predicates, f"{text} ")]
    return text[: begins[-1]] if begins else ""


def _with_predicate(text: str, tests: Sequence[tree.Test]) -> AskedThing | None:
    """Return the thing of "which car is nearest?" ("nearest car") and "who is at the kiosk?" ("person at the kiosk")."""
    order = next((test for test in tests if isinstance(test, tree.Order)), None)
    if (who := _WHO.match(text)) is not None:
        verb, rest = who[0].split()[-1].lower() if " " in who[0].strip() else "", text[who.end() :]
        noun, start = "person", who.start()
        if (group := _OF_GROUP.match(rest)) is not None:  # "who of the workers wears a white helmet?"
            noun, rest = singular(group["noun"].lower()), re.sub(r"^(?:is|are) ", "", rest[group.end() :])
        is_has = who[0].split()[-1].lower() in {"has", "have"}
        if rest.split(" ")[0].lower() in _PRONOUNS or (_ARTICLE.match(rest) and not is_has):
            return None  # "who's there?", "who is the man on the left?"
    elif (which := _WHICH.fullmatch(text)) is not None:
        verb, rest, noun, start = which["verb"].lower(), which["rest"], which["noun"], which.start("noun")
    else:
        return None
    if noun.split(" ")[-1].lower() in _PRONOUNS:
        return None
    if order is not None:
        rank = re.sub(r"^the | to (?:the camera|us|you)$", "", rest, flags=re.IGNORECASE)
        return AskedThing(f"{singular(noun)} {rank}" if " " in rank else f"{rank} {singular(noun)}", start, start)
    first, _, tail = rest.partition(" ")
    verb = {"doesn't": "without", "don't": "without"}.get(verb, verb)
    if first.lower() in {"wears", "wear", "carries", "carry", "holds", "hold", "has", "have"}:
        verb, rest = re.sub(r"ies$", "y", first.lower()).removesuffix("s") if first.lower() != "has" else "has", tail
    if verb in {"is", "are"} and " " not in rest and is_state(rest.lower()):
        return AskedThing(f"{rest} {noun}", start, start)  # "which dock doors are open?"
    joint = _VERBS.get(re.sub(r"ies$", "y", verb).removesuffix("s") if verb not in {"has", "is"} else verb, "")
    return AskedThing(" ".join(x for x in (noun, joint, rest) if x), start, start)
