"""Answer questions about the scene as a whole, and about what is happening."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from scope_ptz import english
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.ground_truth.answers.counted_things import add_tests
from scope_ptz.perception.ground_truth.answers.legible_text import quotes
from scope_ptz.perception.ground_truth.answers.locations import answer_what
from scope_ptz.perception.ground_truth.answers.restating import none_in_view, noun_phrase
from scope_ptz.perception.ground_truth.answers.thing_names import (
    TruthAnswer,
    coloured_name,
    distance_words,
    is_or_are,
    known_answer,
    list_names,
    position_words,
)
from scope_ptz.perception.ground_truth.answers.values import activity_of
from scope_ptz.perception.ground_truth.relations import BACKGROUND_CONCEPTS
from scope_ptz.perception.ground_truth.thing_facts import ABSENT_VALUES, COLOUR_KEYS, colour_of, fact_words, facts, key_words
from scope_ptz.perception.ground_truth.thing_search import find
from scope_ptz.perception.ground_truth.view import Thing, View

MAX_GROUPS = 10
"""Maximum number of groups of things in a view's description."""
MAX_TEXTS = 3
"""Maximum number of texts in a view's description, and maximum number of things to describe individually."""
NON_ACTIVITIES = frozenset({None, "parked", "open", "closed", "lit", "unlit", "standing", "full", "empty", "stationary", "fallen"})
"""States that are not activities."""


def answer_describe(view: View, question: tree.Describe) -> TruthAnswer:
    """Describe the view, people first and then the largest things, with the legible texts."""
    if question.what is not None:
        return _describe_things(view, question.what, question.tests)
    if question.tests:
        return _answer_load(view, question.tests) or answer_what(
            view, tree.What(tree.Description((tree.Phrase(("thing",)),)), question.tests)
        )
    people = find(view, tree.Description((tree.Phrase(("people",)),)))
    others = [t for t in view.top_level() if t not in people and not t.concepts & BACKGROUND_CONCEPTS]
    groups = _group_things(others)
    if not (people or groups):
        return known_answer("I can see nothing that stands out")
    shown = _most_important(groups, MAX_GROUPS - bool(people))
    parts = english.listing([*_people_words(people), *(group.words for group in shown)])
    if len(shown) < len(groups):
        parts += ", among other things"
    texts = quotes(view.texts)[:MAX_TEXTS]
    readable = f". I can read {english.listing(texts)}" if texts else ""
    return known_answer(f"I can see {parts}{readable}")


def _answer_load(view: View, tests: tuple[tree.Test, ...]) -> TruthAnswer | None:
    """Answer "what is on the trailer?" with the load that the scene states; None if the scene does not state it."""
    match tests:
        case (tree.Relation(kind="on", other=other),):
            carrier = next(iter(find(view, other)), None)
            load = carrier.attributes.get("load") if carrier is not None else None
            if carrier is not None and isinstance(load, str) and load not in ABSENT_VALUES:
                return known_answer(f"the {coloured_name(carrier)} {position_words(carrier)} carries {load}")
    return None


def _describe_things(view: View, what: tree.Description, tests: tuple[tree.Test, ...]) -> TruthAnswer:
    """Describe individual things with all facts that the scene states about them."""
    matches = find(view, add_tests(what, tests))
    if not matches:
        return known_answer(none_in_view(view, what))
    if len(matches) > MAX_TEXTS:
        return known_answer(f"there are {len(matches)} {noun_phrase(view, what, plural=True)}: {list_names(matches)}")
    return TruthAnswer(" ".join(english.sentence(_thing_details(t)) for t in matches))


def _thing_details(thing: Thing) -> str:
    details = [
        f"{' '.join(key_words(k))} {v}" for k, v in facts(thing) if k not in COLOUR_KEYS and not isinstance(v, bool) and k != "kind"
    ]
    details += [" ".join(key_words(k)) for k, v in facts(thing) if v is True]
    texts = [f'it reads "{t}"' for t in thing.texts]
    location = (
        f"there is {english.article(coloured_name(thing))} {position_words(thing)}, about {distance_words(thing.distance_m)} away"
    )
    return "; ".join([location, *([", ".join(details)] if details else []), *texts])


def _people_words(people: Sequence[Thing]) -> list[str]:
    """Return the people in view as one group: "16 people". A count of people has the same number."""
    if len(people) == 1:
        return [f"{english.article(coloured_name(people[0]))} {position_words(people[0])}"]
    return [f"{len(people)} people"] if people else []


@dataclass(frozen=True, slots=True)
class _Group:
    """Things of one kind in words, and whether they are animals or vehicles, which no description leaves out."""

    words: str
    is_mobile: bool


def _most_important(groups: Sequence[_Group], number: int) -> list[_Group]:
    """Return at most ``number`` groups in their order: all animals and vehicles, and then the largest others."""
    kept = sorted(range(len(groups)), key=lambda i: (not groups[i].is_mobile, i))[:number]
    return [groups[i] for i in sorted(kept)]


_MOBILE = frozenset({"animal", "vehicle"})


def _group_things(things: Iterable[Thing]) -> list[_Group]:
    """Return groups of things, largest on screen first: "3 cars (2 white, 1 red)"."""
    by_kind: dict[str, list[Thing]] = {}
    for thing in sorted(things, key=lambda t: -t.sighting.pixels):
        by_kind.setdefault(thing.category, []).append(thing)
    parts = []
    for kind, members in by_kind.items():
        is_mobile = any(t.concepts & _MOBILE for t in members)
        if len(members) == 1:
            parts.append(_Group(f"{english.article(coloured_name(members[0]))} {position_words(members[0])}", is_mobile))
            continue
        colours = Counter(c for c in map(colour_of, members) if c)
        if list(colours.values()) == [len(members)]:
            parts.append(_Group(f"{len(members)} {next(iter(colours))} {english.plural(kind)}", is_mobile))
            continue
        shown = f" ({english.listing([f'{n} {c}' for c, n in colours.most_common()])})" if colours and len(colours) <= 4 else ""
        parts.append(_Group(f"{english.counted(len(members), kind)}{shown}", is_mobile))
    return parts


def answer_happening(view: View) -> TruthAnswer:
    """Answer which things are moving or active. If there are none, describe the view."""
    activities = Counter((t.category, activity) for t in view.top_level() if (activity := _activity_of(t)) is not None)
    if not activities:
        return TruthAnswer(f"Nothing is moving. {answer_describe(view, tree.Describe()).text}")
    parts = [
        f"{english.article(k) if n == 1 else english.counted(n, k)} {is_or_are(n)} {activity}"
        for (k, activity), n in activities.items()
    ]
    return known_answer(english.listing(parts[:MAX_GROUPS]))


def _activity_of(thing: Thing) -> str | None:
    activity = activity_of(thing)
    return activity if activity not in NON_ACTIVITIES else "moving" if "moving" in fact_words(thing) else None
