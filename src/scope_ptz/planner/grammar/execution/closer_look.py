"""Go closer when perception reports that something is too small, look again, and put the camera back."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from scope_ptz import english
from scope_ptz.english.grammar.closer_views import CloserViews, closer_views_in
from scope_ptz.english.grammar.questions.positions import without_position
from scope_ptz.english.grammar.questions.question_parser import parse_question
from scope_ptz.english.grammar.questions.question_tree import Read
from scope_ptz.planner.grammar.execution import answer_sentences as phrases
from scope_ptz.planner.grammar.execution.move_arguments import return_arguments
from scope_ptz.planner.grammar.execution.run_state import CallGenerator, Offer, RunState

if TYPE_CHECKING:
    from scope_ptz.geometry import Pose
    from scope_ptz.tools.arguments import View

_TOO_SMALL = re.compile(
    r"\btoo (?:small|far|distant|tiny|blurry|blurred)\b|\b(?:illegible|unreadable|unintelligible)\b"
    r"|\bnot (?:big|large|close|sharp|clear) enough\b|\b(?:not|no|in)[ -]?(?:legible|readable)\b"
    r"|\b(?:cannot|can't|can not|unable to|could not|couldn't) (?:be read|read|make out|be made out)\b",
    re.IGNORECASE,
)
"""Reports that a closer view could help. Text that is hidden or seen from the side is no better from close up."""

_NOUN_PHRASE = re.compile(
    r"\b(?:the|that|this|these|those|a|an) (?P<thing>.+?)(?= (?:says?|reads?|shows?|displays?|states?|lists?"
    r"|ha(?:s|ve)|is|are|was|were|looks?|wears?)\b|,|\?|\.?$)",
    re.IGNORECASE,
)
_PROPERTY_OF = re.compile(
    r"(?:texts?|writing|words?|letter(?:s|ing)|message|names?|number|figures?|digits|prices?|time|colour|color|state|title|caption"
    r"|slogan|inscription|close[- ]up|(?:speed )?limit|date|(?:opening )?hours|logo|brand|make|kind|type|side|front|back|rear|top)"
    r"(?: (?:that (?:is|are) )?(?:written|printed|painted|shown|displayed|given|stated))? (?:of|on|for|at|in|that)"
    r" (?:the|that|this|an?) ",
    re.IGNORECASE,
)
"""The beginning of a phrase that names a property or a part of a thing: "the price on the"."""

_NO_THING = frozenset({"picture", "image", "view", "frame", "scene", "photo", "text", "writing", "time", "word", "words"})


class CloserLook(RunState):
    """The part of a run that asks perception questions, and zooms in when something is too small."""

    def _answer_to(self, question: str, view: View, thing: str = "") -> CallGenerator:
        """Ask a question and return the result; None if perception fails.

        A question such as "what does the sign say when you zoom in on it?" is asked from close up.

        Args:
            question: The question.
            view: The view to ask about.
            thing: The thing that the question is about; empty to find it in the question.
        """
        plain = without_close_up(question)
        if plain != question and view == "current" and (subject := thing or thing_of(plain)):
            result = yield from self._from_close_up(plain, subject, None)
            if result is not None:
                return result
        result = yield from self._perception_call("query_answer", question=plain, view=view)
        if result is None or view != "current" or self.moves_are_forbidden:
            return result
        answer, closer = closer_views_in(result["answer"])
        if closer is not None and isinstance(parse_question(question), Read):
            if self.may_go_closer:
                return (yield from self._from_several_close_ups({**result, "answer": answer}, closer))
            if not result.get("known", True):
                self.offers.append(Offer(closer.things[0], reading_question(closer.things[0]), self.pose))
            return result
        if not is_too_small(result):
            return result
        if not thing and (bearer := _object_with_text(result)):
            thing, question = bearer, _about_bearer(question, bearer)
        thing = thing or thing_of(question)
        if not thing:
            return result
        if not self.may_go_closer:
            self.offers.append(Offer(thing, question, self.pose))
            return result
        return (yield from self._from_close_up(question, thing, result))

    def _can_zoom_in(self) -> bool:
        """Return whether the lens has room for a closer view."""
        return self.pose is not None and self.pose.zoom < self.limits.max_zoom - 0.01

    def _from_close_up(self, question: str, thing: str, before: dict[str, Any] | None) -> CallGenerator:
        """Zoom in on a thing, ask a question about it, and put the camera back. Return the result, or ``before`` if there is none.

        If a part cannot be found ("licence plate of the van"), the camera zooms in on the whole."""
        start, found = self.pose, False
        for target in dict.fromkeys((thing, whole_of(thing))):
            thing = target
            zoomed = yield from self._perception_call("zoom_to_object", description=thing)
            found = zoomed is not None and bool(zoomed.get("found"))
            if found or zoomed is None:
                break
        if not found:
            return before
        question = without_position(question)  # what was at the bottom is now in the middle
        result = yield from self._answer_from_here(question, thing)
        if result is None or not result.get("known", True):
            extent = "" if self._can_zoom_in() else " as far as I can"
            self._note(f"I zoomed in on the {thing}{extent}, but that did not help, so I put the camera back")
        elif (matches := zoomed.get("matches", 1)) > 1:
            chosen = phrases.chosen_text(thing, matches, zoomed.get("chosen", ""))
            others = "other one" if matches == 2 else f"other {matches - 1}"
            self._note(f"I zoomed in on {chosen}, and put the camera back afterwards; I did not go closer to the {others}")
        else:
            self._note(f"I zoomed in on the {thing} to answer that, and put the camera back afterwards")
        yield from self._put_back(start)
        return before if result is None else result

    def _answer_from_here(self, question: str, thing: str) -> CallGenerator:
        """Ask a question about a thing on which the camera has zoomed in. If its text is still too small, zoom in on the text."""
        result = yield from self._perception_call("query_answer", question=question, view="current")
        if result is not None and is_too_small(result) and self._can_zoom_in():
            text = "number plate of" if _ASKS_FOR_PLATE.search(question) else "text on"
            whole = without_position(whole_of(thing) if "plate" in text else thing)
            zoomed = yield from self._perception_call("zoom_to_object", description=f"{text} the {whole}")
            if zoomed is not None and zoomed.get("found"):
                result = yield from self._perception_call("query_answer", question=question, view="current")
        return result

    def _put_back(self, start: Pose) -> CallGenerator:
        """Move the camera back to the pose before a closer look."""
        if self.assume_met:
            self.pose = start  # a plan cannot know how far the camera zooms in, so it cannot compute the move back
        elif arguments := return_arguments(start, self.pose, self.limits):
            yield from self._camera_call("adjust_ptz", **arguments)

    def _from_several_close_ups(self, before: dict[str, Any], closer: CloserViews) -> CallGenerator:
        """Zoom in on several things one after the other, read each, and put the camera back.

        Return the result ``before``, with what was read from close up.
        """
        start, seen, answers = self.pose, list[str](), list[dict[str, Any]]()
        for thing in closer.things:
            zoomed = yield from self._perception_call("zoom_to_object", description=thing)
            if zoomed is None or not zoomed.get("found"):
                continue
            asked = without_position(thing)
            if parse_question(reading_question(asked)) is None:
                asked = f"{thing.split()[-1]} in the middle"  # where the camera points now: the words of the name form no phrase
            question = reading_question(asked)
            reply = yield from self._answer_from_here(question, thing)
            yield from self._put_back(start)
            if reply is not None:
                seen.append(thing if thing.split()[-1].isdigit() else f"the {thing}")  # "dock number 8"
                text = closer_views_in(reply["answer"])[0]
                names = "|".join(re.escape(name) for name in (thing, asked, english.letters(asked)))
                text = re.sub(names, thing.replace("\\", r"\\"), text, count=1, flags=re.IGNORECASE)  # "the CCTV sign"
                answers.append({**reply, "answer": text[:1].upper() + text[1:]})
        if not seen:
            return before
        zoomed_in = f"I zoomed in on {english.listing(seen)}"
        if not any(reply.get("known", True) for reply in answers):
            text = f"{zoomed_in}, but that did not help, so I put the camera back. {before['answer']}"
            return {**before, "answer": text}
        skipped = f"; I did not go closer to {closer.more} more" if closer.more else ""
        report = f"{zoomed_in}, and put the camera back afterwards{skipped}."
        beginning = f"{before['answer']} {report}" if before.get("known", True) else report
        return {**before, "known": True, "answer": _joined([beginning, *(reply["answer"] for reply in answers)])}


def reading_question(thing: str) -> str:
    """Return the question that asks perception for the text on an object."""
    head = phrases.head_and_rest(thing)[0].partition(" for ")[0]  # "price card for carrots" is singular
    plural = phrases.noun(head, 1) != head
    return f"What {'do' if plural else 'does'} the {thing} say?"


def _joined(sentences: Sequence[str]) -> str:
    """Join sentences. What follows a list with a line for each row begins on a new line."""
    text = ""
    for sentence in sentences:
        text += ("\n" if "\n" in text.rpartition(". ")[2] else " ") + sentence
    return text.strip()


_ASKS_FOR_PLATE = re.compile(r"\b(?:plate|registration)\b", re.IGNORECASE)


def _object_with_text(result: dict[str, Any]) -> str:
    """Return the object that the text is on, according to an answer; empty if the answer names none.

    For "The price of the lettuce is on the price card for lettuce, but it is too small to read", it is "price card for lettuce".
    """
    match = _OBJECT_WITH_TEXT.search(str(result.get("answer", "")))
    return match[1] if match else ""


def _about_bearer(question: str, bearer: str) -> str:
    """Return a question about the text on a thing ("the sign on the statue") for the thing that bears it ("the plinth")."""
    return reading_question(bearer) if isinstance(parse_question(question), Read) else question


_OBJECT_WITH_TEXT = re.compile(r"^The .+ (?:is|are|may be) on the (.+), but it is too small to read")


def whole_of(thing: str) -> str:
    """Return the whole of a part: "van" for "licence plate of the van". Return other things unchanged."""
    match = re.search(r" (?:of|on) (?:the|that|this|an?) (.+)", thing, re.IGNORECASE)
    return match[1] if match else thing


_CLOSE_UP = re.compile(
    r",? (?:when|if|after|once) (?:you )?zoom(?:ed|ing)? in(?: on (?:it|them))?(?: to read(?: it)?)?(?=\W*$)"
    r"|,? (?:seen |viewed )?(?:from close up|up close)(?=\W*$)",
    re.IGNORECASE,
)
_CLOSE_UP_OF = re.compile(r"\b(?:a|the) close[- ]up of (?=\w)", re.IGNORECASE)


def without_close_up(question: str) -> str:
    """Return a question without the request to zoom in: "what does the sign say when you zoom in on it?"."""
    return _CLOSE_UP.sub("", _CLOSE_UP_OF.sub("", question))


def is_too_small(result: dict[str, Any]) -> bool:
    """Return whether an answer reports that the thing is too small or too far away to tell."""
    return not result.get("known", True) and bool(_TOO_SMALL.search(str(result.get("answer", ""))))


def thing_of(question: str) -> str:
    """Return the thing that a question is about, without its article; empty if it names none.

    For "what is written on the sign next to the gate?", it is "sign next to the gate".
    """
    text = " ".join(question.split())
    while match := _NOUN_PHRASE.search(text):
        thing = match["thing"].strip()
        if (inner := _PROPERTY_OF.match(text, match.start("thing"))) is not None:
            text = "the " + text[inner.end() :]
        elif phrases.head_and_rest(thing.lower())[0] in _NO_THING:
            text = text[match.end("thing") :]
        else:
            return thing
    return ""


def offer_text(offer: Offer) -> str:
    """Return the question that asks whether to go closer. ``offer_in`` reads the offer back from this text."""
    thing, question = (json.dumps(text, ensure_ascii=False) for text in (offer.thing, offer.question))
    return f"Shall I zoom in on {thing} to answer {question}? {_END}"


_END = "Please answer yes or no."
_STRING = r'"(?:[^"\\]|\\.)*"'
_OFFER = re.compile(rf"Shall I zoom in on (?P<thing>{_STRING}) to answer (?P<question>{_STRING})\? {re.escape(_END)}\Z", re.DOTALL)


def offer_in(reply: str) -> tuple[str, str] | None:
    """Return the thing and the question of the offer at the end of a reply; None if there is none."""
    match = _OFFER.search(reply)
    return (json.loads(match["thing"]), json.loads(match["question"])) if match else None
