"""Reading: signs, boards and lettering, in views that are near enough and after zooming in on what bears them."""

from __future__ import annotations

import re
from collections.abc import Iterator

from scope_ptz.bench.authoring.drafts import Draft, Question, ask, view
from scope_ptz.bench.authoring.naming import Named, ends, singles
from scope_ptz.bench.authoring.places import Place
from scope_ptz.bench.authoring.targets import framed
from scope_ptz.bench.authoring.words import about
from scope_ptz.bench.expected import Text
from scope_ptz.bench.tasks import ProgramCall
from scope_ptz.world.truth import TextSighting

LONGEST = 80
"""Longer texts are not asked for: nobody would dictate them."""


def drafts(place: Place) -> list[Draft]:
    if place.swept:
        return []
    named = [*singles(place.sight, coloured=True), *ends(place.sight)]
    return [*_in_view(place, named), *_zoomed(place, named)]


def _in_view(place: Place, named: list[Named]) -> Iterator[Draft]:
    for one in named:
        texts = place.sight.texts_on(one.thing.instance)
        expected = wanted(one, texts)
        if texts and expected is not None:
            yield _draft(place, one, expected, texts, place, ())


def _zoomed(place: Place, named: list[Named]) -> Iterator[Draft]:
    """What cannot be read from here, but can once the camera has zoomed in on it."""
    for one in named:
        family = place.scene.families[one.thing.instance.id]
        lettered = any(place.scene.by_id[text.parent].number in family for text in place.scene.file.texts)
        if one.place or not lettered or place.sight.texts_on(one.thing.instance):
            continue
        close = framed(place, one.thing, one.thing.instance)
        if close is None:
            continue
        texts = close.sight.texts_on(one.thing.instance)
        expected = wanted(one, texts)
        if texts and expected is not None:
            call = ProgramCall(tool="zoom_to_object", arguments={"description": one.name})
            yield _draft(place, one, expected, texts, close, (call,))


def wanted(one: Named, texts: tuple[TextSighting, ...] | None) -> Text | None:
    """What the thing says in all; None when that is nothing, too much, or already in its name."""
    if not texts:
        return None
    said = list(dict.fromkeys(t.text.text.strip() for t in texts))
    whole = " / ".join(said)
    name = set(re.findall(r"\w+", one.name.lower()))
    if len(whole) > LONGEST or len(said) > 4 or set(re.findall(r"\w+", whole.lower())) <= name or not re.search(r"\w", whole):
        return None
    return Text(accepted=(whole,), ocr=True)


def _draft(
    place: Place, one: Named, expected: Text, texts: tuple[TextSighting, ...], close: Place, zoom: tuple[ProgramCall, ...]
) -> Draft:
    forms: tuple[tuple[str, str], ...] = (
        (f"what does the {one.name} say?", f"what the {one.name} says"),
        (f"what is written on the {one.name}?", f"what is written on the {one.name}"),
        (f"what text is on the {one.name}?", f"what text is on the {one.name}"),
        (f"what can be read on the {one.name}?", f"what can be read on the {one.name}"),
        (f"which words or figures are on the {one.name}?", f"which words or figures are on the {one.name}"),
    )
    if zoom:
        forms = (
            (f"zoom in on the {one.name}. What does it say?", f"what the {one.name} says when you zoom in on it"),
            (f"what does the {one.name} say? Zoom in on it.", f"what is written on the {one.name}, zooming in on it to read"),
            (
                f"what is the writing on the {one.name} if you zoom in on it?",
                f"the writing on the {one.name} after zooming in on it",
            ),
            (f"get a close-up of the {one.name}. What is on it?", f"what a close-up of the {one.name} says"),
        )
    question = f"what does the {one.name} say?"
    # Items are measured in the look that reads them, at its own sharpness.
    items = [close.sight.text_item(t) for t in texts]
    return Draft(
        category="ocr",
        kind="close-up" if zoom else "in-view",
        key=f"text:{one.thing.instance.id}",
        place=place,
        expected=expected,
        question=Question(forms),
        evidence=(view(close, expected, about(one.kind), items, whole=False),),
        looks=(*zoom, ask(question, place)),
        needs=tuple(dict.fromkeys((*place.needs, *(("zoom",) if zoom else ())))),
        tags=("text",),
        weight=len(texts),
        reads=expected.accepted[0],
    )
