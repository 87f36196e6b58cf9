"""Sample runs for judges, and sample replies of judges."""

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
from tests.bench.sample_runs import PRESETS, samples

PRESET_VIEWPOINTS = PresetViewpoints({name: position.viewpoint or "" for name, position in PRESETS.items()}, "mast")
CORRECT = {"reason": "The count is right.", "verdict": "correct", "error_mode": "none"}
MISCOUNTED = {"reason": "The tool counted 4, expected 5.", "verdict": "incorrect", "error_mode": "vlm_counting"}


def sample(category: str = "counting") -> tuple[Task, Episode]:
    """Return the first sample task of a category, and a run that passes it."""
    return next((task, episode) for task, episode in samples() if task.category == category)


def facts_and_case(category: str = "counting") -> tuple[TaskFacts, JudgeCase]:
    task, episode = sample(category)
    return facts_of(task, "mast"), case_of_episode(episode, PRESET_VIEWPOINTS)


def long_case(calls: int, answer_chars: int) -> JudgeCase:
    _, case = facts_and_case()
    case_calls = (
        CaseCall("query_answer", {"question": f"number {n}?"}, {"answer": f"<{n}>" + "x" * answer_chars}, None, Pose())
        for n in range(calls)
    )
    return replace(case, calls=tuple(case_calls))


def json_text(content: Any) -> str:
    return json.dumps(content)
