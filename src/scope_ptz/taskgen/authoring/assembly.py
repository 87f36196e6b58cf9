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
        chosen_by_category: dict[Category, list[ChosenDraft]] = {}
        pools = self._drafts_by_category()
        for category, quota in self.quotas.items():
            chosen_by_category[category] = Selection(category, quota, self.shared, self.seed).fill(pools[category])
            if (missing := quota - len(chosen_by_category[category])) > 0:
                built.missing[category] = missing
            self.progress(f"{category}: {len(chosen_by_category[category])} of {quota}")
        for category, chosen_drafts in chosen_by_category.items():
            self._assign_ids(category, chosen_drafts)
            built.tasks += [_create_task(chosen, chosen.text) for chosen in chosen_drafts]
        built.tasks += self._create_paraphrases(chosen_by_category)
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

    def _assign_ids(self, category: Category, chosen_drafts: list[ChosenDraft]) -> None:
        """Assign an id to every selected draft, and link the two tasks of each pair."""
        counts: Counter[str] = Counter()
        for chosen in chosen_drafts:
            counts[chosen.scene] += 1
            chosen.id = f"{DATASET}-{chosen.scene}-{category.replace('_', '-')}-{counts[chosen.scene]:03d}"
        by_draft = {id(chosen.draft): chosen for chosen in chosen_drafts}
        for chosen in chosen_drafts:
            if chosen.draft.twin is not None:
                twin = by_draft[id(chosen.draft.twin)]
                chosen.pair, twin.pair = twin.id, chosen.id

    def _create_paraphrases(self, chosen_by_category: dict[Category, list[ChosenDraft]]) -> list[Task]:
        """Return additional tasks that paraphrase some core tasks, which are taken from each category in turn."""
        number = max(1, PARAPHRASED_TASKS * sum(self.quotas.values()) // sum(QUOTAS.values()))
        paraphrases = list[Task]()
        candidates = {
            c: [chosen for chosen in chosen_drafts if len(chosen.variants) >= EXTRA_WORDINGS]
            for c, chosen_drafts in chosen_by_category.items()
        }
        for chosen_drafts in candidates.values():
            chosen_drafts.sort(key=lambda chosen: chosen.draft.digest(f"{self.seed}:paraphrases"))
        paraphrased = 0
        while paraphrased < number and any(candidates.values()):
            for chosen_drafts in candidates.values():
                if chosen_drafts and paraphrased < number:
                    chosen, paraphrased = chosen_drafts.pop(), paraphrased + 1
                    texts = [text for text in dict.fromkeys(chosen.variants) if text not in self.shared.texts][:EXTRA_WORDINGS]
                    self.shared.texts.update(texts)
                    paraphrases += [_create_task(chosen, text, n) for n, text in enumerate(texts, 1)]
        return paraphrases


def _create_task(chosen: ChosenDraft, text: str, wording_number: int = 0) -> Task:
    draft, place = chosen.draft, chosen.draft.place
    ends_at_place = draft.program is None and not draft.ends_zoomed
    behaviour = draft.behaviour or (Behaviour(final=place.final) if ends_at_place else Behaviour())
    return Task(
        id=f"{chosen.id.replace(f'-{chosen.scene}-', f'-{chosen.scene}-wording-')}{wording_number}"
        if wording_number
        else chosen.id,
        dataset=DATASET,
        stratum="paraphrase" if wording_number else "core",
        scene=chosen.scene,
        preset=place.start,
        time_s=place.scene.file.start_s,
        instruction=text,
        category=draft.category,
        scope="full" if place.swept else "current",
        difficulty=difficulty(draft.calls, draft.object_count, swept=place.swept),
        expected=draft.expected,
        behaviour=behaviour,
        evidence=draft.evidence,
        reference=draft.calls,
        needs=draft.needs if draft.needs is not None else place.needs,
        tags=(*draft.tags, f"sort:{draft.question_type}"),
        pair=None if wording_number else chosen.pair,
        paraphrase_of=chosen.id if wording_number else None,
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
