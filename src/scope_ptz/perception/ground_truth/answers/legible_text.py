"""Answer questions about text. Only legible text is reported; for illegible text, the answer states why it cannot be read."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz import english
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.ground_truth.answers.restating import definite_phrase, is_plural, none_in_view
from scope_ptz.perception.ground_truth.answers.thing_names import TruthAnswer, known_answer, unknown_answer
from scope_ptz.perception.ground_truth.thing_search import find
from scope_ptz.perception.ground_truth.view import Thing, View, concepts_of
from scope_ptz.simulator.truth import MAX_READING_ANGLE_DEG, MIN_CAP_HEIGHT_PX, TextSighting


def answer_read(view: View, question: tree.Read) -> TruthAnswer:
    """Answer with the text on a thing, its number plate, or all text in view."""
    if question.what is None:
        return _quote_texts(view, None, [t for t in view.texts if not question.plate or is_plate(view, t)], question.plate)
    things = find(view.with_cut_off_texts(), question.what)
    if not things and _PLATE_WORDS.issuperset(phrase.words for phrase in question.what.phrases):
        # "the number plate" names no vehicle, so the plates of all vehicles are read
        return answer_read(view, tree.Read(None, plate=True))
    if not things:
        return unknown_answer(f"I cannot tell: {none_in_view(view, question.what)}")
    texts = _texts_on(view, things, question.plate)
    return _quote_texts(view, question.what, texts, question.plate)


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
    subject = definite_phrase(view, what, is_plural(what)) if what else "the picture"
    legible = list(dict.fromkeys(t.text.text for t in texts if t.legible))
    if legible:
        quoted = english.listing([f'"{t}"' for t in legible])
        if plate:
            return TruthAnswer(english.sentence(f"the number plate reads {quoted}"))
        return TruthAnswer(
            english.sentence(
                f"{subject} {'read' if what and is_plural(what) else 'reads'} {quoted}" if what else f"I can read {quoted}"
            )
        )
    if texts:
        thing = "a number plate" if plate else "text"
        return unknown_answer(
            f"there is {thing} {'on ' + subject if what else 'in view'}, but it is {illegibility_reason(texts)} to read"
        )
    if plate:
        return unknown_answer(f"I cannot tell: I can see no number plate {'on ' + subject if what else 'in view'}")
    return known_answer(f"there is no text on {subject}" if what else "there is no text in view")


def illegibility_reason(texts: Sequence[TextSighting]) -> str:
    """Return why the largest of several illegible texts cannot be read."""
    best = max(texts, key=lambda t: t.cap_height_px)
    if best.cap_height_px < MIN_CAP_HEIGHT_PX:
        return "too small"
    return "too oblique" if best.angle_deg > MAX_READING_ANGLE_DEG else "too much hidden or cut off"


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
    legible = list(dict.fromkeys(t.text.text for t in texts if t.legible))
    if legible:
        return known_answer(f"yes, I can read {english.listing([f'{chr(34)}{t}{chr(34)}' for t in legible])}{place}")
    if texts:
        return unknown_answer(f"there is text {where}, but it is {illegibility_reason(texts)} to read")
    return known_answer(f"no, there is no text {where}")


def answer_from_signs(view: View, signs: Sequence[Thing], fact: str) -> TruthAnswer | None:
    """Answer with a fact that is written on signs, such as the speed limit; None if the signs have no text."""
    texts = _texts_on(view, signs, plate=False)
    legible = list(dict.fromkeys(t.text.text for t in texts if t.legible and ("limit" not in fact or _is_speed_limit(view, t))))
    if legible:
        return TruthAnswer(english.sentence(f"the {fact} reads {english.listing([f'{chr(34)}{t}{chr(34)}' for t in legible])}"))
    return _quote_texts(view, None, texts, plate=False) if texts else None
