"""A dataset: drafts of all scenes chosen to the published quotas, worded, numbered, paired and paraphrased."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from scope_ptz.bench.authoring.descriptor import values_of
from scope_ptz.bench.authoring.desk import Desk
from scope_ptz.bench.authoring.drafts import Draft, Frames, difficulty
from scope_ptz.bench.authoring.places import preset_at
from scope_ptz.bench.authoring.reactions import DATASET, reactions
from scope_ptz.bench.coverage import gap
from scope_ptz.bench.episode import Look
from scope_ptz.bench.ground import EYES
from scope_ptz.bench.tasks import Behaviour, Category, Task
from scope_ptz.world.pack import Scene

QUOTAS: dict[Category, int] = {
    "counting": 95, "descriptor": 89, "location": 53, "ocr": 54, "single_call": 72, "multi_step_command": 57,
    "multi_step_reasoning": 54, "comparative": 62,
}  # fmt: skip
"""The paper's 536."""

PAIRS: dict[Category, int] = {"counting": 28, "descriptor": 18, "location": 9, "multi_step_reasoning": 9}
"""How many tasks of a category say that there is none, each beside one of like wording that says that there is."""

REACTIONS = 44
PARAPHRASED, WORDINGS = 64, 3
FRAME_SHARE = 0.06
ANSWER_SHARE, TEXT_SHARE = 0.2, 0.06
"""No wording, no answer, and no text that is to be read, is more frequent in a category than this."""

Say = Callable[[str], None]


@dataclass
class Built:
    """``short``: how many tasks of a category (or stratum) the scenes did not yield."""

    tasks: list[Task] = field(default_factory=list)
    short: dict[str, int] = field(default_factory=dict)


@dataclass
class _Chosen:
    draft: Draft
    text: str
    scene: str
    id: str = ""
    pair: str | None = None
    variants: list[str] = field(default_factory=list)


class Builder:
    """Chooses from the desks of all scenes in turn, so that scenes, viewpoints and sorts of question are evenly used."""

    def __init__(
        self, scenes: Sequence[Scene], seed: int, quotas: dict[Category, int] | None = None, say: Say | None = None
    ) -> None:
        self.scenes, self.seed, self.quotas = list(scenes), seed, quotas or QUOTAS
        self.say: Say = say or (lambda _: None)
        things = [thing for scene in scenes for thing in scene.things]
        nouns = frozenset({thing.category for thing in things} | {noun for scene in scenes for noun in scene.file.absent})
        self.desks = [Desk(scene, seed, nouns, values_of(things)) for scene in scenes]
        self.asked: set[str] = set()
        self.texts: set[str] = set()

    def build(self) -> Built:
        built = Built()
        chosen: dict[Category, list[_Chosen]] = {}
        for category, quota in self.quotas.items():
            chosen[category] = _Category(self, category, quota).fill()
            if (missing := quota - len(chosen[category])) > 0:
                built.short[category] = missing
            self.say(f"{category}: {len(chosen[category])} of {quota}")
        for category, rows in chosen.items():
            self._number(category, rows)
            built.tasks += [_task(row, row.text) for row in rows]
        built.tasks += self._paraphrases(chosen)
        if self.quotas is QUOTAS:
            extra, missing = reactions(self.scenes, self.seed, REACTIONS)
            built.tasks += extra
            if missing:
                built.short["reaction"] = missing
        return built

    def _number(self, category: Category, rows: list[_Chosen]) -> None:
        counts: Counter[str] = Counter()
        for row in rows:
            counts[row.scene] += 1
            row.id = f"{DATASET}-{row.scene}-{category.replace('_', '-')}-{counts[row.scene]:03d}"
        by_draft = {id(row.draft): row for row in rows}
        for row in rows:
            if row.draft.twin is not None:
                twin = by_draft[id(row.draft.twin)]
                row.pair, twin.pair = twin.id, row.id

    def _paraphrases(self, chosen: dict[Category, list[_Chosen]]) -> list[Task]:
        """Further wordings of tasks, categories in turn."""
        wanted = max(1, PARAPHRASED * sum(self.quotas.values()) // sum(QUOTAS.values()))
        rng, found = random.Random(f"{self.seed}:paraphrases"), list[Task]()
        able = {c: [row for row in rows if len(row.variants) >= WORDINGS] for c, rows in chosen.items()}
        for rows in able.values():
            rng.shuffle(rows)
        done = 0
        while done < wanted and any(able.values()):
            for rows in able.values():
                if rows and done < wanted:
                    row, done = rows.pop(), done + 1
                    texts = [text for text in dict.fromkeys(row.variants) if text not in self.texts][:WORDINGS]
                    self.texts.update(texts)
                    found += [_task(row, text, n) for n, text in enumerate(texts, 1)]
        return found


class _Category:
    """Fills one category's quota."""

    def __init__(self, builder: Builder, category: Category, quota: int) -> None:
        self.builder, self.category, self.quota = builder, category, quota
        self.pairs = round(PAIRS.get(category, 0) * quota / QUOTAS[category])
        self.rng = random.Random(f"{builder.seed}:{category}")
        self.frames, self.rows = Frames(), list[_Chosen]()
        self.frames.texts = builder.texts
        self.answers: Counter[str] = Counter()
        self.kinds: Counter[str] = Counter()
        self.most = max(2, int(quota * FRAME_SHARE))

    def fill(self) -> list[_Chosen]:
        streams = {desk.scene.name: desk.stream(self.category) for desk in self.builder.desks}
        seen: dict[str, list[list[Draft]]] = {name: [] for name in streams}
        for per_place in (2, 4, 8):
            open_desks = list(streams)
            at = dict.fromkeys(streams, 0)
            while open_desks and len(self.rows) < self.quota:
                # The scene with the fewest tasks so far is next: the quota is shared out evenly.
                name = min(open_desks, key=lambda n: (self._of(n), list(streams).index(n)))
                if at[name] == len(seen[name]):
                    batch = next(streams[name], None)
                    if batch is None:
                        open_desks.remove(name)
                        continue
                    self.rng.shuffle(batch)
                    seen[name].append(batch)
                self._take(seen[name][at[name]], name, per_place)
                at[name] += 1
        return self.rows

    def _of(self, scene: str) -> int:
        return sum(row.scene == scene for row in self.rows)

    def _take(self, drafts: list[Draft], scene: str, most: int) -> None:
        """The best few drafts of one place: pairs while they are wanted, then the sorts of question least used."""
        taken = 0
        pairs = [d for d in drafts if d.twin is not None]
        if self.pairs > 0 and len(self.rows) + 2 <= self.quota:
            for draft in pairs:
                if self._pair(draft, scene):
                    self.pairs -= 1
                    taken += 1
                    break
        rest = [d for d in drafts if d.twin is None]
        while taken < most and rest and len(self.rows) < self.quota - 2 * self.pairs:
            rest.sort(key=lambda d: self.kinds[d.kind])
            draft = rest.pop(0)
            taken += self._add(draft, scene) is not None

    def _pair(self, draft: Draft, scene: str) -> bool:
        twin = draft.twin
        if twin is None or twin.full_key in self.builder.asked or draft.full_key in self.builder.asked:
            return False
        frame = self._add(draft, scene)
        if frame is None:
            return False
        if self._add(twin, scene, like=frame.split("/", 1)[1]) is None:
            row = self.rows.pop()
            self.builder.asked.discard(row.draft.full_key)
            self.builder.texts.discard(row.text)
            self.kinds[draft.kind] -= 1
            self.answers[draft.reads] -= 1
            self.frames.used[frame] -= 1
            return False
        return True

    def _add(self, draft: Draft, scene: str, like: str | None = None) -> str | None:
        """Take a draft, unless it was asked already or its answer is too frequent; the frame of its wording."""
        free = draft.reads in ("none", "yes") or draft.expected.kind == "action_only"
        share = TEXT_SHARE if self.category == "ocr" else ANSWER_SHARE
        if draft.full_key in self.builder.asked or (not free and self.answers[draft.reads] >= max(2, int(self.quota * share))):
            return None
        if _seen_from_start(draft):
            return None
        worded = self.frames.word(draft, self.rng, like and f"{draft.kind}/{like}")
        if worded is None or self.frames.used[worded[1]] >= self.most:
            return None
        text, frame = worded
        self.frames.take(text, frame)
        self.builder.asked.add(draft.full_key)
        self.kinds[draft.kind] += 1
        self.answers[draft.reads] += 1
        others = [self.frames.word(draft, self.rng) for _ in range(5)]
        self.rows.append(_Chosen(draft, text, scene, variants=[o[0] for o in others if o is not None]))
        return frame


def _seen_from_start(draft: Draft) -> bool:
    """Whether what is meant to take a move or a sweep could be answered at the start view, and nothing else would tell."""
    place = draft.place
    needs = place.needs if draft.needs is None else draft.needs
    views = [view for view in draft.evidence if view.must_look]
    preset = next(p for p in place.scene.file.presets if p.name == place.start)
    start = preset_at(preset)
    moved = draft.program is None and not draft.looks_closer and place.at != start
    if not needs or not views or moved or (draft.behaviour is not None and draft.behaviour.final is not None):
        return False
    looks = (Look(start.viewpoint, EYES.view(start.pose), place.scene.file.start_s, "query", " ".join(v.about)) for v in views)
    return all(gap(view, [look]) is None for view, look in zip(views, looks, strict=True))


def _task(row: _Chosen, text: str, wording: int = 0) -> Task:
    draft, place = row.draft, row.draft.place
    fixed = draft.program is None and not draft.looks_closer
    behaviour = draft.behaviour or (Behaviour(final=place.final) if fixed else Behaviour())
    return Task(
        id=f"{row.id.replace(f'-{row.scene}-', f'-{row.scene}-wording-')}{wording}" if wording else row.id,
        dataset=DATASET,
        stratum="paraphrase" if wording else "core",
        scene=row.scene,
        preset=place.start,
        time_s=place.scene.file.start_s,
        instruction=text,
        category=draft.category,
        scope="full" if place.swept else "current",
        difficulty=difficulty(draft.calls, draft.weight, swept=place.swept),
        expected=draft.expected,
        behaviour=behaviour,
        evidence=draft.evidence,
        reference=draft.calls,
        needs=draft.needs if draft.needs is not None else place.needs,
        tags=(*draft.tags, f"sort:{draft.kind}"),
        pair=None if wording else row.pair,
        paraphrase_of=row.id if wording else None,
    )


def build(scenes: Sequence[Scene], seed: int = 1, quotas: dict[Category, int] | None = None, say: Say | None = None) -> Built:
    """The dataset of these scenes; what they do not yield is told in ``short``."""
    return Builder(scenes, seed, quotas, say).build()
