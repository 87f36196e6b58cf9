"""Multi-step reasoning tasks: sums, differences, conditions, and plans that depend on what the camera sees."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

from scope_ptz.bench.tasks.expected import ActionOnly, NoneThere, Number, YesNo
from scope_ptz.bench.tasks.task import Behaviour, EvidenceView
from scope_ptz.taskgen.authoring.drafts import Question, TaskDraft, count_call, evidence_view
from scope_ptz.taskgen.authoring.noun_phrases import answer_words, object_words, plural_noun, singular_noun, with_article
from scope_ptz.taskgen.authoring.task_places import ScenePlaces, TaskPlace, comparison_start, preset_call, preset_position
from scope_ptz.taskgen.authoring.view_contents import (
    absent_kinds,
    are_disjoint,
    category_counts,
    countable_kinds,
    scene_kinds_first,
)
from scope_ptz.taskgen.facts.kinds import GROUPS, Kind

_SUMS = (
    "How many {many} do the presets {p} and {q} show in total? Those in the one view are not those in the other.",
    "Add up the {many} in the {p} view and those in the {q} view, which are different ones. What is the total?",
    "Count the {many} at the {p} preset, then the other ones at the {q} preset, and give me the sum.",
    "None of the {many} is both in the {q} and in the {p} view. How many are there in the two views together?",
    "Taking the {p} view and the {q} view together, how many {many} are there? None of them is in both.",
    "I want one figure: the {many} seen from the {p} preset plus the other ones seen from the {q} preset.",
)
_DIFFERENCES = (
    "How many more {many} are there in the {p} view than in the {q} view?",
    "By how many does the number of {many} at the {p} preset exceed that at the {q} preset?",
    "Look at the presets {p} and {q}: how many more {many} does the first one show?",
    "Count the {many} at the {q} preset and at the {p} preset. How many more does {p} have?",
)
_BRANCHES = (
    "Check the {p} preset. If you can see {least} {many} there, go to the {yes} preset; otherwise go to {no}.",
    "Go to the {p} preset and count the {many}. With {least} of them, switch to the {yes} preset, and with fewer to {no}.",
    "If there are {least} {many} in the {p} view, move the camera to the preset {yes}. If not, move it to {no}.",
    "Count the {many} in the {p} view: if there are {least}, bring up the {yes} view, and if there are fewer, the {no} view.",
)
_CHECKS = (
    "Look for {one} at the {p} preset and tell me whether you found one. If so, go on to the {yes} preset; if not, to {no}.",
    "Is there {one} in the {p} view? Tell me, then switch to the {yes} view if there is, and to {no} if there is not.",
    "Check the {p} preset for {many}. If you see any, say so and move to the {yes} preset; if not, say that and move to {no}.",
    "Go to the {p} preset and look for {one}. Found one? Then finish at the {yes} preset. If not, finish at {no}. Report back.",
    "Please see whether {one} is in the {p} view. If yes, leave the camera at the {yes} preset, else at {no}, and let me know.",
)
_EITHER_VIEW_FORMS = (
    "Check the presets {p} and {q}: is there {one} in either of them?",
    "Is {one} to be seen from the {p} preset or from {q}?",
    "Look from the {p} preset, then from {q}, and tell me whether {one} is there in one of the views.",
    "Is there {one} in the {p} view or in the {q} view?",
    "Have a look at the presets {p} and {q}. Can you find {one}?",
)


def drafts(one: TaskPlace, two: TaskPlace, places: ScenePlaces, nouns: frozenset[str], rng: random.Random) -> list[TaskDraft]:
    """Return drafts about the view of ``one.preset`` that also involve ``two.preset``, or presets to go to afterwards."""
    p, q = one.preset, two.preset
    if p is None or q is None or p == q:
        return []
    return [
        *_total_drafts(one, two, p, q), *_branch_drafts(one, p, places, rng), *_either_view_drafts(one, two, p, q, nouns, rng),
        *_check_drafts(one, p, places, nouns, rng),
    ]  # fmt: skip


def _count_evidence(place: TaskPlace, kind: Kind, number: int) -> EvidenceView:
    shows = Number(value=number, unit=answer_words(kind)) if number else NoneThere(subject=answer_words(kind)[:2])
    return evidence_view(
        place, shows, object_words(kind), [place.truth.item(t, True) for t in place.truth.all_of(kind) or ()], whole=True
    )


def _total_drafts(one: TaskPlace, two: TaskPlace, p: str, q: str) -> Iterator[TaskDraft]:
    """Yield questions about the sum of, or the difference between, the counts of one kind at two presets."""
    second_counts = dict(countable_kinds(two.truth))
    start = comparison_start(one, two)
    for kind, n in countable_kinds(one.truth):
        m = second_counts.get(kind)
        if m is None:
            continue
        many = plural_noun(kind)
        program = (preset_call(p), count_call(many, one), preset_call(q), count_call(many, two))
        evidence = (_count_evidence(one, kind, n), _count_evidence(two, kind, m))
        # An object that is visible in both views would be counted twice in a sum.
        in_both = {t.number for t in one.truth.discernible_objects if kind.fits(t)} & {
            t.number for t in two.truth.discernible_objects
        }
        question_types = [
            *([("sum", n + m, _SUMS)] if not in_both else []),
            *([("difference", n - m, _DIFFERENCES)] if n > m else []),
        ]
        for question_type, value, texts in question_types:
            yield TaskDraft(
                category="multi_step_reasoning",
                question_type=question_type,
                key=f"{question_type}:{p}:{q}:{many}",
                place=start,
                expected=Number(value=value, unit=answer_words(kind)),
                instructions=tuple(t.format(many=many, p=p, q=q) for t in texts),
                evidence=evidence,
                program=program,
                needs=("preset",),
                tags=("two-views",),
                object_count=n + m,
                answer_key=str(value),
            )


def drafts_within_view(place: TaskPlace, rng: random.Random) -> list[TaskDraft]:
    """Return drafts about sums and differences within one view."""
    result = list[TaskDraft]()
    plain = list(category_counts(place.truth))
    rng.shuffle(plain)
    for (one, n), (two, m) in pairwise(plain):
        if min(n, m) < 2 or not are_disjoint(place.truth, (one, two)):
            continue
        first, second = plural_noun(one), plural_noun(two)
        if _is_only_one_living(one, two):
            continue
        together = Question(
            (
                (f"how many {first} and {second} are there together?", f"how many {first} and {second} there are together"),
                (f"what is the total of {first} and {second}?", f"the total of {first} and {second}"),
            )
        )
        difference = Question(
            (
                (f"how many more {first} than {second} are there?", f"how many more {first} than {second} there are"),
                (f"by how many do the {first} outnumber the {second}?", f"by how many the {first} outnumber the {second}"),
            )
        )
        question_types = ([("together", n + m, together)] if n + m > 3 else []) + ([("excess", n - m, difference)] if n > m else [])
        for question_type, value, question in question_types:
            # The answer has no unit, so that a reply with the two counts is not parsed as their sum or difference.
            result.append(
                TaskDraft(
                    category="multi_step_reasoning",
                    question_type=question_type,
                    key=f"{question_type}:{first}:{second}",
                    place=place,
                    expected=Number(value=value),
                    question=question,
                    evidence=(_count_evidence(place, one, n), _count_evidence(place, two, m)),
                    perception_calls=(count_call(first, place), count_call(second, place)),
                    tags=("arithmetic",),
                    object_count=n + m,
                    answer_key=str(value),
                )
            )
    return result


def _is_only_one_living(one: Kind, two: Kind) -> bool:
    """Return whether only one of two kinds is living. A question that combines their counts would sound unnatural."""
    return (one.category in _LIVING_CATEGORIES) != (two.category in _LIVING_CATEGORIES)


_LIVING_CATEGORIES = GROUPS["person"] | {"dog", "pigeon", "cyclist"}


def _branch_drafts(one: TaskPlace, p: str, places: ScenePlaces, rng: random.Random) -> Iterator[TaskDraft]:
    """Yield commands that go to one of two presets, depending on a count."""
    others = [name for name in places.presets if name != p and name != one.start]
    if len(others) < 2:
        return
    start = TaskPlace(one.scene, one.start, (), one.at)
    for kind, n in category_counts(one.truth):
        if n < 2:
            continue
        yes, no = rng.sample(others, 2)
        least = n + rng.choice((-1, 0, 2)) if n > 2 else n + rng.choice((0, 1))
        end = yes if n >= least else no
        final = TaskPlace(one.scene, one.start, (), preset_position(places.presets[end])).final
        many = plural_noun(kind)
        yield TaskDraft(
            category="multi_step_reasoning",
            question_type="condition",
            key=f"if:{p}:{many}:{least}",
            place=start,
            expected=ActionOnly(),
            instructions=tuple(t.format(p=p, many=many, least=f"at least {least}", yes=yes, no=no) for t in _BRANCHES),
            evidence=(_count_evidence(one, kind, n),),
            program=(preset_call(p), count_call(many, one), preset_call(end)),
            behaviour=Behaviour(final=final),
            needs=("preset",),
            tags=("condition",),
            object_count=n,
            answer_key=end,
        )


def _check_drafts(one: TaskPlace, p: str, places: ScenePlaces, nouns: frozenset[str], rng: random.Random) -> Iterator[TaskDraft]:
    """Yield questions about whether a kind is visible at a preset, with a preset to go to if it is and another if it is not."""
    others = [name for name in places.presets if name != p and name != one.start]
    shown = [kind for kind, _ in category_counts(one.truth)]
    absent = [kind for kind in absent_kinds(one.truth, nouns) if kind.colour is None]
    if len(others) < 2:
        return
    rng.shuffle(shown)
    absent = scene_kinds_first(one, absent, rng)
    for present, missing in zip(shown, absent, strict=False):
        yes, no = rng.sample(others, 2)
        things = one.truth.all_of(present) or ()
        there = YesNo(value=True, affirms=answer_words(present)[:2])
        none = NoneThere(subject=answer_words(missing)[:2])
        evidence = evidence_view(one, there, object_words(present), [one.truth.item(things[0], True)], whole=False)
        twin = _check_draft(one, p, present, there, evidence, (yes, no), places)
        yield replace(
            _check_draft(one, p, missing, none, evidence_view(one, none, object_words(missing), whole=True), (yes, no), places),
            question_type="check-none",
            twin=twin,
        )


def _check_draft(
    one: TaskPlace,
    p: str,
    kind: Kind,
    expected: YesNo | NoneThere,
    evidence: EvidenceView,
    end_presets: tuple[str, str],
    places: ScenePlaces,
) -> TaskDraft:
    yes, no = end_presets
    end = no if isinstance(expected, NoneThere) else yes
    start = TaskPlace(one.scene, one.start, (), one.at)
    words = {"p": p, "one": with_article(singular_noun(kind)), "many": plural_noun(kind), "yes": yes, "no": no}
    return TaskDraft(
        category="multi_step_reasoning",
        question_type="check",
        key=f"check:{p}:{singular_noun(kind)}",
        place=start,
        expected=expected,
        instructions=tuple(text.format(**words) for text in _CHECKS),
        evidence=(evidence,),
        program=(preset_call(p), count_call(plural_noun(kind), one), preset_call(end)),
        behaviour=Behaviour(final=TaskPlace(one.scene, one.start, (), preset_position(places.presets[end])).final),
        needs=("preset",),
        tags=("none-there",) if isinstance(expected, NoneThere) else ("presence",),
        answer_key=end,
    )


def _either_view_drafts(
    one: TaskPlace, two: TaskPlace, p: str, q: str, nouns: frozenset[str], rng: random.Random
) -> Iterator[TaskDraft]:
    """Yield questions about whether an absent kind is visible at one of two presets, each with a twin about a present kind."""
    absent_in_second = set(absent_kinds(two.truth, nouns))
    absent = [kind for kind in absent_kinds(one.truth, nouns) if kind in absent_in_second]
    shown = [
        (kind, place)
        for place, other in ((one, two), (two, one))
        for kind, _ in countable_kinds(place.truth)
        if other.truth.all_of(kind) is not None
    ]
    absent = scene_kinds_first(one, absent, rng)
    rng.shuffle(shown)
    start = comparison_start(one, two)
    if start.start == q:
        return  # the start view would answer the question without a move
    for kind, (present, place) in zip(absent, shown, strict=False):
        plurals = (plural_noun(kind), plural_noun(present))
        yes = YesNo(value=True, affirms=answer_words(present)[:2])
        things = place.truth.all_of(present) or ()
        twin = TaskDraft(
            category="multi_step_reasoning",
            question_type="either",
            key=f"either:{p}:{q}:{singular_noun(present)}",
            place=start,
            expected=yes,
            instructions=tuple(t.format(p=p, q=q, one=with_article(singular_noun(present))) for t in _EITHER_VIEW_FORMS),
            evidence=(evidence_view(place, yes, object_words(present), [place.truth.item(things[0], True)], whole=False),),
            program=(preset_call(p), count_call(plurals[1], one), preset_call(q), count_call(plurals[1], two)),
            needs=("preset",),
            tags=("presence",),
            answer_key="yes",
        )
        none = NoneThere(subject=answer_words(kind)[:2])
        yield TaskDraft(
            category="multi_step_reasoning",
            question_type="neither",
            key=f"either:{p}:{q}:{singular_noun(kind)}",
            place=start,
            expected=none,
            instructions=tuple(t.format(p=p, q=q, one=with_article(singular_noun(kind))) for t in _EITHER_VIEW_FORMS),
            evidence=(
                evidence_view(one, none, object_words(kind), [], whole=True),
                evidence_view(two, none, object_words(kind), [], whole=True),
            ),
            program=(preset_call(p), count_call(plurals[0], one), preset_call(q), count_call(plurals[0], two)),
            needs=("preset",),
            tags=("none-there", "two-views"),
            twin=twin,
            answer_key="none",
        )
