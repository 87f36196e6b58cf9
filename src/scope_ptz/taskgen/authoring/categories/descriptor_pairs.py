"""Whether something is there, whether it has a colour, and the colour of what may not be there: presences beside absences."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace

from scope_ptz.bench.tasks.expected import Choice, NoneThere, YesNo
from scope_ptz.bench.tasks.task import EvidenceView
from scope_ptz.taskgen.authoring.categories.counting_tasks import absent, counted, likely_first
from scope_ptz.taskgen.authoring.drafts import Draft, Question, ask, count, view
from scope_ptz.taskgen.authoring.noun_phrases import (
    about,
    article,
    colour_options,
    many_of,
    noun_of,
    plain_colour,
    plural,
    the,
    unit_of,
    wordings,
)
from scope_ptz.taskgen.authoring.object_names import singles
from scope_ptz.taskgen.authoring.task_places import Place
from scope_ptz.taskgen.facts.kinds import Kind, colour_shows, near_colours, own_colour


def drafts(place: Place, nouns: frozenset[str], rng: random.Random) -> Iterator[Draft]:
    yield from _presence(place, nouns, rng)
    yield from _coloured_or_not(place, rng)
    yield from _colour_if_there(place, nouns, rng)


def _presence(place: Place, nouns: frozenset[str], rng: random.Random) -> Iterator[Draft]:
    present = [kind for kind, _ in counted(place.sight)]
    rng.shuffle(present)
    missing = likely_first(place, absent(place.sight, nouns), rng)
    for here, gone in zip(present, missing, strict=False):
        yield _there(place, gone, there=False, twin=_there(place, here, there=True))


def _there(place: Place, kind: Kind, *, there: bool, twin: Draft | None = None) -> Draft:
    one, many = noun_of(kind), many_of(kind)
    expected = YesNo(value=True, affirms=unit_of(kind)[:2]) if there else NoneThere(subject=unit_of(kind)[:2])
    things = (place.sight.of(kind) or ())[:1] if there else ()
    return Draft(
        category="descriptor",
        kind="there" if there else "not-there",
        key=f"there:{one}",
        place=place,
        expected=expected,
        question=Question(
            (
                (f"is there {article(one)}?", f"whether there is {article(one)}"),
                (f"are there any {many}?", f"whether there are any {many}"),
                (f"can you see {article(one)}?", f"if you can see {article(one)}"),
                (f"do you see any {many}?", f"whether you see any {many}"),
            )
        ),
        evidence=(view(place, expected, about(kind), [place.sight.item(t, True) for t in things], whole=not there),),
        looks=(ask(f"are there any {many}?", place),),
        tags=("presence",) if there else ("none-there",),
        twin=twin,
        reads="yes" if there else "none",
    )


def _coloured_or_not(place: Place, rng: random.Random) -> Iterator[Draft]:
    """Whether one thing has a colour: its own, or one that nobody would take for it."""
    for one in singles(place.sight, coloured=False, min_pixels=400):
        colour = plain_colour(own_colour(one.thing.instance))
        if colour is None or colour in one.name or not colour_shows(one.thing.instance):
            continue
        strangers = [c for c in ("red", "blue", "green", "yellow", "white", "black") if c != colour and not near_colours(c, colour)]
        for said in (colour, rng.choice(strangers)):
            expected = YesNo(value=said == colour, affirms=(said,), denies=(colour,) if said != colour else ())
            yield Draft(
                category="descriptor",
                kind="is-coloured",
                key=f"is-coloured:{one.thing.instance.id}",
                place=place,
                expected=expected,
                question=Question(
                    (
                        (f"is {one.the} {said}?", f"whether {one.the} is {said}"),
                        (f"is it true that {one.the} is {said}?", f"if it is true that {one.the} is {said}"),
                    )
                ),
                evidence=(view(place, expected, one.words, [place.sight.item(one.thing, colour)], whole=False),),
                looks=(ask(f"what colour is {one.the}?", place),),
                tags=("verification",),
                reads="yes" if expected.value else "no",
            )


def _colour_if_there(place: Place, nouns: frozenset[str], rng: random.Random) -> Iterator[Draft]:
    """The colour of something that is not there, beside that of something that is."""
    missing = likely_first(place, [kind for kind in absent(place.sight, nouns) if kind.colour is None], rng)
    shown = [one for one in singles(place.sight, coloured=False, min_pixels=300) if own_colour(one.thing.instance)]
    rng.shuffle(shown)
    for one, gone in zip(shown, missing, strict=False):
        colour = plain_colour(own_colour(one.thing.instance))
        if colour is None or colour in one.name or not colour_shows(one.thing.instance):
            continue
        value = Choice(value=colour, options=colour_options(), subject=unit_of(one.kind)[:2])
        none = NoneThere(subject=unit_of(gone)[:2], claims=wordings(colour_options()))
        item = place.sight.item(one.thing, colour)
        twin = _if_there(place, one.name, value, view(place, value, one.words, [item], whole=False), colour)
        yield replace(
            _if_there(place, noun_of(gone), none, view(place, none, about(gone), whole=True), "none"), kind="no-colour", twin=twin
        )


def _if_there(place: Place, name: str, expected: Choice | NoneThere, evidence: EvidenceView, reads: str) -> Draft:
    one = article(name)
    return Draft(
        category="descriptor",
        kind="colour-if",
        key=f"colour-if:{name}",
        place=place,
        expected=expected,
        question=Question(
            (
                (f"what colour is {the(name)}, if there is one?", f"what colour {the(name)} is, if there is one"),
                (f"if there is {one}, what colour is it?", f"what colour {the(name)} is, if you can see one"),
                (f"can you see {one}, and what colour is it?", f"whether you can see {one}, and what colour it is"),
            )
        ),
        evidence=(evidence,),
        looks=(count(f"{plural(name)}", place),) if reads == "none" else (ask(f"what colour is {the(name)}?", place),),
        tags=("none-there",) if reads == "none" else ("attribute", "colour"),
        reads=reads,
    )
