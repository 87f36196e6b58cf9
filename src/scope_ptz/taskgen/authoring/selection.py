"""Select a category's drafts, balanced over scenes, viewpoints, question types and answers."""

from __future__ import annotations

import random
from collections import Counter, defaultdict
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field

from scope_ptz.bench.scoring.coverage import uncovered_part
from scope_ptz.bench.scoring.episode import Observation
from scope_ptz.bench.tasks.task import Category
from scope_ptz.taskgen.authoring.drafts import SentenceFrames, TaskDraft
from scope_ptz.taskgen.authoring.task_places import preset_position
from scope_ptz.taskgen.facts.answer_phrasing import offered_answers
from scope_ptz.taskgen.facts.robust import TASK_CAMERA

PAIR_QUOTAS: dict[Category, int] = {"counting": 31, "descriptor": 16, "location": 12, "multi_step_reasoning": 16}
"""Number of pairs per category.

The two tasks in a pair have the same wording, but one is about an object that is absent and the other about one that is present.
"""

MAX_PAIRS_OF_TYPE = {"not-there": 4, "half-none": 3, "neither": 4}
"""Caps on absence/presence pairs per question type, so that always answering yes scores low."""

MAX_SAME_ANSWER: dict[Category, int] = {
    "counting": 5, "descriptor": 2, "location": 1, "ocr": 1, "single_call": 1, "multi_step_reasoning": 2, "comparative": 1,
}  # fmt: skip
"""Maximum number of tasks per category that have the same correct answer, not counting pairs.

Across all categories, at most 3% of the tasks have the same correct answer.
"""

MAX_SAME_YES_NO = 1
"""Maximum number of tasks with the answer "yes", and of tasks with "no", per question type, not counting pairs."""

MAX_SAME_QUESTION = 2
"""Maximum number of tasks in a scene that have the same question and answer, about different views."""

MAX_AT_ONE_POSITION: dict[Category, int] = {"descriptor": 3, "location": 3, "comparative": 5}
"""Maximum number of tasks whose correct answer has the same position among the question's options, not counting pairs.

Across all categories, no position holds the correct answer in more than 3% of the tasks.
"""

_NO_LIMIT = 1000.0  # slack at which the limits on repeated questions, repeated answers and answer positions have no effect

MAX_FRAME_SHARE = 0.06  # maximum fraction of a category's tasks with the same sentence frame
MAX_FROM_START = 3  # maximum number of tasks per category that can be answered from the start view

# The cost of selecting another draft with the same trait, by trait.
_TRAIT_COSTS = {"scene": 3.0, "viewpoint": 1.5, "question type": 2.0, "answer": 4.0, "subject": 1.5, "place": 1.0, "start": 0.3}

CanAnswer = Callable[[TaskDraft], bool]
"""A function that returns whether ground-truth perception can answer the calls in a draft's reference program."""

_AddDraft = Callable[[TaskDraft], bool]


@dataclass
class ChosenDraft:
    """A selected draft with its wording, its sentence frame and alternative wordings."""

    draft: TaskDraft
    text: str
    frame: str
    id: str = ""
    pair: str | None = None
    variants: list[str] = field(default_factory=list)

    @property
    def scene(self) -> str:
        """Name of the scene."""
        return self.draft.place.scene.name


@dataclass
class SharedLimits:
    """Limits that all categories share, and the questions and instructions that any category has already used.

    Attributes:
        used_questions: Keys of the questions and views that have already been used.
        texts: Instructions that have already been used.
        scale: Size of this dataset relative to the published one. Limits are multiplied by it.
        can_answer: Returns whether perception can answer a draft; None accepts all drafts.
    """

    used_questions: set[str] = field(default_factory=set)
    texts: set[str] = field(default_factory=set)
    scale: float = 1.0
    can_answer: CanAnswer | None = None

    def scale_limit(self, limit: int) -> int:
        """Scale a limit to the size of this dataset. The result is at least 1."""
        return max(1, round(limit * self.scale))


class Selection:
    """Selects drafts for one category from the drafts for all scenes."""

    def __init__(self, category: Category, quota: int, shared: SharedLimits, seed: int) -> None:
        self.category, self.quota, self.shared = category, quota, shared
        self.seed = seed
        self.frames = SentenceFrames(shared.texts)
        self.selected: list[ChosenDraft] = []
        self.used: defaultdict[str, Counter[Hashable]] = defaultdict(Counter)
        self.slack = 1.0
        self.max_per_frame = max(2, int(quota * MAX_FRAME_SHARE))

    def fill(self, drafts: Sequence[TaskDraft]) -> list[ChosenDraft]:
        """Select drafts, beginning with pairs. The result is shorter than the quota if there are too few drafts."""
        # The order is pseudo-random. It does not depend on the other drafts or on the order of the scenes.
        pool = sorted(drafts, key=lambda draft: draft.digest(self.seed))
        pairs = [draft for draft in pool if draft.twin is not None]
        pair_count = (
            min(self.shared.scale_limit(PAIR_QUOTAS.get(self.category, 0)), self.quota // 2) if self.category in PAIR_QUOTAS else 0
        )
        for _ in range(pair_count):
            self._add_best(pairs, self._add_pair)
        for slack in (1.0, 1.2, 1.4, 1.6, 2.0, 3.0, _NO_LIMIT):
            # If there are too few drafts within the limits, the limits are raised step by step.
            self.slack, singles = slack, [draft for draft in pool if draft.twin is None]
            while len(self.selected) < self.quota and self._add_best(singles, self._add_single):
                pass
        return self.selected

    def _add_best(self, pool: list[TaskDraft], add_draft: _AddDraft) -> bool:
        """Select the draft that improves the balance most, and return whether one was selected.

        The selected draft and the drafts that ``add_draft`` rejected are removed from the pool.
        """
        while pool:
            index = min(range(len(pool)), key=lambda n: self._cost(pool[n]))
            if add_draft(pool.pop(index)):
                return True
        return False

    def _cost(self, draft: TaskDraft) -> float:
        """Return the weighted number of times that a draft's traits have already been used."""
        twin = () if draft.twin is None else (("answer", draft.twin.answer_key),)
        return sum(_TRAIT_COSTS[name] * self.used[name][value] for name, value in (*draft.traits, *twin))

    def _add_single(self, draft: TaskDraft) -> bool:
        return not self._exceeds_limits(draft) and self._add(draft) is not None

    def _exceeds_limits(self, draft: TaskDraft) -> bool:
        if draft.expected.kind == "yes_no":
            return self.used["yes or no"][draft.question_type, draft.answer_key] >= self.shared.scale_limit(MAX_SAME_YES_NO)
        if draft.expected.kind == "action_only":
            return False
        if self.used["question"][draft.place.scene.name, draft.key, draft.answer_key] >= int(self.slack * MAX_SAME_QUESTION):
            return True
        limit = self.shared.scale_limit(MAX_SAME_ANSWER.get(self.category, self.quota))
        return self.used["unpaired"][draft.answer_key] >= int(self.slack * limit)

    def _add_pair(self, draft: TaskDraft) -> bool:
        twin, limit = draft.twin, MAX_PAIRS_OF_TYPE.get(draft.question_type)
        if twin is None or (limit is not None and self.used["pairs"][draft.question_type] >= self.shared.scale_limit(limit)):
            return False
        if twin.full_key in self.shared.used_questions or draft.full_key in self.shared.used_questions:
            return False
        chosen = self._add(draft)
        if chosen is None:
            return False
        if self._add(twin, frame=chosen.frame.split("/", 1)[1]) is None:
            self._remove(chosen)
            return False
        self.used["pairs"][draft.question_type] += 1
        return True

    def _add(self, draft: TaskDraft, frame: str | None = None) -> ChosenDraft | None:
        """Add a draft to the selection and return it.

        Return None if the question is already used or can be answered from the start view, if a limit is reached, or if no wording
        is left. ``frame`` is the frame of its twin, which the draft must share.
        """
        if draft.full_key in self.shared.used_questions or is_answerable_from_start(draft):
            return None
        if self.shared.can_answer is not None and not self.shared.can_answer(draft):
            return None
        from_start_view = draft.place.is_start_view and not draft.moves_camera
        if (
            from_start_view
            and self.category != "single_call"
            and self.used["start view"][True] >= self.shared.scale_limit(MAX_FROM_START)
        ):
            return None
        rng = random.Random(draft.digest(self.seed))
        wording = self.frames.word(draft, rng, frame and f"{draft.question_type}/{frame}")
        if wording is None or self.frames.used[wording[1]] >= self.max_per_frame:
            return None
        is_unpaired, is_limited = frame is None and draft.twin is None, self.slack < _NO_LIMIT
        limit = self.shared.scale_limit(MAX_AT_ONE_POSITION.get(self.category, self.quota))
        if (
            is_unpaired
            and is_limited
            and any(self.used["position"][index] >= limit for index in answer_positions(draft, wording[0]))
        ):
            return None
        self.frames.record_use(*wording)
        self.shared.used_questions.add(draft.full_key)
        others = [self.frames.word(draft, rng) for _ in range(5)]
        chosen = ChosenDraft(draft, *wording, variants=[o[0] for o in others if o is not None])
        self.selected.append(chosen)
        self._count_use(chosen, 1, paired=not is_unpaired)
        self.used["start view"][True] += from_start_view
        return chosen

    def _count_use(self, chosen: ChosenDraft, change: int, *, paired: bool) -> None:
        for name, value in chosen.draft.traits:
            self.used[name][value] += change
        self.used["question"][chosen.scene, chosen.draft.key, chosen.draft.answer_key] += change
        if paired:
            return
        self.used["unpaired"][chosen.draft.answer_key] += change
        self.used["yes or no"][chosen.draft.question_type, chosen.draft.answer_key] += change
        for index in answer_positions(chosen.draft, chosen.text):
            self.used["position"][index] += change

    def _remove(self, chosen: ChosenDraft) -> None:
        self.selected.remove(chosen)
        self._count_use(chosen, -1, paired=True)
        self.shared.used_questions.discard(chosen.draft.full_key)
        self.shared.texts.discard(chosen.text)
        self.frames.used[chosen.frame] -= 1


def answer_positions(draft: TaskDraft, text: str) -> list[str]:
    """Return the position of the correct answer among the options in a wording, and also "last" if it is the last option.

    The list is empty if the wording does not contain the answer.
    """
    names, value = offered_answers(draft.expected, text), getattr(draft.expected, "value", None)
    if isinstance(value, tuple) and len(value) == 1:
        (value,) = value  # a set of names with one element
    index = names.index(value) if value in names else -1
    return [] if index < 0 else [str(index), *(["last"] if index == len(names) - 1 else [])]


def is_answerable_from_start(draft: TaskDraft) -> bool:
    """Return whether a task that needs a move or a sweep would pass all checks even if a run observed only the start view."""
    place = draft.place
    needs = place.needs if draft.needs is None else draft.needs
    views = [view for view in draft.evidence if view.must_look]
    preset = next(p for p in place.scene.file.presets if p.name == place.start)
    start = preset_position(preset)
    moved = draft.program is None and not draft.ends_zoomed and place.at != start
    if not needs or not views or moved or (draft.behaviour is not None and draft.behaviour.final is not None):
        return False
    start_observations = (
        Observation(start.viewpoint, TASK_CAMERA.view(start.pose), place.scene.file.start_s, "query", " ".join(v.about))
        for v in views
    )
    return all(uncovered_part(view, [seen]) is None for view, seen in zip(views, start_observations, strict=True))
