"""Ground-truth perception for task validation, with a cache for the ground truth of each view and without image storage."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from scope_ptz.bench.answers import agrees, parse_answer
from scope_ptz.bench.program_runner import MakeToolContext
from scope_ptz.camera.base import Frame
from scope_ptz.english import COLOURS
from scope_ptz.english.grammar.lexicon import nouns_in
from scope_ptz.english.grammar.questions.question_parser import parse_description, parse_question
from scope_ptz.geometry import Projection
from scope_ptz.perception.ground_truth import GroundTruthPerception
from scope_ptz.perception.ground_truth.answers import answer
from scope_ptz.perception.ground_truth.view import View, read_view
from scope_ptz.simulator.actors import appearances, may_be_visible
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.truth import ViewTruth, view_truth
from scope_ptz.taskgen.authoring.drafts import TaskDraft
from scope_ptz.taskgen.facts.robust import RobustTruth
from scope_ptz.tools.context import ToolContext


class NullImageStore:
    """An image store that returns file names but stores no images."""

    def __init__(self) -> None:
        self._count = 0

    def _next_name(self) -> str:
        self._count += 1
        return f"{self._count:04d}.png"

    async def save_frame(self, frame: Frame) -> str:  # noqa: ARG002
        return self._next_name()

    async def save_picture(self, frame: Frame) -> str:  # noqa: ARG002
        return self._next_name()


class TruthCache:
    """A cache for the ground truth of views. A view without moving actors has a single entry for all times.

    Args:
        limit: Maximum number of cached views.
    """

    def __init__(self, limit: int = 400) -> None:
        self._limit = limit
        self._cache: dict[tuple[str, str, Projection, float | None], ViewTruth] = {}

    def read(self, scene: Scene, viewpoint: str, projection: Projection, time_s: float) -> ViewTruth:
        """Return the ground truth of a view, from the cache if possible."""
        moving = any(may_be_visible(a, projection) for a in appearances(scene, scene.viewpoint(viewpoint), time_s))
        key = (scene.name, viewpoint, projection, round(time_s, 3) if moving else None)
        if key not in self._cache:
            if len(self._cache) >= self._limit:
                self._cache.pop(next(iter(self._cache)))
            self._cache[key] = view_truth(scene, viewpoint, projection, time_s)
        return self._cache[key]


def is_answerable(draft: TaskDraft) -> bool:
    """Return whether ground-truth perception answers the questions in a draft's reference program as expected.

    The result is True for drafts that end with a zoom, which are checked later by validation.
    """
    truth = draft.place.truth
    questions = [str(call.arguments["question"]) for call in draft.perception_calls if call.tool == "query_answer"]
    if draft.ends_zoomed or not questions:
        return True
    view = _view(truth)
    replies = [answer(view, parse_question(question)) for question in questions]
    if len(draft.perception_calls) == 1 and agrees(draft.expected, parse_answer(draft.expected, replies[0].text)) is False:
        return False
    return all(reply.known for reply in replies)


def is_plain_noun(view: View, description: str) -> bool:
    """Return whether a description consists only of colours and a known noun.

    For other descriptions, an empty ground-truth result does not prove that there is no such object in the view.
    """
    for phrase in parse_description(description).phrases:
        spans = nouns_in(phrase.words, view.nouns)
        plain = any(end == len(phrase.words) and set(phrase.words[:start]) <= COLOURS for start, end in spans)
        if not plain or phrase.tests:
            return False
    return True


@lru_cache(maxsize=512)
def _view(truth: RobustTruth) -> View:
    return read_view(truth.first_sample, truth.scene.file, truth.time_s)


def ground_truth_tools(scenes: Mapping[str, Scene], truth: TruthCache | None = None) -> MakeToolContext:
    """Return a function that creates tool contexts with ground-truth perception and without image storage."""
    perception = GroundTruthPerception(lambda name: scenes[name], (truth or TruthCache()).read)
    return lambda camera: ToolContext(camera, perception, NullImageStore())
