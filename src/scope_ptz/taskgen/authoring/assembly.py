"""Assemble a dataset: select drafts from all scenes to fill the quotas, then word, number, pair and paraphrase them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from scope_ptz.bench.tasks.task import Behaviour, Category, Task
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.categories.descriptor_tasks import attribute_values
from scope_ptz.taskgen.authoring.drafts import TaskDraft, difficulty
from scope_ptz.taskgen.authoring.reactions import DATASET, create_reactions
from scope_ptz.taskgen.authoring.scene_drafts import SceneDrafts
from scope_ptz.taskgen.authoring.selection import CanAnswer, ChosenDraft, Selection, SharedLimits

QUOTAS: dict[Category, int] = {
    "counting": 95, "descriptor": 89, "location": 53, "ocr": 54, "single_call": 72, "multi_step_command": 57,
    "multi_step_reasoning": 54, "comparative": 62,
}  # fmt: skip
"""Number of core tasks per category, as in the paper: 536 in total."""

REACTION_TASKS = 44  # number of tasks whose request the agent should ask about or refuse
PARAPHRASED_TASKS, EXTRA_WORDINGS = 64, 3  # number of core tasks to paraphrase, and number of additional wordings for each of them

Progress = Callable[[str], None]


@dataclass
class BuiltTasks:
    """The tasks in a dataset.

    Attributes:
        tasks: The tasks.
        missing: How many tasks are missing because the scenes yielded too few drafts, by category or stratum.
    """

    tasks: list[Task] = field(default_factory=list)
    missing: dict[str, int] = field(default_factory=dict)


class Builder:
    """The state of one dataset build. The arguments are those of the function ``build``."""

    def __init__(
        self,
        scenes: Sequence[Scene],
        seed: int,
        quotas: dict[Category, int] | None = None,
        progress: Progress | None = None,
        can_answer: CanAnswer | None = None,
    ) -> None:
        self.scenes, self.seed, self.quotas = sorted(scenes, key=lambda scene: scene.name), seed, quotas or QUOTAS
        self.progress: Progress = progress or (lambda _: None)
        things = [thing for scene in scenes for thing in scene.things]
        nouns = frozenset({thing.category for thing in things} | {noun for scene in scenes for noun in scene.file.absent})
        self.scene_drafts = [SceneDrafts(scene, seed, nouns, attribute_values(things)) for scene in scenes]
        self.shared = SharedLimits(scale=sum(self.quotas.values()) / sum(QUOTAS.values()), can_answer=can_answer)

    def build(self) -> BuiltTasks:
        """Select and word the tasks of every category, then the paraphrases and reactions."""
        built = BuiltTasks()
        chosen: dict[Category, list[ChosenDraft]] = {}
        pools = self._drafts_by_category()
        for category, quota in self.quotas.items():
            chosen[category] = Selection(category, quota, self.shared, self.seed).fill(pools[category])
            if (missing := quota - len(chosen[category])) > 0:
                built.missing[category] = missing
            self.progress(f"{category}: {len(chosen[category])} of {quota}")
        for category, rows in chosen.items():
            self._assign_ids(category, rows)
            built.tasks += [_create_task(row, row.text) for row in rows]
        built.tasks += self._create_paraphrases(chosen)
        if self.quotas is QUOTAS:
            extra, missing = create_reactions(self.scenes, self.seed, REACTION_TASKS)
            built.tasks += extra
            if missing:
                built.missing["reaction"] = missing
        return built

    def _drafts_by_category(self) -> dict[Category, list[TaskDraft]]:
        """Return the drafts from all scenes by category. Only one scene's images are in memory at a time."""
        pools: dict[Category, list[TaskDraft]] = {category: [] for category in self.quotas}
        for drafts in self.scene_drafts:
            for category, pool in pools.items():
                pool += drafts.drafts(category)
            drafts.scene.release()
            number = sum(draft.place.scene is drafts.scene for pool in pools.values() for draft in pool)
            self.progress(f"{drafts.scene.name}: {number} drafts")
        return pools

    def _assign_ids(self, category: Category, rows: list[ChosenDraft]) -> None:
        """Assign an id to every selected draft, and link the two tasks of each pair."""
        counts: Counter[str] = Counter()
        for row in rows:
            counts[row.scene] += 1
            row.id = f"{DATASET}-{row.scene}-{category.replace('_', '-')}-{counts[row.scene]:03d}"
        by_draft = {id(row.draft): row for row in rows}
        for row in rows:
            if row.draft.twin is not None:
                twin = by_draft[id(row.draft.twin)]
                row.pair, twin.pair = twin.id, row.id

    def _create_paraphrases(self, chosen: dict[Category, list[ChosenDraft]]) -> list[Task]:
        """Return additional tasks that paraphrase some core tasks, which are taken from each category in turn."""
        number = max(1, PARAPHRASED_TASKS * sum(self.quotas.values()) // sum(QUOTAS.values()))
        paraphrases = list[Task]()
        candidates = {c: [row for row in rows if len(row.variants) >= EXTRA_WORDINGS] for c, rows in chosen.items()}
        for rows in candidates.values():
            rows.sort(key=lambda row: row.draft.digest(f"{self.seed}:paraphrases"))
        paraphrased = 0
        while paraphrased < number and any(candidates.values()):
            for rows in candidates.values():
                if rows and paraphrased < number:
                    row, paraphrased = rows.pop(), paraphrased + 1
                    texts = [text for text in dict.fromkeys(row.variants) if text not in self.shared.texts][:EXTRA_WORDINGS]
                    self.shared.texts.update(texts)
                    paraphrases += [_create_task(row, text, n) for n, text in enumerate(texts, 1)]
        return paraphrases


def _create_task(row: ChosenDraft, text: str, wording: int = 0) -> Task:
    draft, place = row.draft, row.draft.place
    ends_at_place = draft.program is None and not draft.ends_zoomed
    behaviour = draft.behaviour or (Behaviour(final=place.final) if ends_at_place else Behaviour())
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
        tags=(*draft.tags, f"sort:{draft.question_type}"),
        pair=None if wording else row.pair,
        paraphrase_of=row.id if wording else None,
    )


def build(
    scenes: Sequence[Scene],
    seed: int = 1,
    quotas: dict[Category, int] | None = None,
    progress: Progress | None = None,
    can_answer: CanAnswer | None = None,
) -> BuiltTasks:
    """Build the tasks for a dataset.

    Args:
        scenes: Scenes for the tasks.
        seed: Seed for every random choice.
        quotas: Number of core tasks per category. By default, the published quotas are used and reactions are added.
        progress: Called with a line of text after every step.
        can_answer: Returns whether perception can answer the questions of a draft. By default, all drafts count as answerable.

    Returns:
        The tasks, and how many are missing per category.
    """
    return Builder(scenes, seed, quotas, progress, can_answer).build()
