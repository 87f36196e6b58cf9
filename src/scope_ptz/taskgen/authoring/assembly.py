"""A dataset: drafts of all scenes chosen to the published quotas, worded, numbered, paired and paraphrased."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from scope_ptz.bench.tasks.task import Behaviour, Category, Task
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.categories.descriptor_tasks import values_of
from scope_ptz.taskgen.authoring.drafts import Draft, difficulty
from scope_ptz.taskgen.authoring.reactions import DATASET, reactions
from scope_ptz.taskgen.authoring.scene_drafts import SceneDrafts
from scope_ptz.taskgen.authoring.selection import Answered, Chosen, Selection, Shared

QUOTAS: dict[Category, int] = {
    "counting": 95, "descriptor": 89, "location": 53, "ocr": 54, "single_call": 72, "multi_step_command": 57,
    "multi_step_reasoning": 54, "comparative": 62,
}  # fmt: skip
"""The paper's 536."""

REACTIONS = 44
PARAPHRASED, WORDINGS = 64, 3

Say = Callable[[str], None]


@dataclass
class Built:
    """``short``: how many tasks of a category (or stratum) the scenes did not yield."""

    tasks: list[Task] = field(default_factory=list)
    short: dict[str, int] = field(default_factory=dict)


class Builder:
    """Chooses from the desks of all scenes in turn, so that scenes, viewpoints and sorts of question are evenly used."""

    def __init__(
        self,
        scenes: Sequence[Scene],
        seed: int,
        quotas: dict[Category, int] | None = None,
        say: Say | None = None,
        answered: Answered | None = None,
    ) -> None:
        self.scenes, self.seed, self.quotas = sorted(scenes, key=lambda scene: scene.name), seed, quotas or QUOTAS
        self.say: Say = say or (lambda _: None)
        things = [thing for scene in scenes for thing in scene.things]
        nouns = frozenset({thing.category for thing in things} | {noun for scene in scenes for noun in scene.file.absent})
        self.desks = [SceneDrafts(scene, seed, nouns, values_of(things)) for scene in scenes]
        self.shared = Shared(scale=sum(self.quotas.values()) / sum(QUOTAS.values()), answered=answered)

    def build(self) -> Built:
        built = Built()
        chosen: dict[Category, list[Chosen]] = {}
        pools = self._pools()
        for category, quota in self.quotas.items():
            chosen[category] = Selection(category, quota, self.shared, self.seed).fill(pools[category])
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

    def _pools(self) -> dict[Category, list[Draft]]:
        """All drafts of all scenes by category. One scene's layers are in memory at a time."""
        pools: dict[Category, list[Draft]] = {category: [] for category in self.quotas}
        for desk in self.desks:
            for category, pool in pools.items():
                pool += desk.drafts(category)
            desk.scene.release()
            self.say(
                f"{desk.scene.name}: {sum(draft.place.scene is desk.scene for pool in pools.values() for draft in pool)} drafts"
            )
        return pools

    def _number(self, category: Category, rows: list[Chosen]) -> None:
        counts: Counter[str] = Counter()
        for row in rows:
            counts[row.scene] += 1
            row.id = f"{DATASET}-{row.scene}-{category.replace('_', '-')}-{counts[row.scene]:03d}"
        by_draft = {id(row.draft): row for row in rows}
        for row in rows:
            if row.draft.twin is not None:
                twin = by_draft[id(row.draft.twin)]
                row.pair, twin.pair = twin.id, row.id

    def _paraphrases(self, chosen: dict[Category, list[Chosen]]) -> list[Task]:
        """Further wordings of tasks, categories in turn."""
        wanted = max(1, PARAPHRASED * sum(self.quotas.values()) // sum(QUOTAS.values()))
        found = list[Task]()
        able = {c: [row for row in rows if len(row.variants) >= WORDINGS] for c, rows in chosen.items()}
        for rows in able.values():
            rows.sort(key=lambda row: row.draft.digest(f"{self.seed}:paraphrases"))
        done = 0
        while done < wanted and any(able.values()):
            for rows in able.values():
                if rows and done < wanted:
                    row, done = rows.pop(), done + 1
                    texts = [text for text in dict.fromkeys(row.variants) if text not in self.shared.texts][:WORDINGS]
                    self.shared.texts.update(texts)
                    found += [_task(row, text, n) for n, text in enumerate(texts, 1)]
        return found


def _task(row: Chosen, text: str, wording: int = 0) -> Task:
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


def build(
    scenes: Sequence[Scene],
    seed: int = 1,
    quotas: dict[Category, int] | None = None,
    say: Say | None = None,
    answered: Answered | None = None,
) -> Built:
    """The dataset of these scenes; what they do not yield is told in ``short``. ``answered``: whether eyes that see all can answer
    what the reference program of a draft asks them (None: taken for granted)."""
    return Builder(scenes, seed, quotas, say, answered).build()
