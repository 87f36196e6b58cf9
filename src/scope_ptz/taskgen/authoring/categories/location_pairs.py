"""Location tasks in pairs, about an absent and a present object: in a half of the frame, or in one of its quarters."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace

from scope_ptz.bench.tasks.expected import Choice, NoneThere, Options, YesNo
from scope_ptz.bench.tasks.task import EvidenceView
from scope_ptz.taskgen.authoring.drafts import Question, TaskDraft, evidence_view, query_call
from scope_ptz.taskgen.authoring.noun_phrases import (
    all_wordings,
    answer_words,
    object_words,
    plural_noun,
    pluralise,
    singular_noun,
    with_article,
    with_the,
)
from scope_ptz.taskgen.authoring.object_names import NamedThing
from scope_ptz.taskgen.authoring.task_places import TaskPlace
from scope_ptz.taskgen.authoring.view_contents import absent_kinds, countable_kinds, scene_kinds_first
from scope_ptz.taskgen.facts.kinds import Kind


def drafts(place: TaskPlace, named: list[NamedThing], nouns: frozenset[str], rng: random.Random) -> Iterator[TaskDraft]:
    """Yield one draft for each pair: the task about the absent object, whose twin is the task about the present one."""
    yield from _half_pairs(place, nouns, rng)
    yield from _conditional_location_drafts(place, named, nouns, rng)


def quarter_options() -> Options:
    """Return the quarters of the frame as answer options."""
    return {
        f"{level} {side}": (f"{level}-{side}", f"{other} {side}", f"{other}-{side}")
        for level, other in (("top", "upper"), ("bottom", "lower"))
        for side in ("left", "right")
    }


def _half_pairs(place: TaskPlace, nouns: frozenset[str], rng: random.Random) -> Iterator[TaskDraft]:
    present = [
        (k, s)
        for k, _ in countable_kinds(place.truth)
        if len(s := {place.truth.side(t, 0) for t in place.truth.all_of(k) or ()}) == 1 and None not in s
    ]
    absent = scene_kinds_first(place, absent_kinds(place.truth, nouns), rng)
    for (kind, sides), missing in zip(present, absent, strict=False):
        side = ("left", "right")[next(iter(sides)) or 0]
        yield _half_draft(place, missing, side, is_present=False, twin=_half_draft(place, kind, side, is_present=True))


def _half_draft(place: TaskPlace, kind: Kind, side: str, *, is_present: bool, twin: TaskDraft | None = None) -> TaskDraft:
    one, many = singular_noun(kind), plural_noun(kind)
    expected = YesNo(value=True, affirms=answer_words(kind)[:2]) if is_present else NoneThere(subject=answer_words(kind)[:2])
    items = [place.truth.item(t, True) for t in (place.truth.all_of(kind) or ())[:1]] if is_present else []
    return TaskDraft(
        category="location",
        question_type="half-there" if is_present else "half-none",
        key=f"half-there:{one}:{side}",
        place=place,
        expected=expected,
        question=Question(
            (
                (
                    f"is there {with_article(one)} in the {side} half of the picture?",
                    f"whether there is {with_article(one)} in the {side} half of the picture",
                ),
                (
                    f"are there any {many} on the {side} side of the frame?",
                    f"whether there are any {many} on the {side} side of the frame",
                ),
            )
        ),
        evidence=(evidence_view(place, expected, object_words(kind), items, whole=not is_present),),
        perception_calls=(query_call(f"are there any {many} in the {side} half of the picture?", place),),
        tags=("presence",) if is_present else ("none-there",),
        twin=twin,
        answer_key="yes" if is_present else "none",
    )


def _conditional_location_drafts(
    place: TaskPlace, named: list[NamedThing], nouns: frozenset[str], rng: random.Random
) -> Iterator[TaskDraft]:
    """Yield questions about the quarter that an absent object is in, each with a twin about a present one."""
    missing = scene_kinds_first(place, [kind for kind in absent_kinds(place.truth, nouns) if kind.colour is None], rng)
    located = [(n, place.truth.side(n.thing, 0), place.truth.side(n.thing, 1)) for n in named if n.name[-1].isalpha()]
    for (one, side, level), absent in zip([p for p in located if None not in p[1:]], missing, strict=False):
        value = Choice(
            value=f"{('top', 'bottom')[level or 0]} {('left', 'right')[side or 0]}",
            options=quarter_options(),
            subject=answer_words(one.kind)[:2],
        )
        none = NoneThere(subject=answer_words(absent)[:2], claims=all_wordings(quarter_options()))
        evidence = evidence_view(place, value, one.words, [place.truth.item(one.thing, value.value)], whole=False)
        twin = _conditional_location_draft(place, one.name, value, evidence, value.value)
        yield replace(
            _conditional_location_draft(
                place, singular_noun(absent), none, evidence_view(place, none, object_words(absent), whole=True), "none"
            ),
            question_type="nowhere",
            twin=twin,
        )


def _conditional_location_draft(
    place: TaskPlace, name: str, expected: Choice | NoneThere, evidence: EvidenceView, answer_key: str
) -> TaskDraft:
    one = with_article(name)
    forms = (
        (f"in which quarter of the picture is {with_the(name)}, if there is one?",
         f"in which quarter of the picture {with_the(name)} is, if there is one"),
        (f"if you can see {one}, is it top left, top right, bottom left or bottom right?",
         f"where in the frame {with_the(name)} is (top left, top right, bottom left or bottom right), if you can see one"),
        (f"can you find {one}, and in which quarter of the frame is it?",
         f"whether you can find {one}, and in which quarter of the frame it is"),
    )  # fmt: skip
    question = f"are there any {pluralise(name)}?" if answer_key == "none" else f"where in the frame is {with_the(name)}?"
    return TaskDraft(
        category="location",
        question_type="where-if",
        key=f"where-if:{name}",
        place=place,
        expected=expected,
        question=Question(forms),
        evidence=(evidence,),
        perception_calls=(query_call(question, place),),
        tags=("none-there",) if answer_key == "none" else ("frame",),
        answer_key=answer_key,
    )
