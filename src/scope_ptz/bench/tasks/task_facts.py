"""The properties of a task that judges and reports use."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict

from scope_ptz.bench.tasks.task import Category, Scope, Stratum


class TaskFacts(BaseModel):
    """The properties of a task that judges receive and by which reports group runs.

    Attributes:
        id: The task's id.
        dataset: The dataset's version.
        stratum: Part of the dataset that contains the task; "imported" for imported tasks, whose answers have no executable check.
        scene: The scene.
        viewpoint: The viewpoint at which runs start.
        preset: The preset at which runs start.
        instruction: The instruction to the agent.
        category: The task's category.
        scope: Whether the task is about the current view or the full scene.
        difficulty: The task's difficulty.
        expected: The expected answer in words.
        demands: The requirements that follow from the instruction, as sentences for a judge.
        needs: Kinds of camera actions that the task requires.
        pair: Id of the other task in a contrast pair. The two tasks have similar wording, but the thing in question is present in
            one and absent in the other.
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
