"""Reading: signs, boards and lettering, in views that are near enough and after zooming in on what bears them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise

from scope_ptz.bench.tasks.expected import Text
from scope_ptz.bench.tasks.task import ProgramCall
from scope_ptz.simulator.truth import BoxTuple, TextSighting
from scope_ptz.taskgen.authoring.drafts import Draft, Question, ask, view
from scope_ptz.taskgen.authoring.object_names import Named, boards, distinct, ends
from scope_ptz.taskgen.authoring.task_places import Place
from scope_ptz.taskgen.authoring.zoom_targets import SMALLEST_PX, framed
from scope_ptz.taskgen.facts.robust import with_parts

LONGEST = 80
"""Longer texts are not asked for: nobody would dictate them."""


_GUESSED_PX = 5.0
"""Whoever may zoom in knows what to zoom in on when its capitals are this high."""


def drafts(place: Place) -> list[Draft]:
    if place.swept:
        return []
    named = [*distinct(place.sight, SMALLEST_PX, _GUESSED_PX), *boards(place.sight, SMALLEST_PX), *ends(place.sight)]
    return [*_in_view(place, named), *_zoomed(place, named)]


def _in_view(place: Place, named: list[Named]) -> Iterator[Draft]:
    for one in named:
        texts = asked_for(one, place)
        expected = wanted(one, texts)
        if texts and expected is not None:
            yield _draft(place, one, expected, texts, place, ())


def _zoomed(place: Place, named: list[Named]) -> Iterator[Draft]:
    """What cannot be read from here, but can once the camera has zoomed in on it."""
    if any("zoom_factor" in call.arguments for call in place.calls):
        return  # nobody zooms in twice
    for one in named:
        family = with_parts(place.scene, one.thing.instance.id)
        lettered = any(text.parent in family for text in place.scene.file.texts)
        if one.place or not lettered or place.sight.texts_on(one.thing.instance):
            continue
        close = framed(place, one.thing, one.thing.instance)
        if close is None:
            continue
        texts = asked_for(one, close)
        expected = wanted(one, texts)
        if texts and expected is not None:
            call = ProgramCall(tool="zoom_to_object", arguments={"description": one.name})
            yield _draft(place, one, expected, texts, close, (call,))


def lines(texts: tuple[TextSighting, ...] | None) -> tuple[TextSighting, ...] | None:
    """Texts from top to bottom, where they are the lines of one piece of writing; None where they stand apart."""
    if not texts:
        return None
    found = {t.text.text.strip(): t for t in texts}
    order = sorted(found.values(), key=lambda t: t.box[1] + t.box[3])
    for upper, lower in pairwise(order):
        height = min(upper.box[3] - upper.box[1], lower.box[3] - lower.box[1])
        shared = min(upper.box[2], lower.box[2]) - max(upper.box[0], lower.box[0])
        beside = upper.box[3] - lower.box[1] > height / 2
        narrow = shared < 0.5 * min(upper.box[2] - upper.box[0], lower.box[2] - lower.box[0])
        if beside or narrow or lower.box[1] - upper.box[3] > _LINE_GAP * height:
            return None
    return tuple(order)


_LINE_GAP = 3.0
"""Lines of one piece of writing are no farther apart than so many times their height."""


def priced(texts: tuple[TextSighting, ...]) -> tuple[TextSighting, ...]:
    """Of what a price card says the price: its name holds the rest."""
    return tuple(t for t in texts if re.fullmatch(r"\d+\.\d\d", t.text.text.strip()))


def wanted(one: Named, texts: tuple[TextSighting, ...] | None) -> Text | None:
    """What the thing says in all; None when that is nothing, too much, or mostly in its name."""
    if not texts:
        return None
    said = list(dict.fromkeys(t.text.text.strip() for t in texts))
    whole = " ".join(said)
    name, words = (re.findall(r"\w+", text.lower()) for text in (one.name, whole))
    if len(whole) > LONGEST or len(said) > 4 or 2 * sum(word in name for word in words) >= len(words) or not words:
        return None
    return Text(accepted=(whole,), ocr=True)


def asked_for(one: Named, place: Place) -> tuple[TextSighting, ...] | None:
    """What is read on a thing at a place: all its lines, of a price card the price; None where the writing stands apart."""
    found = lines(place.sight.texts_on(one.thing.instance))
    here = place.sight.first.sightings
    box = next((s.box for s in here if s.instance.number == one.thing.instance.number), None)
    if found and not all(on_it(box, text) for text in found):
        return None
    return priced(found) if found and one.kind.category == "price card" else found


def on_it(box: BoxTuple | None, text: TextSighting) -> bool:
    """Whether a text lies within the box of a thing, and not on a plate beside it: that this is its number does not show."""
    x, y = (text.box[0] + text.box[2]) / 2, (text.box[1] + text.box[3]) / 2
    return box is not None and box[0] <= x <= box[2] and box[1] <= y <= box[3]


_Forms = tuple[tuple[str, str], ...]
_WRITING: tuple[_Forms, _Forms] = (
    (
        ("what does {n} say?", "what {n} says"),
        ("what is written on {n}?", "what is written on {n}"),
        ("what text is on {n}?", "what text is on {n}"),
        ("what can be read on {n}?", "what can be read on {n}"),
        ("which words or figures are on {n}?", "which words or figures are on {n}"),
    ),
    (
        ("what does {n} say when you zoom in on it?", "what {n} says when you zoom in on it"),
        ("what can you read on {n} after zooming in on it?", "what you can read on {n} after zooming in on it"),
        ("what is written on {n}, if you zoom in on it to read?", "what is written on {n}, seen from close up"),
        ("what does a close-up of {n} say?", "what a close-up of {n} says"),
    ),
)
_PLATES: tuple[_Forms, _Forms] = (
    (
        ("what is the number plate of {n}?", "the number plate of {n}"),
        ("which registration does {n} have?", "the registration of {n}"),
        ("can you read the number plate of {n}?", "what the number plate of {n} says"),
    ),
    (
        ("what is the number plate of {n}, if you zoom in on it to read?", "the number plate of {n}, seen from close up"),
        ("which registration does a close-up of {n} show?", "which registration a close-up of {n} shows"),
    ),
)


_PRICES: tuple[_Forms, _Forms] = (
    (
        ("what price is on {n}?", "what price is on {n}"),
        ("which price does {n} show?", "which price {n} shows"),
        ("can you read the price on {n}?", "the price on {n}"),
    ),
    (
        ("what price is on {n}, if you zoom in on it to read?", "the price on {n}, seen from close up"),
        ("what price does {n} show when you zoom in on it?", "which price {n} shows when you zoom in on it"),
        ("which price does a close-up of {n} show?", "the price that a close-up of {n} shows"),
    ),
)


def _draft(
    place: Place, one: Named, expected: Text, texts: tuple[TextSighting, ...], close: Place, zoom: tuple[ProgramCall, ...]
) -> Draft:
    plate = str(one.thing.instance.attributes.get("plate", ""))
    plated, price = expected.accepted == (plate,), one.kind.category == "price card"
    forms = (_PLATES if plated else _PRICES if price else _WRITING)[bool(zoom)]
    forms = tuple((direct.format(n=one.the), inside.format(n=one.the)) for direct, inside in forms)
    question = f"what is the number plate of {one.the}?" if plated else f"what does {one.the} say?"
    # Items are measured in the look that reads them, at its own sharpness.
    items = [close.sight.text_item(t) for t in texts]
    return Draft(
        category="ocr",
        kind=("plate-" if plated else "price-" if price else "") + ("close-up" if zoom else "in-view"),
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
