"""Counting tasks: the number of objects of a kind in a view or in a sweep, including kinds that are absent."""

from __future__ import annotations

import random

from scope_ptz.bench.tasks.expected import NoneThere, Number
from scope_ptz.taskgen.authoring.drafts import Question, TaskDraft, count_call, evidence_view, scope_of
from scope_ptz.taskgen.authoring.noun_phrases import answer_words, object_words, plural_noun, singular_noun
from scope_ptz.taskgen.authoring.task_places import TaskPlace
from scope_ptz.taskgen.authoring.view_contents import absent_kinds, countable_kinds, scene_kinds_first
from scope_ptz.taskgen.facts.kinds import Kind


def count_question(kind: Kind) -> Question:
    """Return wordings of the question "how many are there?" for a kind of object."""
    many = plural_noun(kind)
    return Question(
        (
            (f"how many {many} are there?", f"how many {many} there are"),
            (f"how many {many} can you see?", f"how many {many} you can see"),
            (f"what is the number of {many}?", f"the number of {many}"),
            (f"how many {many} are visible?", f"how many {many} are visible"),
            (f"what's the count of {many}?", f"the count of {many}"),
        )
    )


def drafts(place: TaskPlace, nouns: frozenset[str], rng: random.Random) -> list[TaskDraft]:
    """Return a draft for every countable kind at a place, and drafts for absent kinds, each paired with a present one."""
    truth = place.truth
    about_present = [_count_draft(place, kind, n) for kind, n in countable_kinds(truth)]
    twins = list(about_present)
    rng.shuffle(twins)
    missing = scene_kinds_first(place, absent_kinds(truth, nouns), rng)
    about_absent = [
        TaskDraft(
            category="counting",
            question_type="none",
            key=f"count:{singular_noun(kind)}",
            place=place,
            expected=(expected := NoneThere(subject=answer_words(kind)[:2])),
            question=count_question(kind),
            evidence=(evidence_view(place, expected, object_words(kind), whole=True),),
            perception_calls=(count_call(plural_noun(kind), place),),
            tags=("none-there", scope_of(place)),
            twin=twin,
            answer_key="none",
        )
        for kind, twin in zip(missing, twins, strict=False)
    ]
    return [*about_present, *about_absent]


def _count_draft(place: TaskPlace, kind: Kind, count: int) -> TaskDraft:
    """Return a draft that asks for the number of objects of a kind that is present."""
    things = place.truth.all_of(kind) or ()
    expected = Number(value=count, unit=answer_words(kind))
    return TaskDraft(
        category="counting",
        question_type="all-around" if place.swept else "coloured" if kind.colour else "in-state" if kind.attribute else "count",
        key=f"count:{singular_noun(kind)}",
        place=place,
        expected=expected,
        question=count_question(kind),
        evidence=(evidence_view(place, expected, object_words(kind), [place.truth.item(t, True) for t in things], whole=True),),
        perception_calls=(count_call(plural_noun(kind), place),),
        tags=(scope_of(place),),
        object_count=count,
        answer_key=str(count),
    )
