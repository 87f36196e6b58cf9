"""The sections on tasks that nearly every pair fails, costs, side effects and incidents."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from statistics import fmean

from scope_ptz.bench.reports.details.error_analysis import MODE_TITLES
from scope_ptz.bench.reports.report_runs import CATEGORY_TITLES, ReportRun
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import CellValue, Column, MarkedCell, ReportTable
from scope_ptz.bench.scoring.trials import Trial

MAX_SUCCESS = 0.25
"""Maximum success rate of tasks in the audit section."""
MAX_LISTED = 60
"""Maximum number of tasks in the audit section."""


def audit_section(ranked: Sequence[ReportRun], reference: Sequence[ReportRun], pages: Mapping[str, str]) -> Section:
    """Return the section that lists the tasks with a low success rate over all pairs.

    Args:
        ranked: The runs of model pairs.
        reference: Runs of the grammar planner with exact ground-truth perception.
        pages: Links to the pages about failed tasks, by task id.
    """
    text = [
        f"This section lists the tasks on which at most {MAX_SUCCESS:.0%} of the trials of all pairs succeed. Such a task is hard "
        "or wrong, so check these tasks first in an audit of the benchmark. The last column is the result of the grammar planner "
        "with ground-truth perception. If they pass a task, it can be done as it is worded. Their failure does not show that a "
        "task is wrong, because they understand only a limited language."
    ]
    if len(ranked) < 2:
        text.append("There are fewer than two model pairs, so this is not measured.")
        return Section("audit", "Tasks that nearly every pair fails", tuple(text))
    by_task = _by_task(ranked)
    rates = sorted((fmean(t.headline == "correct" for _, t in trials), task) for task, trials in by_task.items())
    selected = [(rate, task) for rate, task in rates if rate <= MAX_SUCCESS]
    exact = _by_task(reference)
    columns = (
        Column("task", "Task"),
        Column("category", "Category"),
        Column("scope", "Scope"),
        Column("instruction", "Instruction", "prose"),
        Column("expected", "Expected", "prose"),
        Column("success", "Success (%)", "share"),
        Column("trials", "Trials", "count"),
        Column("passed_by", "Passed by"),
        Column("modes", "Error modes (rules)"),
        Column("reference", "Grammar planner, ground-truth perception (%)", "share"),
    )
    rows = tuple(_audit_row(task, rate, by_task[task], exact.get(task, []), pages) for rate, task in selected[:MAX_LISTED])
    text.append(
        f"{len(selected)} of {len(by_task)} tasks have such a low success rate."
        + (f" The {MAX_LISTED} with the lowest rates are listed." if len(selected) > MAX_LISTED else "")
    )
    return Section(
        "audit", "Tasks that nearly every pair fails", tuple(text), (), (ReportTable("audit", "Tasks to audit", columns, rows),)
    )


def _by_task(runs: Sequence[ReportRun]) -> dict[str, list[tuple[ReportRun, Trial]]]:
    """Return the scored trials of each task with their runs, by task id."""
    trials: dict[str, list[tuple[ReportRun, Trial]]] = defaultdict(list)
    for run in runs:
        for trial in run.scored_trials:
            trials[trial.task.id].append((run, trial))
    return trials


def _audit_row(
    task: str,
    success: float,
    trials: Sequence[tuple[ReportRun, Trial]],
    reference_trials: Sequence[tuple[ReportRun, Trial]],
    pages: Mapping[str, str],
) -> tuple[CellValue, ...]:
    facts = trials[0][1].task
    passed_by = list(dict.fromkeys(run.label for run, trial in trials if trial.headline == "correct"))
    modes = Counter(trial.error_mode for _, trial in trials if trial.error_mode)
    mode_counts = ", ".join(f"{MODE_TITLES[mode]} {number}" for mode, number in modes.most_common())
    reference = fmean(trial.headline == "correct" for _, trial in reference_trials) if reference_trials else None
    return (
        MarkedCell(task, link=pages.get(task, "")),
        CATEGORY_TITLES[facts.category],
        facts.scope,
        facts.instruction,
        facts.expected,
        success,
        len(trials),
        "; ".join(passed_by) or "nobody",
        mode_counts or "none",
        reference,
    )


def costs_section(runs: Sequence[ReportRun]) -> Section:
    """Return the section on the tokens and the cost of each run."""
    columns = (
        Column("run", "Run"),
        Column("trials", "Trials", "count"),
        Column("input_tokens", "Input tokens", "count"),
        Column("output_tokens", "Output tokens", "count"),
        Column("tokens_a_trial", "Tokens per trial, mean", "count"),
        Column("priced", "Priced trials", "count"),
        Column("cost_usd", "Cost of priced trials (USD)", "usd"),
        Column("cost_a_trial", "USD per trial", "usd"),
        Column("cost_a_success", "USD per correct trial", "usd"),
        Column("judge_tokens", "Tokens of judges", "count"),
    )
    notes = (
        "Tokens are those of the planner, as reported by its server. The tokens of the perception model are not counted. The cost "
        "is that of the planner's tokens. It is stated only if the log contains prices.",
    )
    return Section(
        "costs", "Cost", (), (), (ReportTable("costs", "Tokens and cost", columns, tuple(_cost_row(r) for r in runs), notes),)
    )


def _cost_row(run: ReportRun) -> tuple[CellValue, ...]:
    trials = run.evaluation.trials
    input_tokens, output_tokens = sum(t.input_tokens for t in trials), sum(t.output_tokens for t in trials)
    tokens = input_tokens + output_tokens
    priced = [t for t in trials if t.cost_usd is not None]
    cost = sum(t.cost_usd or 0.0 for t in priced) if priced else None
    correct = sum(t.headline == "correct" for t in priced)
    judge = sum(j.input_tokens + j.output_tokens for t in trials for j in t.judgements)
    return (
        run.label,
        len(trials),
        input_tokens if tokens else None,
        output_tokens if tokens else None,
        tokens / len(trials) if tokens else None,
        len(priced),
        cost,
        cost / len(priced) if cost is not None else None,
        cost / correct if cost is not None and correct else None,
        judge or None,
    )


def incidents_section(runs: Sequence[ReportRun]) -> Section:
    """Return the section on collateral changes, invalid calls, perception failures and server failures."""
    columns = (
        Column("run", "Run"),
        Column("collateral", "Collateral change (%)", "share"),
        Column("bad_calls", "Invalid calls per trial", "number"),
        Column("perception_failures", "Failed perception calls per trial", "number"),
        Column("steps", "Steps per trial", "number"),
        Column("limit", "At the step or time limit (%)", "share"),
        Column("server_events", "Server failures, including recovered ones"),
    )
    notes = (
        "Collateral change: the camera ended at another pose although neither the instruction nor the answer required a move. It "
        "does not affect accuracy.",
    )
    rows = tuple(_incidents_row(run) for run in runs if run.evaluation.trials)
    return Section(
        "conduct",
        "Side effects and incidents",
        (),
        (),
        (ReportTable("conduct", "Side effects and incidents", columns, rows, notes),),
    )


def _incidents_row(run: ReportRun) -> tuple[CellValue, ...]:
    trials = [t for t in run.evaluation.trials if t.headline != "infrastructure"]
    events = sum((Counter(t.server_events) for t in run.evaluation.trials), Counter[str]())
    failures = ", ".join(f"{kind} {number}" for kind, number in sorted(events.items())) or "none"
    if not trials:
        return run.label, None, None, None, None, None, failures
    return (
        run.label,
        fmean(t.collateral for t in trials),
        fmean(t.bad_calls for t in trials),
        fmean(t.perception_failures for t in trials),
        fmean(t.steps for t in trials),
        fmean(t.outcome in ("step_limit", "budget") for t in trials),
        failures,
    )
