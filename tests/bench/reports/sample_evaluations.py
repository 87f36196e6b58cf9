"""Invented evaluations with known success rates, as a sweep of pairs would produce them."""

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
CATEGORY_EFFECTS: dict[Category, float] = {
    "counting": 0.0, "descriptor": -0.15, "location": -0.1, "ocr": -0.05, "single_call": 0.3, "multi_step_command": 0.25,
    "multi_step_reasoning": 0.05, "comparative": -0.2,
}  # fmt: skip
SCENES = ("freight-yard", "high-street", "highway-works", "station-square")
VIEWPOINTS = ("east", "north", "west")
JUDGE = "gpt-oss-120b"


def facts(per_category: int = 6, *, stratum: Any = "core") -> tuple[TaskFacts, ...]:
    """Return tasks spread evenly over scenes and viewpoints."""
    tasks = []
    for category in CATEGORIES:
        for number in range(per_category):
            scene, viewpoint = SCENES[number % 4], VIEWPOINTS[(number // 4 + len(category)) % 3]
            tasks.append(
                TaskFacts(
                    id=f"scope1-{scene}-{category.replace('_', '-')}-{number + 1:03d}",
                    dataset="scope1", stratum=stratum, scene=scene, viewpoint=viewpoint, preset="gate",
                    instruction=f"Turn to the {scene} and do {category} number {number + 1}.", category=category,
                    scope="full" if number % 3 == 0 else "current", difficulty="medium", expected=f"{number + 2} cones",
                )
            )  # fmt: skip
    return tuple(tasks)


def paraphrases(tasks: Sequence[TaskFacts], times: int = 3) -> tuple[TaskFacts, ...]:
    """Return paraphrases of tasks."""
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


def card(planner: str, perception: str, **extra: Any) -> RunCard:
    """Return a run card. "grammar" and "ground-truth" are not models."""
    basics: dict[str, Any] = {
        "run_id": f"{planner}-{perception}",
        "started": "2026-11-20T10:00:00Z", "package_version": "0.1.0", "engine_version": "0.3.285",
        "dataset": "scope1", "dataset_digest": "d" * 64, "split": "core", "max_steps": 60, "sampling": {"temperature": 0.7},
        "seed": 1, "prompt_digest": "p" * 64, "concurrency": 8, "host": "bench-1",
    }  # fmt: skip
    not_models = {"grammar", "ground-truth", "ground_truth"}
    return RunCard(
        planner=ModelCard(name=planner, registry=None if planner in not_models else planner, deterministic=planner in not_models),
        perception=ModelCard(
            name=perception, registry=None if perception in not_models else perception, deterministic=perception in not_models
        ),
        **{**basics, **extra},
    )


def trial(task: TaskFacts, headline: Any = "correct", **extra: Any) -> Trial:
    """Return a trial with typical values."""
    basics: dict[str, Any] = {
        "sample": f"{task.id}/1", "reason": "every check passed" if headline == "correct" else "answer: says 4, not 5",
        "outcome": "answered", "answer": "There are 5 cones.", "steps": 3, "tool_calls": {"go_to_preset": 1, "count_objects": 1},
        "error_mode": ErrorMode.VLM_COUNTING if headline == "incorrect" else None,
        "checks": (CheckRecord(name="answer", passed=headline == "correct", reason="says 5"),),
    }  # fmt: skip
    return Trial(task=task, headline=headline, **{**basics, **extra})


def evaluation(
    planner: str, perception: str, tasks: Sequence[TaskFacts], skill: float, *, seed: int = 0, epochs: int = 1, judged: bool = True,
    latency_s: tuple[float, float] = (1.5, 6.0), perception_share: float = 0.6, broken_share: float = 0.02, **extra: Any,
) -> Evaluation:  # fmt: skip
    """Return an evaluation whose tasks succeed with a probability of ``skill`` plus an effect of the category.

    ``broken_share`` is the share of trials that infrastructure breaks, and also the share that cannot be scored.
    """
    rng = random.Random(f"{planner} {perception} {seed}")
    trials = []
    for task in tasks:
        success_rate = min(0.99, max(0.02, skill + CATEGORY_EFFECTS[task.category] - (0.1 if task.scope == "full" else 0.0)))
        for epoch in range(1, epochs + 1):
            trials.append(_random_trial(task, epoch, success_rate, rng, judged, latency_s, perception_share, broken_share))
    run_card = card(planner, perception, epochs=epochs, **extra)
    return Evaluation(card=run_card, trials=tuple(trials), wanted=len(trials))


def _random_trial(
    task: TaskFacts, epoch: int, success_rate: float, rng: random.Random, judged: bool, latency_s: tuple[float, float],
    share: float, broken_share: float,
) -> Trial:  # fmt: skip
    roll = rng.random()
    broken = "infrastructure" if roll < broken_share else "unscored" if roll < 2 * broken_share else None
    headline = broken or ("correct" if rng.random() < success_rate else "incorrect")
    mode = None
    if headline == "incorrect":
        perception_modes = (ErrorMode.VLM_COUNTING, ErrorMode.VLM_QUERY)
        others = tuple(m for m in ErrorMode if m not in perception_modes)
        mode = rng.choice(perception_modes) if rng.random() < share else rng.choice(others)
    planner_s, perception_s = (rng.lognormvariate(0, 0.4) * seconds for seconds in latency_s)
    judge_agrees = (headline == "correct") != (rng.random() < 0.06)
    verdict: Any = ("correct" if judge_agrees else "incorrect") if rng.random() < 0.97 else "unparseable"
    judgement = Judgement(
        judge=JUDGE, prompt="standard-1", verdict=verdict,
        error_mode=(mode or ErrorMode.REASONING) if verdict == "incorrect" else None,
        reason="The count is wrong." if mode else "", input_tokens=2000, output_tokens=150,
    )  # fmt: skip
    call_s = perception_s if task.scope == "current" else perception_s * 1.25
    return trial(
        task, headline, epoch=epoch, sample=f"{task.id}/{epoch}", error_mode=mode, judgements=(judgement,) if judged else (),
        timings=Timings(planner_s=planner_s, perception_s=perception_s, camera_s=0.2, render_s=0.1,
                        total_s=planner_s + perception_s + 0.35),
        looks=(ObservationTime(view=task.scope, eyes_s=call_s, capture_s=0.25, call_s=call_s + 0.3),), input_tokens=3000,
        output_tokens=200, cost_usd=0.002, collateral=rng.random() < 0.03, steps=rng.randint(2, 6),
    )  # fmt: skip


def sweep(per_category: int = 6) -> list[Evaluation]:
    """Return an invented sweep of six pairs, of which one has repeats, and further evaluations.

    These are a rerun with ground-truth perception, the baseline, a prompt variant, a latency run, paraphrases, reaction tasks,
    a blind baseline, and an incomplete evaluation with many broken trials.
    """
    tasks = facts(per_category)
    planners = (("qwen3-4b", 0.55, 1.9), ("qwen3-4b-fp8", 0.54, 1.0), ("qwen3-30b-a3b", 0.68, 1.4))
    perception_models = (("moondream2", -0.04, 6.0), ("moondream3", 0.03, 9.2))
    evaluations = [
        evaluation(
            p, e, tasks, skill + gain, latency_s=(planner_s, perception_s), epochs=3 if (p, e) == ("qwen3-4b", "moondream2") else 1
        )
        for e, gain, perception_s in perception_models
        for p, skill, planner_s in planners
    ]
    evaluations.append(evaluation("qwen3-30b-a3b", "ground-truth", tasks, 0.88, perception_share=0.0))
    evaluations.append(evaluation("grammar", "ground-truth", tasks, 1.2, judged=False, latency_s=(0.01, 0.05), broken_share=0.0))
    evaluations.append(evaluation("qwen3-4b", "moondream3", tasks, 0.5, seed=1, variant="prompt short-1"))
    evaluations.append(
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
    evaluations.append(evaluation("qwen3-30b-a3b", "moondream3", paraphrases(tasks[::6]), 0.66, split="paraphrase"))
    requests = tuple(t.model_copy(update={"stratum": "reaction", "id": f"{t.id}7"}) for t in tasks[::9])
    evaluations.append(evaluation("qwen3-30b-a3b", "moondream3", requests, 0.5, split="reaction"))
    evaluations.append(evaluation("qwen3-30b-a3b", "blind", tasks, 0.05, variant="blind", latency_s=(1.0, 0.0)))
    evaluations.append(evaluation("qwen3-4b", "qwen2.5-vl-7b", tasks[: len(tasks) // 2], 0.3, broken_share=0.3, judged=False))
    return evaluations
