"""Say which texts cannot be read, for which reason, and which things a closer view may help with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from scope_ptz.english.grammar.closer_views import closer_views_sentence
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.question_parser import parse_description
from scope_ptz.perception.ground_truth.answers.restating import noun_phrase
from scope_ptz.perception.ground_truth.answers.thing_names import position_words
from scope_ptz.perception.ground_truth.thing_search import find, holds
from scope_ptz.perception.ground_truth.view import Thing, View
from scope_ptz.simulator.truth import MAX_READING_ANGLE_DEG, MIN_CAP_HEIGHT_PX, MIN_UNHIDDEN_FRACTION, TextSighting


def things_with_text(texts: Sequence[TextSighting], *, legible: bool) -> list[str]:
    """Return the ids of the things that bear any of the texts."""
    return list(dict.fromkeys(t.text.parent for t in texts if t.legible or not legible))


def illegible_things(view: View, texts: Sequence[TextSighting]) -> list[str]:
    """Return the ids of the visible things on which no text is legible."""
    readers = things_with_text(texts, legible=True)
    return [thing for thing in things_with_text(texts, legible=False) if thing not in readers and thing in view.by_id]


def is_only_too_small(text: TextSighting) -> bool:
    """Return whether a text cannot be read, but could be from close up."""
    is_in_sight = text.angle_deg <= MAX_READING_ANGLE_DEG and text.unhidden_fraction >= MIN_UNHIDDEN_FRACTION
    return is_in_sight and text.cap_height_px < MIN_CAP_HEIGHT_PX


def illegibility(texts: Sequence[TextSighting]) -> str:
    """Return why several texts cannot be read, in words before "to read": the reason of the largest that a closer view may help."""
    problem = _problem(_largest([t for t in texts if is_only_too_small(t)] or texts))
    return "too much of it is hidden or cut off" if problem == "hidden" else f"it is {_REASONS[problem]}"


def reasons_against(texts: Sequence[TextSighting], unread: Sequence[str]) -> list[str]:
    """Return all reasons why the texts on some things cannot be read: "too small", "seen too much from the side"."""
    return list(dict.fromkeys(_REASONS[_problem(t)] for t in texts if t.text.parent in unread))


def unread_rest(view: View, texts: Sequence[TextSighting]) -> str:
    """Return the sentence about visible text that is not legible, beside the text that is; empty if there is none."""
    rest = [t for t in texts if not t.legible and t.unhidden_fraction > 0 and t.text.parent in view.by_id]
    return f". The rest is {_REASONS[_problem(_largest(rest))]} to read" if rest else ""


def unread_reason(view: View, question: tree.Exists | tree.Count | tree.What | tree.YesNo) -> str:
    """Return why it is open whether any thing says something: no legible text does, but not all texts are legible. Else empty."""
    what = question.subject if isinstance(question, tree.YesNo) else question.what
    tests = () if isinstance(question, tree.Exists) else question.tests
    phrase = what.phrases[0]
    said = next((t.words for t in (*phrase.tests, *tests) if isinstance(t, tree.Says) and t.words), None)
    if said is None or len(what.phrases) > 1:
        return ""
    silent = replace(phrase, tests=tuple(t for t in phrase.tests if not isinstance(t, tree.Says)))
    candidates = find(view, tree.Description((silent,)))
    answers = [holds(view, t, tree.Says(said)) for t in candidates]
    if True in answers or None not in answers:
        return ""
    kind, literal = noun_phrase(view, tree.Description((silent,)), plural=len(candidates) > 1), " ".join(said).upper()
    if len(candidates) == 1:
        unread = [t for t in view.texts_on(candidates[0]) if not t.legible]
        return f'I cannot tell whether the {kind} says "{literal}", because {illegibility(unread)} to read'
    # The reason does not name a size, because a closer view of one of them would not decide it.
    return (
        f'I cannot tell whether any of the {len(candidates)} {kind} says "{literal}": not all of their text can be read from here'
    )


def closer_views(view: View, texts: Sequence[TextSighting]) -> str:
    """Return the sentence that names the things to go closer to, without its full stop; empty if there are none.

    These are the things on which no text is legible, and the largest text is only too small. They are sorted by its size.
    A thing is named only if a search for the name finds it.
    """
    unread = illegible_things(view, texts)
    largest = [_largest([t for t in texts if t.text.parent == thing]) for thing in unread]
    promising = sorted((t for t in largest if is_only_too_small(t)), key=lambda t: -t.cap_height_px)
    names = [name for t in promising if (name := _distinct_name(view, view.by_id[t.text.parent])) is not None]
    return closer_views_sentence(list(dict.fromkeys(names)))


def _distinct_name(view: View, thing: Thing) -> str | None:
    """Return a description for which a search returns the thing first; None if its name and place do not tell it apart."""
    names = (thing.name, f"{thing.name} {position_words(thing)}")
    return next((name for name in names if find(view, parse_description(name))[:1] == [thing]), None)


_REASONS = {"small": "too small", "oblique": "seen too much from the side", "hidden": "too much hidden or cut off"}


def _problem(text: TextSighting) -> Literal["small", "oblique", "hidden"]:
    if text.angle_deg > MAX_READING_ANGLE_DEG:
        return "oblique"  # whatever its size: no zoom changes the angle
    return "small" if text.cap_height_px < MIN_CAP_HEIGHT_PX else "hidden"


def _largest(texts: Sequence[TextSighting]) -> TextSighting:
    return max(texts, key=lambda t: t.cap_height_px)
