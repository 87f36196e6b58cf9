"""Answer questions about text. Only legible text is reported; for illegible text, the answer states why it cannot be read."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from scope_ptz import english
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.base import Box
from scope_ptz.perception.ground_truth.answers.restating import definite_phrase, is_plural, none_in_view, noun_phrase
from scope_ptz.perception.ground_truth.answers.text_blocks import TextBlock, blocks_of
from scope_ptz.perception.ground_truth.answers.thing_names import TruthAnswer, known_answer, position_words, unknown_answer
from scope_ptz.perception.ground_truth.thing_search import find
from scope_ptz.perception.ground_truth.view import Thing, View, concepts_of
from scope_ptz.simulator.truth import MAX_READING_ANGLE_DEG, MIN_CAP_HEIGHT_PX, MIN_UNHIDDEN_FRACTION, TextSighting


def answer_read(view: View, question: tree.Read) -> TruthAnswer:
    """Answer with the text on a thing, its number plate, or all text in view."""
    if question.what is None:
        return _quote_texts(view, None, [t for t in view.texts if not question.plate or is_plate(view, t)], question.plate)
    things = find(view.with_cut_off_texts(), question.what)
    if not things and _PLATE_WORDS.issuperset(phrase.words for phrase in question.what.phrases):
        # A plate is no thing of its own: that "of the taxi" is read on the taxi, and "the number plate" on all vehicles.
        owners = [t.other for p in question.what.phrases for t in p.tests if isinstance(t, tree.Relation) and t.kind == "on"]
        return answer_read(view, tree.Read(owners[0] if owners else None, plate=True))
    if not things:
        return unknown_answer(f"I cannot tell: {none_in_view(view, question.what)}")
    texts = _texts_on(view, things, question.plate)
    if _is_any_sign(question.what) and (lettering := _legible_lettering(view, texts)):
        return _quote_signs_and_lettering(view, question.what, texts, lettering)
    return _quote_texts(view, question.what, texts, question.plate)


def _is_any_sign(what: tree.Description) -> bool:
    """Return whether a description names all signs, without saying which: "the signs"."""
    return what == tree.Description((tree.Phrase(("signs",), article=what.phrases[0].article),))


def _legible_lettering(view: View, on_signs: Sequence[TextSighting]) -> list[TextSighting]:
    """Return the legible texts on the walls of buildings, which people call signs although they are no things of their own."""
    return [t for t in view.texts if t.legible and t not in on_signs and "building" in concepts_of(view.instances[t.text.parent])]


def _quote_signs_and_lettering(
    view: View, what: tree.Description, texts: Sequence[TextSighting], lettering: Sequence[TextSighting]
) -> TruthAnswer:
    """Answer with all signs that can be read, and with the lettering on buildings. The camera needs no closer view for that."""
    buildings = [f"the {name}" for name in dict.fromkeys(view.instances[t.text.parent].name for t in lettering)]
    on_buildings = f"{english.listing(quotes(lettering))} on {english.listing(buildings)}"
    if any(t.legible for t in texts):
        signs = _quote_texts(view, what, texts, plate=False)
        separator = "\n" if "\n" in signs.text else " "
        return known_answer(f"{signs.text.rstrip('.')}.{separator}I can also read {on_buildings}")
    unread = _illegible_things(view, texts)
    if not unread:
        return known_answer(f"I can read {on_buildings}")
    reason = english.listing(_reasons_against(texts, unread), "or")
    if len(unread) == 1:
        return known_answer(f"I can read {on_buildings}. The only {noun_phrase(view, what)} in view is {reason} to read from here")
    signs_in_view = f"{len(unread)} {noun_phrase(view, what, plural=True)} in view"
    return known_answer(f"I can read {on_buildings}. The {signs_in_view} are {reason} to read from here")


def _texts_on(view: View, things: Sequence[Thing], plate: bool) -> list[TextSighting]:
    candidates = [t for t in view.texts if any(view.belongs(t.text.parent, x.id) for x in things)]
    return [t for t in candidates if is_plate(view, t) == plate] or ([] if plate else candidates)


def is_plate(view: View, text: TextSighting) -> bool:
    """Return whether a text is on a number plate, or is on a vehicle and has the form of a registration number."""
    owner = view.instances[text.text.parent]
    concepts = concepts_of(owner)
    return "number plate" in concepts or (
        "vehicle" in concepts and _REGISTRATION_NUMBER.fullmatch(text.text.text.replace(" ", "")) is not None
    )


_REGISTRATION_NUMBER = re.compile(r"(?=.*[0-9])[A-Z]{1,3}[0-9]{1,4}[A-Z]{0,3}")

_PLATE_WORDS = {words for noun in ("plate", "plates") for words in (("number", noun), ("license", noun), ("licence", noun))}


def _is_speed_limit(view: View, text: TextSighting) -> bool:
    """Return whether a text is a speed limit: either the scene says so, or the text is a multiple of ten on a sign."""
    owner = view.instances[text.text.parent]
    content = text.text.text.strip()
    if "signal" in owner.attributes:
        return content == str(owner.attributes["signal"])
    return content.isdigit() and int(content) % 10 == 0 and "sign" in concepts_of(owner)


def _quote_texts(view: View, what: tree.Description | None, texts: Sequence[TextSighting], plate: bool) -> TruthAnswer:
    """Answer with the legible texts, and say what could not be read."""
    subject = definite_phrase(view, what, is_plural(what)) if what else "the picture"
    if not any(t.legible for t in texts):
        if not (texts or plate) and what and (clocks := [t for t in find(view, what) if "clock" in t.concepts]):
            return _answer_clock_time(clocks)
        if what and is_plural(what) and not plate and (best := _best_to_go_closer_to(view, texts)) is not None:
            return unknown_answer(
                f"there is text on {subject}, but {illegibility(texts)} to read; the largest that faces the camera is on the {best}"
            )
        return _nothing_legible(subject if what else "", texts, plate)
    if plate:
        return TruthAnswer(english.sentence(f"the number plate reads {english.listing(quotes(texts))}"))
    readers = _things_with_text(texts, legible=True)
    if what is None:
        return known_answer(f"I can read {english.listing(quotes(texts))}{_unread_rest(view, texts)}")
    if (is_plural(what) or len(readers) > 1) and (unread := _illegible_things(view, texts)):
        share = f"{len(readers)} of the {len(readers) + len(unread)} {noun_phrase(view, what, plural=True)} in view"
        return known_answer(f"I can read {share}:{_quoted(view, texts, readers)}{_unread_things(texts, unread)}")
    verb = "read" if is_plural(what) else "reads"
    return known_answer(f"{_quoted(view, texts, readers, f'{subject} {verb}')}{_unread_rest(view, texts)}")


def _best_to_go_closer_to(view: View, texts: Sequence[TextSighting]) -> str | None:
    """Return the name of the thing with the largest text that is only too small; None if there is none, or only one thing."""
    small = [t for t in texts if is_only_too_small(t)]
    things = [view.by_id[t.text.parent] for t in sorted(small, key=lambda t: -t.cap_height_px) if t.text.parent in view.by_id]
    return things[0].name if things and len(_things_with_text(texts, legible=False)) > 1 else None


def is_only_too_small(text: TextSighting) -> bool:
    """Return whether a text cannot be read, but could be from close up."""
    is_in_sight = text.angle_deg <= MAX_READING_ANGLE_DEG and text.unhidden_fraction >= MIN_UNHIDDEN_FRACTION
    return is_in_sight and text.cap_height_px < MIN_CAP_HEIGHT_PX


def _nothing_legible(subject: str, texts: Sequence[TextSighting], plate: bool) -> TruthAnswer:
    place = f"on {subject}" if subject else "in view"
    if texts:
        return unknown_answer(f"there is {'a number plate' if plate else 'text'} {place}, but {illegibility(texts)} to read")
    if plate:
        return unknown_answer(f"I cannot tell: I can see no number plate {place}")
    return known_answer(f"I can see no text {f'{place} from here' if subject else place}")


def quotes(texts: Sequence[TextSighting]) -> list[str]:
    """Return the legible texts in quotation marks: the lines of a sign together, each row of a list on its own."""
    return list(dict.fromkeys(f'"{line}"' for block in _blocks(texts) for line in block.lines))


def _blocks(texts: Sequence[TextSighting]) -> list[TextBlock]:
    return [
        block
        for thing in _things_with_text(texts, legible=True)
        for block in blocks_of([t for t in texts if t.text.parent == thing and t.legible])
    ]


def _quoted(view: View, texts: Sequence[TextSighting], readers: Sequence[str], reads: str = "") -> str:
    """Return the quotations after ``reads``. The rows of a list have a line each, and several lists have a heading each."""
    by_thing = {thing: [t for t in texts if t.text.parent == thing] for thing in readers}
    if not any(block.is_list for block in _blocks(texts)):
        return f"{reads} {english.listing(quotes(texts))}"
    rows = {thing: "\n".join(quotes(on_thing)) for thing, on_thing in by_thing.items()}
    if len(rows) == 1 and reads:
        return f"{reads}:\n{rows[readers[0]]}"
    heading = "" if reads else "\n"
    return heading + "\n".join(f"The {view.instances[thing].name} reads:\n{row}" for thing, row in rows.items())


def _things_with_text(texts: Sequence[TextSighting], *, legible: bool) -> list[str]:
    """Return the ids of the things that bear any of the texts."""
    return list(dict.fromkeys(t.text.parent for t in texts if t.legible or not legible))


def _illegible_things(view: View, texts: Sequence[TextSighting]) -> list[str]:
    """Return the ids of the visible things on which no text is legible."""
    readers = _things_with_text(texts, legible=True)
    return [thing for thing in _things_with_text(texts, legible=False) if thing not in readers and thing in view.by_id]


def _unread_things(texts: Sequence[TextSighting], unread: Sequence[str]) -> str:
    """Return the sentence about the things on which no text is legible, with all the reasons."""
    rest = "The other one is" if len(unread) == 1 else f"The other {len(unread)} are"
    return f". {rest} {english.listing(_reasons_against(texts, unread), 'or')} to read from here"


def _reasons_against(texts: Sequence[TextSighting], unread: Sequence[str]) -> list[str]:
    """Return all reasons why the texts on some things cannot be read: "too small", "seen too much from the side"."""
    return list(dict.fromkeys(_REASONS[_problem(t)] for t in texts if t.text.parent in unread))


def _unread_rest(view: View, texts: Sequence[TextSighting]) -> str:
    """Return the sentence about visible text that is not legible, beside the text that is; empty if there is none."""
    rest = [t for t in texts if not t.legible and t.unhidden_fraction > 0 and t.text.parent in view.by_id]
    return f". The rest is {_REASONS[_problem(_largest(rest))]} to read" if rest else ""


_REASONS = {"small": "too small", "oblique": "seen too much from the side", "hidden": "too much hidden or cut off"}


def _problem(text: TextSighting) -> Literal["small", "oblique", "hidden"]:
    if text.cap_height_px < MIN_CAP_HEIGHT_PX:
        return "small"
    return "oblique" if text.angle_deg > MAX_READING_ANGLE_DEG else "hidden"


def _largest(texts: Sequence[TextSighting]) -> TextSighting:
    return max(texts, key=lambda t: t.cap_height_px)


def illegibility(texts: Sequence[TextSighting]) -> str:
    """Return why the largest of several illegible texts cannot be read, in words before "to read"."""
    problem = _problem(_largest(texts))
    return "too much of it is hidden or cut off" if problem == "hidden" else f"it is too {problem}"


def _answer_clock_time(clocks: Sequence[Thing]) -> TruthAnswer:
    """Answer what the hands of clocks show, if their faces are large enough."""
    shown = [(t, str(t.attributes.get("time", t.attributes.get("shows", "")))) for t in clocks]
    stated = [(t, time) for t, time in shown if time]
    if not stated:
        return unknown_answer("I cannot tell the time from the clock hands")
    large = [(t, time) for t, time in stated if t.sighting.pixels >= _MIN_CLOCK_PX]
    if not large:
        return unknown_answer(
            "the clocks are too small to read" if len(stated) > 1 else f"the {stated[0][0].name} is too small to read"
        )
    if len(large) == 1:
        return known_answer(f"the {large[0][0].name} shows {large[0][1]}")
    return known_answer(english.listing([f"the {t.name} {position_words(t)} shows {time}" for t, time in large]))


_MIN_CLOCK_PX = 1200
"""Minimum number of visible pixels of a clock whose hands can be read, a face of about 40 x 40 pixels."""


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
    if len(description.phrases) > 1 or (plate and phrase.words not in _PLATE_WORDS):
        return []
    owners = [t.other for t in phrase.tests if isinstance(t, tree.Relation) and t.kind == "on"]
    things = find(view.with_cut_off_texts(), owners[0]) if owners else view.things
    texts = [t for t in _texts_on(view, things, plate) if t.cap_height_px >= _MIN_LOCATED_CAP_PX]
    heights = {holder: max(t.cap_height_px for t in texts if t.text.parent == holder) for holder in {t.text.parent for t in texts}}
    return [
        _region([t for t in texts if t.text.parent == holder], "number plate" if plate else "text")
        for holder in sorted(heights, key=lambda holder: (-heights[holder], holder))
    ]


def _region(texts: Sequence[TextSighting], name: str) -> TextRegion:
    x_min, y_min = (min(t.box[i] for t in texts) for i in (0, 1))
    x_max, y_max = (max(t.box[i] for t in texts) for i in (2, 3))
    return TextRegion(texts[0].text.id, name, Box(x_min=x_min, y_min=y_min, x_max=x_max, y_max=y_max, label=name))


_MIN_LOCATED_CAP_PX = 3.0
"""Minimum height in pixels of the capitals of a text that can be located, although not read."""


def answer_text_exists(view: View, question: tree.TextExists) -> TruthAnswer:
    """Answer whether there is text on a thing or in view, and quote it."""
    if question.what is None:
        texts: Sequence[TextSighting] = view.texts
        where, place = "in view", ""
    else:
        things = find(view.with_cut_off_texts(), question.what)
        if not things:
            return unknown_answer(f"I cannot tell: {none_in_view(view, question.what)}")
        texts = [t for t in view.texts if any(view.belongs(t.text.parent, x.id) for x in things)]
        where = f"on {definite_phrase(view, question.what, is_plural(question.what))}"
        place = f" {where}"
    if any(t.legible for t in texts):
        return known_answer(f"yes, I can read {english.listing(quotes(texts))}{place}")
    if texts:
        return unknown_answer(f"there is text {where}, but {illegibility(texts)} to read")
    return known_answer(f"no, I can see no text {where}{' from here' if place else ''}")


def answer_from_signs(view: View, signs: Sequence[Thing], fact: str) -> TruthAnswer | None:
    """Answer with a fact that is written on signs, such as the speed limit; None if the signs have no text."""
    texts = _texts_on(view, signs, plate=False)
    if legible := [t for t in texts if t.legible and ("limit" not in fact or _is_speed_limit(view, t))]:
        return TruthAnswer(english.sentence(f"the {fact} reads {english.listing(quotes(legible))}"))
    return _quote_texts(view, None, texts, plate=False) if texts else None
