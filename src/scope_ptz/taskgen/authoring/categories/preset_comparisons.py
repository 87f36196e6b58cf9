"""Comparative tasks across presets: which of two or three shows the most objects of a kind."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence

from scope_ptz.bench.tasks.expected import Choice, Options, Wordings
from scope_ptz.taskgen.authoring.categories.comparative_tasks import SAME, count_evidence
from scope_ptz.taskgen.authoring.drafts import TaskDraft, count_call
from scope_ptz.taskgen.authoring.noun_phrases import plural_noun
from scope_ptz.taskgen.authoring.task_places import TaskPlace, comparison_start, preset_call
from scope_ptz.taskgen.authoring.view_contents import countable_kinds

_TWO_PRESET_FORMS = (
    "Are there more {many} at the {p} preset or at the {q} preset?",
    "Compare the presets {p} and {q}: which shows more {many}?",
    "Which view has more {many}, {p} or {q}?",
    "Look at the {p} view and then at {q}. Where can you see more {many}?",
    "Between the {p} and the {q} preset, which one has more {many} in it?",
    "Go to the {p} preset, then to {q}, and say which shows more {many}.",
)
_THREE_PRESET_FORMS = (
    "Which of the presets {p}, {q} and {r} shows the most {many}?",
    "Go through the presets {p}, {q} and {r}, and tell me which of them has the most {many} in view.",
    "Compare the {p}, {q} and {r} views. Where are the most {many}?",
    "I want the preset with the most {many}: {p}, {q} or {r}?",
    "Check the {p} preset, then {q}, then {r}. Which one has the largest number of {many}?",
)

_MIN_TOTAL = 4
"""Minimum number of objects over all compared presets."""


def drafts(places: Sequence[TaskPlace], rng: random.Random) -> list[TaskDraft]:
    """Return drafts that compare two or three presets, which are visited in sequence."""
    comparisons = list(_comparisons(places))
    rng.shuffle(comparisons)
    return comparisons


def _comparisons(places: Sequence[TaskPlace]) -> Iterator[TaskDraft]:
    names = [str(place.preset) for place in places]
    start = comparison_start(places[0], places[1])
    if len(set(names)) < len(places) or (len(places) == 3 and start.start in names[1:]):
        return
    counts_by_place = [dict(countable_kinds(place.truth)) for place in places]
    for kind in counts_by_place[0]:
        numbers = [counts.get(kind) for counts in counts_by_place]
        certain = [number for number in numbers if number is not None]
        if len(certain) < len(places) or sum(certain) < _MIN_TOTAL or (len(places) == 3 and certain.count(max(certain)) > 1):
            continue
        many = plural_noun(kind)
        best = "same" if len(set(certain)) == 1 else names[certain.index(max(certain))]
        options: Options = {name: _unhyphenated_wordings(name) for name in names}
        if len(places) == 2:
            options = {**options, "same": SAME}
        words = dict(zip("pqr", names, strict=False))
        yield TaskDraft(
            category="comparative",
            question_type="between" if len(places) == 2 else "among",
            key=f"between:{':'.join(names)}:{many}",
            place=start,
            expected=Choice(value=best, options=options, picks=("more", "most")),
            instructions=tuple(
                text.format(many=many, **words) for text in (_TWO_PRESET_FORMS if len(places) == 2 else _THREE_PRESET_FORMS)
            ),
            evidence=tuple(count_evidence(place, kind, n) for place, n in zip(places, certain, strict=True)),
            program=tuple(
                call for place, name in zip(places, names, strict=True) for call in (preset_call(name), count_call(many, place))
            ),
            needs=("preset",),
            tags=("two-views",) if len(places) == 2 else ("three-views",),
            object_count=sum(certain),
            answer_key=best,
        )


def _unhyphenated_wordings(name: str) -> Wordings:
    """Return the name of a preset without hyphens as an additional wording; no wording if the name has no hyphens."""
    return (name.replace("-", " "),) if "-" in name else ()
