"""Reading: signs, boards and lettering, in views that are near enough and after zooming in on what bears them."""

from __future__ import annotations

import re
from collections.abc import Iterator

from scope_ptz.bench.authoring.drafts import Draft, Question, ask, view
from scope_ptz.bench.authoring.naming import Named, distinct, ends
from scope_ptz.bench.authoring.places import Place
from scope_ptz.bench.authoring.targets import SMALLEST_PX, framed
from scope_ptz.bench.expected import Text
from scope_ptz.bench.ground import with_parts
from scope_ptz.bench.tasks import ProgramCall
from scope_ptz.world.truth import TextSighting

LONGEST = 80
"""Longer texts are not asked for: nobody would dictate them."""


def drafts(place: Place) -> list[Draft]:
    if place.swept:
        return []
    named = [*distinct(place.sight, SMALLEST_PX), *ends(place.sight)]
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
        family = with_parts(place.scene, one.thing.instance.id)
        lettered = any(text.parent in family for text in place.scene.file.texts)
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


_Forms = tuple[tuple[str, str], ...]
_WRITING: tuple[_Forms, _Forms] = (
    (
        ("what does the {n} say?", "what the {n} says"),
        ("what is written on the {n}?", "what is written on the {n}"),
        ("what text is on the {n}?", "what text is on the {n}"),
        ("what can be read on the {n}?", "what can be read on the {n}"),
        ("which words or figures are on the {n}?", "which words or figures are on the {n}"),
    ),
    (
        ("zoom in on the {n}. What does it say?", "what the {n} says when you zoom in on it"),
        ("what does the {n} say? Zoom in on it.", "what is written on the {n}, zooming in on it to read"),
        ("what is the writing on the {n} if you zoom in on it?", "the writing on the {n} after zooming in on it"),
        ("get a close-up of the {n}. What is on it?", "what a close-up of the {n} says"),
    ),
)
_PLATES: tuple[_Forms, _Forms] = (
    (
        ("what is the number plate of the {n}?", "the number plate of the {n}"),
        ("which registration does the {n} have?", "the registration of the {n}"),
        ("can you read the number plate of the {n}?", "what the number plate of the {n} says"),
    ),
    (
        ("zoom in on the {n} and read its number plate.", "the number plate of the {n}, zooming in on it to read"),
        ("what is the registration of the {n}? Zoom in on it.", "which registration the {n} has when you zoom in on it"),
    ),
)


def _draft(
    place: Place, one: Named, expected: Text, texts: tuple[TextSighting, ...], close: Place, zoom: tuple[ProgramCall, ...]
) -> Draft:
    plate = str(one.thing.instance.attributes.get("plate", ""))
    plated = expected.accepted == (plate,)
    forms = (_PLATES if plated else _WRITING)[bool(zoom)]
    forms = tuple((direct.format(n=one.name), inside.format(n=one.name)) for direct, inside in forms)
    question = f"what is the number plate of the {one.name}?" if plated else f"what does the {one.name} say?"
    # Items are measured in the look that reads them, at its own sharpness.
    items = [close.sight.text_item(t) for t in texts]
    return Draft(
        category="ocr",
        kind=("plate-" if plated else "") + ("close-up" if zoom else "in-view"),
        key=f"text:{one.thing.instance.id}",
        place=place,
        expected=expected,
        question=Question(forms),
        evidence=(view(close, expected, one.words, items, whole=False),),
        looks=(*zoom, ask(question, place)),
        needs=tuple(dict.fromkeys((*place.needs, *(("zoom",) if zoom else ())))),
        tags=("text",),
        weight=len(texts),
        reads=expected.accepted[0],
    )
