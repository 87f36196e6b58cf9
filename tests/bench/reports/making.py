"""Evaluations made up for tests: what a sweep of pairs might leave, with known chances."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any

from scope_ptz.agent.timing import Timings
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import CheckRecord, Evaluation, Judgement, ModelCard, ObservationTime, RunCard, Trial
from scope_ptz.bench.tasks.task import Category
from scope_ptz.bench.tasks.task_facts import TaskFacts

CATEGORIES: tuple[Category, ...] = (
    "counting", "descriptor", "location", "ocr", "single_call", "multi_step_command", "multi_step_reasoning", "comparative"
)  # fmt: skip
HARD: dict[Category, float] = {
    "counting": 0.0, "descriptor": -0.15, "location": -0.1, "ocr": -0.05, "single_call": 0.3, "multi_step_command": 0.25,
    "multi_step_reasoning": 0.05, "comparative": -0.2,
}  # fmt: skip
SCENES = ("freight-yard", "high-street", "highway-works", "station-square")
VIEWPOINTS = ("east", "north", "west")
JUDGE = "gpt-oss-120b"


def facts(per_category: int = 6, *, stratum: Any = "core") -> tuple[TaskFacts, ...]:
    """Tasks spread evenly over scenes and viewpoints."""
    made = []
    for category in CATEGORIES:
        for number in range(per_category):
            scene, viewpoint = SCENES[number % 4], VIEWPOINTS[(number // 4 + len(category)) % 3]
            made.append(
                TaskFacts(
                    id=f"scope1-{scene}-{category.replace('_', '-')}-{number + 1:03d}",
                    dataset="scope1", stratum=stratum, scene=scene, viewpoint=viewpoint, preset="gate",
                    instruction=f"Turn to the {scene} and do {category} number {number + 1}.", category=category,
                    scope="full" if number % 3 == 0 else "current", difficulty="medium", expected=f"{number + 2} cones",
                )
            )  # fmt: skip
    return tuple(made)


def reworded(tasks: Sequence[TaskFacts], times: int = 3) -> tuple[TaskFacts, ...]:
    """Paraphrases of tasks."""
    return tuple(
        task.model_copy(
            update={
                "id": f"{task.id}9{n}",
                "stratum": "paraphrase",
                "paraphrase_of": task.id,
                "instruction": f"{task.instruction} ({n})",
            }
        )
        for task in tasks
        for n in range(times)
    )


def card(planner: str, eyes: str, **further: Any) -> RunCard:
    """A run card; "grammar" and "ground-truth" are what is no model."""
    basics: dict[str, Any] = {
        "run_id": f"{planner}-{eyes}", "started": "2026-11-20T10:00:00Z", "package_version": "0.1.0", "engine_version": "0.3.285",
        "dataset": "scope1", "dataset_digest": "d" * 64, "split": "core", "max_steps": 60, "sampling": {"temperature": 0.7},
        "seed": 1, "prompt_digest": "p" * 64, "concurrency": 8, "host": "bench-1",
    }  # fmt: skip
    own = {"grammar", "ground-truth", "ground_truth"}
    return RunCard(
        planner=ModelCard(name=planner, registry=None if planner in own else planner, deterministic=planner in own),
        perception=ModelCard(name=eyes, registry=None if eyes in own else eyes, deterministic=eyes in own),
        **{**basics, **further},
    )


def trial(task: TaskFacts, headline: Any = "correct", **further: Any) -> Trial:
    """One run with unremarkable figures."""
    basics: dict[str, Any] = {
        "sample": f"{task.id}/1", "reason": "every check passed" if headline == "correct" else "answer: says 4, not 5",
        "outcome": "answered", "answer": "There are 5 cones.", "steps": 3, "tool_calls": {"go_to_preset": 1, "count_objects": 1},
        "error_mode": ErrorMode.VLM_COUNTING if headline == "incorrect" else None,
        "checks": (CheckRecord(name="answer", passed=headline == "correct", reason="says 5"),),
    }  # fmt: skip
    return Trial(task=task, headline=headline, **{**basics, **further})


def evaluation(
    planner: str, eyes: str, tasks: Sequence[TaskFacts], skill: float, *, seed: int = 0, epochs: int = 1, judged: bool = True,
    latency_s: tuple[float, float] = (1.5, 6.0), perception_share: float = 0.6, spoiled: float = 0.02, **further: Any,
) -> Evaluation:  # fmt: skip
    """A run whose tasks succeed with a chance of ``skill`` plus the category's own ease.

    ``spoiled``: share of runs that infrastructure broke, and as many that could not be scored.
    """
    chance = random.Random(f"{planner} {eyes} {seed}")
    made = []
    for task in tasks:
        easy = min(0.99, max(0.02, skill + HARD[task.category] - (0.1 if task.scope == "full" else 0.0)))
        for epoch in range(1, epochs + 1):
            made.append(_chanced(task, epoch, easy, chance, judged, latency_s, perception_share, spoiled))
    found = card(planner, eyes, epochs=epochs, **further)
    return Evaluation(card=found, trials=tuple(made), wanted=len(made))


def _chanced(
    task: TaskFacts, epoch: int, easy: float, chance: random.Random, judged: bool, latency_s: tuple[float, float], share: float,
    spoiled: float,
) -> Trial:  # fmt: skip
    roll = chance.random()
    broken = "infrastructure" if roll < spoiled else "unscored" if roll < 2 * spoiled else None
    headline = broken or ("correct" if chance.random() < easy else "incorrect")
    mode = None
    if headline == "incorrect":
        looks = (ErrorMode.VLM_COUNTING, ErrorMode.VLM_QUERY)
        others = tuple(m for m in ErrorMode if m not in looks)
        mode = chance.choice(looks) if chance.random() < share else chance.choice(others)
    planner_s, eyes_s = (chance.lognormvariate(0, 0.4) * seconds for seconds in latency_s)
    right = (headline == "correct") != (chance.random() < 0.06)
    verdict: Any = ("correct" if right else "incorrect") if chance.random() < 0.97 else "unparseable"
    judgement = Judgement(
        judge=JUDGE, prompt="standard-1", verdict=verdict,
        error_mode=(mode or ErrorMode.REASONING) if verdict == "incorrect" else None,
        reason="The count is wrong." if mode else "", input_tokens=2000, output_tokens=150,
    )  # fmt: skip
    look_s = eyes_s if task.scope == "current" else eyes_s * 1.25
    return trial(
        task, headline, epoch=epoch, sample=f"{task.id}/{epoch}", error_mode=mode, judgements=(judgement,) if judged else (),
        timings=Timings(planner_s=planner_s, perception_s=eyes_s, camera_s=0.2, render_s=0.1, total_s=planner_s + eyes_s + 0.35),
        looks=(ObservationTime(view=task.scope, eyes_s=look_s, capture_s=0.25, call_s=look_s + 0.3),), input_tokens=3000,
        output_tokens=200, cost_usd=0.002, collateral=chance.random() < 0.03, steps=chance.randint(2, 6),
    )  # fmt: skip


def sweep(per_category: int = 6) -> list[Evaluation]:
    """Six pairs, of two eyes and three planners, one repeated; a re-run with ground-truth eyes; the reference; a variant; wordings;
    requests; a blind baseline; and one that misbehaved."""
    tasks = facts(per_category)
    planners = (("qwen3-4b", 0.55, 1.9), ("qwen3-4b-fp8", 0.54, 1.0), ("qwen3-30b-a3b", 0.68, 1.4))
    eyes = (("moondream2", -0.04, 6.0), ("moondream3", 0.03, 9.2))
    found = [
        evaluation(p, e, tasks, skill + gain, latency_s=(slow, look), epochs=3 if (p, e) == ("qwen3-4b", "moondream2") else 1)
        for e, gain, look in eyes
        for p, skill, slow in planners
    ]
    found.append(evaluation("qwen3-30b-a3b", "ground-truth", tasks, 0.88, perception_share=0.0))
    found.append(evaluation("grammar", "ground-truth", tasks, 1.2, judged=False, latency_s=(0.01, 0.05), spoiled=0.0))
    found.append(evaluation("qwen3-4b", "moondream3", tasks, 0.5, seed=1, variant="prompt short-1"))
    found.append(
        evaluation(
            "qwen3-30b-a3b",
            "moondream3",
            tasks[::2],
            0.7,
            seed=2,
            contended=False,
            concurrency=1,
            split="lite",
            latency_s=(0.9, 4.0),
        )
    )
    found.append(evaluation("qwen3-30b-a3b", "moondream3", reworded(tasks[::6]), 0.66, split="paraphrase"))
    requests = tuple(t.model_copy(update={"stratum": "reaction", "id": f"{t.id}7"}) for t in tasks[::9])
    found.append(evaluation("qwen3-30b-a3b", "moondream3", requests, 0.5, split="reaction"))
    found.append(evaluation("qwen3-30b-a3b", "blind", tasks, 0.05, variant="blind", latency_s=(1.0, 0.0)))
    found.append(evaluation("qwen3-4b", "qwen2.5-vl-7b", tasks[: len(tasks) // 2], 0.3, spoiled=0.3, judged=False))
    return found
