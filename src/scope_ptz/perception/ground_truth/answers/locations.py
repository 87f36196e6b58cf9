"""Answer questions of the forms "where is ...?" and "what is ...?"."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import nouns_in
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.ambiguity import is_person
from scope_ptz.perception.ground_truth.answers.clock_times import answer_clock_time
from scope_ptz.perception.ground_truth.answers.counted_things import add_tests
from scope_ptz.perception.ground_truth.answers.legible_text import answer_read
from scope_ptz.perception.ground_truth.answers.restating import (
    definite_as_asked,
    is_plural,
    none_in_view,
    noun_phrase,
    predicate_words,
    unmodelled_background,
    unmodelled_place,
    words_after_noun,
)
from scope_ptz.perception.ground_truth.answers.thing_names import (
    TruthAnswer,
    coloured_name,
    distance_words,
    known_answer,
    list_names,
    names_with_positions,
    position_words,
    unknown_answer,
)
from scope_ptz.perception.ground_truth.answers.undecided import undecided_reason
from scope_ptz.perception.ground_truth.answers.values import (
    UNANSWERABLE_SUBJECTS,
    WRITTEN_FACTS,
    answer_absent,
    answer_fact_in_view,
    value_of,
)
from scope_ptz.perception.ground_truth.answers.vehicle_interiors import answer_about_occupants, asked_vehicle
from scope_ptz.perception.ground_truth.answers.verdicts import missing_reference
from scope_ptz.perception.ground_truth.relations import NEAR_M, relation_holds, stands_above
from scope_ptz.perception.ground_truth.thing_search import find, holds
from scope_ptz.perception.ground_truth.view import Thing, View

MAX_LOCATED = 3
"""Maximum number of things to locate individually. If there are more, they are counted by region of the frame."""
_NOT_REFERENCES = frozenset({"surface", "sky", "plant life", "mountain"})


def answer_where(view: View, question: tree.Where) -> TruthAnswer:
    """Answer where the things that match a description are."""
    matches = find(view, question.what)
    if not matches:
        return answer_absent(view, question.what)
    if len(matches) == 1:
        thing = matches[0]
        return known_answer(
            f"the {coloured_name(thing)} is {position_words(thing)}, "
            f"about {distance_words(thing.distance_m)} away{neighbour_words(view, thing)}"
        )
    if len(matches) > MAX_LOCATED:
        counts_by_place = Counter(position_words(t) for t in matches)
        places = english.listing([f"{n} {location}" for location, n in counts_by_place.items()])
    else:
        places = english.listing(
            [f"{english.article(coloured_name(t))} {position_words(t)} about {distance_words(t.distance_m)} away" for t in matches]
        )
    return known_answer(f"there are {len(matches)} {noun_phrase(view, question.what, plural=True)}: {places}")


def neighbour_words(view: View, thing: Thing) -> str:
    """Return a thing's relation to the largest thing near or in line with it (", next to the barrier"), or an empty string."""
    others = [
        t
        for t in view.top_level()
        if t is not thing and t.name != thing.name and not t.concepts & _NOT_REFERENCES and thing.parent != t.id
    ]
    nearby_things = [t for t in others if thing.gap_m(t) <= NEAR_M]
    if nearby_things:
        best = max(nearby_things, key=lambda t: t.sighting.pixels)
        side = _depth_side(view, thing, best)
        return f", {f'just {side}' if side else 'next to'} the {coloured_name(best)}"
    aligned = [t for t in others if _depth_side(view, thing, t)]
    if aligned:
        best = max(aligned, key=lambda t: t.sighting.pixels)
        return f", {_depth_side(view, thing, best)} the {coloured_name(best)}"
    return ""


def _depth_side(view: View, thing: Thing, other: Thing) -> str:
    """Return "behind", "in front of", or an empty string."""
    if relation_holds(view, thing, "behind", other):
        return "behind"
    return "in front of" if relation_holds(view, thing, "front", other) else ""


def answer_what(view: View, question: tree.What) -> TruthAnswer:
    """Answer with the names of all matching things."""
    if _refers_to_list(question.what):
        return _answer_listed(view, question)
    if question.tests == (tree.Says(()),):  # "what signs can you read?" asks for what they say
        return answer_read(view, tree.Read(question.what))
    missing = next((m for m in (missing_reference(view, t) for t in question.tests) if m is not None), None)
    if missing is not None and unmodelled_background(view, missing):
        kind = "who" if is_person(question.what.phrases[0].words) else f"which {noun_phrase(view, question.what)}"
        return unknown_answer(f"I cannot tell {kind} {predicate_words(view, question.tests, 1)}")
    if missing is not None:
        return answer_absent(view, missing)
    description = add_tests(question.what, question.tests)
    matches = find(view, description)
    thing_with_text = _thing_with_text(question)
    things_with_text = [] if thing_with_text is None else find(view.with_cut_off_texts(), thing_with_text)
    if things_with_text and (not matches or any("sign" in thing.concepts and thing.texts for thing in things_with_text)):
        return answer_read(view, tree.Read(thing_with_text))
    if not matches:
        return _answer_no_match(view, question, description)
    return answer_matches(
        view, question.tests, _sort_by_nearness(view, question.tests, _prefer_stacked(view, question.tests, matches))
    )


def _thing_with_text(question: tree.What) -> tree.Description | None:
    """Return the description of the thing whose text "what is on the sign?" asks for; None for other questions."""
    match question:
        case tree.What(
            what=tree.Description(phrases=(tree.Phrase(words=("thing",)),)), tests=(tree.Relation(kind="on", other=other),)
        ):
            return other
    return None


def _refers_to_list(description: tree.Description) -> bool:
    """Return whether a description ("the following", "these") does not name a thing but refers to a list after it."""
    words = {word for phrase in description.phrases for word in phrase.words}
    return bool(words) and words <= {"following", "these", "those", "them"}


def _answer_listed(view: View, question: tree.What) -> TruthAnswer:
    """Answer which of the things that the question lists are in view."""
    tests = [test for asked in question.tests for test in (asked.tests if isinstance(asked, tree.Any) else (asked,))]
    listed = tuple(tree.Phrase(test.words) for test in tests if isinstance(test, tree.Is))
    if not listed:
        return unknown_answer("I cannot tell: I do not know which ones are meant")
    matches = [thing for phrase in listed for thing in find(view, tree.Description((phrase,)))[:1]]
    return known_answer(f"I can see {list_names(matches)}" if matches else none_in_view(view, tree.Description(listed)))


def _answer_no_match(view: View, question: tree.What, description: tree.Description) -> TruthAnswer:
    """Answer if nothing matches: with a fact that the scene states ("which lane is closed?"), or by saying that nothing matches."""
    if (vehicle := asked_vehicle(view, description)) is not None:
        return answer_about_occupants(view, description, vehicle, is_yes_no=False)
    state_words = [x for t in question.tests if isinstance(t, tree.Is) for x in t.words]
    if state_words and not find(view, question.what):
        return answer_fact_in_view(view, (*question.what.phrases[0].words, *state_words))
    if unmodelled_place(view, description):
        where = english.listing([words_after_noun(view, t) for t in question.tests]) or noun_phrase(view, description)
        return unknown_answer(f"I cannot tell what is {where}")
    open_tests = [t for t in (*question.tests, *question.what.phrases[0].tests) if isinstance(t, tree.Has)]
    bare = tree.Description(tuple(replace(p, tests=()) for p in question.what.phrases))
    if any(
        holds(view, t, test) is None or (not test.worn and find(view, test.what)) for t in find(view, bare) for test in open_tests
    ):
        return unknown_answer(f"I cannot tell which {noun_phrase(view, bare, plural=True)} {predicate_words(view, open_tests, 2)}")
    if description.phrases[0].words == ("thing",):
        places = [t.other for t in question.tests if isinstance(t, tree.Relation) and not find(view, t.other)]
        if places and nouns_in(places[0].phrases[0].words, view.nouns):
            return answer_absent(view, places[0])
        return known_answer(f"I can see nothing {' '.join(words_after_noun(view, t) for t in question.tests)}")
    if reason := undecided_reason(view, description):
        return unknown_answer(reason)
    return answer_absent(view, description)


def _prefer_stacked(view: View, tests: tuple[tree.Test, ...], matches: list[Thing]) -> list[Thing]:
    """Return the things that stand on what they are above, if there are any: "which cabin is above the grey one?"."""
    lower = [a for t in tests if isinstance(t, tree.Relation) and t.kind == "above" for a in find(view, t.other)]
    return [t for t in matches if any(stands_above(t, a) for a in lower)] or matches


def _sort_by_nearness(view: View, tests: tuple[tree.Test, ...], matches: list[Thing]) -> list[Thing]:
    """Sort things by their distance from those that the relations in ``tests`` refer to. Without relations, keep the order."""
    anchors = [a for t in tests if isinstance(t, tree.Relation) for a in find(view, t.other)]
    return sorted(matches, key=lambda t: min(t.gap_m(a) for a in anchors)) if anchors else matches


def answer_matches(view: View, tests: tuple[tree.Test, ...], matches: list[Thing]) -> TruthAnswer:
    """Answer with things and their places: "a white van and 2 traffic cones are behind the barrier"."""
    rest = tuple(t for t in tests if not isinstance(t, tree.Order))
    if len(rest) < len(tests):
        return known_answer(
            f"it is the {coloured_name(matches[0])} {position_words(matches[0])}, "
            f"about {distance_words(matches[0].distance_m)} away"
        )
    if not rest:
        return known_answer(names_with_positions(matches) if len(matches) <= 3 else f"I can see {list_names(matches)}")
    location = f", {position_words(matches[0])}" if len(matches) == 1 and not any(isinstance(t, tree.Region) for t in rest) else ""
    return known_answer(f"{list_names(matches)} {predicate_words(view, rest, len(matches))}{location}")


def answer_present(view: View, question: tree.Present) -> TruthAnswer:
    """Answer which of the listed things are in view, in the words of the question."""
    kinds = [tree.Description((phrase,)) for phrase in question.options.phrases]
    seen = [_kind_with_article(view, kind) for kind in kinds if find(view, kind)]
    missing = [kind for kind in kinds if not find(view, kind)]
    if not seen:
        return known_answer(none_in_view(view, question.options))
    rest = f", but no {english.listing([noun_phrase(view, kind, is_plural(kind)) for kind in missing], 'or')}" if missing else ""
    return known_answer(f"I can see {english.listing(seen)}{rest}")


def _kind_with_article(view: View, kind: tree.Description) -> str:
    """Return a kind of thing in the words of the question: "a clock", "some clocks"."""
    return f"some {noun_phrase(view, kind, plural=True)}" if is_plural(kind) else english.article(noun_phrase(view, kind))


def answer_kind_of(view: View, question: tree.KindOf) -> TruthAnswer:
    """Answer what kind of thing something is, with the kind that the scene states or else with its name."""
    matches = find(view, question.what)
    kinds = Counter(kind for t in matches if (kind := value_of(t, ("kind",))) is not None)
    if kinds.total() < len(matches) or not matches:
        return answer_what(view, tree.What(question.what))
    if len(matches) == 1:
        return known_answer(f"{definite_as_asked(view, question.what)} is {english.article(next(iter(kinds)))}")
    return known_answer(f"I can see {english.listing([english.counted(count, kind) for kind, count in kinds.items()])}")


def _clocks_of(view: View, test: tree.Test) -> list[Thing]:
    """Return the clocks in "the time on the clock"; none for other tests."""
    return [t for t in find(view, test.other) if "clock" in t.concepts] if isinstance(test, tree.Relation) else []


def answer_identify(view: View, question: tree.Identify) -> TruthAnswer:
    """Answer what a thing is. If the words name a fact ("the speed limit"), answer with that fact."""
    if (vehicle := asked_vehicle(view, question.what)) is not None:
        return answer_about_occupants(view, question.what, vehicle, is_yes_no=False)
    phrase = question.what.phrases[0]
    fact = answer_fact_in_view(view, phrase.words)
    has_only_on_tests = all(isinstance(t, tree.Relation) and t.kind == "on" for t in phrase.tests)
    if phrase.words == ("time",) and (clocks := [t for test in phrase.tests for t in _clocks_of(view, test)]):
        return answer_clock_time(clocks)
    is_written = bool(WRITTEN_FACTS & set(phrase.words))
    if (fact.known or is_written) and has_only_on_tests and phrase.order is None:
        return fact
    matches = find(view, question.what)
    if not matches:
        return (
            fact
            if fact.known or UNANSWERABLE_SUBJECTS & set(phrase.words)
            else unknown_answer(f"I cannot tell: {none_in_view(view, question.what)}")
        )
    if len(matches) == 1:
        return known_answer(
            f"it is {english.article(coloured_name(matches[0]))} {position_words(matches[0])}, "
            f"about {distance_words(matches[0].distance_m)} away"
        )
    return known_answer(f"there are {len(matches)}: {list_names(matches)}")
