"""Locate texts, on which a camera can zoom in although they are not things of their own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scope_ptz.english.grammar.lexicon import lexicon, nouns_in
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.base import Box
from scope_ptz.perception.ground_truth.answers.legible_text import names_plates, texts_on
from scope_ptz.perception.ground_truth.answers.text_blocks import groups_of
from scope_ptz.perception.ground_truth.thing_search import find, find_phrase
from scope_ptz.perception.ground_truth.view import View
from scope_ptz.simulator.truth import TextSighting


@dataclass(frozen=True, slots=True)
class TextRegion:
    """The part of the frame with all texts on a thing. A camera can zoom in on it, although it is not a thing of its own."""

    id: str
    name: str
    box: Box

    @property
    def point(self) -> tuple[float, float]:
        return self.box.centre


def find_text_regions(view: View, description: tree.Description) -> list[TextRegion]:
    """Return the regions of the texts that a description names ("number plate of the van", "text on the sign"), largest first."""
    phrase = description.phrases[0]
    plate = phrase.words[-1:] != ("text",)
    if len(description.phrases) > 1 or (plate and not names_plates(phrase)):
        return []
    owners = [t.other for t in phrase.tests if isinstance(t, tree.Relation) and t.kind == "on"]
    things = find(view.with_cut_off_texts(), owners[0]) if owners else view.things
    texts = [t for t in texts_on(view, things, plate) if t.cap_height_px >= _MIN_LOCATED_CAP_PX]
    heights = {holder: max(t.cap_height_px for t in texts if t.text.parent == holder) for holder in {t.text.parent for t in texts}}
    return [
        _region([t for t in texts if t.text.parent == holder], "number plate" if plate else "text")
        for holder in sorted(heights, key=lambda holder: (-heights[holder], holder))
    ]


def find_sign_regions(view: View, description: tree.Description) -> list[TextRegion]:
    """Return the regions of "signs on the gantry", if its signs are no things of their own: those of the texts read together.

    Nothing else is known about such signs, so a description with further conditions has none.
    """
    (phrase, *others) = description.phrases
    is_plain = len(phrase.words) == 1 and lexicon().concept(phrase.words[0]) == "sign" and len(phrase.tests) == 1
    if others or not is_plain or phrase.order is not None or phrase.ordinal is not None:
        return []
    return _regions_of_lettering(view, phrase)


def may_be_lettering(view: View, description: tree.Description) -> bool:
    """Return whether a description may fit signs that are no things of their own, such as "red signs on the gantry"."""
    return any(_names_signs(view, phrase) and _regions_of_lettering(view, phrase) for phrase in description.phrases)


def _names_signs(view: View, phrase: tree.Phrase) -> bool:
    spans = nouns_in(phrase.words, view.nouns)
    concept = lexicon().concept(" ".join(phrase.words[slice(*spans[0])])) if spans else None
    return concept is not None and "sign" in lexicon().kinds(concept)


def _regions_of_lettering(view: View, phrase: tree.Phrase) -> list[TextRegion]:
    """Return the regions of the texts on what a phrase says its signs are on; none if that has signs of its own."""
    place = next((t for t in phrase.tests if isinstance(t, tree.Relation) and t.kind == "on"), None)
    if place is None or find_phrase(view, tree.Phrase(("signs",), (place,))):
        return []
    texts = [t for t in texts_on(view, find(view, place.other), plate=False) if t.cap_height_px >= _MIN_LOCATED_CAP_PX]
    bearers = dict.fromkeys(t.text.parent for t in texts)
    groups = [group for bearer in bearers for group in groups_of([t for t in texts if t.text.parent == bearer])]
    return sorted((_region(group, "sign") for group in groups), key=lambda region: -region.box.width * region.box.height)


def _region(texts: Sequence[TextSighting], name: str) -> TextRegion:
    x_min, y_min = (min(t.box[i] for t in texts) for i in (0, 1))
    x_max, y_max = (max(t.box[i] for t in texts) for i in (2, 3))
    return TextRegion(texts[0].text.id, name, Box(x_min=x_min, y_min=y_min, x_max=x_max, y_max=y_max, label=name))


_MIN_LOCATED_CAP_PX = 3.0
"""Minimum height in pixels of the capitals of a text that can be located, although not read."""
