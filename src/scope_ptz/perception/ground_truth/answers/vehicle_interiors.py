"""Answer who is in a vehicle. A picture does not show that, unless the scene models the driver."""

from __future__ import annotations

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.ambiguity import is_person
from scope_ptz.perception.ground_truth.answers.restating import definite_as_asked, none_in_view
from scope_ptz.perception.ground_truth.answers.thing_names import (
    TruthAnswer,
    coloured_name,
    known_answer,
    position_words,
    unknown_answer,
)
from scope_ptz.perception.ground_truth.stated_items import as_worn
from scope_ptz.perception.ground_truth.thing_facts import ABSENT_VALUES
from scope_ptz.perception.ground_truth.thing_search import INSIDE, find
from scope_ptz.perception.ground_truth.view import Thing, View

_DRIVING = frozenset({"driving", "operating", "steering", "riding"})


_DRIVERS = frozenset({"driver", "drivers", "operator", "operators"})
_ANYONE = frozenset({"person", "people", "anyone", "anybody", "someone", "somebody", "who", "occupant", "occupants"})
_PASSENGERS = frozenset({"passenger", "passengers"})


def asked_vehicle(view: View, description: tree.Description) -> tree.Description | None:
    """Return the vehicle whose occupants a description names ("a driver in the taxi", "anyone driving the taxi"), or None."""
    (phrase, *others) = description.phrases
    if others or not phrase.words or not (is_person(phrase.words[:1]) or phrase.words[0] in _PASSENGERS | _DRIVING):
        return None
    driven = driven_vehicle(phrase)
    inside = [
        t.other
        for t in phrase.tests
        if isinstance(t, tree.Relation) and t.kind == "on" and t.preposition in {*INSIDE, "of", ""} and as_worn(t) is None
    ]
    if driven is not None and names_vehicle(driven):
        return driven  # if it is not in view, the answer says so
    candidates = [driven] if driven is not None else inside
    return next((c for c in candidates if _vehicles(view, c) or c.phrases[0].words == ("it",)), None)


def names_vehicle(description: tree.Description) -> bool:
    """Return whether the noun of a description is a vehicle or a machine, in view or not."""
    concept = lexicon().concept(description.phrases[0].words[-1])
    return concept is not None and bool(lexicon().kinds(concept) & {"vehicle", "machine"})


def driven_vehicle(phrase: tree.Phrase) -> tree.Description | None:
    """Return the vehicle in "anyone driving the taxi", which the parser reads as a state of a person; None if there is none."""
    words = [*phrase.words, *(x for t in phrase.tests if isinstance(t, tree.Is) for x in t.words)]
    start = next((i + 1 for i, x in enumerate(words) if x in _DRIVING), len(words))
    return tree.Description((tree.Phrase(tuple(words[start:]), article="the"),)) if words[start:] else None


def answer_about_occupants(
    view: View, description: tree.Description, vehicle: tree.Description, *, is_yes_no: bool = True
) -> TruthAnswer:
    """Answer who is in a vehicle: the people whom the scene models in it, or that this cannot be seen.

    Args:
        view: The view.
        description: The people that the question asks about.
        vehicle: The vehicle.
        is_yes_no: Whether the answer begins with "yes" or "no".
    """
    asked = description.phrases[0].words[0]
    vehicles = _vehicles(view, vehicle)
    if not vehicles and names_vehicle(vehicle):
        return known_answer(none_in_view(view, vehicle))
    occupants = [t for t in view.things if t.parent in {v.id for v in vehicles} and "person" in t.concepts]
    if occupants and asked in _DRIVERS | _ANYONE | _DRIVING:
        yes = "yes, " if is_yes_no else ""
        return known_answer(f"{yes}there is {english.article(coloured_name(occupants[0]))} {position_words(occupants[0])}")
    asks_for_driver = asked in _DRIVERS | _ANYONE | _DRIVING
    stated = {str(v.attributes.get("driver", "")).lower() for v in vehicles}
    named = definite_as_asked(view, vehicle)
    if asks_for_driver and stated == {"yes"}:
        yes = "yes, " if is_yes_no else ""
        return known_answer(f"{yes}{named} {'have drivers' if len(vehicles) > 1 else 'has a driver'}")
    if asks_for_driver and stated and stated <= ABSENT_VALUES - {""}:
        no = "no, " if is_yes_no else ""
        return known_answer(f"{no}{named} {'have no drivers' if len(vehicles) > 1 else 'has no driver'}")
    return unknown_answer(f"I cannot see who is in {'it' if vehicle.phrases[0].words == ('it',) else named}")


def _vehicles(view: View, vehicle: tree.Description) -> list[Thing]:
    return [t for t in find(view, vehicle) if t.concepts & {"vehicle", "machine"}]
