"""Reasoning over several looks: sums, differences, conditions, and plans that depend on what is seen."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

from scope_ptz.bench.tasks.expected import ActionOnly, NoneThere, Number, YesNo
from scope_ptz.bench.tasks.task import Behaviour, EvidenceView
from scope_ptz.taskgen.authoring.categories.counting_tasks import absent, apart, counted, likely_first, plain_counts
from scope_ptz.taskgen.authoring.drafts import Draft, Question, count, view
from scope_ptz.taskgen.authoring.noun_phrases import about, article, many_of, noun_of, unit_of
from scope_ptz.taskgen.authoring.task_places import Place, Places, elsewhere, go, preset_at
from scope_ptz.taskgen.facts.kinds import GROUPS, Kind

_SUMS = (
    "How many {many} do the presets {p} and {q} show in total? Those in the one view are not those in the other.",
    "Add up the {many} in the {p} view and those in the {q} view, which are different ones. What is the total?",
    "Count the {many} at the {p} preset, then the other ones at the {q} preset, and give me the sum.",
    "None of the {many} is both in the {q} and in the {p} view. How many are there in the two views together?",
    "Taking the {p} view and the {q} view together, how many {many} are there? None of them is in both.",
    "I want one figure: the {many} seen from the {p} preset plus the other ones seen from the {q} preset.",
)
_GAPS = (
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
_WHERE = (
    "Check the presets {p} and {q}: is there {one} in either of them?",
    "Is {one} to be seen from the {p} preset or from {q}?",
    "Look from the {p} preset, then from {q}, and tell me whether {one} is there in one of the views.",
    "Is there {one} in the {p} view or in the {q} view?",
    "Have a look at the presets {p} and {q}. Can you find {one}?",
)


def drafts(one: Place, two: Place, places: Places, nouns: frozenset[str], rng: random.Random) -> list[Draft]:
    """What takes two presets."""
    p, q = one.preset, two.preset
    if p is None or q is None or p == q:
        return []
    return [
        *_totals(one, two, p, q), *_branches(one, p, places, rng), *_either(one, two, p, q, nouns, rng),
        *_checks(one, p, places, nouns, rng),
    ]  # fmt: skip


def _seen(place: Place, kind: Kind, number: int) -> EvidenceView:
    shows = Number(value=number, unit=unit_of(kind)) if number else NoneThere(subject=unit_of(kind)[:2])
    return view(place, shows, about(kind), [place.sight.item(t, True) for t in place.sight.of(kind) or ()], whole=True)


def _totals(one: Place, two: Place, p: str, q: str) -> Iterator[Draft]:
    there = dict(counted(two.sight))
    start = elsewhere(one, two)
    for kind, n in counted(one.sight):
        m = there.get(kind)
        if m is None:
            continue
        many = many_of(kind)
        program = (go(p), count(many, one), go(q), count(many, two))
        seen = (_seen(one, kind, n), _seen(two, kind, m))
        # What shows in both views would be counted twice in their sum.
        same = {t.number for t in one.sight.traces if kind.fits(t)} & {t.number for t in two.sight.traces}
        sorts = [*([("sum", n + m, _SUMS)] if not same else []), *([("difference", n - m, _GAPS)] if n > m else [])]
        for sort, value, texts in sorts:
            yield Draft(
                category="multi_step_reasoning",
                kind=sort,
                key=f"{sort}:{p}:{q}:{many}",
                place=start,
                expected=Number(value=value, unit=unit_of(kind)),
                orders=tuple(t.format(many=many, p=p, q=q) for t in texts),
                evidence=seen,
                program=program,
                needs=("preset",),
                tags=("two-views",),
                weight=n + m,
                reads=str(value),
            )


def within(place: Place, rng: random.Random) -> list[Draft]:
    """Sums and differences within one view."""
    found = list[Draft]()
    plain = list(plain_counts(place.sight))
    rng.shuffle(plain)
    for (one, n), (two, m) in pairwise(plain):
        if min(n, m) < 2 or not apart(place.sight, (one, two)):
            continue
        first, second = many_of(one), many_of(two)
        if _unlike(one, two):
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
        sorts = ([("together", n + m, together)] if n + m > 3 else []) + ([("excess", n - m, difference)] if n > m else [])
        for sort, value, asked in sorts:
            # No unit: a sum of two kinds has none, and their own numbers must not be taken for it.
            found.append(
                Draft(
                    category="multi_step_reasoning",
                    kind=sort,
                    key=f"{sort}:{first}:{second}",
                    place=place,
                    expected=Number(value=value),
                    question=asked,
                    evidence=(_seen(place, one, n), _seen(place, two, m)),
                    looks=(count(first, place), count(second, place)),
                    tags=("arithmetic",),
                    weight=n + m,
                    reads=str(value),
                )
            )
    return found


def _unlike(one: Kind, two: Kind) -> bool:
    """Whether nobody would add up things of two kinds: people (or animals) and what is none."""
    return (one.category in _ALIVE) != (two.category in _ALIVE)


_ALIVE = GROUPS["person"] | {"dog", "pigeon", "cyclist"}


def _branches(one: Place, p: str, places: Places, rng: random.Random) -> Iterator[Draft]:
    others = [name for name in places.presets if name != p and name != one.start]
    if len(others) < 2:
        return
    start = Place(one.scene, one.start, (), one.at)
    for kind, n in plain_counts(one.sight):
        if n < 2:
            continue
        yes, no = rng.sample(others, 2)
        least = n + rng.choice((-1, 0, 2)) if n > 2 else n + rng.choice((0, 1))
        end = yes if n >= least else no
        final = Place(one.scene, one.start, (), preset_at(places.presets[end])).final
        many = many_of(kind)
        yield Draft(
            category="multi_step_reasoning",
            kind="condition",
            key=f"if:{p}:{many}:{least}",
            place=start,
            expected=ActionOnly(),
            orders=tuple(t.format(p=p, many=many, least=f"at least {least}", yes=yes, no=no) for t in _BRANCHES),
            evidence=(_seen(one, kind, n),),
            program=(go(p), count(many, one), go(end)),
            behaviour=Behaviour(final=final),
            needs=("preset",),
            tags=("condition",),
            weight=n,
            reads=end,
        )


def _checks(one: Place, p: str, places: Places, nouns: frozenset[str], rng: random.Random) -> Iterator[Draft]:
    """Whether something is at a preset, and then another preset for either case."""
    others = [name for name in places.presets if name != p and name != one.start]
    shown = [kind for kind, _ in plain_counts(one.sight)]
    gone = [kind for kind in absent(one.sight, nouns) if kind.colour is None]
    if len(others) < 2:
        return
    rng.shuffle(shown)
    gone = likely_first(one, gone, rng)
    for here, missing in zip(shown, gone, strict=False):
        yes, no = rng.sample(others, 2)
        things = one.sight.of(here) or ()
        there = YesNo(value=True, affirms=unit_of(here)[:2])
        none = NoneThere(subject=unit_of(missing)[:2])
        seen = view(one, there, about(here), [one.sight.item(things[0], True)], whole=False)
        twin = _check(one, p, here, there, seen, (yes, no), places)
        yield replace(
            _check(one, p, missing, none, view(one, none, about(missing), whole=True), (yes, no), places),
            kind="check-none",
            twin=twin,
        )


def _check(
    one: Place, p: str, kind: Kind, expected: YesNo | NoneThere, seen: EvidenceView, ends: tuple[str, str], places: Places
) -> Draft:
    yes, no = ends
    end = no if isinstance(expected, NoneThere) else yes
    start = Place(one.scene, one.start, (), one.at)
    words = {"p": p, "one": article(noun_of(kind)), "many": many_of(kind), "yes": yes, "no": no}
    return Draft(
        category="multi_step_reasoning",
        kind="check",
        key=f"check:{p}:{noun_of(kind)}",
        place=start,
        expected=expected,
        orders=tuple(text.format(**words) for text in _CHECKS),
        evidence=(seen,),
        program=(go(p), count(many_of(kind), one), go(end)),
        behaviour=Behaviour(final=Place(one.scene, one.start, (), preset_at(places.presets[end])).final),
        needs=("preset",),
        tags=("none-there",) if isinstance(expected, NoneThere) else ("presence",),
        reads=end,
    )


def _either(one: Place, two: Place, p: str, q: str, nouns: frozenset[str], rng: random.Random) -> Iterator[Draft]:
    missing_there = set(absent(two.sight, nouns))
    gone = [kind for kind in absent(one.sight, nouns) if kind in missing_there]
    shown = [
        (kind, place)
        for place, other in ((one, two), (two, one))
        for kind, _ in counted(place.sight)
        if other.sight.of(kind) is not None
    ]
    gone = likely_first(one, gone, rng)
    rng.shuffle(shown)
    start = elsewhere(one, two)
    if start.start == q:
        return  # what is there at the start would be seen without going anywhere
    for kind, (present, place) in zip(gone, shown, strict=False):
        texts = (many_of(kind), many_of(present))
        yes = YesNo(value=True, affirms=unit_of(present)[:2])
        first = place.sight.of(present) or ()
        twin = Draft(
            category="multi_step_reasoning",
            kind="either",
            key=f"either:{p}:{q}:{noun_of(present)}",
            place=start,
            expected=yes,
            orders=tuple(t.format(p=p, q=q, one=article(noun_of(present))) for t in _WHERE),
            evidence=(view(place, yes, about(present), [place.sight.item(first[0], True)], whole=False),),
            program=(go(p), count(texts[1], one), go(q), count(texts[1], two)),
            needs=("preset",),
            tags=("presence",),
            reads="yes",
        )
        none = NoneThere(subject=unit_of(kind)[:2])
        yield Draft(
            category="multi_step_reasoning",
            kind="neither",
            key=f"either:{p}:{q}:{noun_of(kind)}",
            place=start,
            expected=none,
            orders=tuple(t.format(p=p, q=q, one=article(noun_of(kind))) for t in _WHERE),
            evidence=(view(one, none, about(kind), [], whole=True), view(two, none, about(kind), [], whole=True)),
            program=(go(p), count(texts[0], one), go(q), count(texts[0], two)),
            needs=("preset",),
            tags=("none-there", "two-views"),
            twin=twin,
            reads="none",
        )
