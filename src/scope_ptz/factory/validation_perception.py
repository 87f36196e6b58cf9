"""Perception for validation: the ground truth of blank frames, with each view read once."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from scope_ptz.bench.answers import agrees, parse_answer
from scope_ptz.bench.program_runner import MakeToolContext
from scope_ptz.camera.base import Frame
from scope_ptz.english import COLOURS
from scope_ptz.geometry import Projection
from scope_ptz.perception.ground_truth import GroundTruthPerception
from scope_ptz.perception.ground_truth.answers import answer
from scope_ptz.perception.ground_truth.language import parse_description, parse_question
from scope_ptz.perception.ground_truth.language.concepts import nouns_in
from scope_ptz.perception.ground_truth.view import View, read_view
from scope_ptz.simulator.actors import appearances, shows
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.truth import ViewTruth, view_truth
from scope_ptz.taskgen.authoring.drafts import TaskDraft
from scope_ptz.taskgen.facts.robust import RobustTruth
from scope_ptz.tools.context import ToolContext


class NamesOnly:
    """An image store that returns names and saves nothing."""

    def __init__(self) -> None:
        self._taken = 0

    def _next(self) -> str:
        self._taken += 1
        return f"{self._taken:04d}.png"

    def save_look(self, frame: Frame) -> str:  # noqa: ARG002
        return self._next()

    def save_picture(self, frame: Frame) -> str:  # noqa: ARG002
        return self._next()


class KnownViews:
    """The ground truth of views, cached. A view without actors has the same truth at all times."""

    def __init__(self, limit: int = 400) -> None:
        self._limit = limit
        self._known: dict[tuple[str, str, Projection, float | None], ViewTruth] = {}

    def look(self, scene: Scene, viewpoint: str, projection: Projection, time_s: float) -> ViewTruth:
        moving = any(shows(a, projection) for a in appearances(scene, scene.viewpoint(viewpoint), time_s))
        key = (scene.name, viewpoint, projection, round(time_s, 3) if moving else None)
        if key not in self._known:
            if len(self._known) >= self._limit:
                self._known.pop(next(iter(self._known)))
            self._known[key] = view_truth(scene, viewpoint, projection, time_s)
        return self._known[key]


def answered(draft: TaskDraft) -> bool:
    """Return whether ground-truth perception can answer the questions of a draft's reference program, in agreement with the draft.

    Questions about a close-up are left to the proof.
    """
    truth = draft.place.truth
    asked = [str(call.arguments["question"]) for call in draft.perception_calls if call.tool == "query_answer"]
    if draft.ends_zoomed or not asked:
        return True
    view = _view(truth)
    replies = [answer(view, parse_question(question)) for question in asked]
    if len(draft.perception_calls) == 1 and agrees(draft.expected, parse_answer(draft.expected, replies[0].text)) is False:
        return False
    return all(reply.known for reply in replies)


def is_plain_noun(view: View, asked: str) -> bool:
    """Return whether a description is only colours and a known noun, so that an empty result means that there is none."""
    for phrase in parse_description(asked).phrases:
        spans = nouns_in(phrase.words, view.nouns)
        plain = any(end == len(phrase.words) and set(phrase.words[:start]) <= COLOURS for start, end in spans)
        if not plain or phrase.tests:
            return False
    return True


@lru_cache(maxsize=512)
def _view(truth: RobustTruth) -> View:
    return read_view(truth.first, truth.scene.file, truth.time_s)


def equip_with_truth(scenes: Mapping[str, Scene], views: KnownViews | None = None) -> MakeToolContext:
    """Return a maker of tool contexts with ground-truth perception and a store that saves nothing."""
    perception = GroundTruthPerception(lambda name: scenes[name], (views or KnownViews()).look)
    return lambda camera: ToolContext(camera, perception, NamesOnly())
