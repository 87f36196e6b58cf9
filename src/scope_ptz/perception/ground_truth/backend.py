"""The simulator's ground truth as a perception backend. It reads a frame's scene, never the frame's pixels."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from anyio import to_thread

from scope_ptz import english
from scope_ptz.builtin_names import GROUND_TRUTH
from scope_ptz.camera.base import Frame
from scope_ptz.errors import NotUnderstoodError, PackError, PerceptionError, UnknownNameError
from scope_ptz.geometry import Projection
from scope_ptz.perception.base import Answer, Caption, Detections, Perception, Point, Points
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.truth import ViewTruth, view_truth

if TYPE_CHECKING:
    from scope_ptz.perception.ground_truth.answers import TruthAnswer
    from scope_ptz.perception.ground_truth.answers.text_regions import TextRegion
    from scope_ptz.perception.ground_truth.view import Thing, View

GROUND_TRUTH_VERSION = 5
"""The version of ground-truth perception, which traces record. It increases when replies to the same request and view change."""

TruthReader = Callable[[Scene, str, Projection, float], ViewTruth]


class GroundTruthPerception(Perception):
    """Perception from the ground truth of simulated frames. Frames from real cameras have none and raise ``PerceptionError``.

    Visibility and legibility follow the simulator's definitions. Boxes are sorted by size, largest first, unless the description
    orders them ("the nearest car"). A box's label is the thing's name, and boxes have no score. The parsers for questions and
    descriptions are imported on first use, because many instructions need neither.
    """

    name = GROUND_TRUTH
    version = GROUND_TRUTH_VERSION
    handles_panoramas = True

    def __init__(self, open_scene: Callable[[str], Scene], read_truth: TruthReader = view_truth) -> None:
        """Set up the backend.

        Args:
            open_scene: Returns the scene with a given name.
            read_truth: Computes the ground truth of a view.
        """
        self.open_scene = open_scene
        self.read_truth = read_truth

    async def caption(self, frame: Frame) -> Caption:
        began = time.perf_counter()
        reply = await to_thread.run_sync(self._describe, frame)
        return Caption(text=reply.text, source=self.name, raw=reply.text, latency_s=time.perf_counter() - began)

    async def query(self, frame: Frame, question: str) -> Answer:
        began = time.perf_counter()
        reply = await to_thread.run_sync(self._answer, frame, question)
        return Answer(text=reply.text, known=reply.known, source=self.name, raw=reply.text, latency_s=time.perf_counter() - began)

    async def detect(self, frame: Frame, description: str) -> Detections:
        began = time.perf_counter()
        things, complete = await to_thread.run_sync(self._find, frame, description)
        boxes, latency_s = tuple(t.box for t in things), time.perf_counter() - began
        return Detections(boxes=boxes, complete=complete, source=self.name, raw=_join_ids(things), latency_s=latency_s)

    async def point(self, frame: Frame, description: str) -> Points:
        began = time.perf_counter()
        things, complete = await to_thread.run_sync(self._find, frame, description)
        points = tuple(Point(x=t.point[0], y=t.point[1], label=t.name) for t in things)
        latency_s = time.perf_counter() - began
        return Points(points=points, complete=complete, source=self.name, raw=_join_ids(things), latency_s=latency_s)

    def view(self, frame: Frame, request: str) -> View:
        """Return the visible contents of a simulated frame.

        ``request`` is the question or description. The ground truth does not depend on it, but simulated noise does.
        """
        from scope_ptz.perception.ground_truth.view import read_view

        origin = frame.origin
        if origin is None:
            raise PerceptionError(
                "This frame is from a real camera and has no ground truth. Name a vision model with --perception."
            )
        try:
            scene = self.open_scene(origin.scene)
            if scene.file.captured is not None:
                raise PerceptionError(
                    f"The scene '{scene.name}' was captured from a camera and has no ground truth. "
                    "Name a vision model, or a text reader such as rapidocr, with --perception."
                )
            truth = self.read_truth(scene, origin.viewpoint, frame.projection, origin.time_s)
        except (PackError, UnknownNameError) as error:
            raise PerceptionError(f"The ground truth of this frame cannot be read: {error}") from error
        return read_view(self.perceive(truth, frame, request), scene.file, origin.time_s)

    def perceive(self, truth: ViewTruth, frame: Frame, request: str) -> ViewTruth:  # noqa: ARG002
        """Return the ground truth as the backend perceives it. This backend perceives everything; subclasses add errors."""
        return truth

    def _describe(self, frame: Frame) -> TruthAnswer:
        from scope_ptz.english.grammar.questions.question_tree import Describe
        from scope_ptz.perception.ground_truth.answers import answer

        return answer(self.view(frame, ""), Describe())

    def _answer(self, frame: Frame, question: str) -> TruthAnswer:
        from scope_ptz.english.grammar.questions.question_parser import parse_question
        from scope_ptz.perception.ground_truth.answers import answer
        from scope_ptz.perception.ground_truth.answers.thing_names import unknown_answer
        from scope_ptz.perception.ground_truth.unknown_words import (
            asks_for_judgement,
            find_unknown_nouns,
            find_unknown_qualities,
            has_unresolved_item,
            is_english_noun,
        )

        if not question.strip():
            raise PerceptionError("The question is empty.")
        if asks_for_judgement(question):
            return unknown_answer("I cannot tell that from the picture")
        parsed, view = parse_question(question), self.view(frame, question)
        if parsed is None:
            raise NotUnderstoodError(
                f"The question '{question}' is not understood. Ask one question about what the picture shows, in plain words."
            )
        if has_unresolved_item(parsed):
            raise NotUnderstoodError("I did not understand 'one' in the question. Name a kind of thing.")
        reply = answer(view, parsed)
        if reply.text.startswith(_ABSENCE_BEGINNINGS) and (unknown := find_unknown_nouns(view, parsed)):
            raise NotUnderstoodError(f"I did not understand {_quote_list(unknown)} in the question. Name a kind of thing.")
        if reply.text.startswith(_DENIAL_BEGINNINGS) and (
            unknown := [x for x in find_unknown_nouns(view, parsed) if not is_english_noun(x)]
        ):
            raise NotUnderstoodError(f"I did not understand {_quote_list(unknown)} in the question. Name a kind of thing.")
        if reply.text.startswith((*_DENIAL_BEGINNINGS, *_ABSENCE_BEGINNINGS)) and (
            unstated := find_unknown_qualities(view, parsed)
        ):
            return unknown_answer(f"I cannot tell what is {english.listing(unstated)}")
        return reply

    def _find(self, frame: Frame, description: str) -> tuple[Sequence[Thing | TextRegion], bool]:
        """Return the things or texts that match a description, and whether there can be no others in view."""
        from scope_ptz.english.grammar.questions.question_parser import parse_description
        from scope_ptz.english.grammar.questions.recognition import is_description
        from scope_ptz.perception.ground_truth.answers.restating import place_without_outside, unmodelled_place
        from scope_ptz.perception.ground_truth.answers.text_regions import (
            find_sign_regions,
            find_text_regions,
            may_be_lettering,
        )
        from scope_ptz.perception.ground_truth.answers.undecided import undecided_reason
        from scope_ptz.perception.ground_truth.thing_search import find
        from scope_ptz.perception.ground_truth.unclear_things import unclear_matches
        from scope_ptz.perception.ground_truth.unknown_words import find_unknown_nouns, find_unknown_qualities

        if not description.strip():
            raise PerceptionError("The description is empty.")
        parsed, view = parse_description(description), self.view(frame, description)
        things = find(view, parsed)
        if not things and (regions := find_text_regions(view, parsed)):
            return regions, True
        if not things and (signs := find_sign_regions(view, parsed)):
            return signs, False
        if not things and may_be_lettering(view, parsed):
            return things, False
        if reason := undecided_reason(view, parsed):
            if not things:
                raise NotUnderstoodError(f"{reason}.")
            return things, False
        if not things and (place := place_without_outside(view, parsed)):
            raise NotUnderstoodError(f"I cannot tell what is outside the {place}.")
        if not things and (place := unmodelled_place(view, parsed)):
            raise NotUnderstoodError(f"I cannot tell what is on the {place}.")
        if not things and not is_description(description):
            raise NotUnderstoodError(
                f"The description '{description}' is not understood, because it is not a noun phrase. Name the things to find."
            )
        if not things and (unknown := find_unknown_nouns(view, parsed)):
            raise NotUnderstoodError(f"I did not understand {_quote_list(unknown)} in the description. Name a kind of thing.")
        if not things and (unstated := find_unknown_qualities(view, parsed)):
            raise NotUnderstoodError(_UNSTATED_QUALITIES.format(words=english.listing(unstated)))
        return things, not unclear_matches(view, parsed)


_UNSTATED_QUALITIES = "I cannot tell what is {words}. Describe the things by what a picture shows."
_DENIAL_BEGINNINGS = ("No, there is no ", "No, there are no ")
_ABSENCE_BEGINNINGS = (
    "There is no ",
    "There are no ",
    "I cannot tell: there is no ",
    "I cannot tell: there are no ",
)
"""The beginnings of answers that report something as absent."""


def _quote_list(phrases: Sequence[str]) -> str:
    return english.listing([f"'{words}'" for words in dict.fromkeys(phrases)])


def _join_ids(things: Sequence[Thing | TextRegion]) -> str:
    return " ".join(t.id for t in things)
