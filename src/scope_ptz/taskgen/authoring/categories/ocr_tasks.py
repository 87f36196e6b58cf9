"""OCR tasks: signs, boards and lettering that are legible in a view, or after zooming in on them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise

from scope_ptz.bench.tasks.expected import Text
from scope_ptz.bench.tasks.task import ProgramCall
from scope_ptz.simulator.truth import BoxTuple, TextSighting
from scope_ptz.taskgen.authoring.drafts import Question, TaskDraft, evidence_view, query_call
from scope_ptz.taskgen.authoring.object_names import NamedThing, coloured_boards, extreme_things, nameable_things
from scope_ptz.taskgen.authoring.task_places import TaskPlace
from scope_ptz.taskgen.authoring.zoom_targets import MIN_TARGET_PX, close_up_place
from scope_ptz.taskgen.facts.robust import ids_with_parts

MAX_TEXT_CHARS = 80
"""Maximum length of the expected text, in characters."""

_NOTICEABLE_TEXT_PX = 5.0
"""Minimum height of capitals, in pixels, for a person to notice that there is text to zoom in on."""


def drafts(place: TaskPlace) -> list[TaskDraft]:
    """Return drafts about text that is legible in a view, or after zooming in; none for a sweep."""
    if place.swept:
        return []
    named = [
        *nameable_things(place.truth, MIN_TARGET_PX, _NOTICEABLE_TEXT_PX),
        *coloured_boards(place.truth, MIN_TARGET_PX),
        *extreme_things(place.truth),
    ]
    return [*_legible_drafts(place, named), *_zoomed_drafts(place, named)]


def _legible_drafts(place: TaskPlace, named: list[NamedThing]) -> Iterator[TaskDraft]:
    for target in named:
        texts = texts_to_read(target, place)
        expected = expected_text(target, texts)
        if texts and expected is not None:
            yield _text_draft(place, target, expected, texts, place, ())


def _zoomed_drafts(place: TaskPlace, named: list[NamedThing]) -> Iterator[TaskDraft]:
    """Yield drafts about text that is legible only after zooming in."""
    if any("zoom_factor" in call.arguments for call in place.calls):
        return  # tasks do not zoom in twice
    for target in named:
        part_ids = ids_with_parts(place.scene, target.thing.instance.id)
        has_lettering = any(text.parent in part_ids for text in place.scene.file.texts)
        if target.positional or not has_lettering or place.truth.texts_on(target.thing.instance):
            continue
        close_up = close_up_place(place, target.thing, target.thing.instance)
        if close_up is None:
            continue
        texts = texts_to_read(target, close_up)
        expected = expected_text(target, texts)
        if texts and expected is not None:
            call = ProgramCall(tool="zoom_to_object", arguments={"description": target.name})
            yield _text_draft(place, target, expected, texts, close_up, (call,))


def order_lines(texts: tuple[TextSighting, ...] | None) -> tuple[TextSighting, ...] | None:
    """Return pieces of text from top to bottom if they are lines of the same text; otherwise None."""
    if not texts:
        return None
    by_text = {t.text.text.strip(): t for t in texts}
    order = sorted(by_text.values(), key=lambda t: t.box[1] + t.box[3])
    for upper, lower in pairwise(order):
        height = min(upper.box[3] - upper.box[1], lower.box[3] - lower.box[1])
        overlap = min(upper.box[2], lower.box[2]) - max(upper.box[0], lower.box[0])
        is_side_by_side = upper.box[3] - lower.box[1] > height / 2
        has_little_overlap = overlap < 0.5 * min(upper.box[2] - upper.box[0], lower.box[2] - lower.box[0])
        if is_side_by_side or has_little_overlap or lower.box[1] - upper.box[3] > _MAX_LINE_GAP * height:
            return None
    return tuple(order)


_MAX_LINE_GAP = 3.0
"""Maximum gap between lines of the same text, as a multiple of their height."""


def select_prices(texts: tuple[TextSighting, ...]) -> tuple[TextSighting, ...]:
    """Return the prices on a price card. Questions use the rest of its text as the card's name."""
    return tuple(t for t in texts if re.fullmatch(r"\d+\.\d\d", t.text.text.strip()))


def expected_text(target: NamedThing, texts: tuple[TextSighting, ...] | None) -> Text | None:
    """Return the whole text on an object as the expected answer.

    Return None if there is no text, if it is too long or has too many pieces, or if half of its words are in the object's name.
    """
    if not texts:
        return None
    pieces = list(dict.fromkeys(t.text.text.strip() for t in texts))
    whole = " ".join(pieces)
    name, words = (re.findall(r"\w+", text.lower()) for text in (target.name, whole))
    if len(whole) > MAX_TEXT_CHARS or len(pieces) > 4 or 2 * sum(word in name for word in words) >= len(words) or not words:
        return None
    return Text(accepted=(whole,), ocr=True)


def texts_to_read(target: NamedThing, place: TaskPlace) -> tuple[TextSighting, ...] | None:
    """Return the lines of text on an object (for a price card, only the price); None if they do not belong together."""
    readable = order_lines(place.truth.texts_on(target.thing.instance))
    box = next((s.box for s in place.truth.first_sample.sightings if s.instance.number == target.thing.instance.number), None)
    if readable and not all(is_on_object(box, text) for text in readable):
        return None
    return select_prices(readable) if readable and target.kind.category == "price card" else readable


def is_on_object(box: BoxTuple | None, text: TextSighting) -> bool:
    """Return whether the centre of text is inside the box of an object, so that the text visibly belongs to the object."""
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
"""Questions about lettering, number plates and prices: first for text that is legible in the view, then for text that becomes
legible by zooming in."""


def _text_draft(
    place: TaskPlace,
    target: NamedThing,
    expected: Text,
    texts: tuple[TextSighting, ...],
    reading_place: TaskPlace,
    zoom: tuple[ProgramCall, ...],
) -> TaskDraft:
    plate = str(target.thing.instance.attributes.get("plate", ""))
    is_plate, is_price = expected.accepted == (plate,), target.kind.category == "price card"
    forms = (_PLATES if is_plate else _PRICES if is_price else _WRITING)[bool(zoom)]
    forms = tuple((direct.format(n=target.with_the), clause.format(n=target.with_the)) for direct, clause in forms)
    question = f"what is the number plate of {target.with_the}?" if is_plate else f"what does {target.with_the} say?"
    # The evidence items are measured in the view in which the text is legible.
    items = [reading_place.truth.text_item(t) for t in texts]
    return TaskDraft(
        category="ocr",
        question_type=("plate-" if is_plate else "price-" if is_price else "") + ("close-up" if zoom else "in-view"),
        key=f"text:{target.thing.instance.id}",
        place=place,
        expected=expected,
        question=Question(forms),
        evidence=(evidence_view(reading_place, expected, target.words, items, whole=False),),
        perception_calls=(*zoom, query_call(question, place)),
        needs=tuple(dict.fromkeys((*place.needs, *(("zoom",) if zoom else ())))),
        tags=("text",),
        object_count=len(texts),
        answer_key=expected.accepted[0],
    )
