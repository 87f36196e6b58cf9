"""Draw evaluations of simulated pairs, and store them in the format that ``scope bench report`` reads."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from scope_ptz.agent.timing import Timings
from scope_ptz.bench.reports.report_runs import SIMULATED_PROVIDER
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import CheckRecord, Evaluation, Judgement, ModelCard, ObservationTime, RunCard, Trial
from tests.bench.reports.simulated.items import Item, core_items
from tests.bench.reports.simulated.strengths import (
    JUDGE_AGREEMENT,
    JUDGE_UNPARSEABLE,
    PANORAMA_RATIO,
    UNSCORED_SHARE,
    Numbers,
    Pair,
    paper_pairs,
    success_probabilities,
    viewpoint_effects,
)

JUDGE = "simulated-judge"
COMMANDS = ("single_call", "multi_step_command")
"""Categories of tasks without a perception call."""
PLANNER_MODES = tuple(mode for mode in ErrorMode if mode not in (ErrorMode.VLM_QUERY, ErrorMode.VLM_COUNTING))
SPREAD = 0.35
"""Standard deviation of the logarithm of all seconds."""
BASELINE = Pair(
    "grammar", "ground-truth", dict.fromkeys(paper_pairs()[0].accuracy, 0.95), 0.0, 0.004, 0.002, 1.6
)  # fmt: skip
"""The pair that represents the built-in planner."""
FAILURE = "simulated: the planner's server ended"


def full_sweep(seed: int = 0, items: Sequence[Item] | None = None) -> list[Evaluation]:
    """Return the paper's 19 pairs, a rerun of each planner with ground-truth perception, and a baseline.

    The last rerun ended in an error before its last tasks.
    """
    pairs = paper_pairs()
    planners = {pair.planner: pair for pair in pairs}  # each with its last perception model
    reruns = [pair.with_perfect_perception() for pair in planners.values()]
    evaluations = [evaluation(pair, seed, items) for pair in (*pairs, *reruns, BASELINE)]
    cut = len(pairs) + len(reruns) - 1
    trials = evaluations[cut].trials[: 9 * len(evaluations[cut].trials) // 10]
    evaluations[cut] = evaluations[cut].model_copy(update={"trials": trials, "failure": FAILURE})
    return evaluations


def store(evaluations: Sequence[Evaluation], folder: Path) -> list[Path]:
    """Write evaluations as results that ``scope bench report`` reads. Their names mark them as simulated."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for run in evaluations:
        paths.append(folder / f"simulated-{run.card.run_id}.json")
        paths[-1].write_text(run.model_dump_json(), "utf-8")
    return paths


def evaluation(pair: Pair, seed: int = 0, items: Sequence[Item] | None = None, population: Numbers | None = None) -> Evaluation:
    """Draw one evaluation of a pair.

    Args:
        pair: The pair.
        seed: The replicate. Viewpoints have the same effects on all pairs of a replicate.
        items: The items (default: the core tasks).
        population: Difficulties over which the mean success is the known accuracy (default: those of the items).
    """
    chosen = tuple(items if items is not None else core_items())
    rng = np.random.default_rng([seed, 2, *pair.label.encode()])
    success = success_probabilities(pair, chosen, viewpoint_effects(chosen, seed), population)
    trials = tuple(_trial(pair, item, p, rng) for item, p in zip(chosen, success.tolist(), strict=True))
    return Evaluation(card=card(pair, seed), trials=trials, wanted=len(trials))


def card(pair: Pair, seed: int) -> RunCard:
    """Return the run card of a pair. Its provider marks it as simulated."""
    is_truth, is_baseline = pair.perception == "ground-truth", pair.planner == "grammar"
    return RunCard(
        run_id=f"{pair.planner}-{pair.perception}-{seed}", started="2026-01-01T00:00:00Z", package_version="0", engine_version="0",
        dataset="scope1", dataset_digest="0" * 64, split="core", max_steps=60, seed=seed, sampling={"temperature": 0.7},
        prompt_digest="0" * 64, concurrency=8 if pair.contended else 1, contended=pair.contended, host="simulated",
        planner=ModelCard(
            name=f"simulated-{pair.planner}", registry=None if is_baseline else pair.planner, provider=SIMULATED_PROVIDER,
            deterministic=is_baseline,
        ),
        perception=ModelCard(
            name=pair.perception_name, registry=None if is_truth else pair.perception, provider=SIMULATED_PROVIDER,
            deterministic=is_truth,
        ),
    )  # fmt: skip


def _trial(pair: Pair, item: Item, success: float, rng: np.random.Generator) -> Trial:
    facts = item.facts
    headline = _headline(pair, success, rng)
    mode = _mode(pair, facts.category, rng) if headline == "incorrect" else None
    calls = 1 + int(rng.poisson(max(0.0, pair.tool_calls - 1)))
    planner_s = pair.planner_s * float(rng.lognormal(0, SPREAD))
    call_s = pair.perception_s * float(rng.lognormal(0, SPREAD)) * (PANORAMA_RATIO if facts.scope == "full" else 1.0)
    is_command = facts.category in COMMANDS
    tool = "count_objects" if facts.category == "counting" else "query_answer"
    perception_s = 0.0 if is_command else call_s
    return Trial(
        task=facts, sample=f"{facts.id}/1", headline=headline, reason="simulated", error_mode=mode, outcome="answered",
        answer="simulated", checks=(CheckRecord(name="answer", passed=headline == "correct", reason="simulated"),),
        steps=calls + 1, tool_calls={"go_to_preset": calls} if is_command else {tool: 1, "adjust_ptz": calls - 1},
        collateral=bool(rng.random() < 0.03), input_tokens=1500 * (calls + 1), output_tokens=40 * (calls + 1), cost_usd=0.001,
        server_events={"timeout": 1} if headline == "infrastructure" else {},
        timings=Timings(
            planner_s=planner_s, perception_s=perception_s, camera_s=0.1, render_s=0.1, first_token_s=0.2 * planner_s,
            total_s=planner_s + perception_s + 0.25,
        ),
        looks=() if is_command else (ObservationTime(view=facts.scope, eyes_s=call_s, capture_s=0.2, call_s=call_s + 0.25),),
        judgements=() if pair.planner == "grammar" else (_judgement(headline, mode, rng),),
    )  # fmt: skip


def _headline(pair: Pair, success: float, rng: np.random.Generator) -> Any:
    if rng.random() < pair.lost:
        return "infrastructure"
    if rng.random() < success:
        return "correct"
    return "unscored" if rng.random() < UNSCORED_SHARE else "incorrect"


def _mode(pair: Pair, category: str, rng: np.random.Generator) -> ErrorMode:
    if rng.random() < pair.perception_share:
        return ErrorMode.VLM_COUNTING if category == "counting" else ErrorMode.VLM_QUERY
    return PLANNER_MODES[int(rng.integers(len(PLANNER_MODES)))]


def _judgement(headline: str, mode: ErrorMode | None, rng: np.random.Generator) -> Judgement:
    agrees = bool(rng.random() < JUDGE_AGREEMENT)
    verdict: Any = "correct" if (headline == "correct") == agrees else "incorrect"
    if rng.random() < JUDGE_UNPARSEABLE:
        verdict = "unparseable"
    return Judgement(
        judge=JUDGE, prompt="simulated", verdict=verdict, reason="simulated", input_tokens=2000, output_tokens=150,
        error_mode=(mode or ErrorMode.REASONING) if verdict == "incorrect" else None,
    )  # fmt: skip
