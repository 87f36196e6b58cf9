"""Locate texts, on which a camera can zoom in although they are not things of their own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.base import Box
from scope_ptz.perception.ground_truth.answers.legible_text import names_any_sign, names_plates, texts_on
from scope_ptz.perception.ground_truth.answers.text_blocks import groups_of
from scope_ptz.perception.ground_truth.thing_search import find
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
    """Return the regions of "signs on the gantry", if its signs are no things of their own: those of the texts read together."""
    owners = [t.other for p in description.phrases for t in p.tests if isinstance(t, tree.Relation) and t.kind == "on"]
    if not owners or not all(names_any_sign(view, phrase) for phrase in description.phrases):
        return []
    texts = [t for t in texts_on(view, find(view, owners[0]), plate=False) if t.cap_height_px >= _MIN_LOCATED_CAP_PX]
    bearers = dict.fromkeys(t.text.parent for t in texts)
    groups = [group for bearer in bearers for group in groups_of([t for t in texts if t.text.parent == bearer])]
    return sorted((_region(group, "sign") for group in groups), key=lambda region: -region.box.width * region.box.height)


def _region(texts: Sequence[TextSighting], name: str) -> TextRegion:
    x_min, y_min = (min(t.box[i] for t in texts) for i in (0, 1))
    x_max, y_max = (max(t.box[i] for t in texts) for i in (2, 3))
    return TextRegion(texts[0].text.id, name, Box(x_min=x_min, y_min=y_min, x_max=x_max, y_max=y_max, label=name))


_MIN_LOCATED_CAP_PX = 3.0
"""Minimum height in pixels of the capitals of a text that can be located, although not read."""
