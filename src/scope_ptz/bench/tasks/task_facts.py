"""The facts about a task that judges are given and that reports use to group runs."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict

from scope_ptz.bench.tasks.task import Category, Scope, Stratum


class TaskFacts(BaseModel):
    """The facts about a task that judges are given and by which reports group runs.

    Attributes:
        id: The task's id.
        dataset: The dataset's version.
        stratum: Part of the dataset; "imported" for an imported task, whose answer has no executable check.
        scene: The scene.
        viewpoint: The viewpoint where the run starts.
        preset: The preset where the run starts.
        instruction: The instruction to the agent.
        category: The task's category.
        scope: Whether the task is about the current view or the full scene.
        difficulty: The task's difficulty.
        expected: The expected answer in words.
        demands: Requirements on the run that follow from the instruction, in sentences for a judge.
        needs: Kinds of camera actions that the task requires.
        pair: Id of a task with similar wording. In one of the two tasks the thing in question is present, in the other it is
            absent.
        paraphrase_of: Id of the task that this task paraphrases.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    id: str
    dataset: str
    stratum: Stratum | Literal["imported"]
    scene: str
    viewpoint: str
    preset: str
    instruction: str
    category: Category
    scope: Scope
    difficulty: Literal["easy", "medium", "hard"]
    expected: str
    demands: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    pair: str | None = None
    paraphrase_of: str | None = None
