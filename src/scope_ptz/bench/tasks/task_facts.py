"""The facts about a task that reports group runs by and judges read."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict

from scope_ptz.bench.tasks.task import Category, Scope, Stratum


class TaskFacts(BaseModel):
    """What reports group runs by. ``viewpoint``: where the run starts; ``expected``: the expected answer in words.

    ``stratum`` "imported": a task of another file, without executable checks of its answer. ``demands``: what the run must have
    done, in sentences for a judge; only what the instruction fixes.
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
