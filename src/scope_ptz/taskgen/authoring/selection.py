"""Selection of the drafts of a category, balanced over scenes, viewpoints, question types and answers."""

from __future__ import annotations

import random
from collections import Counter, defaultdict
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field

from scope_ptz.bench.scoring.coverage import uncovered_part
from scope_ptz.bench.scoring.episode import Observation
from scope_ptz.bench.tasks.task import Category
from scope_ptz.taskgen.authoring.drafts import SentenceFrames, TaskDraft
from scope_ptz.taskgen.authoring.task_places import preset_at
from scope_ptz.taskgen.facts.answer_phrasing import offered
from scope_ptz.taskgen.facts.robust import TASK_CAMERA

PAIRS: dict[Category, int] = {"counting": 31, "descriptor": 16, "location": 12, "multi_step_reasoning": 16}
"""Pairs of an absence and a presence with the same wording, per category."""

PAIRS_OF_TYPE = {"not-there": 4, "half-none": 3, "neither": 4}
"""Caps on absence/presence pairs per question type, so that always answering yes scores low."""

ANSWERS: dict[Category, int] = {
    "counting": 5, "descriptor": 2, "location": 1, "ocr": 1, "single_call": 1, "multi_step_reasoning": 2, "comparative": 1,
}  # fmt: skip
"""How often the same answer may be right in a category, pairs excluded. Together that is at most 3% of all tasks."""

POLAR = 1
"""How often "yes" and "no" may each be right per question type, pairs excluded."""

SAME = 2
"""How often the same question may be asked of different views with the same answer."""

AT_ONE_POSITION: dict[Category, int] = {"descriptor": 3, "location": 3, "comparative": 5}
"""How often the right answer may be the first, second or last of those that a question offers, pairs excluded.

Together that is at most 3% of all tasks."""

_NO_LIMIT = 1000.0

FRAME_SHARE = 0.06  # largest share of a category that one sentence frame may have
FROM_START = 3  # most tasks of a category that can be answered from the start view

_WEIGHTS = {"scene": 3.0, "viewpoint": 1.5, "question type": 2.0, "answer": 4.0, "subject": 1.5, "place": 1.0, "start": 0.3}

CanAnswer = Callable[[TaskDraft], bool]
"""Whether ground-truth perception can answer the calls in the reference program of a draft."""

_Take = Callable[[TaskDraft], bool]


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
    """Limits that all categories share.

    Attributes:
        asked: Questions with their views that are in use.
        texts: Instructions that are in use.
        scale: Size of this dataset as a share of the published one. Limits are scaled by it.
        can_answer: Filter for drafts that perception cannot answer.
    """

    asked: set[str] = field(default_factory=set)
    texts: set[str] = field(default_factory=set)
    scale: float = 1.0
    can_answer: CanAnswer | None = None

    def scaled(self, limit: int) -> int:
        """Return a limit for this size of dataset, at least 1."""
        return max(1, round(limit * self.scale))


class Selection:
    """Fills the quota of one category from the drafts of all scenes."""

    def __init__(self, category: Category, quota: int, shared: SharedLimits, seed: int) -> None:
        self.category, self.quota, self.shared = category, quota, shared
        self.seed = seed
        self.frames = SentenceFrames(shared.texts)
        self.rows: list[ChosenDraft] = []
        self.used: defaultdict[str, Counter[Hashable]] = defaultdict(Counter)
        self.slack = 1.0
        self.most_frame = max(2, int(quota * FRAME_SHARE))

    def fill(self, drafts: Sequence[TaskDraft]) -> list[ChosenDraft]:
        """Select drafts, pairs first. The result is shorter than the quota when there are too few drafts."""
        # The order is pseudo-random, but adding or removing drafts or reordering scenes leaves the order of the others unchanged.
        pool = sorted(drafts, key=lambda draft: draft.digest(self.seed))
        pairs = [draft for draft in pool if draft.twin is not None]
        pair_count = min(self.shared.scaled(PAIRS.get(self.category, 0)), self.quota // 2) if self.category in PAIRS else 0
        for _ in range(pair_count):
            self._best(pairs, self._pair)
        for slack in (1.0, 1.2, 1.4, 1.6, 2.0, 3.0, _NO_LIMIT):
            # When the scenes yield too little within the limits, the limits are widened step by step.
            self.slack, singles = slack, [draft for draft in pool if draft.twin is None]
            while len(self.rows) < self.quota and self._best(singles, self._single):
                pass
        return self.rows

    def _best(self, pool: list[TaskDraft], take: _Take) -> bool:
        """Take the draft that improves the balance most. Drafts that cannot be taken leave the pool."""
        while pool:
            at = min(range(len(pool)), key=lambda n: self._cost(pool[n]))
            if take(pool.pop(at)):
                return True
        return False

    def _cost(self, draft: TaskDraft) -> float:
        """Return how often the traits of a draft are already in use, weighted."""
        twin = () if draft.twin is None else (("answer", draft.twin.answer_key),)
        return sum(_WEIGHTS[name] * self.used[name][value] for name, value in (*draft.traits, *twin))

    def _single(self, draft: TaskDraft) -> bool:
        return not self._too_often(draft) and self._add(draft) is not None

    def _too_often(self, draft: TaskDraft) -> bool:
        if draft.expected.kind == "yes_no":
            return self.used["polar"][draft.question_type, draft.answer_key] >= self.shared.scaled(POLAR)
        if draft.expected.kind == "action_only":
            return False
        if self.used["same"][draft.place.scene.name, draft.key, draft.answer_key] >= int(self.slack * SAME):
            return True
        limit = self.shared.scaled(ANSWERS.get(self.category, self.quota))
        return self.used["alone"][draft.answer_key] >= int(self.slack * limit)

    def _pair(self, draft: TaskDraft) -> bool:
        twin, limit = draft.twin, PAIRS_OF_TYPE.get(draft.question_type)
        if twin is None or (limit is not None and self.used["pairs"][draft.question_type] >= self.shared.scaled(limit)):
            return False
        if twin.full_key in self.shared.asked or draft.full_key in self.shared.asked:
            return False
        row = self._add(draft)
        if row is None:
            return False
        if self._add(twin, like=row.frame.split("/", 1)[1]) is None:
            self._drop(row)
            return False
        self.used["pairs"][draft.question_type] += 1
        return True

    def _add(self, draft: TaskDraft, like: str | None = None) -> ChosenDraft | None:
        """Take a draft, unless it was asked already, the start view answers it, or its wordings are used up."""
        if draft.full_key in self.shared.asked or answerable_from_start(draft):
            return None
        if self.shared.can_answer is not None and not self.shared.can_answer(draft):
            return None
        stays = draft.place.stays and not draft.calls_move
        if stays and self.category != "single_call" and self.used["stays"][True] >= self.shared.scaled(FROM_START):
            return None
        rng = random.Random(draft.digest(self.seed))
        worded = self.frames.word(draft, rng, like and f"{draft.question_type}/{like}")
        if worded is None or self.frames.used[worded[1]] >= self.most_frame:
            return None
        alone, limited = like is None and draft.twin is None, self.slack < _NO_LIMIT
        most = self.shared.scaled(AT_ONE_POSITION.get(self.category, self.quota))
        if alone and limited and any(self.used["position"][at] >= most for at in offered_positions(draft, worded[0])):
            return None
        self.frames.take(*worded)
        self.shared.asked.add(draft.full_key)
        others = [self.frames.word(draft, rng) for _ in range(5)]
        row = ChosenDraft(draft, *worded, variants=[o[0] for o in others if o is not None])
        self.rows.append(row)
        self._note(row, 1, paired=not alone)
        self.used["stays"][True] += stays
        return row

    def _note(self, row: ChosenDraft, step: int, *, paired: bool) -> None:
        for name, value in row.draft.traits:
            self.used[name][value] += step
        self.used["same"][row.scene, row.draft.key, row.draft.answer_key] += step
        if paired:
            return
        self.used["alone"][row.draft.answer_key] += step
        self.used["polar"][row.draft.question_type, row.draft.answer_key] += step
        for at in offered_positions(row.draft, row.text):
            self.used["position"][at] += step

    def _drop(self, row: ChosenDraft) -> None:
        self.rows.remove(row)
        self._note(row, -1, paired=True)
        self.shared.asked.discard(row.draft.full_key)
        self.shared.texts.discard(row.text)
        self.frames.used[row.frame] -= 1


def offered_positions(draft: TaskDraft, text: str) -> list[str]:
    """Return the positions of the right answer among those that a wording offers, or nothing when it does not offer it."""
    names, value = offered(draft.expected, text), getattr(draft.expected, "value", None)
    if isinstance(value, tuple) and len(value) == 1:
        (value,) = value  # the set of objects that are there has one element
    at = names.index(value) if value in names else -1
    return [] if at < 0 else [str(at), *(["last"] if at == len(names) - 1 else [])]


def answerable_from_start(draft: TaskDraft) -> bool:
    """Whether a task that should take a move or a sweep could be answered from the start view without any check noticing."""
    place = draft.place
    needs = place.needs if draft.needs is None else draft.needs
    views = [view for view in draft.evidence if view.must_look]
    preset = next(p for p in place.scene.file.presets if p.name == place.start)
    start = preset_at(preset)
    moved = draft.program is None and not draft.ends_zoomed and place.at != start
    if not needs or not views or moved or (draft.behaviour is not None and draft.behaviour.final is not None):
        return False
    start_looks = (
        Observation(start.viewpoint, TASK_CAMERA.view(start.pose), place.scene.file.start_s, "query", " ".join(v.about))
        for v in views
    )
    return all(uncovered_part(view, [look]) is None for view, look in zip(views, start_looks, strict=True))
