"""Choosing the drafts of a category: scenes, viewpoints, sorts of question and answers as even as the scenes allow."""

from __future__ import annotations

import random
from collections import Counter, defaultdict
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field

from scope_ptz.bench.scoring.coverage import uncovered_part
from scope_ptz.bench.scoring.episode import Observation
from scope_ptz.bench.tasks.task import Category
from scope_ptz.taskgen.authoring.drafts import Draft, Frames
from scope_ptz.taskgen.authoring.places import preset_at
from scope_ptz.taskgen.facts.phrasing import offered
from scope_ptz.taskgen.facts.robust import EYES

PAIRS: dict[Category, int] = {"counting": 31, "descriptor": 16, "location": 12, "multi_step_reasoning": 16}
"""How many tasks of a category say that there is none, each beside one of like wording that says that there is."""

PAIRS_OF_KIND = {"not-there": 4, "half-none": 3, "neither": 4}
"""Of these sorts of pair no more: whoever looks and then says "yes" gets the presences right."""

ANSWERS: dict[Category, int] = {
    "counting": 5, "descriptor": 2, "location": 1, "ocr": 1, "single_call": 1, "multi_step_reasoning": 2, "comparative": 1,
}  # fmt: skip
"""How often one and the same answer is right in a category, tasks of pairs aside: together no more than 3% of all tasks."""

POLAR = 1
"""How often "yes" is right, and how often "no", for each sort of question, pairs aside."""

SAME = 2
"""How often the same is asked of several views with the same answer."""

AT_ONE_PLACE: dict[Category, int] = {"descriptor": 3, "location": 3, "comparative": 5}
"""How often the right answer may be the first of those that the question offers, and the second, and the last, pairs aside:
together no more than 3% of all tasks."""

_NO_LIMIT = 1000.0

FRAME_SHARE = 0.06
FROM_START = 3
"""No wording is more frequent than this share of a category; so many tasks of a category can be done from the start view."""

_WEIGHTS = {"scene": 3.0, "viewpoint": 1.5, "kind": 2.0, "answer": 4.0, "subject": 1.5, "place": 1.0, "start": 0.3}

Answered = Callable[[Draft], bool]
"""Whether eyes that see all can answer what the reference program of a draft asks them."""

_Take = Callable[[Draft], bool]


@dataclass
class Chosen:
    """A draft that was taken, with its wording and further ones."""

    draft: Draft
    text: str
    frame: str
    id: str = ""
    pair: str | None = None
    variants: list[str] = field(default_factory=list)

    @property
    def scene(self) -> str:
        return self.draft.place.scene.name


@dataclass
class Shared:
    """What must not come twice, or too often, in all categories together."""

    asked: set[str] = field(default_factory=set)
    texts: set[str] = field(default_factory=set)
    scale: float = 1.0
    answered: Answered | None = None
    """Of the published numbers what share is made; the limits shrink with it."""

    def most(self, limit: int) -> int:
        return max(1, round(limit * self.scale))


class Selection:
    """Fills one category's quota from all drafts of all scenes."""

    def __init__(self, category: Category, quota: int, shared: Shared, seed: int) -> None:
        self.category, self.quota, self.shared = category, quota, shared
        self.seed = seed
        self.frames = Frames(shared.texts)
        self.rows: list[Chosen] = []
        self.used: defaultdict[str, Counter[Hashable]] = defaultdict(Counter)
        self.slack = 1.0
        self.most_frame = max(2, int(quota * FRAME_SHARE))

    def fill(self, drafts: Sequence[Draft]) -> list[Chosen]:
        """The drafts taken, pairs first. Fewer than the quota when there are not enough."""
        # By lot, but so that drafts more or fewer, or scenes in another order, leave the order of the others as it is.
        pool = sorted(drafts, key=lambda draft: draft.digest(self.seed))
        pairs = [draft for draft in pool if draft.twin is not None]
        wanted = min(self.shared.most(PAIRS.get(self.category, 0)), self.quota // 2) if self.category in PAIRS else 0
        for _ in range(wanted):
            self._best(pairs, self._pair)
        for slack in (1.0, 1.2, 1.4, 1.6, 2.0, 3.0, _NO_LIMIT):
            # What the scenes do not yield within the limits is taken beyond them, as little beyond as possible.
            self.slack, singles = slack, [draft for draft in pool if draft.twin is None]
            while len(self.rows) < self.quota and self._best(singles, self._single):
                pass
        return self.rows

    def _best(self, pool: list[Draft], take: _Take) -> bool:
        """Take the draft that evens things out most; those that cannot be taken leave the pool."""
        while pool:
            at = min(range(len(pool)), key=lambda n: self._cost(pool[n]))
            if take(pool.pop(at)):
                return True
        return False

    def _cost(self, draft: Draft) -> float:
        """How much there already is of what a draft would add."""
        twin = () if draft.twin is None else (("answer", draft.twin.reads),)
        return sum(_WEIGHTS[name] * self.used[name][value] for name, value in (*draft.traits, *twin))

    def _single(self, draft: Draft) -> bool:
        return not self._too_often(draft) and self._add(draft) is not None

    def _too_often(self, draft: Draft) -> bool:
        if draft.expected.kind == "yes_no":
            return self.used["polar"][draft.kind, draft.reads] >= self.shared.most(POLAR)
        if draft.expected.kind == "action_only":
            return False
        if self.used["same"][draft.place.scene.name, draft.key, draft.reads] >= int(self.slack * SAME):
            return True
        limit = self.shared.most(ANSWERS.get(self.category, self.quota))
        return self.used["alone"][draft.reads] >= int(self.slack * limit)

    def _pair(self, draft: Draft) -> bool:
        twin, limit = draft.twin, PAIRS_OF_KIND.get(draft.kind)
        if twin is None or (limit is not None and self.used["pairs"][draft.kind] >= self.shared.most(limit)):
            return False
        if twin.full_key in self.shared.asked or draft.full_key in self.shared.asked:
            return False
        row = self._add(draft)
        if row is None:
            return False
        if self._add(twin, like=row.frame.split("/", 1)[1]) is None:
            self._drop(row)
            return False
        self.used["pairs"][draft.kind] += 1
        return True

    def _add(self, draft: Draft, like: str | None = None) -> Chosen | None:
        """Take a draft, unless it was asked already, the start view answers it, or its wordings are used up."""
        if draft.full_key in self.shared.asked or seen_from_start(draft):
            return None
        if self.shared.answered is not None and not self.shared.answered(draft):
            return None
        stays = draft.place.stays and not draft.calls_move
        if stays and self.category != "single_call" and self.used["stays"][True] >= self.shared.most(FROM_START):
            return None
        rng = random.Random(draft.digest(self.seed))
        worded = self.frames.word(draft, rng, like and f"{draft.kind}/{like}")
        if worded is None or self.frames.used[worded[1]] >= self.most_frame:
            return None
        alone, limited = like is None and draft.twin is None, self.slack < _NO_LIMIT
        most = self.shared.most(AT_ONE_PLACE.get(self.category, self.quota))
        if alone and limited and any(self.used["right at"][at] >= most for at in right_at(draft, worded[0])):
            return None
        self.frames.take(*worded)
        self.shared.asked.add(draft.full_key)
        others = [self.frames.word(draft, rng) for _ in range(5)]
        row = Chosen(draft, *worded, variants=[o[0] for o in others if o is not None])
        self.rows.append(row)
        self._note(row, 1, paired=not alone)
        self.used["stays"][True] += stays
        return row

    def _note(self, row: Chosen, step: int, *, paired: bool) -> None:
        for name, value in row.draft.traits:
            self.used[name][value] += step
        self.used["same"][row.scene, row.draft.key, row.draft.reads] += step
        if paired:
            return
        self.used["alone"][row.draft.reads] += step
        self.used["polar"][row.draft.kind, row.draft.reads] += step
        for at in right_at(row.draft, row.text):
            self.used["right at"][at] += step

    def _drop(self, row: Chosen) -> None:
        self.rows.remove(row)
        self._note(row, -1, paired=True)
        self.shared.asked.discard(row.draft.full_key)
        self.shared.texts.discard(row.text)
        self.frames.used[row.frame] -= 1


def right_at(draft: Draft, text: str) -> list[str]:
    """Where among several that a wording offers the right answer stands; nothing where it offers none, or not the right one."""
    names, value = offered(draft.expected, text), getattr(draft.expected, "value", None)
    if isinstance(value, tuple) and len(value) == 1:
        (value,) = value  # all of those that are there: the only one
    at = names.index(value) if value in names else -1
    return [] if at < 0 else [str(at), *(["last"] if at == len(names) - 1 else [])]


def seen_from_start(draft: Draft) -> bool:
    """Whether what is meant to take a move or a sweep could be answered at the start view, and nothing else would tell."""
    place = draft.place
    needs = place.needs if draft.needs is None else draft.needs
    views = [view for view in draft.evidence if view.must_look]
    preset = next(p for p in place.scene.file.presets if p.name == place.start)
    start = preset_at(preset)
    moved = draft.program is None and not draft.looks_closer and place.at != start
    if not needs or not views or moved or (draft.behaviour is not None and draft.behaviour.final is not None):
        return False
    looks = (
        Observation(start.viewpoint, EYES.view(start.pose), place.scene.file.start_s, "query", " ".join(v.about)) for v in views
    )
    return all(uncovered_part(view, [look]) is None for view, look in zip(views, looks, strict=True))
