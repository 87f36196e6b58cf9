"""Descriptor tasks in pairs, about an absent and a present object, and questions about whether an object has a given colour."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace

from scope_ptz.bench.tasks.expected import Choice, NoneThere, YesNo
from scope_ptz.bench.tasks.task import EvidenceView
from scope_ptz.taskgen.authoring.drafts import Question, TaskDraft, count_call, evidence_view, query_call
from scope_ptz.taskgen.authoring.noun_phrases import (
    all_wordings,
    answer_words,
    colour_options,
    object_words,
    plain_colour,
    plural_noun,
    pluralise,
    singular_noun,
    with_article,
    with_the,
)
from scope_ptz.taskgen.authoring.object_names import unique_things
from scope_ptz.taskgen.authoring.task_places import TaskPlace
from scope_ptz.taskgen.authoring.view_contents import absent_kinds, countable_kinds, scene_kinds_first
from scope_ptz.taskgen.facts.kinds import Kind, are_similar_colours, is_colour_visible, own_colour


def drafts(place: TaskPlace, nouns: frozenset[str], rng: random.Random) -> Iterator[TaskDraft]:
    """Yield questions about presence, about a given colour, and about the colour of objects that may be absent."""
    yield from _presence_drafts(place, nouns, rng)
    yield from _colour_check_drafts(place, rng)
    yield from _conditional_colour_drafts(place, nouns, rng)


def _presence_drafts(place: TaskPlace, nouns: frozenset[str], rng: random.Random) -> Iterator[TaskDraft]:
    """Yield questions about whether an absent object is there, each with a twin about a present one."""
    present = [kind for kind, _ in countable_kinds(place.truth)]
    rng.shuffle(present)
    missing = scene_kinds_first(place, absent_kinds(place.truth, nouns), rng)
    for present_kind, absent_kind in zip(present, missing, strict=False):
        twin = _presence_draft(place, present_kind, is_present=True)
        yield _presence_draft(place, absent_kind, is_present=False, twin=twin)


def _presence_draft(place: TaskPlace, kind: Kind, *, is_present: bool, twin: TaskDraft | None = None) -> TaskDraft:
    one, many = singular_noun(kind), plural_noun(kind)
    expected = YesNo(value=True, affirms=answer_words(kind)[:2]) if is_present else NoneThere(subject=answer_words(kind)[:2])
    things = (place.truth.all_of(kind) or ())[:1] if is_present else ()
    return TaskDraft(
        category="descriptor",
        question_type="there" if is_present else "not-there",
        key=f"there:{one}",
        place=place,
        expected=expected,
        question=Question(
            (
                (f"is there {with_article(one)}?", f"whether there is {with_article(one)}"),
                (f"are there any {many}?", f"whether there are any {many}"),
                (f"can you see {with_article(one)}?", f"if you can see {with_article(one)}"),
                (f"do you see any {many}?", f"whether you see any {many}"),
            )
        ),
        evidence=(
            evidence_view(place, expected, object_words(kind), [place.truth.item(t, True) for t in things], whole=not is_present),
        ),
        perception_calls=(query_call(f"are there any {many}?", place),),
        tags=("presence",) if is_present else ("none-there",),
        twin=twin,
        answer_key="yes" if is_present else "none",
    )


def _colour_check_drafts(place: TaskPlace, rng: random.Random) -> Iterator[TaskDraft]:
    """Yield questions about whether an object has a given colour: its own, or one that is clearly different."""
    for target in unique_things(place.truth, coloured=False, min_pixels=400):
        colour = plain_colour(own_colour(target.thing.instance))
        if colour is None or colour in target.name or not is_colour_visible(target.thing.instance):
            continue
        other_colours = [
            c for c in ("red", "blue", "green", "yellow", "white", "black") if c != colour and not are_similar_colours(c, colour)
        ]
        for asked_colour in (colour, rng.choice(other_colours)):
            expected = YesNo(
                value=asked_colour == colour, affirms=(asked_colour,), denies=(colour,) if asked_colour != colour else ()
            )
            yield TaskDraft(
                category="descriptor",
                question_type="is-coloured",
                key=f"is-coloured:{target.thing.instance.id}",
                place=place,
                expected=expected,
                question=Question(
                    (
                        (f"is {target.with_the} {asked_colour}?", f"whether {target.with_the} is {asked_colour}"),
                        (
                            f"is it true that {target.with_the} is {asked_colour}?",
                            f"if it is true that {target.with_the} is {asked_colour}",
                        ),
                    )
                ),
                evidence=(evidence_view(place, expected, target.words, [place.truth.item(target.thing, colour)], whole=False),),
                perception_calls=(query_call(f"what colour is {target.with_the}?", place),),
                tags=("verification",),
                answer_key="yes" if expected.value else "no",
            )


def _conditional_colour_drafts(place: TaskPlace, nouns: frozenset[str], rng: random.Random) -> Iterator[TaskDraft]:
    """Yield questions about the colour of an absent object, each with a twin about a present one."""
    missing = scene_kinds_first(place, [kind for kind in absent_kinds(place.truth, nouns) if kind.colour is None], rng)
    shown = [target for target in unique_things(place.truth, coloured=False, min_pixels=300) if own_colour(target.thing.instance)]
    rng.shuffle(shown)
    for target, absent in zip(shown, missing, strict=False):
        colour = plain_colour(own_colour(target.thing.instance))
        if colour is None or colour in target.name or not is_colour_visible(target.thing.instance):
            continue
        value = Choice(value=colour, options=colour_options(), subject=answer_words(target.kind)[:2])
        none = NoneThere(subject=answer_words(absent)[:2], claims=all_wordings(colour_options()))
        item = place.truth.item(target.thing, colour)
        twin = _conditional_colour_draft(
            place, target.name, value, evidence_view(place, value, target.words, [item], whole=False), colour
        )
        yield replace(
            _conditional_colour_draft(
                place, singular_noun(absent), none, evidence_view(place, none, object_words(absent), whole=True), "none"
            ),
            question_type="no-colour",
            twin=twin,
        )


def _conditional_colour_draft(
    place: TaskPlace, name: str, expected: Choice | NoneThere, evidence: EvidenceView, answer_key: str
) -> TaskDraft:
    one = with_article(name)
    return TaskDraft(
        category="descriptor",
        question_type="colour-if",
        key=f"colour-if:{name}",
        place=place,
        expected=expected,
        question=Question(
            (
                (f"what colour is {with_the(name)}, if there is one?", f"what colour {with_the(name)} is, if there is one"),
                (f"if there is {one}, what colour is it?", f"what colour {with_the(name)} is, if you can see one"),
                (f"can you see {one}, and what colour is it?", f"whether you can see {one}, and what colour it is"),
            )
        ),
        evidence=(evidence,),
        perception_calls=(count_call(f"{pluralise(name)}", place),)
        if answer_key == "none"
        else (query_call(f"what colour is {with_the(name)}?", place),),
        tags=("none-there",) if answer_key == "none" else ("attribute", "colour"),
        answer_key=answer_key,
    )
