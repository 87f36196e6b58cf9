"""Answer questions about text. Only legible text is reported; for illegible text, the answer states why it cannot be read."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import lexicon, nouns_in, singular_phrase
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.ground_truth.answers.clock_times import answer_clock_time
from scope_ptz.perception.ground_truth.answers.restating import definite_phrase, is_plural, none_in_view, noun_phrase
from scope_ptz.perception.ground_truth.answers.text_blocks import TextBlock, blocks_of
from scope_ptz.perception.ground_truth.answers.thing_names import TruthAnswer, known_answer, unknown_answer
from scope_ptz.perception.ground_truth.answers.unread_texts import (
    closer_views,
    illegibility,
    illegible_things,
    reasons_against,
    things_with_text,
    unread_rest,
)
from scope_ptz.perception.ground_truth.relations import stands_above
from scope_ptz.perception.ground_truth.thing_facts import bears_text, colour_of
from scope_ptz.perception.ground_truth.thing_search import find
from scope_ptz.perception.ground_truth.view import Thing, View, concepts_of
from scope_ptz.simulator.truth import TextSighting


def answer_read(view: View, question: tree.Read) -> TruthAnswer:
    """Answer with the text on a thing, its number plate, or all text in view.

    If the question is about several things, the answer ends with the names of those that a closer view may help with.
    """
    what = question.what
    if what is None:
        return _quote_texts(view, None, [t for t in view.texts if not question.plate or is_plate(view, t)], question.plate)
    things = find(view.with_cut_off_texts(), what)
    if not things:
        owners = [t.other for p in what.phrases for t in p.tests if isinstance(t, tree.Relation) and t.kind == "on"]
        if all(map(names_plates, what.phrases)):
            # A plate is no thing of its own: that "of the taxi" is read on the taxi, and "the number plate" on all vehicles.
            return answer_read(view, tree.Read(owners[0] if owners else None, plate=True))
        if owners and all(names_any_sign(view, phrase) for phrase in what.phrases) and find(view, owners[0]):
            return answer_read(view, tree.Read(owners[0]))  # a sign on a cabin may be the cabin's own lettering
        return unknown_answer(f"I cannot tell: {none_in_view(view, what)}")
    things = things if is_plural(what) else _only_of_colour(what, things)
    texts = texts_on(view, things, question.plate)
    if not texts and not question.plate and (bases := _bases_with_text(view, things)):
        return _quote_base(view, bases[0])
    if _is_any_sign(what) and (lettering := _legible_lettering(view, texts)):
        reply = _quote_signs_and_lettering(view, what, texts, lettering)
    else:
        reply = _quote_texts(view, what, texts, question.plate)
    if question.plate or len(things) == 1 or not (is_plural(what) or not reply.known):
        return reply
    closer = closer_views(view, texts)
    return reply._replace(text=f"{reply.text} {closer}.") if closer else reply


def _bases_with_text(view: View, things: Sequence[Thing]) -> list[Thing]:
    """Return the things with text on which some things stand, as part of them: the plinth of a statue."""
    by_id = {t.id: t for t in view.with_cut_off_texts().things}
    bases = [(t, by_id[t.parent]) for t in things if t.parent is not None and t.parent in by_id]
    return [base for t, base in bases if stands_above(t, base) and view.texts_on(base)]


def _quote_base(view: View, base: Thing) -> TruthAnswer:
    """Answer with the text on what a thing stands on, which people call the text on the thing."""
    texts = view.texts_on(base)
    if any(t.legible for t in texts):
        return known_answer(f"the {base.name} reads {english.listing(quotes(texts))}{unread_rest(view, texts)}")
    return unknown_answer(f"the text is on the {base.name}, but {illegibility(texts)} to read")


def names_any_sign(view: View, phrase: tree.Phrase) -> bool:
    """Return whether a phrase is a noun for a sign without other words: "sign", "name plate"."""
    spans = nouns_in(phrase.words, view.nouns)
    concept = lexicon().concept(" ".join(phrase.words))
    return spans[:1] == [(0, len(phrase.words))] and concept is not None and "sign" in lexicon().kinds(concept)


def _only_of_colour(what: tree.Description, things: list[Thing]) -> list[Thing]:
    """Return the things that have no colour but the requested one, if there are any: a red sign before one with a red rim."""
    colours = {word for phrase in what.phrases for word in phrase.words if word in english.COLOURS}
    return [t for t in things if {colour_of(t)} == colours] or things


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
    unread = illegible_things(view, texts)
    if not unread:
        return known_answer(f"I can read {on_buildings}")
    reason = english.listing(reasons_against(texts, unread), "or")
    if len(unread) == 1:
        return known_answer(f"I can read {on_buildings}. The only {noun_phrase(view, what)} in view is {reason} to read from here")
    signs_in_view = f"{len(unread)} {noun_phrase(view, what, plural=True)} in view"
    return known_answer(f"I can read {on_buildings}. The {signs_in_view} are {reason} to read from here")


def texts_on(view: View, things: Sequence[Thing], plate: bool) -> list[TextSighting]:
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


def names_plates(phrase: tree.Phrase) -> bool:
    """Return whether a phrase is a noun for number plates without other words."""
    return lexicon().concept(singular_phrase(" ".join(phrase.words))) == "number plate"


def _is_speed_limit(view: View, text: TextSighting) -> bool:
    """Return whether a text is a speed limit: one that the scene states, any number on a speed sign, or a multiple of ten."""
    owner = view.instances[text.text.parent]
    content = text.text.text.strip()
    if "signal" in owner.attributes:
        return content == str(owner.attributes["signal"])
    concepts = concepts_of(owner)
    return content.isdigit() and ("speed sign" in concepts or (int(content) % 10 == 0 and "sign" in concepts))


def _quote_texts(view: View, what: tree.Description | None, texts: Sequence[TextSighting], plate: bool) -> TruthAnswer:
    """Answer with the legible texts, and say what could not be read."""
    subject = definite_phrase(view, what, is_plural(what)) if what else "the picture"
    if not any(t.legible for t in texts):
        if not (texts or plate) and what and (clocks := [t for t in find(view, what) if "clock" in t.concepts]):
            return answer_clock_time(clocks)
        if not (texts or plate) and what and any(map(bears_text, find(view, what))):
            return unknown_answer(f"I cannot tell what is written on {subject}")
        return _nothing_legible(subject if what else "", texts, plate)
    if plate:
        return TruthAnswer(english.sentence(f"the number plate reads {english.listing(quotes(texts))}"))
    if what is None:
        return known_answer(f"I can read {english.listing(quotes(texts))}{unread_rest(view, texts)}")
    readers = things_with_text(texts, legible=True)
    unread = illegible_things(view, texts)
    if unread and (is_plural(what) or len(readers) > 1):
        share = f"{len(readers)} of the {len(readers) + len(unread)} {noun_phrase(view, what, plural=True)} in view"
        return known_answer(f"I can read {share}:{_quoted(view, texts, readers)}{_unread_things(texts, unread)}")
    if unread and not _belong_to_one_thing(view, what, (*readers, *unread)):
        subject = f"the {view.instances[readers[0]].name}"  # one of several signs, if asked for "the sign"
        kind = noun_phrase(view, what, plural=len(unread) > 1)
        return known_answer(f"{_quoted(view, texts, readers, f'{subject} reads')}{_unread_things(texts, unread, kind)}")
    verb = "read" if is_plural(what) else "reads"
    return known_answer(f"{_quoted(view, texts, readers, f'{subject} {verb}')}{unread_rest(view, texts)}")


def _belong_to_one_thing(view: View, what: tree.Description, bearers: Sequence[str]) -> bool:
    """Return whether one of the things asked for has all bearers of text as its parts."""
    return any(all(view.belongs(bearer, t.id) for bearer in bearers) for t in find(view.with_cut_off_texts(), what))


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
        for thing in things_with_text(texts, legible=True)
        for block in blocks_of([t for t in texts if t.text.parent == thing and t.legible])
    ]


def _quoted(view: View, texts: Sequence[TextSighting], readers: Sequence[str], reads: str = "") -> str:
    """Return the quotations after ``reads``. The rows of a list have a line each, and several lists have a heading each."""
    by_thing = {thing: [t for t in texts if t.text.parent == thing] for thing in readers}
    if not any(block.is_list for block in _blocks(texts)):
        # A share such as "7 of the 10 containers" needs the number of those that bear the same text.
        bearers = Counter(quote for on_thing in by_thing.values() for quote in quotes(on_thing))
        counted = [f"{q} ({bearers[q]} times)" if bearers[q] > 1 and not reads else q for q in quotes(texts)]
        return f"{reads} {english.listing(counted)}"
    rows = {thing: "\n".join(quotes(on_thing)) for thing, on_thing in by_thing.items()}
    if len(rows) == 1 and reads:
        return f"{reads}:\n{rows[readers[0]]}"
    heading = "" if reads else "\n"
    return heading + "\n".join(f"The {view.instances[thing].name} reads:\n{row}" for thing, row in rows.items())


def _unread_things(texts: Sequence[TextSighting], unread: Sequence[str], kind: str = "") -> str:
    """Return the sentence about the things on which no text is legible, with all the reasons."""
    noun = f" {kind} in view" if kind else ""
    rest = f"The other{noun or ' one'} is" if len(unread) == 1 else f"The other {len(unread)}{noun} are"
    return f". {rest} {english.listing(reasons_against(texts, unread), 'or')} to read from here"


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
    if question.what is not None and any(map(bears_text, find(view, question.what))):
        return unknown_answer(f"I cannot tell whether there is text {where}")
    return known_answer(f"no, I can see no text {where}{' from here' if place else ''}")


def answer_from_signs(view: View, signs: Sequence[Thing], fact: str) -> TruthAnswer | None:
    """Answer with a fact that is written on signs, such as the speed limit; None if the signs have no text."""
    texts = texts_on(view, signs, plate=False)
    if legible := [t for t in texts if t.legible and ("limit" not in fact or _is_speed_limit(view, t))]:
        if english.is_plural(fact):
            return known_answer(f"the {fact} are given as {english.listing(quotes(legible))}")
        numbers = quotes(legible)
        signs_read = f"{fact} signs read" if len(numbers) > 1 else f"{fact} sign reads"
        return known_answer(f"the {signs_read if 'limit' in fact else f'{fact} reads'} {english.listing(numbers)}")
    illegible = [t for t in texts if not t.legible]
    if not illegible:
        return _quote_texts(view, None, texts, plate=False) if texts else None
    largest = max(illegible, key=lambda t: t.cap_height_px)
    verb = "are" if english.is_plural(fact) else "is"
    return unknown_answer(
        f"the {fact} {verb} on the {view.instances[largest.text.parent].name}, but {illegibility([largest])} to read"
    )
