"""Runs to be judged, made through real tools in a small world, and replies that judges give."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

from scope_ptz.bench.judging.case import CaseCall, JudgeCase, case_of_episode
from scope_ptz.bench.scoring.episode import Episode, PresetViewpoints
from scope_ptz.bench.tasks.task import Task
from scope_ptz.bench.tasks.task_facts import TaskFacts
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.geometry import Pose
from tests.bench.making import PRESETS, samples

PLACES = PresetViewpoints({name: standing.viewpoint or "" for name, standing in PRESETS.items()}, "mast")
CORRECT = {"reason": "The count is right.", "verdict": "correct", "error_mode": "none"}
MISCOUNTED = {"reason": "The tool counted 4, expected 5.", "verdict": "incorrect", "error_mode": "vlm_counting"}


def sample(category: str = "counting") -> tuple[Task, Episode]:
    """The first sample of a category, with a run that passes."""
    return next((task, episode) for task, episode in samples() if task.category == category)


def facts_and_case(category: str = "counting") -> tuple[TaskFacts, JudgeCase]:
    task, episode = sample(category)
    return facts_of(task, "mast"), case_of_episode(episode, PLACES)


def long_case(calls: int, said: int) -> JudgeCase:
    _, case = facts_and_case()
    made = (
        CaseCall("query_answer", {"question": f"number {n}?"}, {"answer": f"<{n}>" + "x" * said}, None, Pose())
        for n in range(calls)
    )
    return replace(case, calls=tuple(made))


def written(content: Any) -> str:
    return json.dumps(content)
